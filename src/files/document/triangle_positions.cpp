// SPDX-License-Identifier: Apache-2.0
// Finds where the vertices of a mesh stand in a file of its triangles alone, face by face, and how the file splits the
// faces. A polygon of n corners takes n - 2 triangles in a row. Triangles go first, then quads, then larger polygons,
// as corners that are known from the former settle the latter. A polygon is matched as a fan around its first corner
// and as it is split at its own positions; if both fit, the one counts with which its corners have moved less. If
// neither fits, the outline of its triangles is matched as a ring, from the start with which corners move least. A
// vertex has one position in all of its faces, or there is no result; there is none either if the counts do not fit.
// Positions are compared exactly, without a tolerance.
#include "vdb_offset/io/mesh_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <utility>

#include "ground/mesh/triangulate.h"

namespace vdb_offset::io {
namespace {

using Split = std::vector<std::array<std::uint32_t, 3>>;

class TrianglePlaces {
 public:
  TrianglePlaces(PolygonView mesh, PolygonView triangles)
      : mesh_(mesh),
        triangles_(triangles),
        position_(mesh.positions.begin(), mesh.positions.end()),
        known_(position_.size(), 0),
        split_(triangles.face_count()) {}

  /// Finds the positions. Triangles can only be split in one way, and go first, then quads: larger polygons are matched
  /// with the corners that are known from them.
  std::optional<InTriangles> find() {
    std::size_t count = 0;
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) count += mesh_.face(f).size() - 2;
    if (count != triangles_.face_count()) return std::nullopt;
    for (const std::size_t large : {std::size_t{3}, kQuad, kQuad + 1}) {
      std::size_t first = 0;
      for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
        const auto face = mesh_.face(f);
        if (std::min(face.size(), kQuad + 1) == large && !take(f, first)) return std::nullopt;
        first += face.size() - 2;
      }
    }
    return InTriangles{std::move(position_), std::move(split_)};
  }

 private:
  static constexpr std::size_t kQuad = 4;  // corners

  /// Takes the positions of a polygon's corners from its triangles. These are those of the offset, in which the polygon
  /// is split as in the source, around its first corner, or as another program has chosen. Where both of the first are
  /// possible, the corners have moved less far.
  bool take(std::size_t f, std::size_t first) {
    const auto face = mesh_.face(f);
    Split fan, as_source;
    for (std::size_t k = 2; k < face.size(); ++k) fan.push_back({face[0], face[k - 1], face[k]});
    append_triangles(mesh_, f, as_source);
    const std::optional<double> by_fan = squared_displacements(fan, first),
                                by_source = squared_displacements(as_source, first);
    if (!by_fan && !by_source) return take_ring(face, first);
    const Split& split = !by_source || (by_fan && *by_fan < *by_source) ? fan : as_source;
    std::copy(split.begin(), split.end(), split_.begin() + static_cast<std::ptrdiff_t>(first));
    for_each_corner(split, first, [&](std::uint32_t v, const Vec3d& there) {
      known_[v] = 1;
      position_[v] = there;
    });
    return true;
  }

  /// Takes the positions of a polygon that was split in another way: its corners' are all around what its triangles
  /// cover. Of the corners that this ring may begin with that counts with which the corners have moved least far.
  bool take_ring(std::span<const std::uint32_t> face, std::size_t first) {
    const std::vector<Vec3d> ring = ring_around(face.size(), first);
    std::size_t best = ring.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t begin = 0; begin < ring.size(); ++begin) {
      double way = 0;
      for (std::size_t k = 0; k < face.size() && way < least; ++k) {
        const Vec3d& there = ring[(begin + k) % ring.size()];
        const bool fits = !known_[face[k]] || position_[face[k]] == there;
        way += fits ? (there - mesh_.positions[face[k]]).lengthSqr() : std::numeric_limits<double>::infinity();
      }
      if (way < least) least = way, best = begin;
    }
    for (std::size_t k = 0; k < face.size() && best < ring.size(); ++k) {
      known_[face[k]] = 1;
      position_[face[k]] = ring[(best + k) % ring.size()];
    }
    for (std::size_t i = first; i + 2 < first + face.size() && best < ring.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto at = std::find(ring.begin(), ring.end(), triangles_.positions[triangles_.face(i)[k]]);
        split_[i][k] = face[(static_cast<std::size_t>(at - ring.begin()) + ring.size() - best) % ring.size()];
      }
    return best < ring.size();
  }

  /// The positions all around some triangles, in order: the ends of the sides that no other of them has the other way
  /// round. Empty unless that is one ring of so many different positions, or if those are very many.
  std::vector<Vec3d> ring_around(std::size_t count, std::size_t first) const {
    constexpr std::size_t kMostOnRing = 1000;  // all of which it may begin with; reasoned: few polygons have as many
    using Point = std::array<double, 3>;
    std::set<std::pair<Point, Point>> sides;
    for (std::size_t i = 0; i + 2 < count && count <= kMostOnRing; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d &a = triangles_.positions[triangles_.face(first + i)[k]],
                    &b = triangles_.positions[triangles_.face(first + i)[(k + 1) % 3]];
        const Point from = {a[0], a[1], a[2]}, to = {b[0], b[1], b[2]};
        if (sides.erase({to, from}) == 0) sides.insert({from, to});
      }
    std::map<Point, Point> next(sides.begin(), sides.end());
    if (next.size() != count || sides.size() != count) return {};
    std::vector<Vec3d> ring;
    for (Point at = next.begin()->first; !next.empty();) {
      const auto side = next.find(at);
      if (side == next.end()) return {};
      ring.emplace_back(at[0], at[1], at[2]);
      at = side->second;
      next.erase(side);
    }
    return ring;
  }

  template <class Visit>
  void for_each_corner(const Split& split, std::size_t first, Visit&& visit) const {
    for (std::size_t i = 0; i < split.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) visit(split[i][k], triangles_.positions[triangles_.face(first + i)[k]]);
  }

  /// The sum of the squared displacements of the corners. None if corners of one vertex are at different positions.
  std::optional<double> squared_displacements(const Split& split, std::size_t first) const {
    std::vector<std::pair<std::uint32_t, Vec3d>> found;
    bool fits = true;
    double way = 0;
    for_each_corner(split, first, [&](std::uint32_t v, const Vec3d& there) {
      fits = fits && (!known_[v] || position_[v] == there);
      way += (there - mesh_.positions[v]).lengthSqr();
      found.emplace_back(v, there);
    });
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 1; i < found.size(); ++i)
      fits = fits && (found[i].first != found[i - 1].first || found[i].second == found[i - 1].second);
    return fits ? std::optional(way) : std::nullopt;
  }

  PolygonView mesh_, triangles_;
  std::vector<Vec3d> position_;
  std::vector<std::uint8_t> known_;
  Split split_;  // how the file splits the faces
};

}  // namespace

std::optional<InTriangles> find_in_triangles(PolygonView mesh, PolygonView triangles) {
  return TrianglePlaces(mesh, triangles).find();
}

}  // namespace vdb_offset::io
