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

/// What stack_layers() and stack_curves() have in common: the rounds that thin layers and let them out again until all
/// cells are valid. What is told of columns of cells, of faces around vertices and of faults differs.
class LayerGrower {
 public:
  LayerGrower(const LayerGrower&) = delete;
  LayerGrower& operator=(const LayerGrower&) = delete;

  LayerStack run(Progress& progress);

 protected:
  /// Keeps references to what stands behind spans, and to `paths`. \pre `source` less `front_origin` is in the frame of
  /// the queries that fields of put_down() ask.
  LayerGrower(std::span<const Vec3d> source, const Vec3d& front_origin, std::span<const Distances> heights,
              Paths& paths);
  ~LayerGrower() = default;

  virtual bool moves(std::uint32_t vertex) const = 0;
  /// Whether a vertex's layers have to stand on a straight line.
  virtual bool is_bound(std::uint32_t) const { return false; }
  /// Whether a way up from a vertex leads away from all faces around it.
  virtual bool sees_all_faces(std::uint32_t vertex, const Vec3d& way) const = 0;
  /// The vertex's own direction, outward, unit length.
  virtual Vec3d direction_of(std::uint32_t vertex) const = 0;

  virtual std::size_t column_count() const = 0;
  /// The vertices of a column's base, in a ring.
  virtual std::span<const std::uint32_t> base(std::size_t column) const = 0;
  virtual std::span<const std::uint32_t> columns_around(std::uint32_t vertex) const = 0;
  /// Whether all cells of a column are valid. Called in parallel.
  virtual bool is_valid(std::size_t column) const = 0;
  virtual std::array<bool, 2> are_valid(std::size_t column, std::size_t other) const {
    return {is_valid(column), is_valid(other)};
  }

  /// Puts these vertices' layers where their shares want them.
  virtual void put(const Indices& vertices) = 0;
  /// Looks for what is wrong with the outermost surface around these vertices, which have been put anew; at first, only
  /// those need be looked at that are not where their paths end.
  virtual void look(const Indices& vertices) = 0;
  virtual void look_first(const Indices& all) { look(all); }
  virtual Indices faulty_vertices() const = 0;
  /// Exact distance of an outermost vertex, as it was last looked at.
  virtual double distance_of(std::uint32_t vertex) const = 0;

  double asked(std::uint32_t v) const { return std::abs(heights_.back()[v]); }
  const Vec3d& outermost(std::uint32_t v) const { return stack_.stacks.of(v).back(); }
  /// Whether a vertex's outermost layer is where its path ended.
  bool is_at_end(std::uint32_t v) const { return stack_.share[v] == most_[v] && most_[v] > 0; }

  /// It sets out in the vertex's own direction, or along a straight line, to where the path ended.
  Rail rail_of(std::uint32_t v) const { return {paths_.displacement[v], bend_[v]}; }
  /// Where on its rail, 0 .. 1, a vertex's descent may begin: above its share. Where it has stood tells of a place
  /// nearby, which is likely to be.
  double top_of(std::uint32_t v) const {
    constexpr double kRoom = 1.15;
    const Standing& stood = stood_[v];
    return is_at_end(v) ? 1 : std::min(1.0, kRoom * stood.eta * (stack_.share[v] / stood.share));
  }

  /// Goes down a vertex's rail from height to height, from the outermost, which is below `top` on it. False if it is
  /// not. `placed` is told of each layer and its distance, and may end the descent: then this is false, too.
  template <class Field, class Placed>
  bool put_down(std::uint32_t v, double top, Field&& field, Placed&& placed) {
    const auto stack = stack_.stacks.of(v);
    const double share = stack_.share[v];
    const Rail rail = rail_of(v);
    const Vec3d origin = source_[v] - front_origin_;
    RailPlace above{top, field.find(origin + rail(top))};
    if (top < 1 && above.phi.value < share * asked(v)) return false;
    for (std::size_t k = heights_.size(); k-- > 0;) {
      const double target = share * std::abs(heights_[k][v]);
      const bool at_end = k + 1 == heights_.size() && share == most_[v];
      if (!at_end) above = place_on(rail, origin, above, target, field);
      stack[k + 1] = source_[v] + (at_end ? rail.whole : round_displacement(rail(above.eta), target));
      if (!placed(k, above.phi.value)) return false;
      if (k + 1 == heights_.size()) stood_[v] = {share, above.eta};
      stack_.first_achieved[v] = above.phi.value;
    }
    return true;
  }

  std::span<const Vec3d> source_;  // where the vertices stand
  Vec3d front_origin_;
  std::span<const Distances> heights_;
  int side_;  // 1 outward, -1 inward
  Paths& paths_;
  std::vector<double> most_;  // the share that each vertex could keep for where its path ended
  LayerStack stack_;

 private:
  /// Where on a rail the outermost layer was when that was last put, and with which share.
  struct Standing {
    double share = 1, eta = std::numeric_limits<double>::infinity();  // it was nowhere
  };
  /// Vertices with all that is known of their layers.
  struct Snapshot {
    Indices vertices;  // sorted
    std::vector<Vec3d> places;
    std::vector<double> first_achieved;
    std::vector<Standing> stood;
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
  Indices corners_of_wrong_columns() const;
  Indices wrong_vertices() const;
  bool straighten();
  bool thin();
  void let_all_out(Progress& progress);
  void let_out(Indices& thinned, std::vector<double>& before);
  Indices take_back(const std::vector<double>& before, const Snapshot& snapshot);
  void finish();

  std::vector<Standing> stood_;
  std::vector<Vec3d> bend_;            // of a vertex's rail, zero where its layers stand on a straight line
  std::vector<std::uint8_t> thinned_;  // in how many rounds a vertex was
  std::vector<std::uint8_t> wrong_column_;
  Indices wrong_columns_;
  Indices straightened_;
};

}  // namespace vdb_offset
