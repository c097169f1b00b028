// SPDX-License-Identifier: Apache-2.0
// Carries out offsets of meshes and curves, from the job to the files.
#include "offset_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "messages.h"
#include "summary/summary.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/io/cad_file.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/report.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

std::vector<OffsetResult> compute(const Job& job) {
  const PolygonView mesh = job.source.view();
  if (job.curves()) return offset_curves(mesh, job.distances, job.options);
  if (!job.to_fit) return offset_several(mesh, job.distances, job.options);
  std::vector<OffsetResult> results;
  results.push_back(fit(mesh, *job.to_fit, job.options.clearance, job.options));
  return results;
}

void require_field(const Job& job) {
  if (job.options.keep_field &&
      std::all_of(job.distances.begin(), job.distances.end(), [](const Distances& d) { return d.scale() == 0; }))
    throw UsageError("--save-vdb: expected a distance other than 0, which needs a field");
}

/// Whether a result is what --strict asks for. If not, says why.
bool is_as_asked(const OffsetResult& result, bool of_curves) {
  const OffsetStatistics& statistics = result.statistics;
  const auto is_clear = [](std::size_t triangles, const char* what) {
    if (triangles > 0)
      report_problem(fmt::format("--strict: {} triangles are nearer to {} than asked", triangles, what));
    return triangles == 0;
  };
  if (statistics.fit) return is_clear(statistics.fit->near, "the mesh that they are to fit");
  if (statistics.obstacles && !is_clear(statistics.obstacles->near, "an obstacle")) return false;
  const double reached = summarise(result).share_reached;
  if (reached < 1)
    report_problem(fmt::format("--strict: {:.4f} % of the {} fall short of the distance", 100 * (1 - reached),
                               of_curves ? "points" : "vertices"));
  return reached == 1;
}

/// A length of two digits that is no more than this one.
double rounded_down(double length) {
  const double step = std::pow(10.0, std::floor(std::log10(length)) - 1);
  return std::floor(length / step) * step;
}

/// Whether any vertex that was to move arrives. If none does, says so, and names a distance as far as half of them
/// came.
bool reaches_anything(const Job& job, const OffsetResult& result, const std::string& output) {
  std::vector<double> achieved;
  for (std::size_t v = 0; v < result.states.size(); ++v) {
    if (result.states[v] == VertexState::Unused || result.distances[v] == 0) continue;
    if (!falls_short(result.states[v])) return true;
    achieved.push_back(result.achieved[v]);
  }
  if (achieved.empty()) return true;
  const auto middle = achieved.begin() + static_cast<std::ptrdiff_t>(achieved.size() / 2);
  std::nth_element(achieved.begin(), middle, achieved.end());
  const Lengths& lengths = job.request.lengths;
  const double asked = result.distances.farthest();
  const MeshFacts& facts = result.statistics.facts;
  const std::string why = asked < 0 && !job.curves() && facts.closed() && facts.inside_out_components == 0 &&
                                  result.statistics.limit.source_crossings == 0
                              ? fmt::format("the part is thinner than 2 × {}", lengths(-asked))
                              : "there is no room for it";
  std::string smaller;
  if (const double half = lengths.in_unit(*middle); half > 0)
    smaller = fmt::format(", as --distance {}", lengths.value(std::copysign(rounded_down(half), asked)));
  report_problem(fmt::format("{}: no {} reached the distance of {}: {}. Try a smaller distance{}", output,
                             job.curves() ? "point" : "vertex", lengths(asked), why, smaller));
  return false;
}

std::string in_words(const FaultCounts& counts) {
  std::vector<std::string> words;
  const auto add = [&](std::size_t count, const char* what) {
    if (count > 0) words.push_back(fmt::format("{} {}", count, what));
  };
  add(counts.inverted, "inverted faces");
  add(counts.collapsed, "collapsed faces");
  add(counts.crowded, "faces where they may not be");
  add(counts.crossings, "new pairs of triangles that meet");
  return fmt::format("{}", fmt::join(words, ", "));
}

