// SPDX-License-Identifier: Apache-2.0
// What about the input may make the result other than was meant, and the option that settles it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "messages.h"
#include "summary/summary.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset::tool {
namespace {

std::string text_of(const SymmetryPlane& plane) {
  constexpr double kRounding = 1e-9;  // of a unit normal
  const double side = plane.normal[0] + plane.normal[1] + plane.normal[2] < 0 ? -1 : 1;
  std::string text;
  for (int k = 0; k < 3; ++k) {
    const double part = side * plane.normal[k];
    if (std::abs(part) <= kRounding) continue;
    if (!text.empty()) text += part < 0 ? " - " : " + ";
    else if (part < 0) text += '-';
    if (std::abs(std::abs(part) - 1) > kRounding) text += fmt::format("{:.6g} ", std::abs(part));
    text += "xyz"[k];
  }
  return fmt::format("{} = {:.6g}", text, side * plane.offset + 0.0);
}

/// A value of --weld that joins what is so far apart.
std::string weld_value(const Lengths& lengths, double length) {
  return lengths.value(MeshFacts::tolerance_above(lengths.in_unit(length)));
}

void add_slivers(const MeshFacts& facts, const Lengths& lengths, Remarks& remarks) {
  if (facts.sliver_edges > 0)
    remarks.add(Gravity::Off,
                fmt::format("{} edges are no longer than {}, where the median is {}; such slivers hold back the "
                            "vertices around them. To close them: --weld {}",
                            facts.sliver_edges, lengths(facts.longest_sliver, 2), lengths(facts.median_edge, 2),
                            weld_value(lengths, facts.longest_sliver)));
}

/// The plane as --symmetry takes it.
std::string as_option(const SymmetryPlane& plane) {
  for (int k = 0; k < 3; ++k)
    if (plane.normal[k] == 1) return fmt::format("{}={:.9g}", "xyz"[k], plane.offset);
  return fmt::format("{:.9g},{:.9g},{:.9g},{:.9g}", plane.normal[0], plane.normal[1], plane.normal[2], plane.offset);
}

/// Which planes borders stay in without having been asked to, and where borders of the offset are not as one would
/// expect from the input.
void add_borders(const Job& job, const BorderFacts& borders, const Lengths& lengths, Remarks& remarks) {
  if (borders.planes.size() > borders.named_planes)
    remarks.add(Gravity::Detail, fmt::format("borders stay in the plane they lie in: {} (--symmetry none: do not)",
                                             planes_in_words(std::span(borders.planes).subspan(borders.named_planes))));
  if (borders.strayed_vertices > 0)
    remarks.add(
        Gravity::Input,
        fmt::format("{} of {} boundary vertices moved out of the plane perpendicular to the boundary (by up to "
                    "{:.3g} degrees)",
                    borders.strayed_vertices, borders.across_vertices + borders.held_vertices, borders.worst_angle));
  if (borders.beyond > 0)
    remarks.add(Gravity::Off, fmt::format("{} vertices crossed a plane that borders stay in, and the input lies on one "
                                          "side of",
                                          borders.beyond));
  if (borders.left.empty()) return;
  std::vector<SymmetryPlane> left;
  double farthest = 0;
  for (const BorderFacts::LeftPlane& each : borders.left) {
    left.push_back(each.plane);
    farthest = std::max(farthest, each.farthest);
  }
  remarks.add(Gravity::Off,
              fmt::format("borders in {} leave that plane by up to {}, because their faces rise from it by less "
                          "than 12 degrees{}",
                          planes_in_words(left), lengths(farthest, 3),
                          is_cad_output(job.request.output, job.request)
                              ? ""
                              : ". To keep them there: --symmetry " + as_option(left.front())));
}

/// A distance as it was given, with the other sign.
std::string turned_round(const std::string& text, const Lengths& lengths) {
  if (const auto number = decimal<double>(text); number && lengths.have_unit())
    return lengths.value(-lengths.in_unit(*number));
  if (text.starts_with('-') && text.find_first_of("+*/^( ", 1) == std::string::npos) return text.substr(1);
  const bool number = text.find_first_not_of("0123456789.eE%") == std::string::npos;
  return number ? "-" + text : fmt::format("'-({})'", text);
}

/// The option that asks for the same offset to the other side.
std::string option_for_other_side(const Job& job) {
  const std::optional<LayersRequest>& layers = job.request.layers;
  if (job.request.side_of) return "use a point on the other side: --side-of";
  if (layers && !layers->heights.empty()) return "use heights below 0";
  const std::vector<LayerLength> given =
      layers ? layers->lengths() : std::vector<LayerLength>{{"--distance", &job.asked.front()}};
  std::vector<std::string> options;
  if (layers && layers->y_plus) options.push_back(fmt::format("--y-plus={:g}", -*layers->y_plus));
  for (const auto& [option, asked] : given) {
    if (!asked->from.empty()) return "use distances of the other sign";
    options.push_back(fmt::format("{} {}", option, turned_round(asked->text, job.request.lengths)));
  }
  return fmt::format("{}", fmt::join(options, " "));
}

void add_made_straight(const Source& source, const Lengths& lengths, Remarks& remarks) {
  if (const std::size_t flattened = source.curves->flattened_shapes; flattened > 0)
    remarks.add(Gravity::Detail, fmt::format("{} curved shape{} became straight segments, at most {} off (--flatten)",
                                             flattened, plural(flattened), lengths(source.curves->flattened_to, 3)));
  for (const OpenCurve& closed : source.closed)
    remarks.add(Gravity::Input, fmt::format("a gap of {} between a curve's ends counts as closed; the written "
                                            "curve keeps it",
                                            lengths(closed.gap)));
}

/// Where a distance without a unit is in that of a drawing, and this is not the one that people think of.
void add_unit_of_drawing(const Job& job, const Distances& distances, Remarks& remarks) {
  const std::optional<double> unit = job.source.curves->file.unit_micrometres, mm = micrometres_of("mm");
  if (!unit || *unit == *mm || job.request.lengths.have_unit() || !distances.uniform() || distances[0] == 0) return;
  for (const DistanceRequest& each : job.request.distances)
    if (const auto number = decimal<double>(each.text); number && *number == distances[0])
      return remarks.add(Gravity::Input,
                         fmt::format("lengths without a unit are in the drawing's own, of {:.4g} mm: {} is {:.4g} mm. "
                                     "For millimetres: --distance {}mm",
                                     *unit / *mm, each.text, *number * *unit / *mm, each.text));
}

/// A distance that is many times the size of what is offset is often one in another unit.
void add_too_far(const Distances& distances, double diagonal, const Lengths& lengths, Remarks& remarks) {
  constexpr double kMostDiagonals = 3;  // not measured: offsets that far are blobs
  const double farthest = std::abs(distances.farthest());
  if (diagonal > 0 && farthest > kMostDiagonals * diagonal)
    remarks.add(Gravity::Wrong, fmt::format("the distance is {:.3g} times the diagonal, which is {}. Is it in another "
                                            "unit? A percentage is of the diagonal",
                                            farthest / diagonal, lengths(diagonal)));
}

/// Lines that enclose nothing move as well, which may not be meant.
void add_open_curves(const MeshFacts& facts, double farthest, Remarks& remarks) {
  const std::size_t open = facts.components - facts.closed_components;
  if (open > 0 && facts.closed_components > 0 && farthest > 0)
    remarks.add(Gravity::Input,
                fmt::format("{} of {} curves {} to one side, which {} direction decides", open, facts.components,
                            open == 1 ? "is open and moves" : "are open and move", open == 1 ? "its" : "their"));
}

/// Whether coordinates are kept to the last bit of a double.
bool has_all_digits(const Job& job) {
  return !job.source.file || job.source.file->precision.kind == Precision::Kind::Double;
}

/// What has to go from the command line for --mode iso; empty if nothing has to.
std::string in_place_of(const Request& request) {
  if (!request.of_preset.empty()) return " in place of --preset " + request.of_preset.front().preset;
  for (const char* const option : {"--corners", "--tolerance", "--only", "--symmetry", "--obstacle", "--collision",
                                   "--taper", "--html", "--states"})
    if (request.given.contains(option)) return std::string(" in place of ") + option;
  return {};
}

/// Where the input intersects itself, or the refined source does. What added vertices are rounded to is all that makes
/// the latter intersect itself where the former does not.
void add_source_crossings(const Job& job, const OffsetStatistics& statistics, Remarks& remarks) {
  const LimitStatistics& limit = statistics.limit;
  if (limit.source_crossings == 0) return;
  const std::string pairs = fmt::format("{}{} {} pairs", limit.more_source_crossings ? "more than " : "",
                                        limit.source_crossings, job.curves() ? "segment" : "triangle");
  const std::string near = limit.more_source_crossings
                               ? "the result was not searched near them"
                               : fmt::format("the result adds {} pairs near them", limit.crossings_near_source);
  const std::string remedy =
      job.curves() || job.request.layers || job.request.iso || is_cad_output(job.request.output, job.request)
          ? ""
          : ". For a clean surface: --mode iso" + in_place_of(job.request);
  const bool is_refined = statistics.certified && statistics.certified->source_faces > 0;
  const std::size_t own = is_refined ? statistics.certified->source_crossings : 0;
  if (is_refined && own == 0)
    remarks.add(Gravity::Input,
                fmt::format("the refined source intersects itself at {} though the input does not, because added "
                            "vertices are rounded; {}{}",
                            pairs, near, has_all_digits(job) ? "" : ". Save the input as OBJ, which has more digits"));
  else
    remarks.add(limit.crossings_near_source > 0 ? Gravity::Wrong : Gravity::Input,
                fmt::format("the input intersects itself at {}{} (not repaired); {}{}", pairs,
                            is_refined ? fmt::format(" after splitting, {} before", own) : "", near, remedy));
}

/// Where the file's coordinates are too coarse for distances to be met to a hundredth, as faces are judged.
void add_rounding(double rounding, double distance, const Lengths& lengths, Remarks& remarks) {
  constexpr double kWorthSaying = 0.01;
  if (distance == 0 || rounding <= kWorthSaying * distance) return;
  remarks.add(Gravity::Wrong,
              fmt::format("coordinates this large are rounded by {}, {:.0f} % of the distance. Move the model to "
                          "the origin, or write a format with more digits (.obj, .ply)",
                          lengths(rounding, 2), 100 * rounding / distance));
}

/// Which pieces are inside out: the largest of them by where it is, how large, and its group or object.
std::string inside_out_in_words(const Job& job, const MeshFacts& facts) {
  const PieceFacts& piece = facts.largest_inside_out;
  const Vec3d middle = (piece.lower + piece.upper) / 2.0;
  std::string group;
  if (job.source.file) {
    const WallNames names = io::wall_names(*job.source.file);
    if (piece.face < names.of_face.size()) group = fmt::format(" of '{}'", names.names[names.of_face[piece.face]]);
  }
  const std::string which =
      fmt::format("{} vertices{}, {} across, around {:.4g} {:.4g} {:.4g}", piece.vertices, group,
                  job.request.lengths((piece.upper - piece.lower).length(), 3), middle[0], middle[1], middle[2]);
  if (facts.components == 1) return "the mesh is inside out";
  if (facts.closed_components == 1) return fmt::format("the only closed piece ({}) is inside out", which);
  if (facts.inside_out_components == 1)
    return fmt::format("one of {} closed pieces ({}) is inside out", facts.closed_components, which);
  return fmt::format("{} of {} closed pieces are inside out (the largest: {})", facts.inside_out_components,
                     facts.closed_components, which);
}

}  // namespace

