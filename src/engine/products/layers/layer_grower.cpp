// SPDX-License-Identifier: Apache-2.0
// Grows layers over a wall, of a surface or of curves alike: paths go in, stacks of layers come out in which all cells
// are valid and the outermost surface has no fault, as far as thinning can reach that. Each vertex gets a rail, bent to
// leave the wall in the vertex's own direction if that leads away from all faces around, else straight. Rails at
// invalid cells are straightened. Then vertices at faults and invalid cells are thinned round by round, at last to no
// height; those that were thinned too far are let out by small steps, and a step that makes a fault is undone. All
// layers of a vertex keep one share of their heights, and no thickness differs from a neighbour's by more than half of
// the edge between them. Where layers stand, and what is valid, is up to the wall (layer_wall.h).
#include "products/layers/layer_grower.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "products/layers/invalid_columns.h"
#include "products/layers/spread_ends.h"

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

/// The share that a vertex keeps of its heights, of one that it could.
double kept(double share) { return share < kLeastShare ? 0 : share; }

/// Lowers shares until no thickness differs from that of a neighbour by more than kThicknessSlope.
class EvenThickness {
 public:
  /// Keeps a reference.
  explicit EvenThickness(const LayerWall& wall) : wall_(wall), stacks_(wall.stacks()) {}

  /// Lowers the neighbours of vertices that have changed, and theirs. Returns all that were lowered, sorted.
  Indices lower_around(Indices changed) const {
    Indices lowered;
    for (std::size_t i = 0; i < changed.size(); ++i) {
      const std::uint32_t v = changed[i];
      if (!wall_.moves(v)) continue;
      const double thickness = stacks_.thickness(v);
      for_each_neighbour(v, [&](std::uint32_t w, double length) {
        if (!lower(w, thickness + kThicknessSlope * length)) return;
        lowered.push_back(w);
        changed.push_back(w);
      });
    }
    sort_unique(lowered);
    return lowered;
  }

  /// Lowers vertices that alone have been let out, and so may be too thick beside their neighbours. Returns the other
  /// vertices that were lowered for that.
  Indices lower_to_neighbours(const Indices& let_out) const {
    std::vector<double> most(let_out.size(), std::numeric_limits<double>::infinity());
    for_each_index(let_out.size(), [&](std::size_t i) {
      for_each_neighbour(let_out[i], [&](std::uint32_t w, double length) {
        most[i] = std::min(most[i], stacks_.thickness(w) + kThicknessSlope * length);
      });
    });
    Indices held_back;
    for (std::size_t i = 0; i < let_out.size(); ++i)
      if (lower(let_out[i], most[i])) held_back.push_back(let_out[i]);
    return lower_around(std::move(held_back));
  }

 private:
  /// Calls visit(neighbour, length of the edge) for each neighbour that moves: twice where two columns share the edge.
  template <class Visit>
  void for_each_neighbour(std::uint32_t v, Visit&& visit) const {
    const auto& source = stacks_.asked().source;
    for (const auto column : wall_.columns_around(v)) {
      const auto ring = wall_.base(column);
      const auto k = static_cast<std::size_t>(std::find(ring.begin(), ring.end(), v) - ring.begin());
      for (const auto w : {ring[(k + 1) % ring.size()], ring[(k + ring.size() - 1) % ring.size()]})
        if (wall_.moves(w)) visit(w, (source[w] - source[v]).length());
    }
  }

  /// Lowers the thickness of a vertex to `most`. Returns false if it is no more than that.
  bool lower(std::uint32_t v, double most) const {
    if (!(stacks_.thickness(v) > most * (1 + kSameThickness))) return false;
    stacks_.set_share(v, kept(most / stacks_.asked().thickness(v)));
    return true;
  }

  const LayerWall& wall_;
  RailStacks& stacks_;
};

