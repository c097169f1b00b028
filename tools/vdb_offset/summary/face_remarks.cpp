// SPDX-License-Identifier: Apache-2.0
// How far faces are from the distance, what is proven of them, and where the error comes from.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "messages.h"
#include "outputs.h"
#include "summary/summary.h"

namespace vdb_offset::tool {
namespace {

// Causes that make up less than this share of the error are not reported: what helps against them would not be seen.
constexpr double kLeastCause = 0.25;
// Miters whose planes go too far by no more than this share do not count as a cause. The error up to which area counts
// as being at the distance.
constexpr double kFaceAtDistance = 0.01;

// Share of the area with room from which on so little is left that it is not worth a warning. That which --preset part
// asks for.
constexpr double kAsGoodAsAll = 0.99;

// Share of the distance by less than which faces that are farther are not reported. Not measured: nobody would see it.
constexpr double kLeastFarther = 1e-3;

/// A share as a percentage; next to nothing is rounding.
std::string percent(double share) { return share < 1e-8 ? "0" : fmt::format("{:.3g}", 100 * share); }

/// Whether faces could be split in place of a mesh that is finer, for which the option is named then.
bool may_be_split(const Job& job, const OffsetStatistics& statistics) {
  return !statistics.certified && !job.curves() && !job.request.layers && !job.request.axes && !job.to_fit &&
         !job.shell && job.files.outputs.size() == 1 && !is_cad_output(job.request.output, job.request);
}

// The least angle of fans that is advised, degrees: they are finer than most meshes then.
constexpr double kLeastFanAngle = 10;

/// Why faces at sharp corners are off, and what helps. Where more than two faces meet at an edge, nothing does.
std::string corners_in_words(const Job& job, const OffsetStatistics& statistics) {
  const bool any_branches = statistics.facts.non_manifold_edges > 0;
  const char* const branches = job.curves() ? "where curves branch" : "at edges of more than two faces";
  if (job.request.corners == Corners::Round)
    return fmt::format("is at sharp corners, where --corners round keeps the vertices at it{}",
                       may_be_split(job, statistics) ? ". To split the faces there: --tolerance 1%" : "");
  if (const double angle = job.request.layers ? fan_angle_of(job.request) : 0; angle > 0 && !any_branches)
    return fmt::format("is at sharp corners. Use a smaller angle of fans: --fan-angle {:.3g}",
                       std::max(kLeastFanAngle, angle / 2));
  if (job.corners() == Corners::Round)
    return fmt::format("is at sharp corners. Use --corners miter{}{}",
                       may_be_split(job, statistics) ? ", or --tolerance 1% to split the faces there" : "",
                       any_branches ? fmt::format(" (neither helps {})", branches) : "");
  const MiterFacts& miters = statistics.miters;
  std::vector<std::string> which;
  const std::size_t round = miters.unproven + miters.taken_back;
  if (round > 0) which.emplace_back("without room for a miter");
  if (miters.cut > 0) which.emplace_back("whose miters are cut");
  if (miters.excess > kFaceAtDistance) which.emplace_back("where more planes meet than one point can be on");
  if (any_branches) which.emplace_back(branches);
  return fmt::format("is at sharp corners {}{}",
                     which.empty() ? "without a miter" : fmt::to_string(fmt::join(which, ", or ")),
                     miters.cut > round              ? ". Use a larger --miter-limit"
                     : job.request.layers            ? ""
                     : may_be_split(job, statistics) ? ". To split the faces there: --tolerance 1%"
                                                     : "");
}

/// How much is too far away at corners of many planes, and what helps.
void add_beyond(const Job& job, const OffsetStatistics& statistics, Remarks& remarks) {
  const FaceError& faces = statistics.faces;
  if (faces.beyond < kFaceAtDistance) return;
  remarks.add(Gravity::Off,
              fmt::format("{:.1f} % of the area is too far away, by up to {:.0f} %, at corners where more planes meet "
                          "than one vertex can be on{}",
                          100 * faces.beyond, 100 * faces.most_beyond,
                          may_be_split(job, statistics) ? ". To split the faces there: --tolerance 1%" : ""));
}

std::string cause_of_coarse(const Job& job, const OffsetStatistics& statistics) {
  if (job.curves()) return "is between points that are far apart. Use more points";
  if (may_be_split(job, statistics)) return "is between the vertices of large faces. To split these: --tolerance 1%";
  return "is between the vertices of large faces. Use a finer mesh";
}

}  // namespace

std::string area_percent(double share, int digits) {
  const double step = std::pow(10.0, digits);
  return fmt::format("{:.{}f}", std::floor(share * 100 * step) / step, digits);
}

std::string faces_in_words(const FaceError& faces, const std::string& asked, bool curves) {
  return fmt::format("{} % of the {} is within 1 % of {} (on average {} % off)", area_percent(faces.at_distance, 1),
                     curves ? "length" : "area", asked, percent(faces.mean));
}

std::size_t faces_in(const MeshFacts& facts) {
  std::size_t faces = 0;
  for (const auto& [corners, count] : facts.faces_by_corners) faces += count;
  return faces;
}

std::string certified_in_words(const CertifiedFaces& certified, const Lengths& lengths) {
  const std::string within =
      certified.share > 0 ? fmt::format("{:.6g} %", 100 * certified.share) : lengths(certified.length);
  return fmt::format("{} % of the area is certified within {} of the distance at every point",
                     area_percent(certified.certified, 2), within);
}

void add_certified(const CertifiedFaces& certified, std::size_t faces, Remarks& remarks) {
  if (certified.source_faces > 0)
    remarks.add(Gravity::Detail, fmt::format("{} faces became {}", certified.source_faces, faces));
  if (certified.certified < certified.there)
    remarks.add(
        certified.certified < kAsGoodAsAll * certified.there ? Gravity::Off : Gravity::Detail,
        fmt::format("the vertices of {} % of the area reached the distance; what of it is not certified is up to "
                    "{:.3g} % off",
                    area_percent(certified.there, 2), 100 * certified.worst_left));
  // The area is that of the source, and what has little there may have much in the offset.
  if (certified.worst > certified.worst_left)
    remarks.add(Gravity::Detail, fmt::format("the worst of all faces is up to {:.3g} % off", 100 * certified.worst));
}

bool is_certified(const CertifiedFaces& certified, std::optional<double> asked, const std::string& offset,
                  const Lengths& lengths) {
  if (certified.out_of_faces)
    report_problem(
        fmt::format("--max-faces: {}: expected more faces, as those whose vertices are at the distance are up to "
                    "{:.3g} % off",
                    offset, 100 * certified.worst_left));
  else if (asked && certified.certified < *asked)
    report_problem(
        fmt::format("{}: {}: expected {:g} %", offset, certified_in_words(certified, lengths), 100 * *asked));
  else return true;
  return false;
}

std::string layers_faces_in_words(const FaceError& outermost, const FaceError& first, bool curves) {
  return fmt::format("outermost {}: {}; at the first height: {}\n", curves ? "curve" : "surface",
                     faces_in_words(outermost, "its height", curves), faces_in_words(first, "it", curves));
}

void add_iso_cause(const FaceError& faces, Remarks& remarks) {
  if (faces.mean > kFaceAtDistance)
    remarks.add(Gravity::Off, "the faces' error comes from the size of voxels. Use a smaller --voxel-size");
}

void add_faces(const Job& job, const OffsetStatistics& statistics, Remarks& remarks) {
  add_beyond(job, statistics, remarks);
  const FaceError& faces = statistics.faces;
  if (faces.farther > kLeastFarther)
    remarks.add(Gravity::Detail,
                fmt::format("at sharp edges faces are {:.3g} % farther than the distance on average (miters)",
                            100 * faces.farther));
  const bool curves = job.curves();
  const char* const less = job.request.layers ? "a smaller height"
                           : job.to_fit       ? "a smaller clearance"
                                              : "a smaller distance";
  std::vector<std::pair<double, std::string>> causes{
      // Where there is room on the other side, another remark says so.
      {statistics.room.suggests_other() ? 0 : faces.held_back,
       fmt::format("is at {} that fall short. Use {}, which has more room", curves ? "points" : "vertices", less)},
      {faces.stuck, fmt::format("is at {} that have no room at any distance", curves ? "points" : "vertices")},
      {faces.no_room, fmt::format("is in walls or gaps narrower than two distances. Use {}", less)},
      {faces.corners, corners_in_words(job, statistics)},
      {faces.coarse, cause_of_coarse(job, statistics)}};
  std::erase_if(causes, [](const auto& cause) { return cause.first < kLeastCause; });
  std::stable_sort(causes.begin(), causes.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [share, text] : causes)
    remarks.add(Gravity::Off,
                fmt::format("{:.0f} % of the {}' error {}", 100 * share, curves ? "segments" : "faces", text));
}

bool are_within(const FaceError& faces, double bound, const std::string& offset) {
  if (100 * faces.quantile_99 <= bound) return true;
  report_problem(fmt::format("--strict-faces: {}: 99 % of it is within {:.3g} % of the distance, expected {:g} %",
                             offset, 100 * faces.quantile_99, bound));
  return false;
}

}  // namespace vdb_offset::tool
