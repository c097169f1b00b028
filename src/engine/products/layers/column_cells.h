// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ground/system/assert.h"
#include "products/layers/layer_points.h"
#include "vdb_offset/cells.h"

namespace vdb_offset {

/// The cells of one column in one layer. Corners are numbered around the face; after the last comes 0 again.
class ColumnCells {
 public:
  ColumnCells(const LayerPoints& points, std::span<const std::uint32_t> ring, std::size_t layer)
      : points_(points), ring_(ring), n_(static_cast<std::uint32_t>(ring.size())), layer_(layer), apex_(find_apex()) {
    VDB_OFFSET_ASSERT(n_ > 2);
  }

  std::uint32_t corner(std::uint32_t k) const {
    while (k >= n_) k -= n_;
    return ring_[k];
  }
  std::uint32_t below(std::uint32_t k) const { return points_.at(corner(k), layer_); }
  std::uint32_t above(std::uint32_t k) const { return points_.at(corner(k), layer_ + 1); }
  bool flat(std::uint32_t k) const { return points_.flat(corner(k)); }

  /// Calls begin(CellType) for each cell, then add(corner) for each of its corners.
  template <class Begin, class Add>
  void visit_cells(Begin&& begin, Add&& add) const {
    if (n_ > 4) {
      begin(CellType::Polyhedron);
      visit_polyhedron(add);
    } else if (has_apex()) {
      for (std::uint32_t k = apex_ + 1; k < apex_ + n_ - 1; ++k) visit_cone(k, begin, add);
    } else if (const std::uint32_t first = first_flat(); first < n_) {
      begin(CellType::Prism);
      for (const std::uint32_t k : {first, first + 1}) {
        const std::uint32_t far = k == first ? first + 3 : first + 2;
        add(below(k)), add(below(far)), add(above(far));
      }
    } else {
      begin(n_ == 3 ? CellType::Prism : CellType::Hexahedron);
      for (std::uint32_t k = 0; k < n_; ++k) add(below(k));
      for (std::uint32_t k = 0; k < n_; ++k) add(above(k));
    }
  }

  /// Calls visit(corners, cell) for each lower face of the column's cells. `cell` counts them from 0; `face` is
  /// scratch.
  template <class Visit>
  void visit_below(std::vector<std::uint32_t>& face, Visit&& visit) const {
    visit_cap([&](std::uint32_t k) { return below(k); }, face,
              [&](std::uint32_t cell) {
                std::reverse(face.begin() + 1, face.end());
                visit(face, cell);
              });
  }
  /// Calls visit(corners, cell) for each upper face of the column's cells. `cell` counts them from 0; `face` is
  /// scratch.
  template <class Visit>
  void visit_above(std::vector<std::uint32_t>& face, Visit&& visit) const {
    visit_cap([&](std::uint32_t k) { return above(k); }, face, [&](std::uint32_t cell) { visit(face, cell); });
  }

  /// The face on the side from corner k to the next, seen from outside. Returns its number of corners, which is 0 if
  /// both of these are flat.
  std::uint32_t side(std::uint32_t k, std::array<std::uint32_t, 4>& face) const {
    std::uint32_t size = 0;
    face[size++] = below(k), face[size++] = below(k + 1);
    if (!flat(k + 1)) face[size++] = above(k + 1);
    if (!flat(k)) face[size++] = above(k);
    return size < 3 ? 0 : size;
  }
  /// The cell that has the face on the side from corner k to the next.
  std::uint32_t cell_at_side(std::uint32_t k) const {
    if (!has_apex()) return 0;
    const std::uint32_t from_apex = (k + n_ - apex_) % n_;
    return std::min(from_apex == 0 ? 0 : from_apex - 1, n_ - 3);
  }

 private:
  bool has_apex() const { return apex_ < n_; }
  std::uint32_t first_flat() const {
    std::uint32_t k = 0;
    while (k < n_ && !flat(k)) ++k;
    // If the last corner and corner 0 are both flat, the last is the first of the two.
    return k == 0 && flat(0) && flat(n_ - 1) ? n_ - 1 : k;
  }
  /// A flat corner from which cones over the sides that do not hold it fill the column. Two flat corners in a row of a
  /// quad need no cone; of three in a row it is the middle one, from where the cones cover the whole wall. n_ if none.
  std::uint32_t find_apex() const {
    for (std::uint32_t k = 0; n_ < 5 && k < n_; ++k)
      if (flat(k) && (n_ == 3 || flat(k + 1) == flat(k + n_ - 1))) return k;
    return n_;
  }

  /// A cone from the apex, whose base is the side from corner k to the next, seen from inside.
  template <class Begin, class Add>
  void visit_cone(std::uint32_t k, Begin& begin, Add& add) const {
    std::array<std::uint32_t, 4> base;
    const std::uint32_t size = side(k, base);
    begin(size == 4 ? CellType::Pyramid : CellType::Tetrahedron);
    add(base[0]);
    for (std::uint32_t i = size - 1; i > 0; --i) add(base[i]);
    add(below(apex_));
  }

  template <class Add>
  void visit_polyhedron(Add& add) const {
    std::array<std::uint32_t, 4> face;
    std::uint32_t sides = 0;
    for (std::uint32_t k = 0; k < n_; ++k) sides += side(k, face) > 0;
    add(sides + 2);
    add(n_);
    for (std::uint32_t k = 0; k < n_; ++k) add(below(n_ - k));
    add(n_);
    for (std::uint32_t k = 0; k < n_; ++k) add(above(k));
    for (std::uint32_t k = 0; k < n_; ++k) {
      const std::uint32_t size = side(k, face);
      if (size > 0) add(size);
      for (std::uint32_t i = 0; i < size; ++i) add(face[i]);
    }
  }

  template <class Point, class Visit>
  void visit_cap(Point&& point, std::vector<std::uint32_t>& face, Visit&& visit) const {
    if (!has_apex()) {
      face.clear();
      for (std::uint32_t k = 0; k < n_; ++k) face.push_back(point(k));
      visit(0);
      return;
    }
    for (std::uint32_t k = apex_ + 1; k < apex_ + n_ - 1; ++k) {
      face.assign({point(apex_), point(k), point(k + 1)});
      visit(k - apex_ - 1);
    }
  }

  const LayerPoints& points_;
  std::span<const std::uint32_t> ring_;
  std::uint32_t n_;
  std::size_t layer_;
  std::uint32_t apex_;
};

}  // namespace vdb_offset