std::string planes_in_words(std::span<const SymmetryPlane> planes) {
  constexpr std::size_t kMostNamed = 6;  // planes that are named on a line
  std::vector<std::string> names;
  for (const SymmetryPlane& plane : planes.first(std::min(planes.size(), kMostNamed))) names.push_back(text_of(plane));
  return fmt::format("{}{}", fmt::join(names, ", "),
                     planes.size() > kMostNamed ? fmt::format(" and {} more", planes.size() - kMostNamed) : "");
}

void add_orientation(const Job& job, const MeshFacts& facts, Remarks& remarks) {
  if (facts.inside_out_components > 0) {
    const bool is_one = facts.inside_out_components == 1,
               is_inward = !job.distances.empty() && job.distances.front().farthest() < 0;
    const std::string pieces = inside_out_in_words(job, facts);
    if (job.options.orient == Orient::Keep)
      remarks.add(Gravity::Wrong, fmt::format("{0}: {2} distances {3} {1}. To {4} {1}: --orient fix-direction-only",
                                              pieces, is_one ? "it" : "them", is_inward ? "negative" : "positive",
                                              is_inward ? "enlarge" : "shrink", is_inward ? "shrink" : "enlarge"));
    else remarks.add(Gravity::Detail, pieces + ": treated as flipped; the faces stay as they are");
  }
  if (facts.enclosed_components > 0)
    remarks.add(Gravity::Wrong,
                fmt::format("{} of {} closed pieces lie inside another and point outward: positive distances enlarge "
                            "them. If they are cavities: --orient fix-cavities",
                            facts.enclosed_components, facts.closed_components));
  if (facts.orientation_conflicts > 0)
    remarks.add(facts.unsettled_conflicts > 0 ? Gravity::Input : Gravity::Detail,
                fmt::format("inconsistent orientation at {} edges; {} triangles treated as flipped; {}",
                            facts.orientation_conflicts, facts.turned_triangles,
                            facts.unsettled_conflicts > 0 ? fmt::format("{} edges left", facts.unsettled_conflicts)
                                                          : "none left"));
}

