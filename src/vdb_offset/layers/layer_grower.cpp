#include "vdb_offset/layers/layer_grower.h"

#include "vdb_offset/base/progress_count.h"

#include <algorithm>
#include <limits>

#include "vdb_offset/base/parallel.h"

namespace vdb_offset {
namespace {

// How much of its heights a vertex keeps in a step of thinning; below the last share it keeps none. Large steps take
// few rounds, and what is thinned too far is let out again by small ones.
constexpr double kKeptHeight = 0.65, kLeastShare = 0.01;
// A vertex that has been thinned in so many rounds and is still wrong takes ever more steps at once, up to some.
constexpr int kSmallSteps = 3, kMostSteps = 4;
// Rounds in which thinned vertices are let out again, each by one step; and what it had before, of what it has then.
constexpr int kLetOuts = 16;
constexpr double kLetOutFrom = 0.85;
// Thickness may change by so much of the length of an edge.
constexpr double kThicknessSlope = 0.5;

}  // namespace

LayerGrower::LayerGrower(std::span<const Vec3d> source, const Vec3d& front_origin, std::span<const Distances> heights,
                         Paths& paths)
    : source_(source),
      front_origin_(front_origin),
      heights_(heights),
      side_(heights.back().farthest() < 0 ? -1 : 1),
      paths_(paths),
      most_(source.size(), 0.0),
      stood_(source.size()),
      bend_(source.size(), Vec3d(0.0)),
      thinned_(source.size(), 0) {
  stack_.stacks = VertexStacks(source.size(), heights.size());
  stack_.first_achieved.assign(source.size(), 0.0);
}

LayerStack LayerGrower::run(Progress& progress) {
  for_each_index(source_.size(), [&](std::size_t v) { most_[v] = share_at_end(static_cast<std::uint32_t>(v)); });
  stack_.share = most_;
  Indices all(source_.size());
  for (std::uint32_t v = 0; v < all.size(); ++v) all[v] = v;
  Indices uneven = all;
  if (heights_.back().uniform()) std::erase_if(uneven, [&](std::uint32_t v) { return stack_.share[v] == 1; });
  smooth(std::move(uneven));
  put(all);
  look_first(all);
  check_all_columns();
  stack_.statistics.wrong_columns = wrong_columns_.size();
  while (straighten()) progress.advance(0);
  while (thin()) progress.advance(1);
  let_all_out(progress);
  finish();
  return std::move(stack_);
}

/// What a vertex could keep of its heights for where its path ended; nothing where no way up has all of the faces
/// around it in view.
double LayerGrower::share_at_end(std::uint32_t v) {
  if (!moves(v) || !(paths_.achieved[v] > 0)) return 0;
  const Vec3d& whole = paths_.displacement[v];
  const Vec3d start = direction_of(v) * (side_ * whole.length());
  if (!is_bound(v) && sees_all_faces(v, start)) bend_[v] = start - whole;
  else if (!sees_all_faces(v, whole)) return 0;
  if (paths_.state[v] == VertexState::Reached) return 1;
  const double share = std::min(1.0, paths_.achieved[v] / asked(v));
  return share < kLeastShare ? 0 : share;
}

/// Calls visit(neighbour, length of the edge) for each that moves: twice, where two columns share the edge.
template <class Visit>
void LayerGrower::for_each_neighbour(std::uint32_t v, Visit&& visit) const {
  for (const auto column : columns_around(v)) {
    const auto ring = base(column);
    const auto k = static_cast<std::size_t>(std::find(ring.begin(), ring.end(), v) - ring.begin());
    for (const auto w : {ring[(k + 1) % ring.size()], ring[(k + ring.size() - 1) % ring.size()]})
      if (moves(w)) visit(w, (source_[w] - source_[v]).length());
  }
}

/// False if a vertex's thickness is no more than what a neighbour allows.
bool LayerGrower::lower(std::uint32_t v, double most) {
  if (!(stack_.share[v] * asked(v) > most * (1 + 1e-9))) return false;
  stack_.share[v] = most / asked(v) < kLeastShare ? 0 : most / asked(v);
  return true;
}

/// Lowers shares of these vertices and their neighbours until thickness is even enough: for each what the lowest
/// allow. Returns all vertices that it lowered.
Indices LayerGrower::smooth(Indices changed) {
  Indices lowered;
  for (std::size_t i = 0; i < changed.size(); ++i) {
    const std::uint32_t v = changed[i];
    if (!moves(v)) continue;
    const double thickness = stack_.share[v] * asked(v);
    for_each_neighbour(v, [&](std::uint32_t w, double length) {
      if (!lower(w, thickness + kThicknessSlope * length)) return;
      lowered.push_back(w);
      changed.push_back(w);
    });
  }
  sort_unique(lowered);
  return lowered;
}

/// As smooth(), where only these vertices, which have been let out, may be too high. Returns whom else it lowered.
Indices LayerGrower::smooth_back(const Indices& vertices) {
  std::vector<double> most(vertices.size(), std::numeric_limits<double>::infinity());
  for_each_index(vertices.size(), [&](std::size_t i) {
    for_each_neighbour(vertices[i], [&](std::uint32_t w, double length) {
      most[i] = std::min(most[i], stack_.share[w] * asked(w) + kThicknessSlope * length);
    });
  });
  Indices held_back;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (lower(vertices[i], most[i])) held_back.push_back(vertices[i]);
  return smooth(std::move(held_back));
}

/// Looks whether columns column(0 .. count - 1) are valid, two at a time.
template <class Column>
void LayerGrower::judge(std::size_t count, Column&& column) {
  for_each_index((count + 1) / 2,
                 [&](std::size_t i) {
                   const std::size_t c = column(2 * i), other = column(std::min(2 * i + 1, count - 1));
                   const auto [valid, other_valid] = are_valid(c, other);
                   wrong_column_[c] = !valid;
                   wrong_column_[other] = !other_valid;
                 },
                 32);
}

void LayerGrower::check_all_columns() {
  wrong_column_.assign(column_count(), 0);
  judge(column_count(), [](std::size_t c) { return c; });
  for (std::uint32_t c = 0; c < column_count(); ++c)
    if (wrong_column_[c]) wrong_columns_.push_back(c);
}

void LayerGrower::check_columns(const Indices& moved) {
  Indices columns;
  for (const auto v : moved) columns.insert(columns.end(), columns_around(v).begin(), columns_around(v).end());
  sort_unique(columns);
  judge(columns.size(), [&](std::size_t i) { return columns[i]; });
  std::erase_if(wrong_columns_, [&](std::uint32_t c) { return !wrong_column_[c]; });
  for (const auto c : columns)
    if (wrong_column_[c]) wrong_columns_.push_back(c);
  sort_unique(wrong_columns_);
}

LayerGrower::Snapshot LayerGrower::snapshot(const Indices& vertices) const {
  Snapshot taken{vertices, {}, {}, {}};
  taken.places.reserve(vertices.size() * (heights_.size() + 1));
  taken.first_achieved.reserve(vertices.size());
  taken.stood.reserve(vertices.size());
  for (const auto v : vertices) {
    const auto stack = stack_.stacks.of(v);
    taken.places.insert(taken.places.end(), stack.begin(), stack.end());
    taken.first_achieved.push_back(stack_.first_achieved[v]);
    taken.stood.push_back(stood_[v]);
  }
  return taken;
}

/// False if v is none of the snapshot's.
bool LayerGrower::restore(const Snapshot& snapshot, std::uint32_t v) {
  const auto found = std::lower_bound(snapshot.vertices.begin(), snapshot.vertices.end(), v);
  if (found == snapshot.vertices.end() || *found != v) return false;
  const auto i = static_cast<std::size_t>(found - snapshot.vertices.begin());
  const auto stack = stack_.stacks.of(v);
  std::copy_n(snapshot.places.begin() + static_cast<std::ptrdiff_t>(i * stack.size()), stack.size(), stack.begin());
  stack_.first_achieved[v] = snapshot.first_achieved[i];
  stood_[v] = snapshot.stood[i];
  return true;
}

void LayerGrower::move(const Indices& vertices) {
  put(vertices);
  judge_moved(vertices);
}

void LayerGrower::judge_moved(const Indices& vertices) {
  look(vertices);
  check_columns(vertices);
  ++stack_.statistics.rounds;
}

Indices LayerGrower::corners_of_wrong_columns() const {
  Indices corners;
  for (const auto c : wrong_columns_) corners.insert(corners.end(), base(c).begin(), base(c).end());
  sort_unique(corners);
  return corners;
}

Indices LayerGrower::wrong_vertices() const {
  Indices wrong = faulty_vertices();
  const Indices corners = corners_of_wrong_columns();
  wrong.insert(wrong.end(), corners.begin(), corners.end());
  sort_unique(wrong);
  return wrong;
}

/// VertexPositions the layers of wrong cells' vertices on straight lines, where these see all faces around. False if
/// none is left that could be.
bool LayerGrower::straighten() {
  Indices corners = corners_of_wrong_columns();
  std::erase_if(corners, [&](std::uint32_t v) {
    return bend_[v] == Vec3d(0.0) || stack_.share[v] == 0 || !sees_all_faces(v, paths_.displacement[v]);
  });
  if (corners.empty()) return false;
  for (const auto v : corners) {
    bend_[v] = Vec3d(0.0);
    stood_[v] = {};
  }
  straightened_.insert(straightened_.end(), corners.begin(), corners.end());
  move(corners);
  return true;
}

/// Thins the layers of the vertices that something is wrong with. False if none of them has any height left.
bool LayerGrower::thin() {
  Indices wrong = wrong_vertices();
  std::erase_if(wrong, [&](std::uint32_t v) { return stack_.share[v] == 0; });
  if (wrong.empty()) return false;
  for (const auto v : wrong) {
    const int steps = std::clamp(thinned_[v]++ - kSmallSteps + 1, 1, kMostSteps);
    for (int i = 0; i < steps; ++i) stack_.share[v] *= kKeptHeight;
    if (stack_.share[v] < kLeastShare) stack_.share[v] = 0;
  }
  const Indices lowered = smooth(wrong);
  wrong.insert(wrong.end(), lowered.begin(), lowered.end());
  sort_unique(wrong);
  move(wrong);
  return true;
}

/// Lets all that is thinned out again, step by step, each vertex until it cannot go on.
void LayerGrower::let_all_out(Progress& progress) {
  Indices thinned;
  for (std::uint32_t v = 0; v < source_.size(); ++v)
    if (stack_.share[v] > 0 && stack_.share[v] < most_[v]) thinned.push_back(v);
  std::vector<double> before = stack_.share;
  for (int i = 0; i < kLetOuts && !thinned.empty(); ++i) {
    let_out(thinned, before);
    progress.advance(1);
  }
}

/// Lets these vertices out by one step, as far as thickness stays even, and takes those back that something is then
/// wrong with. Keeps in `thinned` who has been let out, and is not at its end yet; `before`, the shares that there are,
/// keeps up with them.
void LayerGrower::let_out(Indices& thinned, std::vector<double>& before) {
  const auto stays = [&](std::uint32_t v) { return !(stack_.share[v] > before[v]); };
  for (const auto v : thinned) stack_.share[v] = std::min(most_[v], before[v] / kLetOutFrom);
  Indices changed = thinned;
  const auto add = [&](const Indices& others) { changed.insert(changed.end(), others.begin(), others.end()); };
  add(smooth_back(thinned));
  std::erase_if(thinned, stays);
  if (thinned.empty()) return;
  const Snapshot stood = snapshot(thinned);
  move(thinned);
  add(take_back(before, stood));
  std::erase_if(thinned, [&](std::uint32_t v) { return stays(v) || stack_.share[v] == most_[v]; });
  for (const auto v : changed) before[v] = stack_.share[v];
}

/// Takes vertices that something is wrong with, and who hinders their thickness from being even, back to where all was
/// well. Those with the share they had are put back themselves: on its rail, a vertex may find that share's height at
/// several places. Returns all of them.
Indices LayerGrower::take_back(const std::vector<double>& before, const Snapshot& snapshot) {
  const auto stays = [&](std::uint32_t v) { return !(stack_.share[v] > before[v]); };
  Indices taken;
  while (true) {
    Indices moved = wrong_vertices();
    std::erase_if(moved, stays);
    if (moved.empty()) return taken;
    for (const auto v : moved) stack_.share[v] = before[v];
    const Indices lowered = smooth(moved);
    moved.insert(moved.end(), lowered.begin(), lowered.end());
    sort_unique(moved);
    Indices between;
    for (const auto v : moved)
      if (stack_.share[v] != before[v] || !restore(snapshot, v)) between.push_back(v);
    put(between);
    judge_moved(moved);
    taken.insert(taken.end(), moved.begin(), moved.end());
  }
}

void LayerGrower::finish() {
  for (const auto v : straightened_) stack_.statistics.straightened += stack_.share[v] > 0;
  for (std::uint32_t v = 0; v < source_.size(); ++v) {
    if (!moves(v)) continue;
    if (!is_at_end(v)) paths_.displacement[v] = outermost(v) - source_[v];
    if (stack_.share[v] == 1) continue;
    ++stack_.statistics.thinned_vertices;
    stack_.statistics.flat_vertices += stack_.share[v] == 0;
    if (is_at_end(v)) continue;  // as far as its path went
    paths_.achieved[v] = stack_.share[v] > 0 ? distance_of(v) : 0;
    paths_.state[v] = VertexState::Limited;
  }
}

}  // namespace vdb_offset
