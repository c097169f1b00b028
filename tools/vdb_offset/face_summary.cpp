// SPDX-License-Identifier: Apache-2.0
// What is told of the error of faces.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "messages.h"
#include "summary.h"

namespace vdb_offset::tool {
namespace {

// Causes that make up less than this share of the error are not told: what helps against them would not be seen.
constexpr double kLeastTold = 0.25;

/// A share as a percentage; next to nothing is rounding.
std::string percent(double share) { return share < 1e-8 ? "0" : fmt::format("{:.3g}", 100 * share); }

std::string corners_in_words(const Job& job) {
  if (job.options.corners == Corners::Round)
    return fmt::format("beside sharp corners: --corners miter puts {} at the distance",
                       job.curves() ? "segments" : "faces");
  return "beside sharp corners that are not mitred, as there is no room, or that are cut";
}

}  // namespace

void print_faces(std::FILE* out, const FaceError& faces, bool curves) {
  if (faces.samples == 0) return;
  fmt::print(out, "; {} {} % off on average, {:.1f} % of the {} within 1 %", curves ? "segments" : "faces",
             percent(faces.mean), 100 * faces.at_distance, curves ? "length" : "area");
}

void print_face_causes(std::FILE* out, const Job& job, const FaceError& faces) {
  const bool curves = job.curves();
  std::vector<std::pair<double, std::string>> causes{
      {faces.held_back,
       fmt::format("beside {} that fall short: a smaller distance has more room", curves ? "points" : "vertices")},
      {faces.corners, corners_in_words(job)},
      {faces.coarse,
       curves ? "because they are long: more points help" : "because they are coarse: a finer mesh helps"}};
  std::erase_if(causes, [](const auto& cause) { return cause.first < kLeastTold; });
  if (causes.empty()) return;
  std::stable_sort(causes.begin(), causes.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> words;
  for (const auto& [share, text] : causes) words.push_back(fmt::format("{} ({:.0f} % of it)", text, 100 * share));
  fmt::print(out, "{} are off mostly {}\n", curves ? "segments" : "faces", fmt::join(words, ", and "));
}

bool are_within(const FaceError& faces, double bound, const std::string& offset) {
  if (100 * faces.quantile_99 <= bound) return true;
  tell(fmt::format("--strict-faces: {}: 99 % of it is within {:.3g} % of the distance, expected {:g} %", offset,
                   100 * faces.quantile_99, bound));
  return false;
}

}  // namespace vdb_offset::tool
