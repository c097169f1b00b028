#include "vdb_offset/io/triangle_places.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "vdb_offset/triangulate.h"

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

  std::optional<std::vector<Vec3d>> find() {
    std::size_t count = 0;
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) count += mesh_.face(f).size() - 2;
    if (count != triangles_.face_count() || 3 * count != triangles_.positions.size()) return std::nullopt;
    std::size_t first = 0;
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
      const auto face = mesh_.face(f);
      if (!take(face, first)) return std::nullopt;
      first += face.size() - 2;
    }
    return std::move(place_);
  }

 private:
  /// A polygon is split as it is after the offset, which is not known: mostly around its first corner, or as before.
  bool take(std::span<const std::uint32_t> face, std::size_t first) {
    Split split;
    for (std::size_t k = 2; k < face.size(); ++k) split.push_back({face[0], face[k - 1], face[k]});
    if (fits(split, first)) return true;
    split.clear();
    triangulate(mesh_.positions, face, split);
    return fits(split, first);
  }

  /// Takes the corners of a split, if all of a vertex are in one place.
  bool fits(const Split& split, std::size_t first) {
    std::vector<std::uint32_t> found;
    for (std::size_t i = 0; i < split.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t v = split[i][k];
        const Vec3d& there = triangles_.positions[triangles_.face(first + i)[k]];
        if (!known_[v]) {
          known_[v] = 1;
          place_[v] = there;
          found.push_back(v);
        } else if (place_[v] != there) {
          for (const auto w : found) known_[w] = 0;
          return false;
        }
      }
    return true;
  }

  PolygonView mesh_, triangles_;
  std::vector<Vec3d> place_;
  std::vector<std::uint8_t> known_;
};

}  // namespace

std::optional<std::vector<Vec3d>> places_in_triangles(PolygonView mesh, PolygonView triangles) {
  return TrianglePlaces(mesh, triangles).find();
}

}  // namespace vdb_offset::io
