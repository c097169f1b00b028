// SPDX-License-Identifier: Apache-2.0
#include "valid/limit/limit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ground/system/assert.h"
#include "ground/system/progress_count.h"
#include "valid/limit/contraction.h"
#include "valid/limit/fading.h"
#include "valid/limit/let_out.h"
#include "valid/limit/limit_state.h"
#include "valid/limit/pull_back.h"
#include "valid/limit/return_to_faces.h"
#include "valid/limit/settle.h"
#include "valid/limit/untangle_patches.h"
#include "valid/untangle/schedule.h"

namespace vdb_offset {
namespace {

// Rounds after which half of the stage is shown as done. Measured: 0 to 5,000.
constexpr std::size_t kExpectedRounds = 200;

/// Whether all vertices are at their distances without a fault, and there is nothing to do.
bool is_done(const LimitState& state) {
  if (state.keeps_faces || state.faults.any() || !state.faults.misplaced().empty()) return false;
  for (std::uint32_t v = 0; v < state.share.size(); ++v)
    if (state.distances[v] != 0 && state.constrained.vertex_on_part(v) && state.is_short(v)) return false;
  return true;
}

void make_valid(LimitState& state, double taper, Progress& progress) {
  if (is_done(state)) return;
  while (pull_back(state)) progress.advance(1);
  LetOut let_out(state);
  let_out(progress);
  ReturnToFaces return_to_faces(state);
  // A corner that returns before settling takes room that settling may need: of round corners only large ones do.
  using Which = ReturnToFaces::Which;
  if (return_to_faces(state.keeps_faces ? Which::All : Which::LargeCorners)) let_out(progress);
  Settling settle(state);
  bool any_settled = false;
  for (const LiveArea::Lines lines : {LiveArea::Lines::KeepBorder, LiveArea::Lines::All})
    if (settle(lines)) {
      let_out(progress);
      any_settled = true;
    }
  if ((any_settled || !state.keeps_faces) && return_to_faces(Which::All)) let_out(progress);
  if (state.keeps_faces && return_to_faces.settle()) let_out(progress);
  if (Contraction contract(state); contract()) {
    let_out(progress);
    // What has been contracted makes room for others to settle; with miters, they would take that of miters.
    if (!state.keeps_faces && settle(LiveArea::Lines::All)) let_out(progress);
    if (!state.keeps_faces && contract()) let_out(progress);
    if (return_to_faces(Which::All)) let_out(progress);
  }
  if (taper > 0) Fading{state, taper}(progress);
  while (pull_back(state)) progress.advance(1);  // should a face that was put back be judged otherwise than before
}

/// Writes displacements, distances and states of the vertices to the paths. `mended`, unless it is empty, becomes 1 of
/// each vertex that is not where its path had led.
void write_paths(LimitState& state, std::vector<std::uint8_t>& mended) {
  Paths& paths = state.paths;
  double lost = 0;
  std::size_t moving = 0;
  for (std::uint32_t v = 0; v < state.share.size(); ++v) {
    const double target = std::abs(state.distances[v]);
    if (target == 0 || !state.constrained.vertex_on_part(v)) continue;
    ++moving;
    const Vec3d displacement = state.displacement_of(v);
    const bool stayed = paths.displacement[v] == displacement;
    paths.displacement[v] = displacement;
    const bool is_exact = stayed && !state.constrained.nearer.empty() && state.constrained.nearer[v] > 0;
    if (is_exact) continue;  // what it has achieved is its distance from the exact surface
    const double distance = state.faults.distance_of(v), before = std::exchange(paths.achieved[v], distance);
    if (stayed) continue;
    if (!mended.empty()) mended[v] = 1;
    lost += std::max(0.0, before - distance) / target;
    paths.closest[v] = state.faults.closest_to(v);
    if (std::abs(distance - target) <= kReachedTolerance * target + state.faults.rounding(v)) {
      paths.state[v] = VertexState::Reached;  // a collided vertex may have slid to where there is room
    } else if (state.share[v] != 1 || !falls_short(paths.state[v])) {
      paths.state[v] = VertexState::Limited;
      ++state.statistics.limited_vertices;
    }
  }
  state.statistics.thickness_lost = lost / static_cast<double>(std::max<std::size_t>(1, moving));
}

/// Writes the result to the paths, and what nearer offsets start from to `starts`.
LimitStatistics finish(LimitState& state, WarmStart* starts) {
  std::vector<std::uint8_t> mended(starts ? state.source.size() : 0, 0);
  write_paths(state, mended);
  state.statistics.left = state.faults.count();
  state.statistics.crossings_near_source = state.faults.crossings_near_source().size();
  if (starts) {
    const std::vector<std::uint8_t> none(state.source.size(), 0);
    *starts = {.distances = state.distances,
               .displacement = state.paths.displacement,
               .achieved = state.paths.achieved,
               .mended = std::move(mended),
               .pulled = none,
               .held_back = none,
               .many_faults = state.many_at_first};
    for (const auto v : state.pulled) starts->pulled[v] = 1;
    for (std::size_t v = 0; v < state.share.size(); ++v) starts->held_back[v] = state.share[v] != 1;
  }
  return state.statistics;
}

}  // namespace

LimitStatistics untangle(FaultFinder& faults, const SurfaceOffset& offset, const ProgressCallback& callback) {
  Progress progress(callback, Stage::Limit, kExpectedRounds, Units::Unknown);
  LimitState state(faults, offset, nullptr);
  PatchUntangler{state}(progress);
  return finish(state, nullptr);
}

LimitStatistics limit(FaultFinder& faults, const SurfaceOffset& offset, const ProgressCallback& callback,
                      const WarmStart* started_from, WarmStart* starts) {
  Progress progress(callback, Stage::Limit, kExpectedRounds, Units::Unknown);
  LimitState state(faults, offset, started_from);
  PatchUntangler{state}(progress);
  make_valid(state, offset.taper, progress);
  return finish(state, starts);
}

}  // namespace vdb_offset