/// Names the outputs that are not valid although they should be. Returns false if there are none.
bool report_faults(const Job& job, std::span<const OffsetResult> results) {
  bool any = false;
  const std::vector<Destination>& destinations = job.files.outputs;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const FaultCounts& left = results[i].statistics.limit.left;
    if (left.total() == 0) continue;
    any = true;
    report_problem(fmt::format("{}: not valid: {} are left", i < destinations.size() ? destinations[i].mesh : "--inner",
                               in_words(left)));
  }
  return any;
}

/// Writes what one distance gives. Nothing, and says why, if no CAD model could be made of it, and others are to be.
std::optional<Products> try_outputs(const Job& job, const Outcome& outcome, const Timing& timing) {
  try {
    return write_outputs(job, outcome, timing.start);
  } catch (const io::NoCadModel& error) {
    if (job.files.outputs.size() == 1) throw;
    report_problem(error.what());
    return std::nullopt;
  }
}

/// Names what CAD models lack. Returns false if none lacks a body, and none is doubtful.
bool report_cad_gaps(const Job& job, std::span<const std::optional<Products>> all) {
  bool any = false;
  for (std::size_t i = 0; i < all.size(); ++i) {
    any |= !all[i];
    if (!all[i] || !all[i]->cad || all[i]->cad->gaps.empty()) continue;
    const CadFileFacts& cad = *all[i]->cad;
    const std::string gaps = fmt::format("{}", fmt::join(cad.gaps, "; "));
    const bool is_doubtful = cad.made == CadFileFacts::Made::Doubtful;
    any |= cad.missing > 0 || is_doubtful;
    if (is_doubtful)
      report_problem(fmt::format("{}: not right everywhere: {}. Use a smaller distance or --deflection",
                                 job.files.outputs[i].mesh, gaps));
    else if (cad.missing > 0)
      report_problem(
          fmt::format("{}: bodies of {} faces could not be made: {}", job.files.outputs[i].mesh, cad.missing, gaps));
    else if (!job.request.quiet)
      report_problem(fmt::format("{}: {}{}", job.files.outputs[i].mesh, gaps,
                                 cad.triangles > 0 ? " (--exact refuses triangles)" : ""));
  }
  return any;
}

/// Returns kProcessing if a result is not valid, or if what a scene expects or --strict asks for is not met.
ExitCode judge(const Job& job, std::span<const OffsetResult> results, const std::optional<ShellFacts>& shell) {
  std::vector<std::string> failed;
  if (job.source.scene) failed = scene::unmet(job.expect, job.source.view(), results.front());
  if (job.expect.volume)
    for (std::string& expectation : scene::unmet(job.expect, *shell)) failed.push_back(std::move(expectation));
  for (const std::string& expectation : failed) report_problem(fmt::format("{}: {}", job.request.input, expectation));
  if (!failed.empty() || report_faults(job, results)) return kProcessing;
  const auto output = [&](std::size_t i) {
    return i < job.files.outputs.size() ? job.files.outputs[i].mesh : "--inner";
  };
  bool faces_there = true;
  for (std::size_t i = 0; i < results.size() && !job.to_fit; ++i)
    faces_there &= reaches_anything(job, results[i], output(i));
  for (std::size_t i = 0; i < results.size() && job.request.strict_faces; ++i)
    faces_there &= are_within(results[i].statistics.faces, *job.request.strict_faces, output(i));
  if (!faces_there) return kProcessing;
  bool as_asked = true;
  for (std::size_t i = 0; i < results.size() && job.request.strict; ++i)
    as_asked &= is_as_asked(results[i], job.curves());
  if (const auto& certified = results.front().statistics.certified)
    as_asked &=
        is_certified(*certified, job.request.certified_asked(), job.files.outputs.front().mesh, job.request.lengths);
  return as_asked ? kDone : kProcessing;
}

