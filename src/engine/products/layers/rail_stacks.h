// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "ground/numbers/index_set.h"
#include "motion/paths/propagate.h"
#include "products/layers/rails.h"
#include "vdb_offset/layers.h"

namespace vdb_offset {

/// The layers that are asked for.
struct AskedLayers {
  /// \pre there is a set of heights, and each has one for each vertex
  AskedLayers(std::span<const Vec3d> positions, const Vec3d& origin, std::span<const Distances> of_layers);
  /// Finds how much farther than the heights mitered vertices go. \param paths of the vertices, to the outermost layer
  void stretch_mitered(const Paths& paths);

  std::span<const Vec3d> source;  ///< Positions of the vertices on the wall.
  Vec3d front_origin;             ///< `source` less this is in the frame of the queries that rails are put down by.
  std::span<const Distances> heights;  ///< Of the vertices, one set for each layer, all of one sign.
  int side;                            ///< 1 outward, -1 inward.

  /// Of each vertex: how many times as far as a height the vertex is from the wall where its faces have that height; 1
  /// but for mitered ones, whose layers stand on the straight line to the end of the miter. Empty if none is mitered.
  std::vector<double> stretch;

  /// How far a layer of a vertex is to be from the wall.
  double distance(std::size_t layer, std::uint32_t v) const { return stretched(std::abs(heights[layer][v]), v); }
  /// How far the outermost layer of a vertex is to be from the wall.
  double thickness(std::uint32_t v) const { return distance(heights.size() - 1, v); }
  bool is_mitered(std::uint32_t v) const { return !stretch.empty() && stretch[v] != 1; }

 private:
  double stretched(double height, std::uint32_t v) const { return stretch.empty() ? height : height * stretch[v]; }
};

/// The stacks of vertices while layers grow: the rail that each stands on, the share of its heights that it keeps, and
/// the positions of its layers.
///
/// start() chooses the rail of a vertex, once; set_share() says how much of its heights the vertex keeps from then on;
/// put_down(), or a caller that writes to of(), moves its layers there. Vertices may be handled in parallel.
class RailStacks {
 public:
  /// Keeps references.
  /// \param paths of the vertices, at the ends of which the rails end
  RailStacks(const AskedLayers& asked, const Paths& paths);

  const AskedLayers& asked() const { return asked_; }

  /// Puts a vertex on a rail to the end of its path that is bent like this (see Rail), and lets it keep `most` of its
  /// heights, the share that the end of the path leaves it.
  void start(std::uint32_t v, const Vec3d& bend, double most) {
    bend_[v] = bend;
    most_[v] = share_[v] = most;
  }
  double most(std::uint32_t v) const { return most_[v]; }
  /// The share of its heights that a vertex keeps, 0 .. most().
  double share(std::uint32_t v) const { return share_[v]; }
  void set_share(std::uint32_t v, double share) { share_[v] = share; }
  const std::vector<double>& shares() const { return share_; }
  /// The share that a vertex keeps of the height of its outermost layer, world units.
  double thickness(std::uint32_t v) const { return share_[v] * asked_.thickness(v); }
  /// Whether a vertex's outermost layer is where its path ended.
  bool is_at_end(std::uint32_t v) const { return share_[v] == most_[v] && most_[v] > 0; }

  /// The rail of a vertex: to the end of its path, either starting in the vertex's own direction, or straight.
  Rail rail_of(std::uint32_t v) const { return {paths_.displacement[v], bend_[v]}; }
  /// Makes the rail of a vertex straight. Its layers stay where they are until they are put down again.
  void straighten(std::uint32_t v) {
    bend_[v] = Vec3d(0.0);
    last_put_[v] = {};
  }
  /// Where on its rail, 0 .. 1, the descent of a vertex may begin: likely above its share. It is estimated from where
  /// the outermost layer was when it was last put; whether it is above is up to put_down().
  double top_of(std::uint32_t v) const {
    // Factor on the parameter that a rail along which distances grow evenly would have. An estimate that is too low
    // costs a second descent from the rail's end, one that is too high a larger ball of near triangles. Not measured.
    constexpr double kRoom = 1.15;
    const LastPut& last = last_put_[v];
    return is_at_end(v) ? 1 : std::min(1.0, kRoom * last.eta * (share_[v] / last.share));
  }