/// Layers that have been put, and what is wrong with them: faulty faces, and columns with invalid cells.
class PutLayers {
 public:
  /// Puts the layers of all vertices for the first time. Keeps a reference. \pre rails and shares are chosen
  PutLayers(LayerWall& wall, const Indices& all) : wall_(wall), invalid_(put_first(wall, all)) {}

  /// Puts the layers of vertices where their shares want them, and judges that.
  void move(const Indices& vertices) {
    wall_.put(vertices);
    judge(vertices);
  }
  /// Judges the layers around vertices that have been moved.
  void judge(const Indices& moved) {
    wall_.find_faults(moved);
    invalid_.judge_around(moved);
    ++rounds_;
  }

  const InvalidColumns& invalid() const { return invalid_; }
  /// The vertices of faulty faces, and of columns with invalid cells. Sorted.
  Indices vertices_to_thin() const {
    Indices vertices = wall_.faulty_vertices();
    const Indices corners = invalid_.corners();
    vertices.insert(vertices.end(), corners.begin(), corners.end());
    sort_unique(vertices);
    return vertices;
  }
  /// How often layers have been judged since they were put for the first time.
  std::size_t rounds() const { return rounds_; }

 private:
  static InvalidColumns put_first(LayerWall& wall, const Indices& all) {
    wall.put(all);
    wall.find_first_faults(all);
    return InvalidColumns(wall);
  }

  LayerWall& wall_;
  InvalidColumns invalid_;
  std::size_t rounds_ = 0;
};

/// The rounds of one wall. Each takes the layers as the one before has put them.
class LayerGrower {
 public:
  LayerGrower(LayerWall& wall, Paths& paths, std::span<const Vec3d> unspread)
      : wall_(wall),
        stacks_(wall.stacks()),
        paths_(paths),
        unspread_(unspread),
        even_(wall),
        count_(stacks_.asked().source.size()),
        thinned_(count_, 0) {}

  LayerStack run(Progress& progress) {
    Indices all(count_);
    for (std::uint32_t v = 0; v < count_; ++v) all[v] = v;
    choose_rails(all);
    PutLayers layers(wall_, all);
    statistics_.wrong_columns = layers.invalid().size();
    while (straighten(layers) || take_spread_back(layers)) progress.advance(0);
    while (thin(layers)) progress.advance(1);
    let_all_out(layers, progress);
    return finish(layers);
  }

 private:
  void choose_rails(const Indices& all);
  double share_at_end(std::uint32_t v, Vec3d& bend) const;
  void start(std::uint32_t v);
  bool straighten(PutLayers& layers);
  bool take_spread_back(PutLayers& layers);
  bool thin(PutLayers& layers);
  void let_all_out(PutLayers& layers, Progress& progress);
  void let_out(PutLayers& layers, Indices& thinned, std::vector<double>& before);
  Indices take_back(PutLayers& layers, const std::vector<double>& before, const RailStacks::Snapshot& snapshot);
  LayerStack finish(const PutLayers& layers);

  LayerWall& wall_;
  RailStacks& stacks_;
  Paths& paths_;
  std::span<const Vec3d> unspread_;  // see stack_layers()
  EvenThickness even_;
  std::size_t count_;                  // of vertices
  std::vector<std::uint8_t> thinned_;  // of each vertex: in how many rounds it was thinned
  Indices straightened_;               // vertices whose layers were put on a straight line
  LayerStatistics statistics_;
};

/// Chooses the rails of all vertices, and shares with which the thickness is even.
void LayerGrower::choose_rails(const Indices& all) {
  for_each_index(count_, [&](std::size_t v) { start(static_cast<std::uint32_t>(v)); });
  Indices uneven = all;
  if (stacks_.asked().heights.back().uniform())
    std::erase_if(uneven, [&](std::uint32_t v) { return stacks_.share(v) == 1; });
  even_.lower_around(std::move(uneven));
}

