// SPDX-License-Identifier: Apache-2.0
#include "write/attempts.h"

#include <algorithm>

#include "ground/process/progress.h"
#include "hybrid/hybrid_offset.h"
#include "join/cells.h"
#include "join/opencascade_joins.h"
#include "judge/judge.h"
#include "trim/trim_offset.h"
#include "write/own_process.h"

namespace vdb_offset::cad {
namespace {

constexpr unsigned kTrial = 60, kHybrid = 120, kOther = 15;  // seconds

// The share of an attempt that is shown as done once the body is made. Measured on six models: 0.1 to 0.4.
constexpr double kMade = 0.2;

MadeBody check(const BodyTask& task, const OffsetCadResult& result, Exactness exactness = Exactness::Exact) {
  const ProgressPart part(kMade, 1);
  return check_body(task.body, result, task.asked, exactness);
}

OffsetCadResult made_in_part(const OffsetCadRequest& request) {
  const ProgressPart part(0, kMade);
  return offset_cad(request);
}

MadeBody trimmed(const BodyTask& task, const OffsetCadResult& result) {
  if (result.shape.IsNull() || !result.gaps.empty()) return {};
  if (task.is_even_solid()) return check(task, trim_offset(task.body.source.shape, result, task.request().distance));
  return check(task, trim_offset(task.body.faces_that(false), result, *task.body.distance_of_moved()));
}

/// With the source's topology, as far as the distance leaves it; crossing faces are trimmed.
MadeBody make_alike(const BodyTask& task) {
  const OffsetCadResult result = made_in_part(task.request());
  MadeBody made = check(task, result);
  if (made.is_good() || !task.may_be_trimmed()) return made;
  limit_seconds(kTrial);
  MadeBody other = trimmed(task, result);
  return other.is_good() ? other : made;
}

/// The same with all edges there: what the distance turns round is trimmed as well.
MadeBody make_turned(const BodyTask& task) {
  OffsetCadRequest request = task.request();
  request.keeps_turned = true;
  return trimmed(task, made_in_part(request));
}

MadeBody make_nothing(const BodyTask& task) {
  MadeBody made;
  if (!leaves_nothing(task.body.source.shape, task.request().distance)) return made;
  made.facts.vanished = 1;
  made.facts.swallowed = task.body.body.faces.size();
  made.facts.made = io::CadMade::Solid;
  return made;
}

MadeBody make_cells(const BodyTask& task) { return check(task, cells_offset(task.request())); }
MadeBody join_by_arcs(const BodyTask& task) { return check(task, opencascade_offset(task.request(), Join::Arcs)); }
MadeBody join_by_intersection(const BodyTask& task) {
  return check(task, opencascade_offset(task.request(), Join::Intersection));
}

/// With triangles in place of what is exact, too, where the check finds a fault. One that is left where nothing is
/// exact is the mesh's own: the result is doubtful then, and no other way makes it better.
MadeBody make_with_triangles(const BodyTask& task, ExactParts parts) {
  constexpr int kMostChecks = 4;
  const Asked& asked = task.asked;
  const Body& body = task.body.body;
  HybridOffset hybrid(task.request(),
                      shell_meshes(body, shape_of(body), task.body.mesh, asked.write.positions, asked.millimetres),
                      parts);
  MadeBody best;
  for (int checks = 1;; ++checks) {
    MadeBody made = check(task, hybrid.make(), Exactness::Hybrid);
    const bool is_doubtful = made.facts.made == io::CadMade::Doubtful;
    if (parts == ExactParts::None || (made.is_good() && !is_doubtful)) return made;
    const bool is_mended = !made.bad_places.empty() && hybrid.take_off_near(made.bad_places);
    if (is_doubtful) {
      made.may_be_better = is_mended || made.bad_places.empty();
      best = made;
      task.keep(best);
    }
    if (!is_mended || checks == kMostChecks) return best.is_good() ? best : made;
  }
}

MadeBody make_hybrid(const BodyTask& task) { return make_with_triangles(task, ExactParts::Near); }
MadeBody make_stricter_hybrid(const BodyTask& task) { return make_with_triangles(task, ExactParts::There); }
MadeBody make_triangles(const BodyTask& task) { return make_with_triangles(task, ExactParts::None); }

bool any(const BodyTask&) { return true; }
bool is_even_solid(const BodyTask& task) { return task.is_even_solid(); }
bool may_be_trimmed(const BodyTask& task) { return task.may_be_trimmed(); }
bool may_vanish(const BodyTask& task) { return task.is_even_solid() && task.request().distance < 0; }
bool is_thin(const BodyTask& task) { return task.is_even_solid() && !task.asked.write.thick; }
bool has_mesh(const BodyTask& task) { return !task.asked.write.positions.empty(); }
/// OpenCASCADE takes a minute to write, read and check 20,000 faces.
bool has_small_mesh(const BodyTask& task) {
  constexpr std::size_t kMost = 20000;
  std::size_t triangles = 0;
  for (const FaceMesh& face : task.body.mesh.faces) triangles += face.triangles.size();
  return has_mesh(task) && triangles <= kMost;
}

constexpr Attempt kAttempts[] = {
    {any, make_alike, false, 0, 0.6, 0.8},
    {may_vanish, make_nothing, false, kTrial, 0.3, 0.82},
    {may_be_trimmed, make_turned, false, kOther, 0.3, 0.86},
    {is_thin, make_cells, false, kOther, 0.3, 0.9},
    {is_even_solid, join_by_arcs, false, kOther, 0.5, 0.92},
    {is_even_solid, join_by_intersection, false, kOther, 1, 0.94},
    {has_mesh, make_hybrid, true, kHybrid, 0.5, 0.96},
    {has_mesh, make_stricter_hybrid, true, kHybrid, 0.5, 0.98},
    {has_small_mesh, make_triangles, true, kTrial, 1, 1},
};

}  // namespace

std::span<const Attempt> attempts() { return kAttempts; }

}  // namespace vdb_offset::cad
