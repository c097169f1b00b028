// SPDX-License-Identifier: Apache-2.0
// Finds the boundary of what is inside of a surface whose solids overlap or lie in each other. Triangles that meet no
// other form patches over their edges, and a patch is buried if the middle of its largest triangle has the inside on
// both sides. A triangle that meets others is cut along the shared segments into convex parts, by a binary tree of
// lines in its plane, and each part is judged by its middle. Holes that are to be filled get a fan of triangles around
// their centre. A triangle stays whole if none of its parts is buried, and there is no result if all of the surface is
// boundary and no hole is filled. Cuts are rounded, and parts do not fit together at their edges: the result is for
// distances alone, and no mesh to write.
#include "products/iso/solid_boundary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "ground/numbers/disjoint_sets.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "valid/faults/triangle_crossings.h"

namespace vdb_offset {
namespace {

// Lengths below this share of the diagonal are the rounding of a cut's position.
constexpr double kCutRounding = 1e-13;

using Polygon = std::vector<Vec3d>;  // plane and convex
struct SharedSegment {
  Vec3d from, to;
};

/// Cuts a triangle into convex parts such that no segment leads into one: by a binary tree of lines in its plane, each
/// of which is the line of a segment that passes through a part.
class TriangleCutter {
 public:
  TriangleCutter(const std::array<Vec3d, 3>& triangle, const Vec3d& normal, double rounding)
      : normal_(normal), rounding_(rounding) {
    nodes_.push_back({{}, 0, 0, 0, Polygon(triangle.begin(), triangle.end())});
  }

  void cut(const SharedSegment& segment) {
    const Vec3d across = normal_.cross(segment.to - segment.from);
    if (const double length = across.length(); length > rounding_) insert(0, segment, across / length);
  }

  /// Calls take(part) for each part.
  template <class Take>
  void for_each_part(Take&& take) const {
    for (const Node& node : nodes_)
      if (!node.part.empty()) take(node.part);
  }

 private:
  /// A line with the nodes on its two sides, or a part.
  struct Node {
    Vec3d across;
    double offset;
    std::uint32_t below, above;
    Polygon part;
  };

  int side(const Node& node, const Vec3d& x) const {
    const double height = node.across.dot(x) - node.offset;
    return static_cast<int>(height > rounding_) - static_cast<int>(height < -rounding_);
  }

  void insert(std::uint32_t at, const SharedSegment& segment, const Vec3d& across) {
    if (!nodes_[at].part.empty()) return split(at, segment, across);
    const int from = side(nodes_[at], segment.from), to = side(nodes_[at], segment.to);
    if (from == 0 && to == 0) return;  // the line cuts there already
    const std::uint32_t below = nodes_[at].below, above = nodes_[at].above;
    if (from >= 0 && to >= 0) return insert(above, segment, across);
    if (from <= 0 && to <= 0) return insert(below, segment, across);
    const double a = nodes_[at].across.dot(segment.from) - nodes_[at].offset,
                 b = nodes_[at].across.dot(segment.to) - nodes_[at].offset;
    const Vec3d middle = segment.from + (segment.to - segment.from) * (a / (a - b));
    insert(from > 0 ? above : below, {segment.from, middle}, across);
    insert(from > 0 ? below : above, {middle, segment.to}, across);
  }

  void split(std::uint32_t at, const SharedSegment& segment, const Vec3d& across) {
    if (!passes_through(nodes_[at].part, segment)) return;
    Node line{across, across.dot(segment.from), 0, 0, {}};
    Polygon below, above;
    const Polygon& part = nodes_[at].part;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Vec3d &p = part[i], &q = part[(i + 1) % part.size()];
      const int at_p = side(line, p), at_q = side(line, q);
      if (at_p <= 0) below.push_back(p);
      if (at_p >= 0) above.push_back(p);
      if (at_p * at_q >= 0) continue;
      const double a = across.dot(p) - line.offset, b = across.dot(q) - line.offset;
      const Vec3d cut = p + (q - p) * (a / (a - b));
      below.push_back(cut);
      above.push_back(cut);
    }
    if (below.size() < 3 || above.size() < 3) return;
    line.below = static_cast<std::uint32_t>(nodes_.size());
    line.above = line.below + 1;
    nodes_[at] = line;
    nodes_.push_back({{}, 0, 0, 0, std::move(below)});
    nodes_.push_back({{}, 0, 0, 0, std::move(above)});
  }

