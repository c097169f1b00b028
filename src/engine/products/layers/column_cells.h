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

/// How a side of a column is split in its first layer, beside a fan that ends: not at all, or along a diagonal from the
/// wall at one of its ends up to the other end.
enum class SideSplit : std::uint8_t { None, UpToNext, DownToNext };

/// The sides of a column that are split, and the point in the middle of its first cell that this asks for.
struct ColumnSplits {
  std::span<const SideSplit> sides;  ///< From each corner to the next. Empty: none is split.
  std::uint32_t middle = kNone;
};

/// The cells of one column in one layer. Corners are numbered around the face; after the last comes 0 again.
///
/// Over an edge or a corner that is opened into a fan, corners share a point of the wall: a column of the fan begins
/// with a prism that lies along the edge, or with a tetrahedron. Where a fan ends in a point, its last cells are
/// tetrahedra, and the two columns beside it see the edge there as two triangles: their first cells are parted into
/// pyramids and tetrahedra around a point in the middle.
class ColumnCells {
 public:
  ColumnCells(const LayerPoints& points, std::span<const std::uint32_t> ring, std::size_t layer,
              const ColumnSplits& splits = {})
      : points_(points),
        ring_(ring),
        n_(static_cast<std::uint32_t>(ring.size())),
        layer_(layer),
        apex_(find_apex()),
        splits_(layer == 0 ? splits : ColumnSplits{}) {
    VDB_OFFSET_ASSERT(n_ > 2);
  }

  std::uint32_t corner(std::uint32_t k) const {
    while (k >= n_) k -= n_;
    return ring_[k];
  }
  std::uint32_t below(std::uint32_t k) const { return points_.at(corner(k), layer_); }
  std::uint32_t above(std::uint32_t k) const { return points_.at(corner(k), layer_ + 1); }
  bool flat(std::uint32_t k) const { return points_.flat(corner(k)); }

  /// Whether the column's first cell is parted around a point in its middle.
  bool has_middle() const { return is_split() && n_ < 5 && first_shared() == n_; }

