// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/triangle_positions.h"

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
        place_(mesh.positions.begin(), mesh.positions.end()),
        known_(place_.size(), 0) {}

  /// Triangles and quads are split in one way; larger polygons go by the corners that these tell.
  std::optional<std::vector<Vec3d>> find() {
    std::size_t count = 0;
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) count += mesh_.face(f).size() - 2;
    if (count != triangles_.face_count() || 3 * count != triangles_.positions.size()) return std::nullopt;
    for (const bool large : {false, true}) {
      std::size_t first = 0;
      for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
        const auto face = mesh_.face(f);
        if ((face.size() > kQuad) == large && !take(face, first)) return std::nullopt;
        first += face.size() - 2;
      }
    }
    return std::move(place_);
  }

 private:
  static constexpr std::size_t kQuad = 4;  // corners

  /// A polygon is split as it is after the offset, which is not known: around its first corner, or as before. Where
  /// both could be, its corners are where they have gone less far.
  bool take(std::span<const std::uint32_t> face, std::size_t first) {
    Split fan, ears;
    for (std::size_t k = 2; k < face.size(); ++k) fan.push_back({face[0], face[k - 1], face[k]});
    if (face.size() > kQuad) triangulate(mesh_.positions, face, ears);
    const std::optional<double> by_fan = way_of(fan, first),
                                by_ears = ears.empty() ? std::nullopt : way_of(ears, first);
    if (!by_fan && !by_ears) return false;
    const Split& split = !by_fan || (by_ears && *by_ears < *by_fan) ? ears : fan;
    for_each_corner(split, first, [&](std::uint32_t v, const Vec3d& there) {
      known_[v] = 1;
      place_[v] = there;
    });
    return true;
  }

  template <class Visit>
  void for_each_corner(const Split& split, std::size_t first, Visit&& visit) const {
    for (std::size_t i = 0; i < split.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) visit(split[i][k], triangles_.positions[triangles_.face(first + i)[k]]);
  }

  /// How far corners have gone, squared and summed up; none if those of a vertex are apart.
  std::optional<double> way_of(const Split& split, std::size_t first) const {
    std::vector<std::pair<std::uint32_t, Vec3d>> found;
    bool fits = true;
    double way = 0;
    for_each_corner(split, first, [&](std::uint32_t v, const Vec3d& there) {
      fits = fits && (!known_[v] || place_[v] == there);
      way += (there - mesh_.positions[v]).lengthSqr();
      found.emplace_back(v, there);
    });
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 1; i < found.size(); ++i)
      fits = fits && (found[i].first != found[i - 1].first || found[i].second == found[i - 1].second);
    return fits ? std::optional(way) : std::nullopt;
  }

  PolygonView mesh_, triangles_;
  std::vector<Vec3d> place_;
  std::vector<std::uint8_t> known_;
};

}  // namespace

std::optional<std::vector<Vec3d>> positions_in_triangles(PolygonView mesh, PolygonView triangles) {
  return TrianglePlaces(mesh, triangles).find();
}

}  // namespace vdb_offset::io
