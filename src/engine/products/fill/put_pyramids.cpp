// SPDX-License-Identifier: Apache-2.0
// Pyramids stand on the quads of a front, so that tetrahedra find triangles alone. How high a pyramid can be is first
// decided edge by edge, from the angle between its quad and the triangle beside it, which both may use a third of; then
// all of the front is searched for crossings, and the pyramids there are halved until there are none.
#include "products/fill/put_pyramids.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "products/fill/check_front.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

// The height of pyramids by the root of the base's area, and by its shortest side at most. Measured on a pipe and a
// wing of quads: 0.2 makes flatter ones (least scaled Jacobian 0.27 for 0.44), 0.5 makes neighbours cross at concave
// edges.
constexpr double kHeight = 0.35, kMostHeight = 0.7;
constexpr double kShareOfAngle = 1.0 / 3;
// Each halves what crosses; 2^-8 of the height is a pyramid that no solver takes.
constexpr int kPyramidHalvings = 8;

struct Base {
  Vec3d middle{0.0}, normal{0.0};  // the normal of unit length, towards what is left
  double height = 0;
};

class Pyramids {
 public:
  Pyramids(std::span<const QuadOfFront> quads, FillFront& front, VolumeMesh& volume)
      : quads_(quads), front_(front), volume_(volume) {}

  void put() {
    for (const QuadOfFront& quad : quads_) bases_.push_back(base_of(quad));
    lower_by_angles();
    make();
    for (int round = 0; round < kPyramidHalvings; ++round)
      if (!lower_crossing()) return;
    require_sound(volume_.points, front_.triangles);
  }

 private:
  const Vec3d& point(Index p) const { return volume_.points[p]; }

  Base base_of(const QuadOfFront& quad) const {
    const auto& [a, b, c, d] = quad.corners;
    Base base;
    base.middle = (point(a) + point(b) + point(c) + point(d)) / 4;
    base.normal = (point(c) - point(a)).cross(point(d) - point(b));
    const double twice = base.normal.length();
    if (twice > 0) base.normal /= twice;
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 4; ++k)
      shortest = std::min(shortest, (point(quad.corners[k]) - point(quad.corners[(k + 1) % 4])).length());
    base.height = std::min(kHeight * std::sqrt(twice / 2), kMostHeight * shortest);
    return base;
  }

  /// The two triangles beside each edge of the front, by its ends.
  using Edge = std::array<Index, 2>;
  std::map<Edge, std::vector<Index>> triangles_at_edges() const {
    std::set<Edge> of_quads;
    for (const QuadOfFront& quad : quads_)
      for (std::size_t k = 0; k < 4; ++k) of_quads.insert(edge(quad.corners[k], quad.corners[(k + 1) % 4]));
    std::map<Edge, std::vector<Index>> beside;
    for (Index t = 0; t < front_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto& corners = front_.triangles[t].corners;
        const Edge here = edge(corners[k], corners[(k + 1) % 3]);
        if (of_quads.contains(here)) beside[here].push_back(t);
      }
    return beside;
  }
  static Edge edge(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }

  /// The angle that is free between the base and the triangle beside it, from one to the other over what is left.
  double free_angle(const Base& base, Index a, Index b, Index triangle) const {
    const auto& corners = front_.triangles[triangle].corners;
    const Index third = *std::find_if(corners.begin(), corners.end(), [&](Index p) { return p != a && p != b; });
    Vec3d along = point(b) - point(a);
    along.normalize(0.0);
    const auto across = [&](const Vec3d& x) {
      const Vec3d from = x - point(a);
      return from - along * from.dot(along);
    };
    const Vec3d inwards = across(base.middle), beside = across(point(third));
    const double angle = std::atan2(beside.dot(base.normal), beside.dot(inwards) / inwards.length());
    return angle < 0 ? angle + 2 * std::numbers::pi : angle;
  }

  void lower_by_angles() {
    const auto beside = triangles_at_edges();
    for (std::size_t q = 0; q < quads_.size(); ++q) {
      Base& base = bases_[q];
      for (std::size_t k = 0; k < 4; ++k) {
        const Index a = quads_[q].corners[k], b = quads_[q].corners[(k + 1) % 4];
        for (const Index t : beside.at(edge(a, b))) {
          if (t == quads_[q].triangle || t == quads_[q].triangle + 1) continue;
          Vec3d along = point(b) - point(a);
          along.normalize(0.0);
          const Vec3d from = base.middle - point(a);
          const double reach = (from - along * from.dot(along)).length();
          const double angle = std::min(kShareOfAngle * free_angle(base, a, b, t), std::numbers::pi / 3);
          base.height = std::min(base.height, reach * std::tan(angle));
        }
      }
    }
  }

  Vec3d apex(std::size_t q) const { return bases_[q].middle + bases_[q].normal * bases_[q].height; }

  /// Adds the pyramids to the mesh, and their sides to the front in place of the quads.
  void make() {
    for (std::size_t q = 0; q < quads_.size(); ++q) {
      const auto& quad = quads_[q].corners;
      const auto cell = static_cast<Index>(volume_.cell_count()), top = static_cast<Index>(volume_.points.size());
      first_apex_ = q == 0 ? top : first_apex_;
      volume_.points.push_back(apex(q));
      volume_.corners.insert(volume_.corners.end(), quad.begin(), quad.end());
      volume_.corners.push_back(top);
      volume_.cell_begin.push_back(volume_.corners.size());
      volume_.cell_types.push_back(CellType::Pyramid);
      // Seen from outside of what is left, a side runs from the next corner to this one.
      const auto side = [&](std::size_t k) { return FrontTriangle{{quad[(k + 1) % 4], quad[k], top}, cell, kNone}; };
      front_.triangles[quads_[q].triangle] = side(0);
      front_.triangles[quads_[q].triangle + 1] = side(1);
      front_.triangles.push_back(side(2));
      front_.triangles.push_back(side(3));
    }
  }

  /// Halves the pyramids whose sides cross others. Returns whether there are any.
  bool lower_crossing() {
    std::set<std::size_t> crossing;
    for (const auto& [s, t] : crossings_of(volume_.points, front_.triangles))
      for (const Index one : {s, t})
        if (const Index top = front_.triangles[one].corners[2]; top >= first_apex_) crossing.insert(top - first_apex_);
    for (const std::size_t q : crossing) {
      bases_[q].height /= 2;
      volume_.points[first_apex_ + q] = apex(q);
    }
    return !crossing.empty();
  }

  std::span<const QuadOfFront> quads_;
  FillFront& front_;
  VolumeMesh& volume_;
  std::vector<Base> bases_;
  Index first_apex_ = kNone;
};

}  // namespace

void put_pyramids_on(std::span<const QuadOfFront> quads, FillFront& front, VolumeMesh& volume) {
  Pyramids(quads, front, volume).put();
}

}  // namespace vdb_offset
