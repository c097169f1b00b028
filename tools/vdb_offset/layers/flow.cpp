// SPDX-License-Identifier: Apache-2.0
#include "layers/flow.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <vector>

#include "messages.h"
#include "summary/summary.h"

namespace vdb_offset::tool {
namespace {

/// The longest side of the box around the vertices in use.
double longest_side(PolygonView mesh) {
  Vec3d lowest(0.0), highest(0.0);
  for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
    const Vec3d& x = mesh.positions[mesh.corners[c]];
    lowest = c == 0 ? x : openvdb::math::minComponent(lowest, x);
    highest = c == 0 ? x : openvdb::math::maxComponent(highest, x);
  }
  const Vec3d size = highest - lowest;
  return std::max({size[0], size[1], size[2]});
}

using Kind = BoundaryPatch::Kind;

/// Patches as are asked for, which may exchange their names. \throw InvalidOption
void rename(const Request& request, std::vector<BoundaryPatch>& patches) {
  std::vector<std::string> names;
  names.reserve(patches.size());
  for (const BoundaryPatch& each : patches) names.push_back(each.name);
  for (const PatchRequest& asked : request.patches) {
    const auto found = std::ranges::find(names, asked.patch);
    if (found == names.end())
      throw InvalidOption(fmt::format("--patch: expected one of {}, got '{}'", fmt::join(names, ", "), asked.patch));
    BoundaryPatch& patch = patches[static_cast<std::size_t>(found - names.begin())];
    if (asked.kind && patch.kind == Kind::Periodic)
      throw InvalidOption(fmt::format("--patch: expected a name alone for {}, which is periodic", asked.patch));
    patch.name = asked.name;
    if (asked.kind) patch.kind = *asked.kind;
  }
  for (const PatchRequest& asked : request.patches)
    if (std::ranges::count(patches, asked.name, &BoundaryPatch::name) > 1)
      throw InvalidOption(fmt::format("--patch: expected another name for each patch, got '{}' for two", asked.name));
}

/// \throw InvalidOption where it is not known what flows through a side
void require_kinds(const VolumeMesh& mesh, const std::vector<BoundaryPatch>& renamed) {
  std::vector<std::string> sides, options;
  for (const PatchFacts& facts : patch_facts(mesh)) {
    const auto patch = std::ranges::find(mesh.patches, facts.name, &BoundaryPatch::name) - mesh.patches.begin();
    if (renamed[static_cast<std::size_t>(patch)].kind != Kind::Side) continue;
    sides.push_back(facts.plane ? fmt::format("{} (in {})", facts.name, planes_in_words({&*facts.plane, 1}))
                                : facts.name);
    options.push_back(fmt::format("--patch {}={}", facts.name, options.empty() ? "inlet:inlet" : "outlet:outlet"));
  }
  if (sides.empty()) return;
  throw InvalidOption(fmt::format("--case: expected to know what {} {}, as by {} (or wall, symmetry, farfield)",
                                  fmt::join(sides, ", "), sides.size() == 1 ? "is" : "are", fmt::join(options, " ")));
}

/// Names as a shell takes them.
std::string shell_words(const std::vector<std::string>& names) {
  std::string words;
  for (const std::string& name : names) words.append(name.starts_with('-') ? " ./" : " ").append(shell_word(name));
  return words;
}

void warn_of_files(const io::CaseFiles& files) {
  if (!files.kept.empty())
    report_problem(fmt::format(
        "warning: {} {} there already, not as this case would have {} (to have {} made anew: rm{})",
        fmt::join(files.kept, ", "), files.kept.size() == 1 ? "is" : "are", files.kept.size() == 1 ? "it" : "them",
        files.kept.size() == 1 ? "it" : "them", shell_words(files.kept)));
  if (!files.results.empty())
    report_problem(fmt::format(
        "warning: {} {} of an earlier mesh, and a solver would go on from there (to start anew: rm -r{})",
        fmt::join(files.results, ", "), files.results.size() == 1 ? "is" : "are", shell_words(files.results)));
}

}  // namespace

io::Flow flow_of(const Job& job) {
  const FlowRequest& request = job.request.flow;
  io::Flow flow = request.given;
  flow.length = request.length ? *request.length : longest_side(job.source.view());
  flow.viscosity = request.viscosity ? *request.viscosity / request.density.value_or(1)
                                     : flow.speed * flow.length / *request.reynolds;
  return flow;
}

void rename_patches(const Request& request, VolumeMesh& mesh) { rename(request, mesh.patches); }

void require_patches(const Request& request, const VolumeMesh& mesh) {
  std::vector<BoundaryPatch> renamed = mesh.patches;
  rename(request, renamed);
  if (!request.solver_case.folder.empty()) require_kinds(mesh, renamed);
}

void write_case(const Job& job, const VolumeMesh& mesh, double thickness) {
  const CaseRequest& request = job.request.solver_case;
  if (request.folder.empty()) return;
  io::Flow flow = flow_of(job);
  flow.thickness = thickness;
  std::vector<io::CasePatch> patches;
  for (const BoundaryPatch& patch : mesh.patches)
    if (patch.face_count() > 0) patches.push_back({patch.name, patch.kind});
  const io::CaseFiles files = request.of_su2 ? io::write_su2_case(job.request.output, patches, flow)
                                             : io::write_openfoam_case(request.folder, patches, flow);
  if (!job.request.quiet) warn_of_files(files);
}

}  // namespace vdb_offset::tool
