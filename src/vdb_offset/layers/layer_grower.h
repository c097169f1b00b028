// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "vdb_offset/base/progress_count.h"
#include "vdb_offset/layers/rails.h"
#include "vdb_offset/layers/surface_layer_grower.h"

namespace vdb_offset {

/// Grows layers for stack_layers() and stack_curves(): the rounds that thin layers, and let them out again, until all
/// cells are valid. The derived classes know the columns of cells, the faces around vertices, and the faults.
class LayerGrower {
 public:
  LayerGrower(const LayerGrower&) = delete;
  LayerGrower& operator=(const LayerGrower&) = delete;

  LayerStack run(Progress& progress);

 protected:
  /// Keeps references to the data of the spans, and to `paths`.
  /// \param source positions of the vertices. \pre `source` less `front_origin` is in the frame of the queries that the
  /// distances of put_down() ask
  /// \param heights of the vertices, one set for each layer
  LayerGrower(std::span<const Vec3d> source, const Vec3d& front_origin, std::span<const Distances> heights,
              Paths& paths);
  ~LayerGrower() = default;

  /// Whether a vertex is asked to have any height.
  virtual bool moves(std::uint32_t vertex) const = 0;
  /// Whether a vertex's layers have to stand on a straight line.
  virtual bool is_bound(std::uint32_t) const { return false; }
  /// Whether a displacement of a vertex leads away from all faces around it.
  virtual bool sees_all_faces(std::uint32_t vertex, const Vec3d& displacement) const = 0;
  /// The vertex's own direction, outward, unit length.
  virtual Vec3d direction_of(std::uint32_t vertex) const = 0;

  virtual std::size_t column_count() const = 0;
  /// The vertices of a column's base, in a ring.
  virtual std::span<const std::uint32_t> base(std::size_t column) const = 0;
  /// The columns that have a vertex in their base.
  virtual std::span<const std::uint32_t> columns_around(std::uint32_t vertex) const = 0;
  /// Whether all cells of a column are valid. Called in parallel.
  virtual bool is_valid(std::size_t column) const = 0;
  /// Whether all cells are valid, of each of two columns. Called in parallel.
  virtual std::array<bool, 2> are_valid(std::size_t column, std::size_t other) const {
    return {is_valid(column), is_valid(other)};
  }

  /// Moves the layers of these vertices to the heights that their shares leave them.
  virtual void put(const Indices& vertices) = 0;
  /// Finds the faults of the outermost surface around these vertices, whose layers have been moved.
  virtual void find_faults(const Indices& vertices) = 0;
  /// Finds the faults after layers have been put for the first time. Only vertices that are not at the ends of their
  /// paths need be looked at.
  virtual void find_first_faults(const Indices& all) { find_faults(all); }
  /// The vertices of faulty faces, or segments, of the outermost surface. Sorted.
  virtual Indices faulty_vertices() const = 0;
  /// Exact distance of an outermost vertex when its faults were last looked for.
  virtual double distance_of(std::uint32_t vertex) const = 0;

  /// The height of a vertex's outermost layer, without its sign.
  double asked(std::uint32_t v) const { return std::abs(heights_.back()[v]); }
  const Vec3d& outermost(std::uint32_t v) const { return stack_.stacks.of(v).back(); }
  /// Whether a vertex's outermost layer is where its path ended.
  bool is_at_end(std::uint32_t v) const { return stack_.share[v] == most_[v] && most_[v] > 0; }

  /// The rail of a vertex: to the end of its path, either starting in the vertex's own direction, or straight.
  Rail rail_of(std::uint32_t v) const { return {paths_.displacement[v], bend_[v]}; }
  /// Where on its rail, 0 .. 1, the descent of a vertex may begin: likely above its share. It is estimated from where
  /// the outermost layer was when it was last put; whether it is above is up to put_down().
  double top_of(std::uint32_t v) const {
    // Factor on the parameter that a rail along which distances grow evenly would have. An estimate that is too low
    // costs a second descent from the rail's end, one that is too high a larger ball of near triangles. Not measured.
    constexpr double kRoom = 1.15;
    const LastPut& last = last_put_[v];
    return is_at_end(v) ? 1 : std::min(1.0, kRoom * last.eta * (stack_.share[v] / last.share));
  }