  /// Whether the segment is inside of a part, by more than an end.
  bool passes_through(const Polygon& part, const SharedSegment& segment) const {
    double begin = 0, end = 1;
    const Vec3d way = segment.to - segment.from;
    for (std::size_t i = 0; i < part.size(); ++i) {
      const Vec3d &p = part[i], edge = part[(i + 1) % part.size()] - p;
      if (!(edge.lengthSqr() > 0)) continue;
      const Vec3d inward = normal_.cross(edge).unit();
      const double start = inward.dot(segment.from - p) - rounding_, rise = inward.dot(way);
      if (std::abs(rise) <= rounding_) {
        if (start < 0) return false;
      } else if (rise > 0) {
        begin = std::max(begin, -start / rise);
      } else {
        end = std::min(end, -start / rise);
      }
    }
    return (end - begin) * way.length() > rounding_;
  }

  Vec3d normal_;
  double rounding_;
  std::vector<Node> nodes_;
};

class BoundaryFinder {
 public:
  BoundaryFinder(const Surface& given, const Inside& inside)
      : given_(given),
        inside_(inside),
        rounding_(kCutRounding * given.facts.diagonal),
        meets_(given.triangles.size()) {}

  std::optional<Boundary> find(std::span<const Hole> holes, bool look_for_buried) {
    if (look_for_buried) {
      sort_pairs(CrossingFinder(given_, given_.vertices).all());
      const bool is_one = given_.facts.components == 1 && given_.facts.non_manifold_edges == 0;
      if (!is_one || !crossing_.empty()) judge_patches();
    }
    if (holes.empty() && crossing_.empty() && buried_.empty()) return std::nullopt;
    keep_patches();
    cut_crossing();
    for (const Hole& hole : holes) fill(hole);
    if (boundary_.buried == 0 && boundary_.cut == 0 && holes.empty()) return std::nullopt;
    build();
    return std::move(boundary_);
  }

 private:
  std::array<Vec3d, 3> corners(std::uint32_t t) const {
    const auto& [a, b, c] = given_.triangles[t];
    return {given_.vertices[a], given_.vertices[b], given_.vertices[c]};
  }

  void sort_pairs(const std::vector<TrianglePair>& pairs) {
    for (const auto& [s, t] : pairs) {
      met_.insert(met_.end(), {{s, t}, {t, s}});
      meets_[s] = meets_[t] = 1;
    }
    std::sort(met_.begin(), met_.end());
    for (std::uint32_t t = 0; t < meets_.size(); ++t)
      if (meets_[t]) crossing_.push_back(t);
  }

  /// Judges whether components of triangles that meet no others are buried: either side of such a component is inside
  /// or outside as a whole.
  void judge_patches() {
    patches_ = DisjointSets(given_.triangles.size());
    for (std::uint32_t edge = 0; edge < given_.next_around_edge.size(); ++edge) {
      const std::uint32_t other = given_.next_around_edge[edge];
      if (given_.next_around_edge[other] != edge || meets_[edge / 3] || meets_[other / 3]) continue;
      patches_.join(edge / 3, other / 3);
    }
    std::vector<std::uint32_t> largest(patches_.size(), kNone);  // triangle of each patch
    for (std::uint32_t t = 0; t < patches_.size(); ++t) {
      std::uint32_t& known = largest[patches_.first(t)];
      if (!meets_[t] && (known == kNone || area_squared(t) > area_squared(known))) known = t;
    }
    std::erase(largest, kNone);
    std::vector<std::uint8_t> is_buried(largest.size(), 0);
    if (largest.size() > 1)
      for_each_index(
          largest.size(),
          [&](std::size_t i) {
            const auto [a, b, c] = corners(largest[i]);
            is_buried[i] = inside_.is_buried(largest[i], (a + b + c) / 3.0, rounding_);
          },
          16);
    for (std::size_t i = 0; i < largest.size(); ++i)
      if (is_buried[i]) buried_.push_back(patches_.first(largest[i]));
    std::sort(buried_.begin(), buried_.end());
  }

  double area_squared(std::uint32_t t) const {
    const auto [a, b, c] = corners(t);
    return (b - a).cross(c - a).lengthSqr();
  }

  void keep_patches() {
    kept_.positions = given_.vertices;
    for (std::uint32_t t = 0; t < given_.triangles.size(); ++t) {
      if (meets_[t]) continue;
      if (patches_.size() > 0 && std::binary_search(buried_.begin(), buried_.end(), patches_.first(t))) {
        ++boundary_.buried;
        continue;
      }
      const auto& [a, b, c] = given_.triangles[t];
      add(a, b, c, t);
    }
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t given) {
    kept_.add_face({a, b, c});
    given_of_face_.push_back(given);
  }