/// Writes what was made, reports it and judges it. `refined`: the source of the job, if its faces have been split.
ExitCode finish(const Job& job, std::vector<OffsetResult>& results, const RefinedSource* refined, const Timing& timing,
                ProgressBar& bar) {
  const Request& request = job.request;
  const OffsetResult* const inner = request.inner ? &results.back() : nullptr;
  std::vector<std::optional<Products>> made;
  OutputFiles outputs(request.sync);
  outputs.report_to(bar.callback(), job.files.written.size());
  if (refined) write_refinement(request, *refined);
  for (std::size_t i = 0; i < job.files.outputs.size(); ++i) {
    results[i].statistics.seconds[static_cast<std::size_t>(Stage::Read)] = timing.read_seconds;
    made.push_back(try_outputs(job, {job.files.outputs[i], results[i], inner}, timing));
  }
  outputs.commit(ignore_interrupts);
  bar.show(Stage::Write, 1);
  bar.clear();
  for (std::size_t i = 0; i < job.files.outputs.size() && !request.quiet; ++i)
    if (made[i]) print_summary(job, {job.files.outputs[i], results[i], inner}, *made[i], seconds_since(timing.start));
  const ExitCode judged = judge(job, results, made.back() ? made.back()->shell : std::nullopt);
  return report_cad_gaps(job, made) ? kProcessing : judged;
}

/// Gives each vertex of a file what the one has that it is a copy of: in STL facets have vertices of their own.
OffsetResult of_copies(const OffsetResult& result, std::span<const std::uint32_t> original) {
  OffsetResult copies;
  copies.has_turned_faces = result.has_turned_faces;
  copies.statistics = result.statistics;
  OffsetStatistics& statistics = copies.statistics;
  statistics.facts.vertices = original.size();
  statistics.vertices_by_state = {};
  std::vector<double> distances;
  for (const std::uint32_t v : original) {
    copies.positions.push_back(result.positions[v]);
    copies.states.push_back(result.states[v]);
    copies.achieved.push_back(result.achieved[v]);
    distances.push_back(result.distances[v]);
    ++statistics.vertices_by_state[static_cast<std::size_t>(result.states[v])];
  }
  copies.distances = result.distances.uniform() ? result.distances : Distances(std::move(distances));
  return copies;
}

/// Carries out a job with --tolerance. From where the faces are split, the refined source stands for the one read.
ExitCode run_to_tolerance(const Job& job, const Timing& timing, ProgressBar& bar) {
  Tolerance tolerance = job.request.tolerance->tolerance;
  tolerance.precision = precision_of_refined(job);
  OffsetOptions options = job.options;
  options.distance = job.distances.front();
  RefinedOffset made = offset_to_tolerance(job.source.view(), options, tolerance);
  // Its file has what the source's own vertices are. Where writing rounds these, they were rounded for the offset.
  std::copy(job.source.view().positions.begin(), job.source.view().positions.end(),
            made.refinement.polygons.positions.begin());
  const RefinedSource refined = refined_source(job.source, std::move(made.refinement));
  std::vector<OffsetResult> results;
  results.push_back(refined.vertex.empty() ? std::move(made.result) : of_copies(made.result, refined.vertex));
  scene::Expectations expect = job.expect;
  // A scene says where its own vertices end, and how many of them arrive; there are others now.
  expect.min_reached = expect.max_reached = expect.max_position_error = {};
  const Request& request = job.request;
  const Job of_refined{.request = request,
                       .source = refined.source,
                       .options = job.options,
                       .target = refined.source.file ? io::target_of(request.output, *refined.source.file,
                                                                     write_options(request, request.output))
                                                     : job.target,
                       .asked = job.asked,
                       .distances = {results.front().distances},
                       .expect = expect,
                       .files = job.files};
  return finish(of_refined, results, &refined, timing, bar);
}

}  // namespace

ExitCode run_offset(const Job& job, const Timing& timing, ProgressBar& bar) {
  const Request& request = job.request;
  if (request.dry_run && job.to_fit) {
    print_fit_dry_run(job, plan_fit(job.source.view(), *job.to_fit, job.options.clearance, job.options));
    return kDone;
  }
  if (request.dry_run) {
    const PolygonView mesh = job.source.view();
    print_dry_run(
        job,
        job.curves() ? plan_curves(mesh, job.distances, job.options) : plan_several(mesh, job.distances, job.options),
        job.distances.front());
    return kDone;
  }
  if (request.tolerance) return run_to_tolerance(job, timing, bar);
  require_field(job);
  std::vector<OffsetResult> results = compute(job);
  return finish(job, results, nullptr, timing, bar);
}

}  // namespace vdb_offset::tool