  /// Puts the layers of a vertex on its rail, going down from height to height.
  /// \param top a parameter of the rail above the outermost layer
  /// \param distance along the rail: QueryDistance, FanDistance or NearDistance
  /// \param placed called with each layer and its distance; returns false to end the descent
  /// \return false if the outermost layer turns out not to be below `top`, or if `placed` has ended the descent
  template <class Distance, class Placed>
  bool put_down(std::uint32_t v, double top, Distance&& distance, Placed&& placed) {
    const auto stack = stack_.stacks.of(v);
    const double share = stack_.share[v];
    const Rail rail = rail_of(v);
    const Vec3d origin = source_[v] - front_origin_;
    RailPoint above{top, distance.find(origin + rail(top))};
    if (top < 1 && above.phi.value < share * asked(v)) return false;
    for (std::size_t k = heights_.size(); k-- > 0;) {
      const double target = share * std::abs(heights_[k][v]);
      const bool at_end = k + 1 == heights_.size() && share == most_[v];
      if (!at_end) above = point_on(rail, origin, above, target, distance);
      stack[k + 1] = source_[v] + (at_end ? rail.whole : round_displacement(rail(above.eta), target));
      if (!placed(k, above.phi.value)) return false;
      if (k + 1 == heights_.size()) last_put_[v] = {share, above.eta};
      stack_.first_achieved[v] = above.phi.value;
    }
    return true;
  }

  std::span<const Vec3d> source_;  // positions of the vertices on the wall
  Vec3d front_origin_;
  std::span<const Distances> heights_;
  int side_;  // 1 outward, -1 inward
  Paths& paths_;
  std::vector<double> most_;  // the share of its heights that the end of each vertex's path leaves it
  LayerStack stack_;

 private:
  /// Where on its rail the outermost layer of a vertex was when it was last put, and with which share.
  struct LastPut {
    double share = 1, eta = std::numeric_limits<double>::infinity();  // infinite: it has not been put yet
  };
  /// Vertices with all that is known of their layers.
  struct Snapshot {
    Indices vertices;  // sorted
    std::vector<Vec3d> positions;
    std::vector<double> first_achieved;
    std::vector<LastPut> last_put;
  };
  double share_at_end(std::uint32_t v);
  template <class Visit>
  void for_each_neighbour(std::uint32_t v, Visit&& visit) const;
  bool lower(std::uint32_t v, double most);
  Indices smooth(Indices changed);
  Indices smooth_back(const Indices& vertices);
  void check_all_columns();
  template <class Column>
  void judge(std::size_t count, Column&& column);
  void check_columns(const Indices& moved);
  Snapshot snapshot(const Indices& vertices) const;
  bool restore(const Snapshot& snapshot, std::uint32_t v);
  void move(const Indices& vertices);
  void judge_moved(const Indices& vertices);
  Indices corners_of_invalid_columns() const;
  Indices vertices_to_thin() const;
  bool straighten();
  bool thin();
  void let_all_out(Progress& progress);
  void let_out(Indices& thinned, std::vector<double>& before);
  Indices take_back(const std::vector<double>& before, const Snapshot& snapshot);
  void finish();

  std::vector<LastPut> last_put_;
  std::vector<Vec3d> bend_;               // of each vertex's rail: zero where its layers stand on a straight line
  std::vector<std::uint8_t> thinned_;     // of each vertex: in how many rounds it was thinned
  std::vector<std::uint8_t> is_invalid_;  // of each column
  Indices invalid_columns_;
  Indices straightened_;  // vertices whose layers were put on a straight line
};

}  // namespace vdb_offset
