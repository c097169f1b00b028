// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "ground/numbers/index_set.h"
#include "products/layers/rail_stacks.h"

namespace vdb_offset {

/// What layers are grown on, of surfaces and of curves: the columns of cells, the faces around vertices, and the faults
/// of the outermost surface.
class LayerWall {
 public:
  LayerWall(const LayerWall&) = delete;
  LayerWall& operator=(const LayerWall&) = delete;

  /// The stacks that put() moves and the others judge.
  RailStacks& stacks() const { return stacks_; }

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

 protected:
  /// Keeps a reference.
  explicit LayerWall(RailStacks& stacks) : stacks_(stacks) {}
  ~LayerWall() = default;

  RailStacks& stacks_;
};

}  // namespace vdb_offset