  /// The positions of a vertex's layers, the wall's first.
  std::span<Vec3d> of(std::uint32_t v) { return positions_.of(v); }
  std::span<const Vec3d> of(std::uint32_t v) const { return positions_.of(v); }
  const Vec3d& outermost(std::uint32_t v) const { return positions_.of(v).back(); }
  const VertexStacks& positions() const { return positions_; }
  /// Puts all layers of a vertex on the wall.
  void flatten(std::uint32_t v) { std::fill(of(v).begin(), of(v).end(), asked_.source[v]); }
  /// Notes the exact distance of a vertex's first layer.
  void set_first_achieved(std::uint32_t v, double distance) { first_achieved_[v] = distance; }

  /// Puts the layers of a vertex on its rail, going down from height to height.
  /// \param top a parameter of the rail above the outermost layer
  /// \param distance along the rail: QueryDistance, FanDistance or NearDistance
  /// \param placed called with each layer and its distance; returns false to end the descent
  /// \return false if the outermost layer turns out not to be below `top`, or if `placed` has ended the descent
  template <class Distance, class Placed>
  bool put_down(std::uint32_t v, double top, Distance&& distance, Placed&& placed) {
    const auto stack = positions_.of(v);
    const double share = share_[v];
    const Rail rail = rail_of(v);
    const Vec3d& wall = asked_.source[v];
    const Vec3d origin = wall - asked_.front_origin;
    const std::size_t layers = asked_.heights.size();
    RailPoint above{top, distance.find(origin + rail(top))};
    if (top < 1 && above.phi.value < share * asked_.thickness(v)) return false;
    for (std::size_t k = layers; k-- > 0;) {
      const double target = share * asked_.distance(k, v);
      const bool at_end = k + 1 == layers && share == most_[v];
      if (!at_end) above = point_on(rail, origin, above, target, distance);
      stack[k + 1] = wall + (at_end ? rail.whole : round_displacement(rail(above.eta), target));
      if (!placed(k, above.phi.value)) return false;
      if (k + 1 == layers) last_put_[v] = {share, above.eta};
      first_achieved_[v] = above.phi.value;
    }
    return true;
  }

  class Snapshot;

  /// What has been grown, for good.
  struct Finished {
    VertexStacks positions;
    std::vector<double> share, first_achieved;
  };
  Finished finish() && { return {std::move(positions_), std::move(share_), std::move(first_achieved_)}; }

 private:
  /// Where on its rail the outermost layer of a vertex was when it was last put, and with which share.
  struct LastPut {
    double share = 1, eta = std::numeric_limits<double>::infinity();  // infinite: it has not been put yet
  };

  const AskedLayers& asked_;
  const Paths& paths_;
  VertexStacks positions_;
  // Of each vertex.
  std::vector<double> most_, share_, first_achieved_;
  std::vector<Vec3d> bend_;  // of its rail: zero where its layers stand on a straight line
  std::vector<LastPut> last_put_;
};

/// Some vertices, with all that put_down() has set of their layers.
class RailStacks::Snapshot {
 public:
  /// \pre `vertices` are sorted
  Snapshot(const RailStacks& stacks, const Indices& vertices);
  /// Puts the layers of a vertex back to where they were. Returns false if it is not in the snapshot.
  bool restore(std::uint32_t v, RailStacks& stacks) const;

 private:
  Indices vertices_;
  std::vector<Vec3d> positions_;
  std::vector<double> first_achieved_;
  std::vector<LastPut> last_put_;
};

}  // namespace vdb_offset
