// SPDX-License-Identifier: Apache-2.0
#include "valid/limit/untangle_patches.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <tbb/parallel_for.h>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "valid/limit/pull_back.h"

namespace vdb_offset {
namespace {

// How far off their planes at the distance the faces around a vertex may get by a slide, on average and in distances,
// and the share of their area that is live from which on that counts. See docs/dev/tuning.md.
constexpr double kMostOff = 2, kLiveShare = 0.2;

}  // namespace

bool PatchUntangler::PatchFaults::is_less_than(const PatchFaults& other) const {
  return std::tie(misplaced, corners, collided) < std::tie(other.misplaced, other.corners, other.collided);
}

void PatchUntangler::operator()(Progress& progress) {
  if (state_.started_from) start_from_farther();
  follow_schedule(progress);
  free_collided(progress);
}

/// Whether a vertex goes to the side of the farther offset, and no farther than it went there.
bool PatchUntangler::may_start_from_farther(std::uint32_t v) const {
  const double distance = state_.distances[v], farther = state_.started_from->distances[v];
  return state_.may_slide(v) && distance * farther > 0 && std::abs(distance) <= std::abs(farther);
}

/// Moves the patches that were moved at the farther distance, and are faulty here, to where they ended up there.
void PatchUntangler::start_from_farther() {
  const WarmStart& farther = *state_.started_from;
  for (std::uint32_t v = 0; v < state_.source.size(); ++v)
    if (farther.mended[v] && may_start_from_farther(v)) state_.gathered.add(v);
  if (state_.gathered.so_far().empty()) return;
  Indices chosen = state_.with_rings(state_.gathered.take(), kWarmStartRings);
  std::erase_if(chosen, [&](std::uint32_t v) { return !may_start_from_farther(v); });
  patches_.split(chosen);
  const std::vector<PatchFaults> faults = faults_by_patch();
  patches_.drop_if([&](const Indices&, std::uint32_t number) { return !faults[number].any(); });
  const Indices started = patches_.vertices();
  const auto start = [&](const Indices& patch) {
    for_each_index(
        patch.size(), [&](std::size_t i) { start_vertex_from_farther(patch[i]); }, 16);
  };
  state_.statistics.followed_vertices = try_out(start);
  for (const auto v : started)
    if (state_.share[v] != 1) state_.pulled.push_back(v);
}

/// If a vertex ended up far enough away, or both have collided: to its distance on the straight line to where it ended
/// up. If it was held back there: as far as it came, on its own path.
void PatchUntangler::start_vertex_from_farther(std::uint32_t v) {
  const WarmStart& farther = *state_.started_from;
  const Vec3d& displacement = farther.displacement[v];
  Vec3d& whole = state_.whole[v];
  const double distance = std::abs(state_.distances[v]);
  if (farther.achieved[v] >= distance * (1 - kReachedTolerance) - state_.faults.rounding(v))
    whole = displacement_to_distance(state_.constrained, v, displacement, distance);
  else if (farther.held_back[v] && whole.lengthSqr() > 0)
    state_.share[v] = std::clamp(displacement.length() / whole.length(), kLastShare, 1.0);
  else if (state_.paths.state[v] == VertexState::Collision) whole = displacement;
}

/// Whether a triangle is one that untangling could not free at the farther distance: all of its corners had to be
/// pulled back there, whether or not they could be let out again.
bool PatchUntangler::is_given_up(std::uint32_t t) const {
  const WarmStart* farther = state_.started_from;
  const auto& corners = state_.surface.triangles[t];
  return farther && std::all_of(corners.begin(), corners.end(), [&](std::uint32_t v) {
           return farther->pulled[v] && state_.distances[v] * farther->distances[v] > 0;
         });
}

/// With a warm start, settings after the first hardly ever free another patch, and are left out.
void PatchUntangler::follow_schedule(Progress& progress) {
  for (const UntangleSetting& setting : kSchedule)
    if (!untangle_with(setting, progress) || state_.started_from) break;
}

/// Tries patches of ever more rings, for as long as there are faults and more rings make another patch. False if it is
/// not worth while to try another setting.
bool PatchUntangler::untangle_with(const UntangleSetting& setting, Progress& progress) {
  const std::size_t before = state_.fault_count();
  Indices last;
  for (const PatchSizes& sizes : setting.sizes) {
    if (!state_.faults.any()) return false;
    if (sizes.rings > kFewRings && state_.has_many_faults()) break;
    Indices chosen = around_faults(sizes.rings);
    if (chosen == last) break;
    untangle(chosen, setting.energy, sizes);
    progress.advance(1);
    last = std::move(chosen);
  }
  return !state_.has_many_faults() || state_.fault_count() < kWorthwhile * static_cast<double>(before);
}

/// Lets collided vertices slide to where they have their distance.
void PatchUntangler::free_collided(Progress& progress) {
  Indices collided;
  for (std::uint32_t v = 0; v < state_.source.size(); ++v)
    if (state_.may_slide(v) && state_.is_short(v)) collided.push_back(v);
  for (const auto& [energy, sizes] : kCollidedSchedule) {
    if (collided.empty()) return;
    const std::size_t before = collided.size();
    const bool many = before > kManyFaults;
    if (many && sizes.rings > 0) continue;
    Indices chosen = state_.with_rings(collided, sizes.rings);
    std::erase_if(chosen, [&](std::uint32_t v) { return !state_.may_slide(v); });
    untangle(chosen, energy, sizes);
    progress.advance(1);
    std::erase_if(collided, [&](std::uint32_t v) { return !state_.is_short(v); });
    if (many && static_cast<double>(collided.size()) > kGiveUpShare * static_cast<double>(before)) return;
  }
}

/// The vertices that may slide, so many rings around the faults that have not been given up.
Indices PatchUntangler::around_faults(int rings) {
  // Gathered by marks: where fronts have run through each other, a vertex is a corner of many faults.
  state_.faults.for_each_faulty_corner([&](std::uint32_t v) { state_.gathered.add(v); },
                                       [&](std::uint32_t t) { return is_given_up(t); });
  Indices chosen = state_.with_rings(state_.gathered.take(), rings);
  std::erase_if(chosen, [&](std::uint32_t v) { return !state_.may_slide(v); });
  return chosen;
}

/// Untangles patches of these vertices, and keeps the moves that make nothing worse.
void PatchUntangler::untangle(const Indices& chosen, const Untangler::Options& energy, const PatchSizes& sizes) {
  patches_.split(chosen);
  leave_out(sizes);
  const Untangler untangler(state_.constrained, state_.distances, energy);
  try_out([&](const Indices& patch) { untangler(patch, state_.whole); });
  ++pass_;
  ++state_.statistics.untanglings;
}

/// Drops patches that are too large, or hopeless (see schedule.h). In the first pass none counts as hopeless:
/// what it leaves decides.
void PatchUntangler::leave_out(const PatchSizes& sizes) {
  const std::size_t most = state_.started_from ? std::min(sizes.most_vertices, kWarmStartVertices)
                                               : sizes.most_vertices * (1 + state_.source.size() / kManyVertices);
  const std::vector<PatchFaults> faults = faults_by_patch();
  const bool is_first = pass_ == 0 && !state_.started_from;
  patches_.drop_if([&](const Indices& patch, std::uint32_t number) {
    const std::size_t n = patch.size();
    const PatchFaults& of_patch = faults[number];
    return n > most || of_patch.collided > sizes.most_collided ||
           (!is_first && n > kHopelessVertices && of_patch.corners > kHopelessCorners * n);
  });
}

std::vector<PatchUntangler::PatchFaults> PatchUntangler::faults_by_patch() const {
  std::vector<PatchFaults> faults(patches_.count());
  state_.faults.for_each_faulty_corner([&](std::uint32_t v) {
    if (patches_.of(v) != kNone) ++faults[patches_.of(v)].corners;
  });
  for (const auto v : state_.faults.misplaced())
    if (patches_.of(v) != kNone) ++faults[patches_.of(v)].misplaced;
  for (std::size_t i = 0; i < faults.size(); ++i)
    faults[i].collided = static_cast<std::size_t>(
        std::count_if(patches_[i].begin(), patches_[i].end(), [&](std::uint32_t v) { return state_.is_short(v); }));
  return faults;
}

/// Marks the patches of which a vertex has strayed: though its faces have room, they are farther off their planes than
/// before, and than if it had been held back.
/// \param chosen the vertices, and how far off their planes were before
std::vector<std::uint8_t> PatchUntangler::patches_astray(const std::vector<std::pair<std::uint32_t, double>>& chosen) {
  Indices strayed, unknown;
  for (const auto& [v, before] : chosen) {
    const double off = state_.off_planes(v, state_.whole[v]);
    if (off <= kMostOff || off <= before) continue;
    strayed.push_back(v);
    if (state_.live_area[v] < 0) unknown.push_back(v);
  }
  state_.live_area.measure(unknown);
  std::vector<std::uint8_t> astray(patches_.count(), 0);
  for (const auto v : strayed)
    if (state_.live_area[v] > kLiveShare * state_.live_area.area(v)) astray[patches_.of(v)] = 1;
  if (state_.keeps_faces) mark_losses(chosen, astray);
  return astray;
}

/// Marks the patches that lose more of their faces than if their faulty vertices were held back: live area, by how far
/// its planes are off.
void PatchUntangler::mark_losses(const std::vector<std::pair<std::uint32_t, double>>& chosen,
                                 std::vector<std::uint8_t>& astray) {
  Indices moved;
  for (const auto& [v, before] : chosen)
    if (state_.off_planes(v, state_.whole[v]) != before) moved.push_back(v);
  state_.live_area.measure(moved);
  Indices faulty = state_.faults.faulty_vertices();
  std::vector<double> lost(patches_.count(), 0.0);
  for (const auto& [v, before] : chosen) {
    const double off = state_.off_planes(v, state_.whole[v]);
    if (off == before) continue;
    const bool is_held = state_.is_short(v) || std::binary_search(faulty.begin(), faulty.end(), v);
    lost[patches_.of(v)] += state_.live_area[v] * (off - (is_held ? std::max(1.0, before) : before));
  }
  for (std::size_t i = 0; i < lost.size(); ++i)
    if (lost[i] > 0) astray[i] = 1;
}

/// Lets move(patch) change the displacements and shares of the patches' vertices, in parallel; then takes back the
/// patches that have got worse, or no better where they had no fault, or have gone astray. Returns how many vertices
/// are not taken back.
template <class Move>
std::size_t PatchUntangler::try_out(Move&& move) {
  const Indices& chosen = patches_.vertices();
  const std::vector<PatchFaults> before = faults_by_patch();
  std::vector<std::pair<Vec3d, double>> old;
  old.reserve(chosen.size());
  std::vector<std::pair<std::uint32_t, double>> off_before;
  off_before.reserve(chosen.size());
  for (const auto v : chosen) {
    old.emplace_back(state_.whole[v], state_.share[v]);
    off_before.emplace_back(v, state_.off_planes(v, state_.whole[v]));
  }
  tbb::parallel_for(std::size_t{0}, patches_.count(), [&](std::size_t i) { move(patches_[i]); });
  const std::vector<std::uint8_t> astray = patches_astray(off_before);
  FaultFinder::Trial trial = state_.faults.try_out(chosen, [&](std::uint32_t v) { return state_.position_of(v); });
  const std::vector<PatchFaults> after = faults_by_patch();
  Indices undone;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const std::uint32_t v = chosen[i];
    const PatchFaults &was = before[patches_.of(v)], &is = after[patches_.of(v)];
    if (!astray[patches_.of(v)] && (was.any_fault() ? !was.is_less_than(is) : is.is_less_than(was))) continue;
    std::tie(state_.whole[v], state_.share[v]) = old[i];
    undone.push_back(v);
  }
  const std::size_t kept = chosen.size() - undone.size();
  patches_.clear();
  if (!undone.empty()) trial.take_back(undone);
  return kept;
}

}  // namespace vdb_offset