  /// Cuts along the intersection of another triangle with the plane: a segment, or its outline if it lies in the plane.
  void cut_along(const std::array<Vec3d, 3>& plane, const Vec3d& normal, std::uint32_t other,
                 TriangleCutter& cutter) const {
    const std::array<Vec3d, 3> corner = corners(other);
    std::array<double, 3> height;
    for (std::size_t k = 0; k < 3; ++k) {
      height[k] = normal.dot(corner[k] - plane[0]);
      if (std::abs(height[k]) <= rounding_) height[k] = 0;
    }
    std::vector<Vec3d> ends;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t n = (k + 1) % 3;
      if (height[k] == 0) ends.push_back(corner[k]);
      else if (height[k] * height[n] < 0)
        ends.push_back(corner[k] + (corner[n] - corner[k]) * (height[k] / (height[k] - height[n])));
    }
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) cutter.cut({ends[k], ends[k + 1]});
    if (ends.size() == 3) cutter.cut({ends[2], ends[0]});
  }

  struct Cut {
    std::vector<Polygon> kept;
    std::size_t parts = 0;
  };

  Cut cut(std::uint32_t t) const {
    const std::array<Vec3d, 3> triangle = corners(t);
    const Polygon whole(triangle.begin(), triangle.end());
    const Vec3d normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
    Cut result;
    if (!(normal.length() > rounding_ * rounding_)) return {{whole}, 1};
    TriangleCutter cutter(triangle, normal.unit(), rounding_);
    for (auto met = std::lower_bound(met_.begin(), met_.end(), TrianglePair{t, 0});
         met != met_.end() && met->first == t; ++met)
      cut_along(triangle, normal.unit(), met->second, cutter);
    cutter.for_each_part([&](const Polygon& part) {
      ++result.parts;
      Vec3d middle(0.0);
      for (const Vec3d& p : part) middle += p / static_cast<double>(part.size());
      if (!inside_.is_buried(t, middle, rounding_)) result.kept.push_back(part);
    });
    // A triangle of which no part is buried stays as it is.
    if (result.kept.size() == result.parts) result.kept = {whole};
    return result;
  }

  void cut_crossing() {
    std::vector<Cut> cuts(crossing_.size());
    for_each_index(
        crossing_.size(), [&](std::size_t i) { cuts[i] = cut(crossing_[i]); }, 4);
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      if (cuts[i].kept.empty()) {
        ++boundary_.buried;
        continue;
      }
      const bool is_whole = cuts[i].kept.size() == 1 && cuts[i].kept[0].size() == 3 &&
                            std::equal(cuts[i].kept[0].begin(), cuts[i].kept[0].end(), corners(crossing_[i]).begin());
      boundary_.cut += !is_whole;
      for (const Polygon& part : cuts[i].kept) {
        const auto first = static_cast<std::uint32_t>(kept_.positions.size());
        kept_.positions.insert(kept_.positions.end(), part.begin(), part.end());
        for (std::uint32_t k = 2; k < part.size(); ++k) add(first, first + k - 1, first + k, crossing_[i]);
      }
    }
  }

  void fill(const Hole& hole) {
    const auto centre = static_cast<std::uint32_t>(kept_.positions.size());
    kept_.positions.push_back(centre_of(given_, hole));
    for (std::size_t i = 0; i < hole.rim.size(); ++i)
      add(centre, hole.rim[i], hole.rim[(i + 1) % hole.rim.size()], hole.beside);
  }

  void build() {
    boundary_.surface = build_surface(kept_.view(), {});
    to_frame(boundary_.surface, Vec3d(0.0));
    boundary_.surface.origin = given_.origin;
    boundary_.surface.facts.lower += given_.origin;
    boundary_.surface.facts.upper += given_.origin;
    for (const auto face : boundary_.surface.face) boundary_.given.push_back(given_of_face_[face]);
  }

  const Surface& given_;
  const Inside& inside_;
  double rounding_;
  std::vector<std::uint8_t> meets_;  // of each triangle: 1 if it meets others
  std::vector<TrianglePair> met_;    // both orders of each pair of triangles that meet, sorted
  std::vector<std::uint32_t> crossing_, buried_;
  DisjointSets patches_;
  Polygons kept_;
  std::vector<std::uint32_t> given_of_face_;
  Boundary boundary_;
};

}  // namespace

std::optional<Boundary> find_boundary(const Surface& given, const Inside& inside, std::span<const Hole> holes,
                                      bool look_for_buried) {
  VDB_OFFSET_ASSERT(given.triangle_normals.size() == given.triangles.size());  // it is placed
  if (holes.empty() && !look_for_buried) return std::nullopt;
  return BoundaryFinder(given, inside).find(holes, look_for_buried);
}

}  // namespace vdb_offset
