// SPDX-License-Identifier: Apache-2.0
#include "valid/limit/settle.h"

#include <algorithm>
#include <utility>

#include "valid/limit/contraction.h"

namespace vdb_offset {
namespace {

// With the first three, gears at 1 % waste 0.9 % of the area that has room, not 1.6 %, in up to 1.8 times the time
// where that helps; single values are not measured. How many short vertices are settled: those with the largest areas;
// and how many trials all of them together have.
constexpr std::size_t kMostSettled = 2000, kMostTrials = 3000;
// Share of the moving part's area: vertices with less live area are left short.
constexpr double kLeastSettled = 2e-5;
// Rings around what has moved in which vertices are tried again. See docs/dev/tuning.md.
constexpr int kRingsAround = 2;

}  // namespace

/// The short vertices that may have room now with which most live area is lost, that with the most first.
std::vector<std::uint32_t> Settling::vertices_to_settle(LiveArea::Lines lines) {
  LiveArea& live_area = state_.live_area;
  const double least = kLeastSettled * live_area.whole_area();
  const Indices around_moved = state_.moved_since(before_, kRingsAround);
  const auto has_changed = [&](std::uint32_t v) {
    return std::binary_search(around_moved.begin(), around_moved.end(), v) ||
           std::binary_search(untried_.begin(), untried_.end(), v) ||
           (lines == LiveArea::Lines::All && live_area.is_at_border(v));
  };
  std::vector<std::pair<double, std::uint32_t>> order;
  for (std::uint32_t v = 0; v < state_.share.size(); ++v)
    if (may_settle(v) && has_changed(v))
      if (const double area = live_area.area(v); area > least) order.emplace_back(-area, v);
  std::sort(order.begin(), order.end());
  std::vector<std::uint32_t> largest, others;
  for (const auto& [area, v] : order) (largest.size() < kMostSettled ? largest : others).push_back(v);
  untried_ = std::move(others);
  live_area.measure(largest);
  std::erase_if(largest, [&](std::uint32_t v) { return !(live_area[v] > least); });
  std::stable_sort(largest.begin(), largest.end(),
                   [&](std::uint32_t v, std::uint32_t w) { return live_area[v] > live_area[w]; });
  return largest;
}

bool Settling::operator()(LiveArea::Lines lines) {
  if (state_.faults.any()) return false;
  SettlingTrial trial(state_, SettlingTrial::Aim::Distance);
  bool any = false;
  const std::vector<std::uint32_t> vertices = vertices_to_settle(lines);
  before_ = state_.displacements();
  for (const auto v : vertices) {
    if (trial.count() >= kMostTrials) untried_.push_back(v);
    if (trial.count() >= kMostTrials || !state_.is_short(v)) continue;
    if (lines == LiveArea::Lines::All && state_.is_held(v)) continue;
    any |= settle(v, lines, trial);
  }
  sort_unique(untried_);
  return any;
}

/// To a position in the surface's frame, or as near to it as planes let the vertex come.
SettlingTrial::Move Settling::move_to(std::uint32_t v, const Vec3d& position) const {
  return {v, state_.in_planes(v, position - state_.surface.vertices[v])};
}

bool Settling::settle(std::uint32_t v, LiveArea::Lines lines, SettlingTrial& trial) {
  return settle_with_room(v, lines, trial) || (!state_.keeps_faces && settle_beside(v, trial));
}

/// Tries a vertex at each of its positions; then, at the first of them, with its neighbours, with the small feature
/// that it is part of, and while the vertices in the way slide aside.
bool Settling::settle_with_room(std::uint32_t v, LiveArea::Lines lines, SettlingTrial& trial) {
  const std::vector<Vec3d> positions = state_.live_area.positions_with_room(v, lines);
  if (positions.empty()) return false;
  for (const Vec3d& position : positions)
    if (trial.try_alone({move_to(v, position)})) return true;
  const SettlingTrial::Move move = move_to(v, positions.front());
  const SettlingTrial::Moves together = with_short_neighbours(move, lines);
  return (together.size() > 1 && trial.try_alone(together)) || trial.try_with_feature(move) ||
         trial.try_with_others_aside(move);
}

/// Tries a vertex beside its neighbours. \pre no faces are kept: it would take room that miters need
bool Settling::settle_beside(std::uint32_t v, SettlingTrial& trial) {
  const std::vector<Contraction::Place> places = Contraction{state_}.places(v);
  return std::any_of(places.begin(), places.end(), [&](const Contraction::Place& place) {
    return trial.try_alone({SettlingTrial::Move{v, place.end}});
  });
}

/// A move, and the moves of the short vertices around it to where they have their distances; not where there are many.
SettlingTrial::Moves Settling::with_short_neighbours(const SettlingTrial::Move& move, LiveArea::Lines lines) {
  SettlingTrial::Moves moves{move};
  const Indices around = state_.with_rings({move.vertex}, 1);
  if (around.size() > SettlingTrial::kMostAside) return moves;
  for (const auto w : around) {
    if (w == move.vertex || !may_settle(w) || (lines == LiveArea::Lines::All && state_.is_held(w))) continue;
    if (const auto positions = state_.live_area.positions_with_room(w, lines); !positions.empty())
      moves.push_back(move_to(w, positions.front()));
  }
  return moves;
}

}  // namespace vdb_offset
