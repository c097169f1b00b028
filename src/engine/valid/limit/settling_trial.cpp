// SPDX-License-Identifier: Apache-2.0
#include "valid/limit/settling_trial.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "motion/paths/propagate.h"
#include "valid/limit/contraction.h"
#include "valid/limit/pull_back.h"

namespace vdb_offset {
namespace {

// A trial is given up with more faults than this, or once the vertices pulled back for it have lost more than this
// share of the live area that is won.
constexpr std::size_t kMostFaults = 150;
constexpr double kWorthLosing = 0.8;
// While looking for room elsewhere, a trial with Aim::Distance may lose up to this many times kWorthLosing, and tries
// at most this many of the vertices that it displaced. See docs/dev/tuning.md.
constexpr double kMayFindRoom = 8;
constexpr std::size_t kMostElsewhere = 4;
// In a trial, a vertex in the way keeps this share of its displacement in a round, less than in pull_back(), so that
// few rounds are needed; below the last share it keeps none.
constexpr double kKeptInTrial = 0.6, kLastShareInTrial = 1e-3;
// A feature goes along with a vertex if no edge that leads to it is longer than this share of the distance. Not
// measured.
constexpr double kReaches[] = {0.01, 0.1, 0.3};
// What a vertex that comes to be short costs when faces are to be won: so many times its area, live or not, beside what
// its faces lose. See docs/dev/tuning.md.
constexpr double kShortCosts = 3;

/// Whether a vertex is among some moves, or some old ones.
template <class Some>
bool holds(const Some& some, std::uint32_t v) {
  return std::any_of(some.begin(), some.end(), [&](const auto& one) { return one.vertex == v; });
}

}  // namespace

/// Puts a vertex there with ever larger features that it may be part of.
bool SettlingTrial::try_with_feature(const Move& move) {
  std::size_t fewer = 1;
  return std::any_of(std::begin(kReaches), std::end(kReaches), [&](double reach) {
    const Moves feature = with_near_vertices(move, reach);
    return feature.size() > std::exchange(fewer, feature.size()) && try_alone(feature);
  });
}

bool SettlingTrial::try_with_others_aside(const Move& move) {
  return std::any_of(std::begin(kSlideAsides), std::end(kSlideAsides),
                     [&](const SlideAside& aside) { return try_out({move}, &aside); });
}

/// A move, and the same displacement of the vertices that edges lead to of which none is longer than a share of the
/// distance: a feature that small goes along as it is.
SettlingTrial::Moves SettlingTrial::with_near_vertices(const Move& move, double reach) const {
  const Surface& surface = state_.surface;
  Moves moves{move};
  const double longest = reach * std::abs(state_.distances[move.vertex]);
  for (std::size_t i = 0; i < moves.size() && moves.size() <= kMostAside; ++i) {
    const Vec3d& from = surface.vertices[moves[i].vertex];
    for (const auto t : surface.triangles_around(moves[i].vertex))
      for (const auto w : surface.triangles[t]) {
        const bool is_near = (surface.vertices[w] - from).length() <= longest &&
                             (surface.vertices[w] - surface.vertices[move.vertex]).length() <= 2 * longest;
        if (!is_near || !state_.may_leave_path(w) || holds(moves, w)) continue;
        moves.push_back({w, state_.in_planes(w, move.displacement)});
      }
  }
  return moves;
}

SettlingTrial::Old SettlingTrial::old_of(std::uint32_t v) const {
  return {v,
          state_.whole[v],
          state_.share[v],
          state_.is_short(v),
          state_.mitered && state_.mitered->is_mitered(v),
          aim_ == Aim::Faces ? state_.off_planes(v) : 0};
}

/// Whether more is won by the trial so far than is lost. With a leeway, up to so many times as much may be lost as a
/// trial may lose in the end; it is for Aim::Distance alone.
bool SettlingTrial::is_worth_it(std::uint32_t vertex, const OldOnes& old, double leeway) {
  double lost = 0;
  Indices some;
  for (const Old& o : old) some.push_back(o.vertex);
  state_.live_area.measure(some);
  if (aim_ == Aim::Distance) {
    for (const Old& o : old)
      if (!o.was_short && state_.is_short(o.vertex)) lost += state_.live_area[o.vertex];
    return lost <= leeway * kWorthLosing * state_.live_area[vertex];
  }
  for (const Old& o : old) {
    const bool is_short = state_.is_short(o.vertex);
    if (is_short != o.was_short) lost += (is_short ? kShortCosts : -kShortCosts) * state_.live_area.area(o.vertex);
    lost += state_.live_area[o.vertex] * (state_.off_planes(o.vertex) - o.was_off);
  }
  return lost < 0;  // what is won counts as well
}

/// One trial: of the first of the moves, and of others that go along. False, and nothing has changed, if more is lost
/// than won, or the first vertex does not get to its distance.
bool SettlingTrial::try_out(const Moves& moves, const SlideAside* aside) {
  ++count_;
  OldOnes old;
  for (const Move& move : moves) old.push_back(old_of(move.vertex));
  put(moves);
  const std::uint32_t vertex = moves.front().vertex;
  if (state_.is_short(vertex) || (aside && !slide_aside(vertex, *aside, old))) {
    put_back(old);
    return false;
  }
  const bool finds_room = aim_ == Aim::Distance && !state_.keeps_faces;  // it may be that of miters
  while (state_.faults.any() || !state_.faults.misplaced().empty()) {
    const Indices in_the_way = vertices_to_pull(state_, vertex);
    const bool is_hopeless = in_the_way.empty() || state_.fault_count() > kMostFaults;
    if (!is_hopeless) pull(in_the_way, old);
    if (is_hopeless || !is_worth_it(vertex, old, finds_room ? kMayFindRoom : 1)) {
      put_back(old);
      return false;
    }
    ++state_.statistics.rounds;
  }
  if (finds_room) put_lost_elsewhere(vertex, old);
  if (!is_worth_it(vertex, old)) {
    put_back(old);
    return false;
  }
  for (const Old& o : old) state_.pulled.push_back(o.vertex);
  sort_unique(state_.pulled);
  return true;
}

void SettlingTrial::put(const Moves& moves) {
  Indices moved, mitered;
  for (const auto& [v, displacement] : moves) {
    moved.push_back(v);
    state_.whole[v] = round_displacement(displacement, std::abs(state_.distances[v]));
    state_.share[v] = 1;
    if (state_.mitered && state_.mitered->is_miter(v, state_.whole[v])) mitered.push_back(v);
  }
  sort_unique(moved);
  if (state_.mitered) {
    state_.mitered->take_back(moved, state_.paths);
    state_.mitered->miter_again(mitered, state_.paths);
  }
  state_.live_area.measure(moved);
  state_.move(moved);
}

void SettlingTrial::pull(const Indices& vertices, OldOnes& old) {
  for (const auto v : vertices)
    if (!holds(old, v)) old.push_back(old_of(v));
  const Indices unmitered = state_.take_miters_back(vertices);
  for (const auto v : vertices) {
    if (std::binary_search(unmitered.begin(), unmitered.end(), v)) continue;
    double& share = state_.share[v];
    share = share < kLastShareInTrial ? 0 : share * kKeptInTrial;
  }
  state_.move(vertices);
}

/// Lets the vertices in the way of a vertex, and those around them, slide at their distance out of the way. False if no
/// vertex may slide, or too many would have to.
bool SettlingTrial::slide_aside(std::uint32_t vertex, const SlideAside& aside, OldOnes& old) {
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

/// Puts vertices that have come to be short where there is room for them, those first with which most is lost, until
/// the trial is worth it. \pre there are no faults, and Aim::Distance
void SettlingTrial::put_lost_elsewhere(std::uint32_t vertex, const OldOnes& old) {
  if (is_worth_it(vertex, old)) return;
  std::vector<std::pair<double, std::uint32_t>> lost;
  for (const Old& o : old)
    if (!o.was_short && state_.is_short(o.vertex) && state_.may_leave_path(o.vertex))
      lost.emplace_back(-state_.live_area[o.vertex], o.vertex);
  std::sort(lost.begin(), lost.end());
  lost.resize(std::min(lost.size(), kMostElsewhere));
  for (const auto& [area, v] : lost)
    if (find_room(v) && is_worth_it(vertex, old)) return;
}

/// Puts a short vertex where it has room, or beside a neighbour, if that makes no fault; else leaves it where it is.
bool SettlingTrial::find_room(std::uint32_t v) {
  std::vector<Vec3d> ends;
  for (const Vec3d& position : state_.live_area.positions_with_room(v, LiveArea::Lines::KeepBorder))
    ends.push_back(state_.in_planes(v, position - state_.surface.vertices[v]));
  for (const Contraction::Place& place : Contraction{state_}.places(v)) ends.push_back(place.end);
  const Vec3d whole = state_.whole[v];
  const double share = state_.share[v];
  for (const Vec3d& end : ends) {
    put({{v, end}});
    if (!state_.faults.any() && state_.faults.misplaced().empty() && !state_.is_short(v)) return true;
  }
  state_.whole[v] = whole;
  state_.share[v] = share;
  state_.move({v});
  return false;
}

void SettlingTrial::put_back(const OldOnes& old) {
  Indices vertices, mitered;
  for (const Old& o : old) {
    state_.whole[o.vertex] = o.whole;
    state_.share[o.vertex] = o.share;
    vertices.push_back(o.vertex);
    if (o.was_mitered) mitered.push_back(o.vertex);
  }
  sort_unique(vertices);
  sort_unique(mitered);
  if (state_.mitered) {
    state_.mitered->take_back(vertices, state_.paths);
    state_.mitered->miter_again(mitered, state_.paths);
  }
  state_.move(vertices);
}

}  // namespace vdb_offset
