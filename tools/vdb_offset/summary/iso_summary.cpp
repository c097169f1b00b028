// SPDX-License-Identifier: Apache-2.0
// What a run with --mode iso says.
#include <fmt/format.h>

#include <cmath>
#include <string>

#include "messages.h"
#include "summary/summary.h"

namespace vdb_offset::tool {
namespace {

/// Which parts of the mesh have an inside, and how that is known.
void add_solids(const IsoStatistics& found, Remarks& remarks) {
  const SolidFacts& solid = found.solid;
  if (!found.is_signed)
    remarks.add(Gravity::Wrong,
                "the input is not closed or inconsistently oriented: the surface goes around it, on all sides");
  else if (solid.open_parts > 0)
    remarks.add(Gravity::Wrong,
                fmt::format("{} of {} parts of the input are open: the surface goes around them, on all "
                            "sides",
                            solid.open_parts, solid.parts));
  if (solid.holes > 0)
    remarks.add(Gravity::Input, fmt::format("{} hole{} of the input ({:.2g} % of its area) filled, so that it has an "
                                            "inside (--inside never: treat it as open)",
                                            solid.holes, plural(solid.holes), 100 * solid.hole_share));
  if (solid.buried + solid.cut > 0)
    remarks.add(Gravity::Detail, fmt::format("{} triangles of the input are buried inside it, {} of them in part; "
                                             "distances are measured to the others",
                                             solid.buried + solid.cut, solid.cut));
}

void print_iso_plan(std::FILE* out, const Job& job, const IsoStatistics& statistics, double distance) {
  const IsoPlan& plan = statistics.plan;
  const Lengths& lengths = job.request.lengths;
  print_facts(out, statistics.source, lengths);
  fmt::print(out, "distance   {}{}\n", lengths(distance, 9),
             statistics.is_signed ? "" : ", on all sides of the surface, as it has no inside");
  fmt::print(out, "voxel size {} ({})\n", lengths(plan.voxel_size), plan.reason);
  fmt::print(out, "estimate   {} leaf nodes, {} triangles, {:.1f} MiB\n", plan.leaf_nodes, plan.triangles,
             static_cast<double>(plan.bytes) / 1048576.0);
}

void print_iso_details(std::FILE* out, const Job& job, const IsoStatistics& found, double distance) {
  print_iso_plan(out, job, found, distance);
  for (const Stage stage : kIsoStages)
    fmt::print(out, "{:<10} {:.3f} s\n", name(stage), found.seconds[static_cast<std::size_t>(stage)]);
}

/// Adds what is to be said of a surface, but not of its source.
void add_surface(const IsoStatistics& found, const Lengths& lengths, Remarks& remarks) {
  const MeshFaults& left = found.mending.left;
  add_iso_cause(found.faces, remarks);
  if (left.needles > 0) remarks.add(Gravity::Off, fmt::format("{} triangles have no area", left.needles));
  if (found.dropped_specks > 0)
    remarks.add(Gravity::Input,
                fmt::format("{} speck{} smaller than a voxel of {} dropped (--keep-specks: do not)",
                            found.dropped_specks, plural(found.dropped_specks), lengths(found.plan.voxel_size)));
  remarks.add(Gravity::Detail, fmt::format("vertices are off the distance by {:.2g} of it at most", found.worst_error));
}

void add_source(const Job& job, const IsoStatistics& found, double distance, Remarks& remarks) {
  add_solids(found, remarks);
  add_orientation(job, found.source, remarks);
  add_seams(found.source.seams, std::abs(distance), job.request.lengths, remarks);
}

std::string surface_in_words(const IsoStatistics& found, double distance, const Lengths& lengths) {
  const MeshFaults& left = found.mending.left;
  std::string text = fmt::format(
      "{} vertices and {} triangles at {}: {} component{}, {}, {}, {} crossing{}", found.vertices, found.triangles,
      lengths(distance), found.components, plural(found.components), found.closed() ? "closed" : "not closed",
      found.manifold() ? "manifold" : "not manifold", left.crossings, plural(left.crossings));
  if (found.faces.samples > 0) text += "; " + faces_in_words(found.faces, "it", false);
  return text;
}

}  // namespace

void print_iso_dry_run(const Job& job, const IsoStatistics& statistics, double distance) {
  const Printout out;
  print_iso_plan(out, job, statistics, distance);
  Remarks remarks;
  add_orientation(job, statistics.source, remarks);
  add_seams(statistics.source.seams, std::abs(distance), job.request.lengths, remarks);
  remarks.print(out, true);
}

Summary summary_of(const Job& job, const std::string& path, double distance, const IsoResult& iso,
                   const IsoProducts& made) {
  const Lengths& lengths = job.request.lengths;
  const IsoStatistics& found = iso.statistics;
  Summary all;
  all.verdict = path + ": ";
  if (const auto& level_set = made.level_set)
    all.verdict += fmt::format("level set of {} active voxels of {}; surface: ", level_set->active_voxels,
                               lengths(level_set->voxel_size));
  if (made.hollow) {
    const ShellFacts& shell = made.hollow->facts;
    all.verdict += fmt::format("hollow solid, {}{}, volume {}; {} skin: ", shell.closed ? "closed" : "not closed",
                               shell.oriented ? "" : ", not oriented", lengths.volume(shell.volume),
                               made.hollow->source == Hollow::Source::Outer ? "inner" : "outer");
    add_shell(shell, all.remarks);
    if (made.hollow->source == Hollow::Source::Inner && job.request.given.contains("--preset hollow"))
      all.remarks.add(Gravity::Input,
                      "above 0 the distance makes a new skin outside. To keep the model's own faces there: "
                      "a distance below 0");
    if (!shell.oriented)
      all.remarks.add(Gravity::Wrong,
                      "faces of the solid point to both sides of it, as pieces of the input do: a slicer "
                      "may fill the cavity. Turn those pieces round first");
    else if (shell.volume < 0)
      all.remarks.add(Gravity::Input, "the solid is inside out, as the input is: its faces point into it");
  }
  all.verdict += surface_in_words(found, distance, lengths);
  add_surface(found, lengths, all.remarks);
  if (made.inner) {
    const IsoStatistics& inner = made.inner->statistics;
    all.verdict += "; inner skin: " + surface_in_words(inner, inner.distance, lengths);
    add_surface(inner, lengths, all.remarks);
  }
  add_source(job, found, distance, all.remarks);
  return all;
}

void print_iso_summary(const Job& job, const std::string& path, double distance, const IsoResult& iso,
                       const IsoProducts& made, double total_seconds) {
  const Printout out(output_is_taken(job));
  if (job.request.verbose) {
    print_iso_details(out, job, iso.statistics, distance);
    if (made.inner) print_iso_details(out, job, made.inner->statistics, made.inner->statistics.distance);
  }
  summary_of(job, path, distance, iso, made).print(out, total_seconds, job.request.verbose);
}

}  // namespace vdb_offset::tool
