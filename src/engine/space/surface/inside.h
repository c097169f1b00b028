// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>

#include "ground/numbers/box_tree.h"
#include "space/surface/holes.h"
#include "space/surface/surface.h"

namespace vdb_offset {

/// Rays through a surface, all in one direction, that edges and faces of real parts do not lie in.
class RayTree {
 public:
  /// Rays meet the triangles for which is_in(triangle) holds. Keeps a reference to the surface; its vertices must stay.
  explicit RayTree(
      const Surface& surface, const std::function<bool(std::size_t)>& is_in = [](std::size_t) { return true; });

  /// Calls visit(triangle, turn) for each triangle that the ray from `start` passes through: turn is 1 if it leaves
  /// the solid there, by the triangle's orientation, or -1. Both triangles at an edge see the ray on the same side of
  /// it, to the last bit, so that it slips between none.
  template <class Visit>
  void cast(const Vec3d& start, Visit&& visit) const;

  /// Calls visit(triangle, turn, height) for each triangle that the line through a point passes through, from `behind`
  /// world units behind the point on; `turn` is as for cast(), `height` how far ahead of the point the triangle is,
  /// along z.
  template <class Visit>
  void cast_from_behind(const Vec3d& x, double behind, Visit&& visit) const;

  /// The direction of all rays, not of unit length.
  static Vec3d direction() { return {0.3819660112501051, 0.2360679774997897, 1}; }

 private:
  /// All rays run along z here.
  static Vec3d leaned(const Vec3d& x) {
    return {x[0] - 0.3819660112501051 * x[2], x[1] - 0.2360679774997897 * x[2], x[2]};
  }
  static float below(double x) { return std::nextafter(static_cast<float>(x), -FloatBox::kInfinity); }
  static float above(double x) { return std::nextafter(static_cast<float>(x), FloatBox::kInfinity); }

  FloatBox box_of(std::size_t triangle) const;
  /// 0 if the line does not pass through the triangle; then `height` says nothing.
  int pass(std::size_t triangle, const Vec3d& leaned_start, double& height) const;

  const Surface& surface_;
  BoxTree tree_;
};

template <class Visit>
void RayTree::cast(const Vec3d& x, Visit&& visit) const {
  cast_from_behind(x, 0, [&](std::size_t t, int turn, double height) {
    if (height > 0) visit(t, turn);
  });
}

template <class Visit>
void RayTree::cast_from_behind(const Vec3d& x, double behind, Visit&& visit) const {
  const Vec3d start = leaned(x);
  const FloatBox ray{{below(start[0]), below(start[1]), below(start[2] - behind)},
                     {above(start[0]), above(start[1]), FloatBox::kInfinity}};
  tree_.for_each_overlap(ray, [&](std::size_t t) {
    double height;
    if (const int turn = pass(t, start, height); turn != 0) visit(t, turn, height);
  });
}

/// Tells which points lie inside a closed surface: those around which it winds as its faces say. Solids that overlap,
/// or lie in each other, are one. Cavities, which have faces that point inwards, are not inside.
class Inside {
 public:
  /// Nothing is inside of a surface that is not closed, or that is not orientable. Keeps a reference to the surface.
  /// `orient` is what the surface was built with.
  explicit Inside(const Surface& surface, Orient orient = Orient::Keep);
  /// For a surface of which only parts are solid; these may have holes, which are filled. Keeps references.
  Inside(const Surface& surface, const Solidity& solidity, Orient orient);

  /// Whether a point is inside. \pre the point is not on the surface
  bool operator()(const Vec3d& x) const;
  /// Whether anything can be inside.
  bool has_inside() const { return sense_ != 0; }
  /// All solids are inside out: inside is then where their faces point away from, if these were turned round.
  bool is_turned() const { return is_turned_; }
  /// Whether the inside ends at fillings of holes somewhere.
  bool has_holes() const { return has_holes_; }
  /// Whether both sides of a triangle are inside at a point on it: then what is inside does not end there. Triangles
  /// that are closer to the point than `close` count as being at the point, too.
  bool is_buried(std::uint32_t triangle, const Vec3d& x, double close) const;

 private:
  const std::unique_ptr<const Surface> filled_;  // what rays pass through, if it is not all of the surface and no more
  RayTree rays_;
  const Surface& surface_;
  int sense_ = 0;  // of winding around a point inside; 0 if there is none
  bool is_turned_ = false, has_holes_ = false;
};

}  // namespace vdb_offset
