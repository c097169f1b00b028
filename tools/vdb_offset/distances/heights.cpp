// SPDX-License-Identifier: Apache-2.0
#include "distances/heights.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>

#include "distances/evaluate.h"
#include "request/option_values.h"
#include "vdb_offset/io/file_bytes.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

/// The heights of layers whose thickness grows by a factor from one to the next.
std::vector<Distances> geometric_heights(const Job& job) {
  const LayersRequest& layers = *job.request.layers;
  std::vector<double> factors;  // of each layer: its height as a multiple of the first layer's
  factors.reserve(layers.count);
  double sum = 0, step = 1;
  for (std::size_t k = 0; k < layers.count; ++k, step *= layers.growth) factors.push_back(sum += step);
  const Distances given = evaluate(job, layers.first ? *layers.first : *layers.total);
  std::vector<Distances> heights;
  heights.reserve(factors.size());
  for (const double factor : factors) heights.push_back(scaled(given, layers.first ? factor : factor / sum));
  return heights;
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
  return job.request.layers->heights.empty() ? geometric_heights(job) : read_heights(job);
}

}  // namespace vdb_offset::tool
