// SPDX-License-Identifier: Apache-2.0
// Carries out offsets of meshes and curves, from the job to the files.
#include "offset_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "messages.h"
#include "summary.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/error.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/report.h"

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
    throw UsageError("--save-vdb: expected a distance other than 0, for which there is a field");
}

/// Whether a result is what --strict asks for. If not, says why.
bool is_as_asked(const OffsetResult& result, bool of_curves) {
  const OffsetStatistics& statistics = result.statistics;
  const auto is_clear = [](std::size_t triangles, const char* what) {
    if (triangles > 0) tell(fmt::format("--strict: {} triangles are nearer to {} than asked", triangles, what));
    return triangles == 0;
  };
  if (statistics.fit) return is_clear(statistics.fit->near, "the mesh that they are to fit");
  if (statistics.obstacles && !is_clear(statistics.obstacles->near, "an obstacle")) return false;
  const double reached = summarise(result).share_reached;
  if (reached < 1)
    tell(fmt::format("--strict: {:.4f} % of the {} fall short of the distance", 100 * (1 - reached),
                     of_curves ? "points" : "vertices"));
  return reached == 1;
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
bool tell_faults(const Job& job, std::span<const OffsetResult> results) {
  bool any = false;
  const std::vector<Destination>& destinations = job.outputs;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const FaultCounts& left = results[i].statistics.limit.left;
    if (left.total() == 0) continue;
    any = true;
    tell(fmt::format("{}: not valid: {} are left", i < destinations.size() ? destinations[i].mesh : "--inner",
                     in_words(left)));
  }
  return any;
}

/// Returns kProcessing if a result is not valid, or if what a scene expects or --strict asks for is not met.
ExitCode judge(const Job& job, std::span<const OffsetResult> results, const std::optional<ShellFacts>& shell) {
  std::vector<std::string> failed;
  if (job.source.scene) failed = scene::unmet(job.expect, job.source.view(), results.front());
  if (job.expect.volume)
    for (std::string& expectation : scene::unmet(job.expect, *shell)) failed.push_back(std::move(expectation));
  for (const std::string& expectation : failed) tell(fmt::format("{}: {}", job.request.input, expectation));
  if (!failed.empty() || tell_faults(job, results)) return kProcessing;
  bool faces_there = true;
  for (std::size_t i = 0; i < results.size() && job.request.strict_faces; ++i)
    faces_there &= are_within(results[i].statistics.faces, *job.request.strict_faces,
                              i < job.outputs.size() ? job.outputs[i].mesh : "--inner");
  if (!faces_there) return kProcessing;
  if (!job.request.strict) return kDone;
  const bool all = std::all_of(results.begin(), results.end(),
                               [&](const OffsetResult& result) { return is_as_asked(result, job.curves()); });
  return all ? kDone : kProcessing;
}

}  // namespace

ExitCode run_offset(const Job& job, const Timing& timing, ProgressBar& bar) {
  const Request& request = job.request;
  if (request.dry_run) {
    const PolygonView mesh = job.source.view();
    print_dry_run(
        job,
        job.curves() ? plan_curves(mesh, job.distances, job.options) : plan_several(mesh, job.distances, job.options),
        job.distances.front());
    return kDone;
  }
  require_field(job);
  std::vector<OffsetResult> results = compute(job);
  bar.show(Stage::Write, 0);
  const OffsetResult* const inner = request.inner ? &results.back() : nullptr;
  std::vector<std::optional<ShellFacts>> shells;
  OutputFiles outputs(request.sync);
  for (std::size_t i = 0; i < job.outputs.size(); ++i) {
    results[i].statistics.seconds[static_cast<std::size_t>(Stage::Read)] = timing.read_seconds;
    shells.push_back(write_outputs(job, {job.outputs[i], results[i], inner}, timing.start));
  }
  outputs.commit(ignore_interrupts);
  bar.clear();
  for (std::size_t i = 0; i < job.outputs.size() && !request.quiet; ++i)
    print_summary(job, {job.outputs[i], results[i], inner}, shells[i], seconds_since(timing.start));
  return judge(job, results, shells.back());
}

}  // namespace vdb_offset::tool