void add_seams(const SeamFacts& seams, double distance, const Lengths& lengths, Remarks& remarks) {
  if (seams.vertices > 0)
    remarks.add(Gravity::Detail,
                fmt::format("{} boundary vertices were welded to others at most {} away, which is rounding "
                            "(--weld exact: do not)",
                            seams.vertices, lengths(seams.widest, 2)));
  if (seams.hanging > 0)
    remarks.add(Gravity::Detail,
                fmt::format("{} T-junction vertices were attached to the edge they lie on, at most {} away "
                            "(--weld exact: do not)",
                            seams.hanging, lengths(seams.widest_hanging, 2)));
  if (seams.slivers > 0)
    remarks.add(Gravity::Detail,
                fmt::format("{} vertices at ends of edges no longer than {} were welded, as single precision could "
                            "not hold these (--weld exact: do not)",
                            seams.slivers, lengths(seams.widest_sliver, 2)));
  constexpr double kFarBelow =
      0.1;  // share of the distance: borders nearer to each other hold the offset back; not measured
  if (seams.near_vertices > 0 && seams.widest_near < kFarBelow * distance)
    remarks.add(
        Gravity::Input,
        fmt::format("{} boundary vertices face another boundary at most {} away. If that gap is "
                    "unintended: --weld {}",
                    seams.near_vertices, lengths(seams.widest_near, 2), weld_value(lengths, seams.widest_near)));
}

