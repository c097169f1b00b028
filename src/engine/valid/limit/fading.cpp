// SPDX-License-Identifier: Apache-2.0
#include "valid/limit/fading.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

#include "ground/system/parallel.h"
#include "valid/untangle/warm_start.h"

namespace vdb_offset {
namespace {

// Share of the distance by which thickness may be above its bound. Reasoned: nothing that shows, and far more than
// positions are rounded by.
constexpr double kAboveBound = 1e-3;
// The largest sine between normals of faces inside a flat face. Reasoned: above what seven digits leave of fine
// meshes' planes, below the bends of curved surfaces.
constexpr double kFlatSine = 5e-4;
// Passes, as each makes room for the next. See docs/dev/tuning.md.
constexpr std::uint64_t kFadingPasses = 16;

}  // namespace

double Fading::thickness(std::uint32_t v) const {
  return std::min(state_.faults.distance_of(v), std::abs(state_.distances[v]));
}

/// Whether a vertex is on a crease, or all faces around it lie in one plane.
bool Fading::is_exact(std::uint32_t v) const {
  if (state_.on_crease[v] || (state_.mitered && state_.mitered->is_mitered(v))) return true;
  const Vec3d* first = nullptr;
  for (const auto t : state_.surface.triangles_around(v)) {
    const Vec3d& normal = state_.surface.triangle_normals[t];
    if (!(normal.lengthSqr() > 0)) continue;
    if (!first) first = &normal;
    else if ((normal - *first).lengthSqr() > kFlatSine * kFlatSine) return false;
  }
  return true;
}

bool Fading::may_fade(std::uint32_t v) const {
  return state_.distances[v] != 0 && state_.constrained.vertex_on_part(v) && !state_.constrained.is_bound(v) &&
         !is_exact(v);
}

/// The vertices that are farther off than what is short around them lets them be, and how far they may be.
std::vector<Fading::Bound> Fading::too_thick() const {
  using Reached = std::pair<double, std::uint32_t>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> open;
  std::vector<double> most(state_.share.size());
  for (std::uint32_t v = 0; v < most.size(); ++v) {
    most[v] = thickness(v);
    if (state_.distances[v] != 0 && state_.constrained.vertex_on_part(v) && state_.is_short(v))
      open.emplace(most[v], v);
  }
  std::vector<std::uint32_t> by(most.size(), kNone);
  Indices lowered;
  while (!open.empty()) {
    const auto [thickness, v] = open.top();
    open.pop();
    if (thickness > most[v]) continue;
    for (const auto t : state_.surface.triangles_around(v))
      for (const auto w : state_.surface.triangles[t]) {
        const double asked = std::abs(state_.distances[w]);
        const double bound = thickness + std::max(0.0, asked - std::abs(state_.distances[v])) +
                             taper_ * (state_.source[w] - state_.source[v]).length();
        if (!(bound + kAboveBound * asked < most[w]) || !may_fade(w)) continue;
        most[w] = bound;
        by[w] = v;
        open.emplace(bound, w);
        lowered.push_back(w);
      }
  }
  sort_unique(lowered);
  std::vector<Bound> bounds;
  for (const auto v : lowered) bounds.push_back({v, by[v], most[v]});
  return bounds;
}

/// Where a vertex may be at its bound: on its own path, on the line to where it stands, beside the vertex that bounds
/// it, as in the source, and in the middle of those around it.
std::vector<PlaceTrials::Place> Fading::places(const Bound& bound) const {
  const std::uint32_t v = bound.vertex;
  std::vector<PlaceTrials::Place> places;
  const auto offer = [&](const Vec3d& displacement, double at) {
    if (!(displacement.lengthSqr() > 0)) return;
    const Vec3d end = displacement_to_distance(state_.constrained, v, displacement, at);
    const auto same = [&](const PlaceTrials::Place& place) { return place.end == end; };
    if (std::none_of(places.begin(), places.end(), same)) places.push_back({end, 0});
  };
  Vec3d middle(0.0);
  double corners = 0;
  for (const auto t : state_.surface.triangles_around(v))
    for (const auto w : state_.surface.triangles[t])
      if (w != v) {
        middle += state_.position_of(w);
        ++corners;
      }
  const double now = thickness(v);
  // Half of the way first, and all of it where that is valid as well: what stays halfway makes room for the next pass.
  for (const double at : {(bound.thickness + now) / 2, bound.thickness}) {
    if (state_.paths.achieved[v] >= at) offer(state_.paths.displacement[v], at);
    offer(state_.displacement_of(v), at);
    offer(state_.in_planes(v, state_.displacement_of(bound.by)), at);
    offer(state_.in_planes(v, middle / corners - state_.source[v]), at);
  }
  return places;
}

/// Lets vertices fade that can without a fault. Returns whether any has.
bool Fading::fade(const std::vector<Bound>& bounds, std::uint64_t pass) {
  std::vector<PlaceTrials::Candidate> candidates(bounds.size());
  for_each_index(
      bounds.size(),
      [&](std::size_t i) {
        candidates[i] = {bounds[i].vertex, places(bounds[i])};
      },
      16);
  PlaceTrials trials(state_, [](std::uint32_t, const PlaceTrials::Place&) { return true; });
  return !trials(std::move(candidates), pass).empty();
}

void Fading::operator()(Progress& progress) {
  std::vector<std::uint8_t> was_short(state_.share.size());
  for (std::uint32_t v = 0; v < was_short.size(); ++v) was_short[v] = state_.is_short(v);
  if (state_.faults.any() || std::count(was_short.begin(), was_short.end(), 1) == 0) return;
  state_.find_creases();
  for (std::uint64_t pass = 0; pass < kFadingPasses; ++pass, progress.advance(1))
    if (const std::vector<Bound> bounds = too_thick(); bounds.empty() || !fade(bounds, pass)) break;
  for (std::uint32_t v = 0; v < was_short.size(); ++v)
    state_.statistics.faded_vertices += !was_short[v] && state_.is_short(v);
}

}  // namespace vdb_offset