  /// Calls begin(CellType) for each cell, then add(corner) for each of its corners.
  template <class Begin, class Add>
  void visit_cells(Begin&& begin, Add&& add) const {
    if (n_ > 4) {
      begin(CellType::Polyhedron);
      visit_polyhedron(add);
    } else if (has_middle()) {
      visit_around_middle(begin, add);
    } else if (has_apex()) {
      for (std::uint32_t k = apex_ + 1; k < apex_ + n_ - 1; ++k) visit_cones(k, below(apex_), begin, add);
    } else if (const std::uint32_t shared = first_shared(); shared < n_) {
      visit_over_ridge(shared, begin, add);
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

  /// Calls visit(point) for each corner of the cell that the column would be without a point in its middle.
  template <class Visit>
  void for_each_point(Visit&& visit) const {
    for (std::uint32_t k = 0; k < n_; ++k) visit(below(k));
    for (std::uint32_t k = 0; k < n_; ++k)
      if (!flat(k)) visit(above(k));
  }
  /// Where the point in the middle lies: the mean of the corners. position(point) is that of each.
  template <class Position>
  Vec3d middle(Position&& position) const {
    Vec3d sum(0.0);
    double count = 0;
    for_each_point([&](std::uint32_t point) { sum += position(point), ++count; });
    return sum / count;
  }

  /// Calls visit(corners, cell) for each lower face of the column's cells. `cell` counts them from 0; `face` is
  /// scratch. A column over an opened edge has none on the wall.
  template <class Visit>
  void visit_below(std::vector<std::uint32_t>& face, Visit&& visit) const {
    if (first_shared() < n_) return;
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
    const std::uint32_t first = has_middle() ? caps() : 0;
    visit_cap([&](std::uint32_t k) { return above(k); }, face, [&](std::uint32_t cell) { visit(face, first + cell); });
  }

  /// The face on the side from corner k to the next, seen from outside. Returns its number of corners, which is 0 if
  /// both of these are flat. \pre the side is not split
  std::uint32_t side(std::uint32_t k, std::array<std::uint32_t, 4>& face) const {
    std::uint32_t size = 0;
    face[size++] = below(k);
    if (!shares(k)) face[size++] = below(k + 1);
    if (!flat(k + 1)) face[size++] = above(k + 1);
    if (!flat(k)) face[size++] = above(k);
    return size < 3 ? 0 : size;
  }
  /// The cell that has the face on the side from corner k to the next.
  std::uint32_t cell_at_side(std::uint32_t k) const {
    if (has_middle()) {
      std::uint32_t cell = 2 * caps();
      for (std::uint32_t i = 0; i < k; ++i) cell += faces_at(i);
      return cell;
    }
    if (!has_apex()) return 0;
    const std::uint32_t from_apex = (k + n_ - apex_) % n_;
    return std::min(from_apex == 0 ? 0 : from_apex - 1, n_ - 3);
  }

 private:
  bool has_apex() const { return apex_ < n_; }
  /// The number of faces that the column's cells have on either end.
  std::uint32_t caps() const { return has_apex() ? n_ - 2 : 1; }
  /// Whether corner k and the next one rise from one point of the wall, in this layer.
  bool shares(std::uint32_t k) const { return layer_ == 0 && below(k) == below(k + 1); }
  /// The first corner that shares its point of the wall with the next one; n_ if none does.
  std::uint32_t first_shared() const {
    std::uint32_t k = 0;
    while (k < n_ && !shares(k)) ++k;
    return k;
  }
  SideSplit split(std::uint32_t k) const { return splits_.sides.empty() ? SideSplit::None : splits_.sides[k % n_]; }
  bool is_split() const {
    return std::any_of(splits_.sides.begin(), splits_.sides.end(), [](SideSplit s) { return s != SideSplit::None; });
  }
  std::uint32_t faces_at(std::uint32_t k) const {
    std::array<std::uint32_t, 4> face;
    return split(k) != SideSplit::None ? 2 : side(k, face) > 0 ? 1 : 0;
  }
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

  /// Calls visit(corners) for each face on the side from corner k to the next, seen from outside.
  template <class Visit>
  void visit_side(std::uint32_t k, Visit&& visit) const {
    std::array<std::uint32_t, 4> face;
    if (split(k) == SideSplit::None) {
      if (const std::uint32_t size = side(k, face); size > 0) visit(std::span<const std::uint32_t>(face).first(size));
      return;
    }
    const std::uint32_t a = below(k), b = below(k + 1), c = above(k + 1), d = above(k);
    const bool up = split(k) == SideSplit::UpToNext;
    face = {a, b, up ? c : d, 0};
    visit(std::span<const std::uint32_t>(face).first(3));
    face = {up ? a : b, c, d, 0};
    visit(std::span<const std::uint32_t>(face).first(3));
  }

  /// A cone over a face, which is seen from outside, to a point inside of it.
  template <class Begin, class Add>
  static void visit_cone(std::span<const std::uint32_t> face, std::uint32_t point, Begin& begin, Add& add) {
    begin(face.size() == 4 ? CellType::Pyramid : CellType::Tetrahedron);
    add(face[0]);
    for (std::size_t i = face.size() - 1; i > 0; --i) add(face[i]);
    add(point);
  }
  /// Cones over the side from corner k to the next.
  template <class Begin, class Add>
  void visit_cones(std::uint32_t k, std::uint32_t point, Begin& begin, Add& add) const {
    visit_side(k, [&](std::span<const std::uint32_t> face) { visit_cone(face, point, begin, add); });
  }

  /// The first cell of a column of a fan, whose corner `shared` has its point of the wall in common with the next one.
  template <class Begin, class Add>
  void visit_over_ridge(std::uint32_t shared, Begin& begin, Add& add) const {
    const std::uint32_t k = shared;
    if (n_ == 3) {
      begin(CellType::Tetrahedron);
      add(above(k)), add(above(k + 2)), add(above(k + 1)), add(below(k));
    } else {
      begin(CellType::Prism);
      add(below(k)), add(above(k)), add(above(k + 1));
      add(below(k + 2)), add(above(k + 3)), add(above(k + 2));
    }
  }

  /// Cones over all faces of the column's cell: the lower ones, the upper ones, then its sides.
  template <class Begin, class Add>
  void visit_around_middle(Begin& begin, Add& add) const {
    std::vector<std::uint32_t> face;
    const auto cone = [&](std::span<const std::uint32_t> corners, std::uint32_t) {
      visit_cone(corners, splits_.middle, begin, add);
    };
    visit_below(face, cone);
    visit_above(face, cone);
    for (std::uint32_t k = 0; k < n_; ++k) visit_cones(k, splits_.middle, begin, add);
  }

  template <class Add>
  void visit_polyhedron(Add& add) const {
    std::uint32_t sides = 0;
    for (std::uint32_t k = 0; k < n_; ++k) sides += faces_at(k);
    add(sides + 2);
    add(n_);
    for (std::uint32_t k = 0; k < n_; ++k) add(below(n_ - k));
    add(n_);
    for (std::uint32_t k = 0; k < n_; ++k) add(above(k));
    for (std::uint32_t k = 0; k < n_; ++k)
      visit_side(k, [&](std::span<const std::uint32_t> face) {
        add(static_cast<std::uint32_t>(face.size()));
        for (const std::uint32_t point : face) add(point);
      });
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
  ColumnSplits splits_;
};

}  // namespace vdb_offset
