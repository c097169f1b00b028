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
// Miters whose planes go too far by no more than this share do not count as a cause. The error up to which area counts
// as being at the distance.
constexpr double kWorthTelling = 0.01;

/// A share as a percentage; next to nothing is rounding.
std::string percent(double share) { return share < 1e-8 ? "0" : fmt::format("{:.3g}", 100 * share); }

/// Which corners faces are off beside, and what helps. Where more than two faces meet at an edge, nothing does.
std::string corners_in_words(const Job& job, const OffsetStatistics& statistics) {
  const char *const faces = job.curves() ? "segments" : "faces", *const branches =
                                                                     job.curves() ? "where curves branch"
                                                                                  : "at edges of more than two faces";
  const bool any_branches = statistics.facts.non_manifold_edges > 0;
  if (job.options.corners == Corners::Round)
    return fmt::format("beside sharp corners: --corners miter puts {} at the distance{}{}", faces,
                       any_branches ? ", but not " : "", any_branches ? branches : "");
  const MiterFacts& miters = statistics.miters;
  std::vector<std::string> which;
  if (miters.unproven + miters.taken_back > 0) which.emplace_back("that have no room for a miter");
  if (miters.cut > 0) which.emplace_back("that are cut (a larger --miter-limit helps)");
  if (miters.excess > kWorthTelling) which.emplace_back("where more planes meet than one point can be on");
  if (any_branches) which.emplace_back(branches);
  return fmt::format("beside sharp corners {}",
                     which.empty() ? "that are not mitred" : fmt::to_string(fmt::join(which, ", or ")));
}

}  // namespace

void print_faces(std::FILE* out, const FaceError& faces, bool curves) {
  if (faces.samples == 0) return;
  fmt::print(out, "; {} {} % off on average, {:.1f} % of the {} within 1 %", curves ? "segments" : "faces",
             percent(faces.mean), 100 * faces.at_distance, curves ? "length" : "area");
}

void print_layers_faces(std::FILE* out, const FaceError& outermost, const FaceError& first, bool curves) {
  if (outermost.samples == 0) return;
  const char* const of = curves ? "length" : "area";
  fmt::print(out, "{} of the outermost {} are {} % off on average, {:.1f} % of the {} within 1 %",
             curves ? "segments" : "faces", curves ? "curve" : "surface", percent(outermost.mean),
             100 * outermost.at_distance, of);
  fmt::print(out, "; at the first height {} %, {:.1f} % of the {}\n", percent(first.mean), 100 * first.at_distance, of);
}

void print_iso_cause(std::FILE* out, const FaceError& faces) {
  if (faces.mean > kWorthTelling)
    fmt::print(out, "faces are off as their edges are as long as voxels are large: a smaller --voxel-size helps\n");
}

void print_face_causes(std::FILE* out, const Job& job, const OffsetStatistics& statistics) {
  const FaceError& faces = statistics.faces;
  const bool curves = job.curves();
  std::vector<std::pair<double, std::string>> causes{
      {faces.held_back,
       fmt::format("beside {} that fall short: a smaller distance has more room", curves ? "points" : "vertices")},
      {faces.corners, corners_in_words(job, statistics)},
      {faces.coarse,
       curves ? "because they are long: more points help" : "because they are coarse: a finer mesh helps"}};
  std::erase_if(causes, [](const auto& cause) { return cause.first < kLeastTold; });
  if (causes.empty()) return;
  std::stable_sort(causes.begin(), causes.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> words;
  words.reserve(causes.size());
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
