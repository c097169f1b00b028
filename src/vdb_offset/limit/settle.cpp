// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/limit/settle.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vdb_offset/base/assert.h"
#include "vdb_offset/limit/pull_back.h"
#include "vdb_offset/paths/propagate.h"

namespace vdb_offset {
namespace {

// With these, gears at 1 % waste 0.9 % of the area that has room, not 1.6 %, in up to 1.8 times the time where that
// helps; single values are not measured.
// How many short vertices are settled: those with the largest areas; and how many trials all of them together have.
constexpr std::size_t kMostSettled = 2000, kMostTrials = 3000;
// Share of the moving part's area: vertices with less live area are left short.
constexpr double kLeastSettled = 2e-5;
// A trial is given up with more faults than this, or once the vertices pulled back for it have lost more than this
// share of the live area that is won.
constexpr std::size_t kMostFaults = 150;
constexpr double kWorthLosing = 0.8;
// In a trial, a vertex in the way keeps this share of its displacement in a round, less than in pull_back(), so that
// few rounds are needed; below the last share it keeps none.
constexpr double kKeptInTrial = 0.6, kLastShareInTrial = 1e-3;
// More vertices than this do not slide aside, or go along, for one. Not measured.
constexpr std::size_t kMostAside = 200;
// A feature goes along with a vertex if no edge that leads to it is longer than this share of the distance. Not
// measured.
constexpr double kReaches[] = {0.01, 0.1, 0.3};

/// Whether a vertex is among some moves, or some old ones.
template <class Some>
bool holds(const Some& some, std::uint32_t v) {
  return std::any_of(some.begin(), some.end(), [&](const auto& one) { return one.vertex == v; });
}

}  // namespace

/// Whether a vertex may be put elsewhere than on its path; not one that an obstacle may have stopped.
bool Settling::may_leave_path(std::uint32_t v) const {
  const ConstrainedSurface& constrained = state_.constrained;
  if (constrained.obstacles && state_.paths.state[v] == VertexState::Collision) return false;
  return state_.distances[v] != 0 && constrained.vertex_on_part(v) && !constrained.is_bound(v);
}

/// The short vertices with which most live area is lost, that with the most first.
std::vector<std::uint32_t> Settling::vertices_to_settle() {
  LiveArea& live_area = state_.live_area;
  const double least = kLeastSettled * live_area.whole_area();
  std::vector<std::pair<double, std::uint32_t>> order;
  for (std::uint32_t v = 0; v < state_.share.size(); ++v)
    if (may_settle(v))
      if (const double area = live_area.area(v); area > least) order.emplace_back(-area, v);
  std::sort(order.begin(), order.end());
  order.resize(std::min(order.size(), kMostSettled));
  std::vector<std::uint32_t> largest;
  largest.reserve(order.size());
  for (const auto& [area, v] : order) largest.push_back(v);
  live_area.measure(largest);
  std::erase_if(largest, [&](std::uint32_t v) { return !(live_area[v] > least); });
  std::stable_sort(largest.begin(), largest.end(),
                   [&](std::uint32_t v, std::uint32_t w) { return live_area[v] > live_area[w]; });
  return largest;
}

bool Settling::operator()(LiveArea::Lines lines) {
  if (state_.faults.any()) return false;
  std::size_t trials = 0;
  bool any = false;
  for (const auto v : vertices_to_settle()) {
    if (trials >= kMostTrials) break;
    if (!state_.is_short(v)) continue;
    if (lines == LiveArea::Lines::All && state_.is_held(v)) continue;
    any |= settle(v, lines, trials);
  }
  return any;
}

/// Tries a vertex at each of its positions; then, at the first of them, with its neighbours, with the small feature
/// that it is part of, and while the vertices in the way slide aside.
bool Settling::settle(std::uint32_t v, LiveArea::Lines lines, std::size_t& trials) {
  const auto try_at = [&](const Moves& moves, const SlideAside* aside) {
    ++trials;
    return settle_at(moves, aside);
  };
  const std::vector<Vec3d> positions = state_.live_area.positions_with_room(v, lines);
  if (positions.empty()) return false;
  for (const Vec3d& position : positions)
    if (try_at({{v, position}}, nullptr)) return true;
  const Move move{v, positions.front()};
  const Moves together = with_short_neighbours(move, lines);
  if (together.size() > 1 && try_at(together, nullptr)) return true;
  std::size_t fewer = 1;
  for (const double reach : kReaches) {
    const Moves feature = with_near_vertices(move, reach);
    if (feature.size() > std::exchange(fewer, feature.size()) && try_at(feature, nullptr)) return true;
  }
  return std::any_of(std::begin(kSlideAsides), std::end(kSlideAsides),
                     [&](const SlideAside& aside) { return try_at({move}, &aside); });
}

/// A move, and the moves of the short vertices around it to where they have their distances; not where there are many.
Settling::Moves Settling::with_short_neighbours(const Move& move, LiveArea::Lines lines) {
  Moves moves{move};
  const Indices around = state_.with_rings({move.vertex}, 1);
  if (around.size() > kMostAside) return moves;
  for (const auto w : around) {
    if (w == move.vertex || !may_settle(w) || (lines == LiveArea::Lines::All && state_.is_held(w))) continue;
    if (const auto positions = state_.live_area.positions_with_room(w, lines); !positions.empty())
      moves.push_back({w, positions.front()});
  }
  return moves;
}

/// A move, and the same displacement of the vertices that edges lead to of which none is longer than a share of the
/// distance: a feature that small goes along as it is.
Settling::Moves Settling::with_near_vertices(const Move& move, double reach) const {
  const Surface& surface = state_.surface;
  Moves moves{move};
  const Vec3d displacement = move.position - surface.vertices[move.vertex];
  const double longest = reach * std::abs(state_.distances[move.vertex]);
  for (std::size_t i = 0; i < moves.size() && moves.size() <= kMostAside; ++i) {
    const Vec3d& from = surface.vertices[moves[i].vertex];
    for (const auto t : surface.triangles_around(moves[i].vertex))
      for (const auto w : surface.triangles[t]) {
        const bool is_near = (surface.vertices[w] - from).length() <= longest &&
                             (surface.vertices[w] - surface.vertices[move.vertex]).length() <= 2 * longest;
        if (!is_near || !may_go_along(w) || holds(moves, w)) continue;
        moves.push_back({w, surface.vertices[w] + displacement});
      }
  }
  return moves;
}

Settling::Old Settling::old_of(std::uint32_t v) const {
  return {v, state_.whole[v], state_.share[v], state_.is_short(v), state_.mitred && state_.mitred->is_mitred(v)};
}

/// The live area of the vertices that were at their distance, and are short now.
double Settling::lost_since(const OldOnes& old) const {
  double lost = 0;
  for (const Old& o : old)
    if (!o.was_short && state_.is_short(o.vertex)) lost += state_.live_area[o.vertex];
  return lost;
}

/// One trial: of the first of the moves, and of others that go along. False, and nothing has changed, if more is lost
/// than won, or the first vertex does not get to its distance.
bool Settling::settle_at(const Moves& moves, const SlideAside* aside) {
  OldOnes old;
  put(moves, old);
  const std::uint32_t vertex = moves.front().vertex;
  if (state_.is_short(vertex) || (aside && !slide_aside(vertex, *aside, old))) {
    put_back(old);
    return false;
  }
  while (state_.faults.any() || !state_.faults.misplaced().empty()) {
    const Indices in_the_way = vertices_to_pull(state_, vertex);
    const bool is_hopeless = in_the_way.empty() || state_.fault_count() > kMostFaults;
    if (!is_hopeless) pull_in_trial(in_the_way, old);
    if (is_hopeless || lost_since(old) > kWorthLosing * state_.live_area[vertex]) {
      put_back(old);
      return false;
    }
    ++state_.statistics.rounds;
  }
  for (const Old& o : old) state_.pulled.push_back(o.vertex);
  sort_unique(state_.pulled);
  return true;
}

void Settling::put(const Moves& moves, OldOnes& old) {
  Indices moved;
  for (const auto& [v, position] : moves) {
    old.push_back(old_of(v));
    moved.push_back(v);
    const Vec3d whole = state_.in_planes(v, position - state_.surface.vertices[v]);
    state_.whole[v] = round_displacement(whole, std::abs(state_.distances[v]));
    state_.share[v] = 1;
  }
  sort_unique(moved);
  if (state_.mitred) state_.mitred->take_back(moved, state_.paths);
  state_.live_area.measure(moved);
  state_.move(moved);
}

void Settling::pull_in_trial(const Indices& vertices, OldOnes& old) {
  for (const auto v : vertices)
    if (!holds(old, v)) old.push_back(old_of(v));
  const Indices unmitred = state_.take_miters_back(vertices);
  for (const auto v : vertices) {
    if (std::binary_search(unmitred.begin(), unmitred.end(), v)) continue;
    double& share = state_.share[v];
    share = share < kLastShareInTrial ? 0 : share * kKeptInTrial;
  }
  state_.move(vertices);
}

/// Lets the vertices in the way of a vertex, and those around them, slide at their distance out of the way. False if no
/// vertex may slide, or too many would have to.
bool Settling::slide_aside(std::uint32_t vertex, const SlideAside& aside, OldOnes& old) {
  state_.faults.for_each_faulty_corner([&](std::uint32_t v) { state_.gathered.add(v); });
  Indices sliding = state_.with_rings(state_.gathered.take(), aside.rings);
  std::erase_if(sliding, [&](std::uint32_t v) { return v == vertex || !state_.may_slide(v); });
  if (sliding.empty() || sliding.size() > kMostAside) return false;
  state_.live_area.measure(sliding);
  for (const auto v : sliding) {
    if (!holds(old, v)) old.push_back(old_of(v));
    state_.share[v] = 1;
  }
  Untangler(state_.constrained, state_.distances, aside.energy)(sliding, state_.whole);
  state_.move(sliding);
  return true;
}

void Settling::put_back(const OldOnes& old) {
  Indices vertices, mitred;
  for (const Old& o : old) {
    state_.whole[o.vertex] = o.whole;
    state_.share[o.vertex] = o.share;
    vertices.push_back(o.vertex);
    if (o.was_mitred) mitred.push_back(o.vertex);
  }
  sort_unique(vertices);
  sort_unique(mitred);
  if (state_.mitred) state_.mitred->miter_again(mitred, state_.paths);
  state_.move(vertices);
}

}  // namespace vdb_offset