std::vector<std::string> side_hints(const Job& job, const SideRoom& room) {
  std::vector<std::string> hints;
  std::vector<OpenCurve> open;
  if (job.curves()) open = open_curves(job.source.view());
  std::erase_if(open, [](const OpenCurve& each) { return !each.is_nearly_closed(); });
  if (!open.empty())
    hints.push_back(
        fmt::format("{} open curve{} with ends that nearly meet ({} apart, length {}). To join the "
                    "ends: --close",
                    open.size(), plural(open.size()), job.request.lengths(open.front().gap),
                    job.request.lengths(open.front().length)));
  if (room.suggests_other())
    hints.push_back(
        fmt::format("only {:.0f} % of the {} has room on this side, {:.0f} % on the other. If {} the wrong "
                    "way: {}",
                    100 * room.here, job.curves() ? "curves" : "surface", 100 * room.there,
                    job.curves() ? "curves run" : "faces point", option_for_other_side(job)));
  return hints;
}

void add_input(const Job& job, const OffsetStatistics& statistics, const Distances& distances, Remarks& remarks) {
  const Lengths& lengths = job.request.lengths;
  const double farthest = std::abs(distances.farthest());
  add_too_far(distances, statistics.facts.diagonal, lengths, remarks);
  add_rounding(statistics.rounding, farthest, lengths, remarks);
  for (std::string& hint : side_hints(job, statistics.room)) remarks.add(Gravity::Wrong, std::move(hint));
  const auto in = [&](VertexState state) { return statistics.vertices_by_state[static_cast<std::size_t>(state)]; };
  if (in(VertexState::Limited) + in(VertexState::Collision) > 0) add_slivers(statistics.facts, lengths, remarks);
  if (job.curves()) {
    add_unit_of_drawing(job, distances, remarks);
    add_open_curves(statistics.facts, farthest, remarks);
    add_made_straight(job.source, lengths, remarks);
  } else add_orientation(job, statistics.facts, remarks);
  add_borders(job, statistics.borders, lengths, remarks);
  add_source_crossings(job, statistics, remarks);
  add_seams(statistics.facts.seams, farthest, lengths, remarks);
  if (statistics.disagreeing_distances > 0)
    remarks.add(Gravity::Input,
                fmt::format("{} {} share a position with one that was given a different distance; the mean was used",
                            statistics.disagreeing_distances, job.curves() ? "points" : "vertices"));
}

}  // namespace vdb_offset::tool
