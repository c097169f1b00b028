// SPDX-License-Identifier: Apache-2.0
#include "valid/limit/return_to_faces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "ground/mesh/planes_around.h"
#include "ground/mesh/prevailing_point.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

// Passes, as each may make room for the next. See docs/dev/tuning.md.
constexpr std::uint64_t kReturnPasses = 2;
// By how much less the planes have to be off, in distances. Reasoned: what is less is no fault of faces.
constexpr double kLessOff = 1e-3;
// Share of the moving part's area: what live area around a corner is large.
constexpr double kLargeCorner = 1e-3;
// How far off the planes are taken to be at a place that is tried first. Where vertices stay there once they are,
// plate_with_notch at 0.5 % has its faces 9.7 % off, not 4.1, and gears at -0.5 % 98.0 % of its vertices, not 98.5.
constexpr double kBest = -1;
// The largest planes around a vertex that its places lie on, and how far these may be, in distances. Not measured.
constexpr std::size_t kPlanesOfPlaces = 4;
constexpr double kFarthestPlace = 4;
// What settling a vertex has to win at least: area by how far it is off, as a share of the moving part's area. How many
// of its places are tried, and how many trials all vertices together have. See docs/dev/tuning.md.
constexpr double kLeastToWin = 5e-5;
constexpr std::size_t kPlacesSettled = 3, kMostFaceTrials = 1000;

}  // namespace

bool ReturnToFaces::may_move(std::uint32_t v) const {
  return state_.may_leave_path(v) && !(state_.mitered && state_.mitered->is_mitered(v));
}

bool ReturnToFaces::operator()(Which which) {
  if (state_.keeps_faces) state_.find_creases();
  // What has moved meanwhile may have made a place no better than where its vertex is.
  PlaceTrials trials(state_,
                     [&](std::uint32_t v, const Place& place) { return place.off < state_.off_planes(v) - kLessOff; });
  bool any = false;
  const Indices vertices = state_.moved_since(before_, 1);
  for (std::uint64_t pass = 0; pass < kReturnPasses; ++pass) {
    if (trials(candidates(vertices, which), pass).empty()) break;
    any = true;
  }
  if (which == Which::All) before_ = state_.displacements();
  return any;
}