void LayerGrower::start(std::uint32_t v) {
  Vec3d bend(0.0);
  const double share = share_at_end(v, bend);
  stacks_.start(v, bend, share);
}

/// The share of its heights that the end of a vertex's path leaves it; 0 where neither the vertex's own direction nor a
/// straight line leads away from all faces around it. Chooses between the two: bends the rail for the former.
double LayerGrower::share_at_end(std::uint32_t v, Vec3d& bend) const {
  if (!wall_.moves(v) || !(paths_.achieved[v] > 0)) return 0;
  const Vec3d& whole = paths_.displacement[v];
  const Vec3d start = wall_.direction_of(v) * (stacks_.asked().side * whole.length());
  const bool may_bend = !wall_.is_bound(v) && !stacks_.asked().is_mitered(v);
  if (may_bend && wall_.sees_all_faces(v, start)) bend = start - whole;
  else if (!wall_.sees_all_faces(v, whole)) return 0;
  if (!falls_short(paths_.state[v])) return 1;
  return kept(std::min(1.0, paths_.achieved[v] / stacks_.asked().thickness(v)));
}

/// Puts the layers of vertices of invalid cells on straight lines, where these lead away from all faces around. Returns
/// false if no vertex is left for which that could be done.
bool LayerGrower::straighten(PutLayers& layers) {
  Indices corners = layers.invalid().corners();
  std::erase_if(corners, [&](std::uint32_t v) {
    return stacks_.rail_of(v).bend == Vec3d(0.0) || stacks_.share(v) == 0 ||
           !wall_.sees_all_faces(v, paths_.displacement[v]);
  });
  if (corners.empty()) return false;
  for (const auto v : corners) stacks_.straighten(v);
  straightened_.insert(straightened_.end(), corners.begin(), corners.end());
  layers.move(corners);
  return true;
}

/// Has the vertices of faults and invalid cells end where their paths led before they were spread. Returns false if
/// none of them was.
bool LayerGrower::take_spread_back(PutLayers& layers) {
  if (unspread_.empty()) return false;
  const Indices vertices = spread_together(
      layers.vertices_to_thin(), count_, [&](std::uint32_t v) { return paths_.displacement[v] != unspread_[v]; },
      [&](std::uint32_t v, const auto& visit) {
        for (const auto column : wall_.columns_around(v))
          for (const auto w : wall_.base(column)) visit(w);
      });
  if (vertices.empty()) return false;
  for (const auto v : vertices) {
    paths_.displacement[v] = unspread_[v];
    start(v);
  }
  layers.move(vertices);
  return true;
}

/// Thins the layers at faulty faces and invalid cells. Returns false if none of their vertices has any height left.
bool LayerGrower::thin(PutLayers& layers) {
  Indices thinned = layers.vertices_to_thin();
  std::erase_if(thinned, [&](std::uint32_t v) { return stacks_.share(v) == 0; });
  if (thinned.empty()) return false;
  for (const auto v : thinned) {
    const int steps = std::clamp(thinned_[v]++ - kSmallSteps + 1, 1, kMostSteps);
    double share = stacks_.share(v);
    for (int i = 0; i < steps; ++i) share *= kKeptHeight;
    stacks_.set_share(v, kept(share));
  }
  const Indices lowered = even_.lower_around(thinned);
  thinned.insert(thinned.end(), lowered.begin(), lowered.end());
  sort_unique(thinned);
  layers.move(thinned);
  return true;
}

/// Lets all thinned vertices out again, step by step, each until its next step would not be valid.
void LayerGrower::let_all_out(PutLayers& layers, Progress& progress) {
  Indices thinned;
  for (std::uint32_t v = 0; v < count_; ++v)
    if (stacks_.share(v) > 0 && stacks_.share(v) < stacks_.most(v)) thinned.push_back(v);
  std::vector<double> before = stacks_.shares();
  for (int i = 0; i < kLetOuts && !thinned.empty(); ++i) {
    let_out(layers, thinned, before);
    progress.advance(1);
  }
}

