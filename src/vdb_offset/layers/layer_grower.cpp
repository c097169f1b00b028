// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/layers/layer_grower.h"

#include "vdb_offset/base/progress_count.h"

#include <algorithm>
#include <limits>

#include "vdb_offset/base/assert.h"
#include "vdb_offset/base/parallel.h"

namespace vdb_offset {
namespace {

// The share of its heights that a vertex keeps in a step of thinning. Large steps take few rounds; vertices that were
// thinned too far are let out again by small ones. Not measured.
constexpr double kKeptHeight = 0.65;
// The share of its heights below which a vertex keeps none: its cells would have a hundredth of the height asked for,
// and aspect ratios as much larger. Not measured.
constexpr double kLeastShare = 0.01;
// The number of rounds in which a vertex is thinned by one step each; if it still has faults it takes ever more steps
// at once, up to kMostSteps, which ends the thinning of large tangles. Not measured.
constexpr int kSmallSteps = 3, kMostSteps = 4;
// The number of rounds in which thinned vertices are let out again, each by one step. 0.85^-16 is 13: a vertex that
// lost six steps of thinning to its neighbours gets all of that back. Not measured.
constexpr int kLetOuts = 16;
// A step of letting out divides the share by this, so that a vertex ends less than a sixth short of its largest valid
// height. Not measured.
constexpr double kLetOutFrom = 0.85;
// The largest difference of thickness between two neighbours, as a share of the length of the edge between them: an
// angle of 27 degrees between wall and outer surface. Not measured.
constexpr double kThicknessSlope = 0.5;
// Differences of thickness below this share are rounding, and no reason to thin another vertex.
constexpr double kSameThickness = 1e-9;

}  // namespace

LayerGrower::LayerGrower(std::span<const Vec3d> source, const Vec3d& front_origin, std::span<const Distances> heights,
                         Paths& paths)
    : source_(source),
      front_origin_(front_origin),
      heights_(heights),
      side_(heights.back().farthest() < 0 ? -1 : 1),
      paths_(paths),
      most_(source.size(), 0.0),
      last_put_(source.size()),
      bend_(source.size(), Vec3d(0.0)),
      thinned_(source.size(), 0) {
  VDB_OFFSET_ASSERT(!heights.empty());
  VDB_OFFSET_ASSERT(paths.displacement.size() == source.size() && paths.achieved.size() == source.size());
  VDB_OFFSET_ASSERT(std::all_of(heights.begin(), heights.end(), [&](const Distances& each) {
    return each.uniform() || each.count() >= source.size();
  }));
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
  find_first_faults(all);
  check_all_columns();
  stack_.statistics.wrong_columns = invalid_columns_.size();
  while (straighten()) progress.advance(0);
  while (thin()) progress.advance(1);
  let_all_out(progress);
  finish();
  return std::move(stack_);
}

/// The share of its heights that the end of a vertex's path leaves it; 0 where neither the vertex's own direction nor a
/// straight line leads away from all faces around it. Chooses between the two.
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

/// Calls visit(neighbour, length of the edge) for each neighbour that moves: twice where two columns share the edge.
template <class Visit>
void LayerGrower::for_each_neighbour(std::uint32_t v, Visit&& visit) const {
  for (const auto column : columns_around(v)) {
    const auto ring = base(column);
    const auto k = static_cast<std::size_t>(std::find(ring.begin(), ring.end(), v) - ring.begin());
    for (const auto w : {ring[(k + 1) % ring.size()], ring[(k + ring.size() - 1) % ring.size()]})
      if (moves(w)) visit(w, (source_[w] - source_[v]).length());
  }
}

/// Lowers the thickness of a vertex to `most`. Returns false if it is no more than that.
bool LayerGrower::lower(std::uint32_t v, double most) {
  if (!(stack_.share[v] * asked(v) > most * (1 + kSameThickness))) return false;
  stack_.share[v] = most / asked(v) < kLeastShare ? 0 : most / asked(v);
  return true;
}

/// Lowers the shares of vertices until no thickness differs from that of a neighbour by more than kThicknessSlope. Only
/// the neighbours of `changed`, and theirs, may have to be lowered. Returns all vertices that were, sorted.
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

/// Makes the thickness even again, as smooth() does, after these vertices alone have been let out, and so may be too
/// thick. Returns the other vertices that were lowered.
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

/// Judges whether the columns column(0), column(1) ... column(count - 1) are valid, two at a time.
template <class Column>
void LayerGrower::judge(std::size_t count, Column&& column) {
  for_each_index((count + 1) / 2,
                 [&](std::size_t i) {
                   const std::size_t c = column(2 * i), other = column(std::min(2 * i + 1, count - 1));
                   const auto [valid, other_valid] = are_valid(c, other);
                   is_invalid_[c] = !valid;
                   is_invalid_[other] = !other_valid;
                 },
                 32);
}

void LayerGrower::check_all_columns() {
  is_invalid_.assign(column_count(), 0);
  judge(column_count(), [](std::size_t c) { return c; });
  for (std::uint32_t c = 0; c < column_count(); ++c)
    if (is_invalid_[c]) invalid_columns_.push_back(c);
}

/// Judges the columns around vertices that have moved.
void LayerGrower::check_columns(const Indices& moved) {
  Indices columns;
  for (const auto v : moved) columns.insert(columns.end(), columns_around(v).begin(), columns_around(v).end());
  sort_unique(columns);
  judge(columns.size(), [&](std::size_t i) { return columns[i]; });
  std::erase_if(invalid_columns_, [&](std::uint32_t c) { return !is_invalid_[c]; });
  for (const auto c : columns)
    if (is_invalid_[c]) invalid_columns_.push_back(c);
  sort_unique(invalid_columns_);
}

LayerGrower::Snapshot LayerGrower::snapshot(const Indices& vertices) const {
  VDB_OFFSET_ASSERT(std::is_sorted(vertices.begin(), vertices.end()));
  Snapshot taken{vertices, {}, {}, {}};
  taken.positions.reserve(vertices.size() * (heights_.size() + 1));
  taken.first_achieved.reserve(vertices.size());
  taken.last_put.reserve(vertices.size());
  for (const auto v : vertices) {
    const auto stack = stack_.stacks.of(v);
    taken.positions.insert(taken.positions.end(), stack.begin(), stack.end());
    taken.first_achieved.push_back(stack_.first_achieved[v]);
    taken.last_put.push_back(last_put_[v]);
  }
  return taken;
}

/// Puts the layers of a vertex back to where they were. Returns false if it is not in the snapshot.
bool LayerGrower::restore(const Snapshot& snapshot, std::uint32_t v) {
  const auto found = std::lower_bound(snapshot.vertices.begin(), snapshot.vertices.end(), v);
  if (found == snapshot.vertices.end() || *found != v) return false;
  const auto i = static_cast<std::size_t>(found - snapshot.vertices.begin());
  const auto stack = stack_.stacks.of(v);
  std::copy_n(snapshot.positions.begin() + static_cast<std::ptrdiff_t>(i * stack.size()), stack.size(), stack.begin());
  stack_.first_achieved[v] = snapshot.first_achieved[i];
  last_put_[v] = snapshot.last_put[i];
  return true;
}

/// Moves the layers of vertices to where their shares want them, and judges that.
void LayerGrower::move(const Indices& vertices) {
  put(vertices);
  judge_moved(vertices);
}

void LayerGrower::judge_moved(const Indices& vertices) {
  find_faults(vertices);
  check_columns(vertices);
  ++stack_.statistics.rounds;
}

Indices LayerGrower::corners_of_invalid_columns() const {
  Indices corners;
  for (const auto c : invalid_columns_) corners.insert(corners.end(), base(c).begin(), base(c).end());
  sort_unique(corners);
  return corners;
}

/// The vertices of faulty faces, and of columns with invalid cells. Sorted.
Indices LayerGrower::vertices_to_thin() const {
  Indices vertices = faulty_vertices();
  const Indices corners = corners_of_invalid_columns();
  vertices.insert(vertices.end(), corners.begin(), corners.end());
  sort_unique(vertices);
  return vertices;
}

/// Puts the layers of vertices of invalid cells on straight lines, where these lead away from all faces around. Returns
/// false if no vertex is left for which that could be done.
bool LayerGrower::straighten() {
  Indices corners = corners_of_invalid_columns();
  std::erase_if(corners, [&](std::uint32_t v) {
    return bend_[v] == Vec3d(0.0) || stack_.share[v] == 0 || !sees_all_faces(v, paths_.displacement[v]);
  });
  if (corners.empty()) return false;
  for (const auto v : corners) {
    bend_[v] = Vec3d(0.0);
    last_put_[v] = {};
  }
  straightened_.insert(straightened_.end(), corners.begin(), corners.end());
  move(corners);
  return true;
}

/// Thins the layers at faulty faces and invalid cells. Returns false if none of their vertices has any height left.
bool LayerGrower::thin() {
  Indices thinned = vertices_to_thin();
  std::erase_if(thinned, [&](std::uint32_t v) { return stack_.share[v] == 0; });
  if (thinned.empty()) return false;
  for (const auto v : thinned) {
    const int steps = std::clamp(thinned_[v]++ - kSmallSteps + 1, 1, kMostSteps);
    for (int i = 0; i < steps; ++i) stack_.share[v] *= kKeptHeight;
    if (stack_.share[v] < kLeastShare) stack_.share[v] = 0;
  }
  const Indices lowered = smooth(thinned);
  thinned.insert(thinned.end(), lowered.begin(), lowered.end());
  sort_unique(thinned);
  move(thinned);
  return true;
}

/// Lets all thinned vertices out again, step by step, each until its next step would not be valid.
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

/// Lets these vertices out by one step, as far as the thickness stays even, and takes those back that then have faults.
/// \param thinned the vertices; receives those that have been let out and have a larger share to get to
/// \param before the shares of all vertices, before and after
void LayerGrower::let_out(Indices& thinned, std::vector<double>& before) {
  const auto stays = [&](std::uint32_t v) { return !(stack_.share[v] > before[v]); };
  for (const auto v : thinned) stack_.share[v] = std::min(most_[v], before[v] / kLetOutFrom);
  Indices changed = thinned;
  const auto add = [&](const Indices& others) { changed.insert(changed.end(), others.begin(), others.end()); };
  add(smooth_back(thinned));
  std::erase_if(thinned, stays);
  if (thinned.empty()) return;
  const Snapshot taken = snapshot(thinned);
  move(thinned);
  add(take_back(before, taken));
  std::erase_if(thinned, [&](std::uint32_t v) { return stays(v) || stack_.share[v] == most_[v]; });
  for (const auto v : changed) before[v] = stack_.share[v];
}

/// Restores faulty vertices, and neighbours that would break the thickness gradient, to their last valid state. A
/// vertex that gets the share back that it had is restored from the snapshot, since its rail may have the height of
/// that share at several points. Returns all vertices that were moved.
Indices LayerGrower::take_back(const std::vector<double>& before, const Snapshot& snapshot) {
  const auto stays = [&](std::uint32_t v) { return !(stack_.share[v] > before[v]); };
  Indices taken;
  while (true) {
    Indices moved = vertices_to_thin();
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

/// Notes down in the paths where the outermost layer is, and counts.
void LayerGrower::finish() {
  VDB_OFFSET_ASSERT(
      std::all_of(stack_.share.begin(), stack_.share.end(), [](double share) { return share >= 0 && share <= 1; }));
  for (const auto v : straightened_) stack_.statistics.straightened += stack_.share[v] > 0;
  for (std::uint32_t v = 0; v < source_.size(); ++v) {
    if (!moves(v)) continue;
    if (!is_at_end(v)) paths_.displacement[v] = outermost(v) - source_[v];
    if (stack_.share[v] == 1) continue;
    ++stack_.statistics.thinned_vertices;
    stack_.statistics.flat_vertices += stack_.share[v] == 0;
    if (is_at_end(v)) continue;  // the path tells its distance and state
    paths_.achieved[v] = stack_.share[v] > 0 ? distance_of(v) : 0;
    paths_.state[v] = VertexState::Limited;
  }
}

}  // namespace vdb_offset
