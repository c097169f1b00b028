// SPDX-License-Identifier: Apache-2.0
// What `vdb_offset check` says.
#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "messages.h"
#include "summary/summary.h"
#include "vdb_offset/report.h"

namespace vdb_offset::tool {
namespace {

// What a table's rows and a verdict call the parts of meshes and of curves.
struct CheckWords {
  const char *vertices, *faces, *faces_row, *error_row, *triangles;
};

const CheckWords& words_for(bool curves) {
  static constexpr CheckWords kOfMeshes{"vertices", "faces", "faces       ", "in faces    ", "triangles"},
      kOfCurves{"points", "segments", "segments    ", "along       ", "segments"};
  return curves ? kOfCurves : kOfMeshes;
}

void print_distances(std::FILE* out, const CheckResult& result, const Lengths& lengths, bool curves) {
  const AchievedSummary achieved = summarise(result.states, result.achieved, result.distances);
  const auto in = [&](VertexState state) { return std::count(result.states.begin(), result.states.end(), state); };
  const auto mitered = in(VertexState::Mitered), cut = in(VertexState::Cut);
  fmt::print(out, "distance    {}: {} % of {} {} there{}{}, {} beyond, {} on the wrong side\n",
             lengths(result.distance, 9), area_percent(achieved.share_reached, 3), achieved.vertices,
             words_for(curves).vertices, mitered > 0 ? fmt::format(", {} of them mitered", mitered) : "",
             cut > 0 ? fmt::format(", {} with a miter that is cut", cut) : "", result.beyond, result.wrong_side);
  fmt::print(out, "achieved    least {}, 1 % {}, 5 % {}, median {}, 95 % {}, most {}\n", lengths(achieved.least),
             lengths(achieved.quantile_01), lengths(achieved.quantile_05), lengths(achieved.median),
             lengths(achieved.quantile_95), lengths(achieved.most));
  fmt::print(
      out, "{}off by {:.3g} % on average, {:.3g} % at 99 of 100 points, {:.3g} % at most; {} % of the {} within 1 %\n",
      words_for(curves).error_row, 100 * result.faces.mean, 100 * result.faces.quantile_99, 100 * result.faces.worst,
      area_percent(result.faces.at_distance, 1), curves ? "length" : "area");
}

void print_faults(std::FILE* out, const CheckResult& result, bool curves) {
  const CheckWords& words = words_for(curves);
  fmt::print(out, "{}{} inverted, {} collapsed{}\n", words.faces_row, result.faults.inverted, result.faults.collapsed,
             result.faults.crowded ? fmt::format(", {} too near to an obstacle", result.faults.crowded) : "");
  fmt::print(out, "crossings   {} new pairs of {}; {}{} in the source, {}\n", result.faults.crossings, words.triangles,
             result.more_source_crossings ? "more than " : "", result.source_crossings,
             result.more_source_crossings ? "near which nothing was searched"
                                          : fmt::format("{} near those", result.crossings_near_source));
}

void print_seams(std::FILE* out, const SeamFacts& seams, const Lengths& lengths) {
  if (seams.vertices > 0)
    fmt::print(out, "seams       {} vertices of the source were welded to others at most {} away, which is rounding\n",
               seams.vertices, lengths(seams.widest, 2));
  if (seams.hanging > 0)
    fmt::print(out, "hanging     {} T-junction vertices of the source were attached to an edge at most {} away\n",
               seams.hanging, lengths(seams.widest_hanging, 2));
}

}  // namespace

Summary summary_of(const Request& made, const CheckResult& result, bool curves) {
  const CheckWords& words = words_for(curves);
  const AchievedSummary achieved = summarise(result.states, result.achieved, result.distances);
  const std::string asked = made.lengths(result.distance);
  Summary all;
  all.verdict = fmt::format("{}: {}; {}; {} % of {} {} reached it", made.output, result.valid() ? "valid" : "not valid",
                            result.certified ? certified_in_words(*result.certified, made.lengths)
                                             : faces_in_words(result.faces, asked, curves),
                            area_percent(achieved.share_reached, 3), achieved.vertices, words.vertices);
  Remarks& remarks = all.remarks;
  const auto add = [&](std::size_t count, const std::string& what) {
    if (count > 0) remarks.add(Gravity::Wrong, fmt::format("{} {}", count, what));
  };
  add(result.faults.inverted, fmt::format("{} are inverted", words.faces));
  add(result.faults.collapsed, fmt::format("{} are collapsed", words.faces));
  add(result.faults.crowded, fmt::format("{} are too near to an obstacle", words.faces));
  add(result.faults.crossings, fmt::format("pairs of {} intersect that do not in the source", words.triangles));
  add(result.beyond, fmt::format("{} are beyond the distance", words.vertices));
  add(result.wrong_side, fmt::format("{} are on the wrong side", words.vertices));
  add(result.torn, fmt::format("{} are apart from others that they stood with", words.vertices));
  if (result.source_crossings > 0)
    remarks.add(Gravity::Input, fmt::format("the source intersects itself at {}{} pairs of {}",
                                            result.more_source_crossings ? "more than " : "", result.source_crossings,
                                            words.triangles));
  if (result.certified) add_certified(*result.certified, 0, remarks);
  return all;
}

void print_check(std::FILE* out, const Request& made, const CheckResult& result, bool curves) {
  const Lengths& lengths = made.lengths;
  print_distances(out, result, lengths, curves);
  if (result.certified) {
    fmt::print(out, "proven      {}\n", certified_in_words(*result.certified, lengths));
    Remarks remarks;
    add_certified(*result.certified, 0, remarks);
    remarks.print(out, true);
  }
  print_faults(out, result, curves);
  print_seams(out, result.facts.seams, lengths);
  if (result.obstacles)
    fmt::print(out, "obstacles   gap {}, {} at the start; {} triangles nearer than the clearance\n",
               lengths(result.obstacles->gap), lengths(result.obstacles->starting_gap), result.obstacles->near);
  if (result.torn)
    fmt::print(out, "torn        {} {} are apart from others that they stood with\n", result.torn,
               words_for(curves).vertices);
  fmt::print(out, "{}\n", result.valid() ? "valid" : "not valid");
}

}  // namespace vdb_offset::tool
