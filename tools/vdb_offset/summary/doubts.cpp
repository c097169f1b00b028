// SPDX-License-Identifier: Apache-2.0
// What is said of an input that may make the result other than was meant, and the option that helps.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "messages.h"
#include "summary/summary.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset::tool {
namespace {

std::string text_of(const SymmetryPlane& plane) {
  std::string text;
  for (int k = 0; k < 3; ++k) {
    if (plane.normal[k] == 0) continue;
    if (!text.empty()) text += " + ";
    if (plane.normal[k] != 1) text += fmt::format("{:.6g} ", plane.normal[k]);
    text += "xyz"[k];
  }
  return fmt::format("{} = {:.6g}", text, plane.offset);
}

/// Says that slivers may have held vertices back.
void print_slivers(std::FILE* out, const MeshFacts& facts) {
  if (facts.sliver_edges > 0)
    fmt::print(out,
               "{} edges are no longer than {:.2g}, where the median is {:.2g}; such slivers hold back what is around "
               "them: --weld {:g} makes one place of their ends\n",
               facts.sliver_edges, facts.longest_sliver, facts.median_edge,
               MeshFacts::tolerance_above(facts.longest_sliver));
}

/// The plane as --symmetry takes it.
std::string as_option(const SymmetryPlane& plane) {
  for (int k = 0; k < 3; ++k)
    if (plane.normal[k] == 1) return fmt::format("{}={:.9g}", "xyz"[k], plane.offset);
  return fmt::format("{:.9g},{:.9g},{:.9g},{:.9g}", plane.normal[0], plane.normal[1], plane.normal[2], plane.offset);
}

/// Says which planes borders stay in without having been asked to, and where borders of the offset are not as one would
/// expect from the input.
void print_borders(std::FILE* out, const BorderFacts& borders) {
  if (borders.planes.size() > borders.named_planes)
    fmt::print(out, "borders are kept in {} (--symmetry none lets them leave)\n",
               planes_in_words(std::span(borders.planes).subspan(borders.named_planes)));
  if (borders.strayed_vertices > 0)
    fmt::print(out, "{} of {} vertices at borders leave the plane across these, by {:.3g} degrees at most\n",
               borders.strayed_vertices, borders.across_vertices + borders.held_vertices, borders.worst_angle);
  if (borders.beyond > 0)
    fmt::print(out, "{} vertices end beyond a plane that the surface lies on one side of, and borders stay in\n",
               borders.beyond);
  if (borders.left.empty()) return;
  std::vector<SymmetryPlane> left;
  double farthest = 0;
  for (const BorderFacts::LeftPlane& each : borders.left) {
    left.push_back(each.plane);
    farthest = std::max(farthest, each.farthest);
  }
  fmt::print(out,
             "borders in {} leave that plane by up to {:.3g}, as their faces rise from it by less than 12 degrees "
             "(--symmetry {} "
             "keeps them there)\n",
             planes_in_words(left), farthest, as_option(left.front()));
}

/// A distance as it was given, with the other sign.
std::string turned_round(const std::string& text) {
  if (text.starts_with('-') && text.find_first_of("+*/^( ", 1) == std::string::npos) return text.substr(1);
  const bool number = text.find_first_not_of("0123456789.eE%") == std::string::npos;
  return number ? "-" + text : fmt::format("'-({})'", text);
}

/// The option that asks for the same offset to the other side.
std::string option_for_other_side(const Job& job) {
  const std::optional<LayersRequest>& layers = job.request.layers;
  const DistanceRequest* const asked = !layers         ? &job.asked.front()
                                       : layers->first ? &*layers->first
                                       : layers->total ? &*layers->total
                                                       : nullptr;
  if (!asked) return "heights below 0";
  if (!asked->from.empty()) return "distances of the other sign";
  const char* const option = !layers ? "--distance" : layers->first ? "--first-height" : "--total-thickness";
  return fmt::format("{} {}", option, turned_round(asked->text));
}

void print_made_straight(std::FILE* out, const Source& source) {
  if (const std::size_t flattened = source.curves->flattened_shapes; flattened > 0)
    fmt::print(out, "{} curved shape{} flattened to within {:.3g} (--flatten)\n", flattened, plural(flattened),
               source.curves->flattened_to);
  for (const OpenCurve& closed : source.closed) fmt::print(out, "closed by a straight segment of {:.6g}\n", closed.gap);
}

/// Whether coordinates are kept to the last bit of a double.
bool has_all_digits(const Job& job) {
  return !job.source.file || job.source.file->precision.kind == Precision::Kind::Double;
}

/// Says where the input crosses itself, or the refined source does. What added vertices are rounded to is all that
/// makes the latter cross where the former does not.
void print_source_crossings(std::FILE* out, const Job& job, const OffsetStatistics& statistics) {
  const LimitStatistics& limit = statistics.limit;
  if (limit.source_crossings == 0) return;
  const char* const what = job.curves() ? "segments" : "triangles";
  const std::string pairs = fmt::format("{}{} pairs of {} meet", limit.more_source_crossings ? "more than " : "",
                                        limit.source_crossings, what);
  const std::string beside = limit.more_source_crossings
                                 ? "what is beside them is not looked at"
                                 : fmt::format("{} more beside them", limit.crossings_near_source);
  const bool is_refined = statistics.certified && statistics.certified->source_faces > 0;
  if (!is_refined) fmt::print(out, "the input crosses itself: {}, left as they are; {}\n", pairs, beside);
  else if (const std::size_t own = statistics.certified->source_crossings; own > 0)
    fmt::print(out,
               "the input crosses itself: {} pairs of {} meet, left as they are; of the refined source {}, and {}\n",
               own, what, pairs, beside);
  else
    fmt::print(out,
               "the refined source crosses itself, and the input does not, as what is added is rounded: {}; {}{}\n",
               pairs, beside, has_all_digits(job) ? "" : " (a copy of the input as OBJ has more digits)");
}

/// Where the file's coordinates are too coarse for distances to be met to a hundredth, as faces are judged.
void print_rounding(std::FILE* out, double rounding, double distance) {
  constexpr double kWorthSaying = 0.01;
  if (rounding <= kWorthSaying * distance) return;
  fmt::print(
      out,
      "coordinates as large as these are rounded by {:.2g}, {:.0f} % of the distance: move the model to the origin, "
      "or write a format with more digits\n",
      rounding, 100 * rounding / distance);
}

}  // namespace

