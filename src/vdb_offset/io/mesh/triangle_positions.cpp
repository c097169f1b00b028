// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/mesh_file.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>

#include "vdb_offset/mesh/triangulate.h"

namespace vdb_offset::io {
namespace {

using Split = std::vector<std::array<std::uint32_t, 3>>;

class TrianglePlaces {
 public:
  TrianglePlaces(PolygonView mesh, PolygonView triangles)
      : mesh_(mesh),
        triangles_(triangles),
        position_(mesh.positions.begin(), mesh.positions.end()),
        known_(position_.size(), 0) {}

  /// Finds the positions. Triangles and quads can only be split in one way, and go first: larger polygons are matched
  /// with the corners that are known from them.
  std::optional<std::vector<Vec3d>> find() {
    std::size_t count = 0;
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) count += mesh_.face(f).size() - 2;
    if (count != triangles_.face_count()) return std::nullopt;
    for (const bool large : {false, true}) {
      std::size_t first = 0;
      for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
        const auto face = mesh_.face(f);
        if ((face.size() > kQuad) == large && !take(face, first)) return std::nullopt;
        first += face.size() - 2;
      }
    }
    return std::move(position_);
  }

 private:
  static constexpr std::size_t kQuad = 4;  // corners

  /// Takes the positions of a polygon's corners from its triangles. These are those of the offset, in which the polygon
  /// is split around its first corner or as in the source. Where both are possible, the corners have moved less far.
  bool take(std::span<const std::uint32_t> face, std::size_t first) {
    Split fan, ears;
    for (std::size_t k = 2; k < face.size(); ++k) fan.push_back({face[0], face[k - 1], face[k]});
    if (face.size() > kQuad) triangulate(mesh_.positions, face, ears);
    const std::optional<double> by_fan = squared_displacements(fan, first),
                                by_ears = ears.empty() ? std::nullopt : squared_displacements(ears, first);
    if (!by_fan && !by_ears) return false;
    const Split& split = !by_fan || (by_ears && *by_ears < *by_fan) ? ears : fan;
    for_each_corner(split, first, [&](std::uint32_t v, const Vec3d& there) {
      known_[v] = 1;
      position_[v] = there;
    });
    return true;
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
};

}  // namespace

std::optional<std::vector<Vec3d>> positions_in_triangles(PolygonView mesh, PolygonView triangles) {
  return TrianglePlaces(mesh, triangles).find();
}

}  // namespace vdb_offset::io
