// SPDX-License-Identifier: Apache-2.0
#include "valid/limit/contraction.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

// Shares of the way from a neighbour to the middle of all neighbours: places are that near to the neighbour.
constexpr double kBesideShares[] = {0.03, 0.3};
// Most places of a vertex, and most faces around one that has any: hubs of fans would have places beside each corner.
constexpr std::size_t kMostBeside = 12, kMostFacesAround = 200;
// How far places are from the vertex at most, in distances. Farther ones bring vertices to their distance, too, but
// stretch what lies between.
constexpr double kFarthestBeside = 4;
// So many times as far off as they are now the faces around a vertex may be with it at a place, which may be better
// once others have moved, or worth it to a settled vertex. See docs/dev/tuning.md for this and what is above.
constexpr double kWorseBeside = 1.2;
// A collided vertex is moved only if the error around it falls below this share of the present one; else it stays in
// the middle between the fronts that have met. With 1, plates_closing has a ring of vertices pulled out of the gap.
constexpr double kCollidedWins = 0.8;
// Passes; after the first, only vertices around those that have moved are looked at, so that few take long.
constexpr std::uint64_t kMostPasses = 20;

}  // namespace

bool Contraction::operator()() {
  if (state_.faults.any()) return false;
  PlaceTrials trials(state_, [&](std::uint32_t v, const Place& place) {
    const double least_won = state_.share[v] == 1 ? kCollidedWins : 1;
    return state_.is_short(v) && error_around(v, place.end) < least_won * error_around(v, state_.displacement_of(v));
  });
  Indices vertices = state_.moved_since(before_, 1);
  std::erase_if(vertices, [&](std::uint32_t v) { return !is_contractible(v); });
  bool any = false;
  for (std::uint64_t pass = 0; pass < kMostPasses; ++pass) {
    const Indices moved = trials(candidates(vertices), pass);
    if (moved.empty()) break;
    any = true;
    vertices = state_.with_rings(moved, 1);
    // Of those at the ends of their paths, as collided ones are, one ring goes in a call: farther in, fronts stay in
    // the middle between what they come from.
    std::erase_if(vertices, [&](std::uint32_t v) { return !is_contractible(v) || state_.share[v] == 1; });
  }
  before_ = state_.displacements();
  return any;
}

bool Contraction::is_contractible(std::uint32_t v) const { return state_.may_leave_path(v) && state_.is_short(v); }

/// The vertices of the moving part that places of a vertex may be beside, each once: those at the border for one at a
/// border.
Indices Contraction::neighbours(std::uint32_t v) const {
  Indices ends, all, along_border;
  for (const auto t : state_.surface.triangles_around(v))
    if (state_.constrained.triangle_on_part(t))
      for (const auto w : state_.surface.triangles[t])
        if (w != v) ends.push_back(w);
  std::sort(ends.begin(), ends.end());
  for (std::size_t i = 0, next = 0; i < ends.size(); i = next) {
    while (next < ends.size() && ends[next] == ends[i]) ++next;
    if (state_.distances[ends[i]] == 0) continue;
    all.push_back(ends[i]);
    if (next - i == 1) along_border.push_back(ends[i]);
  }
  return along_border.empty() ? all : along_border;
}

/// A displacement to a position at a vertex's distance near one, within the planes that the vertex has to stay in; none
/// in narrow grooves, where steps away from one wall lead to the other.
std::optional<Vec3d> Contraction::at_distance(std::uint32_t v, Vec3d position) const {
  // Steps along the gradient, and share of the distance that the last may be off. Reasoned: the gradient has length 1,
  // so that the first step is exact unless another part is nearer at its end.
  constexpr int kMostSteps = 12;
  constexpr double kSettled = 1e-9;
  const double distance = std::abs(state_.distances[v]);
  std::uint32_t hint = state_.constrained.hint(v);
  const Vec3d& from = state_.surface.vertices[v];
  if (state_.is_held(v)) position = from + state_.in_planes(v, position - from);
  for (int step = 0; step < kMostSteps; ++step) {
    const Closest closest = state_.constrained.moving_part(position, hint);
    hint = closest.triangle;
    if (std::abs(closest.distance - distance) <= kSettled * distance)
      return round_displacement(position - from, distance);
    const Vec3d away = position - closest.point, along = state_.in_planes(v, away);
    if (!(along.lengthSqr() > 0)) break;
    // Of the gradient, what lies in the planes; the step is as much longer as the distance rises more slowly along it.
    position += along * ((distance / closest.distance - 1) * away.lengthSqr() / along.lengthSqr());
  }
  return std::nullopt;
}