std::string planes_in_words(std::span<const SymmetryPlane> planes) {
  constexpr std::size_t kMostNamed = 6;  // planes that are named on a line
  std::vector<std::string> names;
  for (const SymmetryPlane& plane : planes.first(std::min(planes.size(), kMostNamed))) names.push_back(text_of(plane));
  return fmt::format("{}{}", fmt::join(names, ", "),
                     planes.size() > kMostNamed ? fmt::format(" and {} more", planes.size() - kMostNamed) : "");
}

void print_orientation(std::FILE* out, const MeshFacts& facts, Orient orient) {
  if (facts.inside_out_components > 0 && orient == Orient::FixCavities)
    fmt::print(out,
               "{} of {} closed components point the wrong way, and are taken as turned; the faces stay as they are\n",
               facts.inside_out_components, facts.closed_components);
  else if (facts.inside_out_components > 0)
    fmt::print(out, "{} of {} closed components point inward as a whole: {}\n", facts.inside_out_components,
               facts.closed_components,
               orient == Orient::Keep
                   ? "a distance above 0 shrinks them (--orient fix-direction-only enlarges them)"
                   : "taken as turned, a distance above 0 enlarges them; the faces stay as they are");
  if (facts.enclosed_components > 0)
    fmt::print(out,
               "{} of {} closed components lie inside another one and point outward as it does: a distance above 0 "
               "enlarges them (if they are cavities, --orient fix-cavities shrinks them)\n",
               facts.enclosed_components, facts.closed_components);
  if (facts.orientation_conflicts > 0)
    fmt::print(out,
               "{} edges between faces that disagree about the outside: {} triangles taken as turned, {} edges left\n",
               facts.orientation_conflicts, facts.turned_triangles, facts.unsettled_conflicts);
}

void print_seams(std::FILE* out, const SeamFacts& seams, double distance) {
  if (seams.vertices > 0)
    fmt::print(out,
               "{} vertices at borders are one with others but for rounding, {:.2g} apart at most, and count as welded "
               "(--weld exact leaves these borders open)\n",
               seams.vertices, seams.widest);
  if (seams.hanging > 0)
    fmt::print(out,
               "{} vertices lie on edges of faces that have no corner there, {:.2g} off at most, and count as joined "
               "to these (--weld exact leaves them hanging)\n",
               seams.hanging, seams.widest_hanging);
  if (seams.slivers > 0)
    fmt::print(
        out,
        "{} vertices are at ends of edges of {:.2g} at most, which single precision could not hold, and count as "
        "welded (--weld exact leaves them apart)\n",
        seams.slivers, seams.widest_sliver);
  constexpr double kFarBelow =
      0.1;  // share of the distance: borders nearer to each other hold the offset back; not measured
  if (seams.near_vertices > 0 && seams.widest_near < kFarBelow * distance)
    fmt::print(out,
               "{} vertices are at borders that run along each other, {:.2g} apart at most: --weld {:g} closes them if "
               "they are not meant\n",
               seams.near_vertices, seams.widest_near, MeshFacts::tolerance_above(seams.widest_near));
}

std::vector<std::string> side_hints(const Job& job, const SideRoom& room) {
  std::vector<std::string> hints;
  std::vector<OpenCurve> open;
  if (job.curves()) open = open_curves(job.source.view());
  std::erase_if(open, [](const OpenCurve& each) { return !each.is_nearly_closed(); });
  if (!open.empty())
    hints.push_back(
        fmt::format("{} open curve{} with ends near each other ({:.6g} apart, of a length of {:.6g}): nothing lies "
                    "between these, nor beyond them (--close joins them)",
                    open.size(), plural(open.size()), open.front().gap, open.front().length));
  if (room.suggests_other())
    hints.push_back(
        fmt::format("there is room for that on this side of {:.0f} % of the {}, on the other side of {:.0f} %: if {} "
                    "the wrong way, {} goes there",
                    100 * room.here, job.curves() ? "curves" : "surface", 100 * room.there,
                    job.curves() ? "curves run" : "faces point", option_for_other_side(job)));
  return hints;
}

void print_doubts(std::FILE* out, const Job& job, const OffsetStatistics& statistics, const Distances& distances) {
  print_rounding(out, statistics.rounding, std::abs(distances.farthest()));
  print_seams(out, statistics.facts.seams, std::abs(distances.farthest()));
  const auto in = [&](VertexState state) { return statistics.vertices_by_state[static_cast<std::size_t>(state)]; };
  if (in(VertexState::Limited) + in(VertexState::Collision) > 0) print_slivers(out, statistics.facts);
  if (job.curves()) print_made_straight(out, job.source);
  else print_orientation(out, statistics.facts, job.options.orient);
  for (const std::string& hint : side_hints(job, statistics.room)) fmt::print(out, "{}\n", hint);
  print_borders(out, statistics.borders);
  print_source_crossings(out, job, statistics);
}

}  // namespace vdb_offset::tool
