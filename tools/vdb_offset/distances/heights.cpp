// SPDX-License-Identifier: Apache-2.0
#include "distances/heights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "distances/evaluate.h"
#include "distances/part_distances.h"
#include "layers/flow.h"
#include "request/option_values.h"
#include "vdb_offset/io/file_bytes.h"
#include "vdb_offset/layer_plan.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

/// One of the lengths of layers, of which parts may have their own.
std::optional<Distances> length_of(const Job& job, const std::optional<DistanceRequest>& asked, bool of_parts) {
  if (!asked) return std::nullopt;
  return of_parts && are_of_parts(job, *asked) ? distances_of_parts(job, *asked).of_vertices() : evaluate(job, *asked);
}

/// The first height at which y+ has the value that is asked for, of which parts may have their own.
Distances first_of_y_plus(const Job& job, double y_plus) {
  const io::Flow flow = flow_of(job);
  const double height = height_of_y_plus(std::abs(y_plus), flow.speed * flow.length / flow.viscosity) * flow.length;
  return *length_of(job, DistanceRequest{"", {.value = y_plus < 0 ? -height : height}, {}}, true);
}

/// The heights of layers each of which is thicker by one factor than that below.
std::vector<Distances> planned_heights(const Job& job) {
  const LayersRequest& layers = *job.request.layers;
  if (job.request.blend.value > 0 && job.request.distances_of.empty())
    throw InvalidOption("--blend: expected --layers-of");
  LayerPlan plan;
  if (layers.count > 0) plan.count = layers.count;
  plan.growth = layers.growth;
  plan.first = layers.y_plus ? first_of_y_plus(job, *layers.y_plus) : length_of(job, layers.first, true);
  plan.total = length_of(job, layers.total, !plan.first);
  plan.last = length_of(job, layers.last, !plan.first && !plan.total);
  return plan_layers(plan);
}

constexpr std::size_t kLongestHeight = 4096;  // bytes: twice the longest expression, or the longest path

/// Reads a file of heights: one a line; empty lines, and text behind a #, are ignored. Files that it names are looked
/// for in its own folder.
std::vector<Distances> read_heights(Job& job) {
  const LayersRequest& layers = *job.request.layers;
  const std::string& path = layers.heights;
  std::error_code unknown;
  if (std::filesystem::is_directory(path, unknown)) throw ReadError(path + ": expected a file, got a folder");
  const io::FileBytes bytes = io::FileBytes::open(path);
  std::string_view rest = bytes.view();
  std::vector<Distances> heights;
  for (std::size_t number = 1; !rest.empty(); ++number) {
    const std::string_view whole = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(whole.size() + 1, rest.size()));
    std::string_view text = whole.substr(0, whole.find('#'));
    const std::size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string::npos) continue;
    text = text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
    if (text.size() > kLongestHeight)
      throw InvalidInput(fmt::format("{}: line {}: expected a height of at most {} characters, got {}", path, number,
                                     kLongestHeight, text.size()));
    const std::string line(text);
    try {
      DistanceRequest request = parse_distance_request(line);
      if (line.starts_with('@')) {
        request.from = (std::filesystem::path(path).parent_path() / request.from).string();
        job.files_of_heights.push_back(request.from);
      }
      heights.push_back(evaluate(job, request));
    } catch (const Error& error) {
      throw InvalidInput(fmt::format("{}: line {}: {}", path, number, error.what()));
    }
  }
  if (heights.empty()) throw InvalidInput(path + ": expected a height on each line, got none");
  if (layers.count > 0 && heights.size() != layers.count)
    throw InvalidInput(fmt::format("{}: expected {} heights, got {}", path, layers.count, heights.size()));
  return heights;
}

}  // namespace

std::vector<Distances> heights_of_layers(Job& job) {
  return job.request.layers->heights.empty() ? planned_heights(job) : read_heights(job);
}

}  // namespace vdb_offset::tool