/// How far the faces around a vertex are off with a displacement of it, in distances: where faces are kept, their
/// planes; else the centres of the displaced faces, by the areas that these have and had: by the latter alone, places
/// would win from which faces stretch far to others that are short.
double Contraction::error_around(std::uint32_t v, const Vec3d& displacement) const {
  if (state_.keeps_faces) return state_.off_planes(v, displacement);
  const auto& x = state_.surface.vertices;
  std::uint32_t hint = state_.constrained.hint(v);
  double error = 0, whole = 0;
  for (const auto t : state_.surface.triangles_around(v)) {
    if (!state_.constrained.triangle_on_part(t)) continue;
    const auto& corners = state_.surface.triangles[t];
    Vec3d at[3];
    double distance = 0;
    for (int k = 0; k < 3; ++k) {
      at[k] = x[corners[k]] + (corners[k] == v ? displacement : state_.displacement_of(corners[k]));
      distance += std::abs(state_.distances[corners[k]]) / 3;
    }
    const double before = (x[corners[1]] - x[corners[0]]).cross(x[corners[2]] - x[corners[0]]).length(),
                 now = (at[1] - at[0]).cross(at[2] - at[0]).length();
    const Closest closest = state_.constrained.moving_part((at[0] + at[1] + at[2]) / 3.0, hint);
    hint = closest.triangle;
    error += (before + now) * std::abs(closest.distance - distance);
    whole += before;
  }
  return whole > 0 ? error / (whole * std::abs(state_.distances[v])) : 0;
}

std::vector<Contraction::Place> Contraction::places(std::uint32_t v) const {
  std::vector<Place> places;
  const Indices around = neighbours(v);
  const auto is_short = [&](std::uint32_t w) { return state_.is_short(w); };
  const bool is_hub = state_.surface.triangles_around(v).size() > kMostFacesAround;
  if (is_hub || std::all_of(around.begin(), around.end(), is_short)) return places;
  const auto position = [&](std::uint32_t w) { return state_.surface.vertices[w] + state_.displacement_of(w); };
  Vec3d middle(0.0);
  for (const auto w : around) middle += position(w) / static_cast<double>(around.size());
  const auto offer = [&](const Vec3d& near) {
    const std::optional<Vec3d> end = at_distance(v, near);
    if (end && end->length() <= kFarthestBeside * std::abs(state_.distances[v]))
      places.push_back({*end, state_.off_planes(v, *end)});
  };
  for (const auto w : around)
    if (!is_short(w))
      for (const double share : kBesideShares) offer(position(w) * (1 - share) + middle * share);
  offer(middle);
  const auto by_off = [](const Place& a, const Place& b) { return a.off < b.off; };
  std::stable_sort(places.begin(), places.end(), by_off);
  if (places.size() > kMostBeside) places.resize(kMostBeside);
  const double worst = kWorseBeside * error_around(v, state_.displacement_of(v));
  for (Place& place : places) place.off = error_around(v, place.end);
  std::erase_if(places, [&](const Place& place) { return !(place.off < worst); });
  std::stable_sort(places.begin(), places.end(), by_off);
  return places;
}

std::vector<PlaceTrials::Candidate> Contraction::candidates(const Indices& vertices) const {
  std::vector<PlaceTrials::Candidate> all(vertices.size());
  for_each_index(
      vertices.size(),
      [&](std::size_t i) {
        all[i] = {vertices[i], places(vertices[i])};
      },
      4);
  std::erase_if(all, [](const PlaceTrials::Candidate& candidate) { return candidate.places.empty(); });
  return all;
}

}  // namespace vdb_offset
