// SPDX-License-Identifier: Apache-2.0
// Reports the error of faces, what is proven of it, and why faces are off.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "messages.h"
#include "summary/summary.h"

namespace vdb_offset::tool {
namespace {

// Causes that make up less than this share of the error are not reported: what helps against them would not be seen.
constexpr double kLeastTold = 0.25;
// Miters whose planes go too far by no more than this share do not count as a cause. The error up to which area counts
// as being at the distance.
constexpr double kWorthTelling = 0.01;

// Share of the distance by less than which faces that are farther are not reported. Not measured: nobody would see it.
constexpr double kLeastFarther = 1e-3;

/// A share as a percentage; next to nothing is rounding.
std::string percent(double share) { return share < 1e-8 ? "0" : fmt::format("{:.3g}", 100 * share); }

/// A share of the area in percent, never more than it is: 100 is all of it.
std::string area_percent(double share) { return fmt::format("{:.2f}", std::floor(1e4 * share) / 100); }

/// Whether faces could be split in place of a mesh that is finer, for which the option is named then.
bool may_be_split(const Job& job, const OffsetStatistics& statistics) {
  return !statistics.certified && !job.curves() && !job.request.layers && !job.request.axes && !job.to_fit &&
         !job.shell && job.files.outputs.size() == 1;
}

/// Which corners faces are off beside, and what helps. Where more than two faces meet at an edge, nothing does.
std::string corners_in_words(const Job& job, const OffsetStatistics& statistics) {
  const char *const faces = job.curves() ? "segments" : "faces", *const branches =
                                                                     job.curves() ? "where curves branch"
                                                                                  : "at edges of more than two faces";
  const bool any_branches = statistics.facts.non_manifold_edges > 0;
  if (job.options.corners == Corners::Round)
    return fmt::format("beside sharp corners: --corners miter puts {} at the distance{}{}{}", faces,
                       any_branches ? ", but not " : "", any_branches ? branches : "",
                       may_be_split(job, statistics) ? "; --tolerance 1% splits them until they are" : "");
  const MiterFacts& miters = statistics.miters;
  std::vector<std::string> which;
  if (miters.unproven + miters.taken_back > 0) which.emplace_back("that have no room for a miter");
  if (miters.cut > 0) which.emplace_back("that are cut (a larger --miter-limit helps)");
  if (miters.excess > kWorthTelling) which.emplace_back("where more planes meet than one point can be on");
  if (any_branches) which.emplace_back(branches);
  return fmt::format("beside sharp corners {}",
                     which.empty() ? "that are not mitred" : fmt::to_string(fmt::join(which, ", or ")));
}

/// Says how much is too far away at corners of many planes, and what helps.
void print_beyond(std::FILE* out, const Job& job, const OffsetStatistics& statistics) {
  const FaceError& faces = statistics.faces;
  if (faces.beyond < kWorthTelling) return;
  fmt::print(out,
             "{:.1f} % of the area is too far away, by up to {:.0f} %, beside corners where more planes meet than one "
             "vertex can be on{}\n",
             100 * faces.beyond, 100 * faces.most_beyond,
             may_be_split(job, statistics)
                 ? fmt::format(": --tolerance 1%{} splits faces until they are at the distance",
                               job.options.corners == Corners::Round ? " --corners miter" : "")
                 : "");
}

}  // namespace

void print_faces(std::FILE* out, const FaceError& faces, bool curves) {
  if (faces.samples == 0) return;
  fmt::print(out, "; {} {} % off on average, {:.1f} % of the {} within 1 %", curves ? "segments" : "faces",
             percent(faces.mean), 100 * faces.at_distance, curves ? "length" : "area");
  if (faces.farther > kLeastFarther) fmt::print(out, ", {:.3g} % farther by miters", 100 * faces.farther);
}

std::size_t faces_in(const MeshFacts& facts) {
  std::size_t faces = 0;
  for (const auto& [corners, count] : facts.faces_by_corners) faces += count;
  return faces;
}

std::string certified_in_words(const CertifiedFaces& certified) {
  const std::string within =
      certified.share > 0 ? fmt::format("{:.6g} %", 100 * certified.share) : fmt::format("{:.6g}", certified.length);
  std::string words =
      fmt::format("{} % of the area certified within {} at every point", area_percent(certified.certified), within);
  if (certified.certified < certified.there) {
    words += fmt::format(", of {} % whose vertices are there", area_percent(certified.there));
    // An error of 0: it was not found, and not ruled out either.
    if (certified.worst_left > 0) words += fmt::format(" (up to {:.3g} % off)", 100 * certified.worst_left);
  }
  // The area is that of the source, and what has little there may have much in the offset.
  if (certified.worst > certified.worst_left)
    words += fmt::format(", and the worst of all faces up to {:.3g} % off", 100 * certified.worst);
  return words;
}

void print_certified(std::FILE* out, const CertifiedFaces& certified, std::size_t faces) {
  fmt::print(out, "; {}", certified_in_words(certified));
  if (certified.source_faces > 0) fmt::print(out, " ({} -> {} faces)", certified.source_faces, faces);
}

bool is_certified(const CertifiedFaces& certified, bool strict, const std::string& offset) {
  if (certified.out_of_faces)
    tell(
        fmt::format("--max-faces: {}: expected more faces, as those whose vertices are at the distance are up to "
                    "{:.3g} % off",
                    offset, 100 * certified.worst_left));
  else if (strict && certified.certified < 1)
    tell(fmt::format("--strict: {}: {}", offset, certified_in_words(certified)));
  else return true;
  return false;
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
  print_beyond(out, job, statistics);
  const FaceError& faces = statistics.faces;
  const bool curves = job.curves();
  std::vector<std::pair<double, std::string>> causes{
      {faces.held_back,
       fmt::format("beside {} that fall short: a smaller distance has more room", curves ? "points" : "vertices")},
      {faces.stuck, fmt::format("beside {} that have no room at any distance", curves ? "points" : "vertices")},
      {faces.no_room, "where walls or gaps are narrower than two distances: only a smaller distance has room there"},
      {faces.corners, corners_in_words(job, statistics)},
      {faces.coarse, curves ? "because they are long: more points help"
                     : may_be_split(job, statistics)
                         ? "because they are coarse: --tolerance 1% splits them until they are at the distance"
                         : "because they are coarse: a finer mesh helps"}};
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