/// Lets these vertices out by one step, as far as the thickness stays even, and takes those back that then have faults.
/// \param thinned the vertices; receives those that have been let out and have a larger share to get to
/// \param before the shares of all vertices, before and after
void LayerGrower::let_out(PutLayers& layers, Indices& thinned, std::vector<double>& before) {
  const auto stays = [&](std::uint32_t v) { return !(stacks_.share(v) > before[v]); };
  for (const auto v : thinned) stacks_.set_share(v, std::min(stacks_.most(v), before[v] / kLetOutFrom));
  Indices changed = thinned;
  const auto add = [&](const Indices& others) { changed.insert(changed.end(), others.begin(), others.end()); };
  add(even_.lower_to_neighbours(thinned));
  std::erase_if(thinned, stays);
  if (thinned.empty()) return;
  const RailStacks::Snapshot taken(stacks_, thinned);
  layers.move(thinned);
  add(take_back(layers, before, taken));
  std::erase_if(thinned, [&](std::uint32_t v) { return stays(v) || stacks_.share(v) == stacks_.most(v); });
  for (const auto v : changed) before[v] = stacks_.share(v);
}

/// Restores faulty vertices, and neighbours that would break the thickness gradient, to their last valid state. A
/// vertex that gets the share back that it had is restored from the snapshot, since its rail may have the height of
/// that share at several points. Returns all vertices that were moved.
Indices LayerGrower::take_back(PutLayers& layers, const std::vector<double>& before,
                               const RailStacks::Snapshot& snapshot) {
  const auto stays = [&](std::uint32_t v) { return !(stacks_.share(v) > before[v]); };
  Indices taken;
  while (true) {
    Indices moved = layers.vertices_to_thin();
    std::erase_if(moved, stays);
    if (moved.empty()) return taken;
    for (const auto v : moved) stacks_.set_share(v, before[v]);
    const Indices lowered = even_.lower_around(moved);
    moved.insert(moved.end(), lowered.begin(), lowered.end());
    sort_unique(moved);
    Indices between;
    for (const auto v : moved)
      if (stacks_.share(v) != before[v] || !snapshot.restore(v, stacks_)) between.push_back(v);
    wall_.put(between);
    layers.judge(moved);
    taken.insert(taken.end(), moved.begin(), moved.end());
  }
}

/// Notes down in the paths where the outermost layer is, counts, and hands the stacks over.
LayerStack LayerGrower::finish(const PutLayers& layers) {
  const std::vector<double>& shares = stacks_.shares();
  VDB_OFFSET_ASSERT(std::all_of(shares.begin(), shares.end(), [](double share) { return share >= 0 && share <= 1; }));
  statistics_.rounds = layers.rounds();
  for (const auto v : straightened_) statistics_.straightened += shares[v] > 0;
  for (std::uint32_t v = 0; v < count_; ++v) {
    if (!wall_.moves(v)) continue;
    if (!stacks_.is_at_end(v)) paths_.displacement[v] = stacks_.outermost(v) - stacks_.asked().source[v];
    if (shares[v] == 1) continue;
    ++statistics_.thinned_vertices;
    statistics_.flat_vertices += shares[v] == 0;
    if (stacks_.is_at_end(v)) continue;  // the path has its distance and state
    paths_.achieved[v] = shares[v] > 0 ? wall_.distance_of(v) : 0;
    paths_.state[v] = VertexState::Limited;
  }
  auto [positions, share, first_achieved] = std::move(stacks_).finish();
  return {std::move(positions), std::move(share), std::move(first_achieved), stacks_.asked().stretch, statistics_};
}

}  // namespace

LayerStack grow_on(LayerWall& wall, Paths& paths, std::span<const Vec3d> unspread, Progress& progress) {
  return LayerGrower(wall, paths, unspread).run(progress);
}

}  // namespace vdb_offset