bool ReturnToFaces::settle() {
  VDB_OFFSET_ASSERT(state_.keeps_faces && !state_.on_crease.empty());
  if (state_.faults.any()) return false;
  std::vector<std::pair<double, Candidate>> all;
  for (Candidate& candidate : candidates(state_.moved_since({}, 0), Which::All)) {
    const std::uint32_t v = candidate.vertex;
    const double to_win = state_.live_area[v] * (state_.off_planes(v) - candidate.places.front().off);
    if (to_win > kLeastToWin * state_.live_area.whole_area()) all.emplace_back(to_win, std::move(candidate));
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  SettlingTrial trial(state_, SettlingTrial::Aim::Faces);
  bool any = false;
  for (const auto& [to_win, candidate] : all) {
    if (trial.count() >= kMostFaceTrials) break;
    any |= settle(candidate, trial);
  }
  return any;
}

/// Tries the best places of a vertex, alone and with the small feature that it is part of; then the first of them while
/// the vertices in the way slide aside.
bool ReturnToFaces::settle(const Candidate& candidate, SettlingTrial& trial) const {
  const std::uint32_t v = candidate.vertex;
  const double worst = state_.off_planes(v) - kLessOff;
  for (std::size_t i = 0; i < std::min(candidate.places.size(), kPlacesSettled); ++i) {
    const SettlingTrial::Move move{v, candidate.places[i].end};
    if (candidate.places[i].off < worst && (trial.try_alone({move}) || trial.try_with_feature(move))) return true;
  }
  const Place& best = candidate.places.front();
  return best.off < worst && trial.try_with_others_aside({v, best.end});
}

/// Whether a vertex is to be looked at: where it is not where its path has led, and with round corners where it is
/// short, else where it may be off its planes.
bool ReturnToFaces::may_be_better(std::uint32_t v) const {
  const bool is_elsewhere = state_.share[v] != 1 || state_.whole[v] != state_.paths.displacement[v];
  return is_elsewhere || (state_.keeps_faces ? state_.on_crease[v] != 0 : state_.is_short(v));
}

/// Those of some vertices with live area that have places better than where they are.
std::vector<ReturnToFaces::Candidate> ReturnToFaces::candidates(const Indices& vertices, Which which) {
  const double least_area = which == Which::LargeCorners ? kLargeCorner * state_.live_area.whole_area() : 0;
  Indices some;
  for (const auto v : vertices)
    if (may_move(v) && may_be_better(v) && state_.off_planes(v) > kLessOff) some.push_back(v);
  state_.live_area.measure(some);
  std::erase_if(some, [&](std::uint32_t v) { return !(state_.live_area[v] > least_area); });
  if (!some.empty()) state_.find_creases();
  std::vector<Candidate> all(some.size());
  for_each_index(
      some.size(),
      [&](std::size_t i) {
        all[i] = {some[i], places(some[i], which)};
      },
      16);
  std::erase_if(all, [](const Candidate& candidate) { return candidate.places.empty(); });
  return all;
}

std::vector<ReturnToFaces::Place> ReturnToFaces::places(std::uint32_t v, Which which) const {
  std::vector<Place> places;
  const double worst = state_.off_planes(v) - kLessOff;
  const auto offer = [&](const Vec3d& end) {
    if (const double off = state_.off_planes(v, end); off < worst) places.push_back({end, off});
  };
  if (const Vec3d* const miter = state_.mitered ? state_.mitered->miter_of(v) : nullptr) offer(*miter);
  if (!falls_short(state_.paths.state[v])) {
    if (state_.keeps_faces) offer(state_.paths.displacement[v]);
    else places.push_back({state_.paths.displacement[v], kBest});  // comes first, and others may follow from there
  }
  if (!state_.constrained.obstacles) {
    if (state_.on_crease[v]) offer_planes(v, worst, places);
    if (which == Which::All && (state_.keeps_faces || state_.is_short(v))) offer_images(v, worst, places);
  }
  std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.off < b.off; });
  const auto same = [](const Place& a, const Place& b) { return a.end == b.end; };
  places.erase(std::unique(places.begin(), places.end(), same), places.end());
  return places;
}

/// Adds the points at the distance that lie on some of the largest planes around a vertex.
void ReturnToFaces::offer_planes(std::uint32_t v, double worst, std::vector<Place>& places) const {
  const Surface& part = state_.constrained.moving_part.surface();
  const std::uint32_t part_vertex = state_.constrained.part_vertex_of(v);
  PlanesAround planes = planes_around(
      state_.surface, v, [&](std::uint32_t t) -> const Vec3d& { return state_.surface.triangle_normals[t]; });
  for (Vec3d& normal : planes.normals) normal = part.along_border(part_vertex, normal);
  for_each_point_on_planes(planes.normals, planes.areas, kPlanesOfPlaces, [&](const Vec3d& x) {
    if (!(x.lengthSqr() <= kFarthestPlace * kFarthestPlace)) return;
    const Vec3d end = round_displacement(x * state_.distances[v], std::abs(state_.distances[v]));
    const double off = state_.off_planes(v, end);
    if (off < worst && is_at_distance(v, end)) places.push_back({end, off});
  });
}

/// Adds the images of live points around a vertex. Where it has to stay in planes, what of them lies in these, if that
/// is at the distance.
void ReturnToFaces::offer_images(std::uint32_t v, double worst, std::vector<Place>& places) const {
  for (const Vec3d& position : state_.live_area.positions_with_room(v, LiveArea::Lines::KeepBorder)) {
    const Vec3d whole = state_.in_planes(v, position - state_.surface.vertices[v]);
    const Vec3d end = round_displacement(whole, std::abs(state_.distances[v]));
    const double off = state_.off_planes(v, end);
    if (off < worst && (!state_.is_held(v) || is_at_distance(v, end))) places.push_back({end, off});
  }
}

bool ReturnToFaces::is_at_distance(std::uint32_t v, const Vec3d& end) const {
  const Closest closest = state_.constrained.moving_part(state_.surface.vertices[v] + end, state_.constrained.hint(v));
  const double distance = std::abs(state_.distances[v]);
  return std::abs(closest.distance - distance) <= kReachedTolerance * distance;
}

}  // namespace vdb_offset
