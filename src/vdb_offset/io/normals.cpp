#include "vdb_offset/io/normals.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace vdb_offset::io {
namespace {

// Vertices that share a normal disagree if theirs are farther apart than this: about two degrees.
constexpr double kLeastCosine = 0.9994;

std::uint32_t normal_of(const MeshFile& source, std::size_t face, std::size_t corner, std::uint32_t vertex) {
  if (source.format == Format::Stl) return static_cast<std::uint32_t>(face);
  if (source.format == Format::Obj) return source.corner_normal.empty() ? kNoNormal : source.corner_normal[corner];
  return vertex;
}

/// Calls visit(normal, vertex, corner's face normal times its angle, whether the face moved) for every face corner that
/// names a normal.
template <class Visit>
void for_each_corner(const MeshFile& source, std::span<const Vec3d> positions, const std::vector<std::uint8_t>& moved,
                     Visit&& visit) {
  const PolygonView mesh = source.polygons.view();
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.face(f);
    const bool face_moved = std::any_of(face.begin(), face.end(), [&](auto v) { return moved[v] != 0; });
    for (std::size_t k = 0; k < face.size(); ++k) {
      const std::uint32_t normal = normal_of(source, f, mesh.face_begin[f] + k, face[k]);
      if (normal == kNoNormal) continue;
      const Vec3d& tip = positions[face[k]];
      const Vec3d next = positions[face[(k + 1) % face.size()]] - tip,
                  previous = positions[face[(k + face.size() - 1) % face.size()]] - tip, across = next.cross(previous);
      const double sine = across.length();
      const Vec3d weighted = sine > 0 ? across * (std::atan2(sine, next.dot(previous)) / sine) : Vec3d(0.0);
      visit(normal, face[k], weighted, face_moved);
    }
  }
}

/// OBJ normals can be shared by several vertices, and what these ask for may come apart.
std::size_t count_disagreeing(const MeshFile& source, std::span<const Vec3d> positions,
                              const std::vector<std::uint8_t>& moved, const std::vector<Vec3d>& value) {
  if (source.format != Format::Obj) return 0;
  std::vector<std::uint32_t> first(value.size(), kNoNormal);
  std::vector<std::uint8_t> shared(value.size(), 0);
  for (std::size_t c = 0; c < source.corner_normal.size(); ++c) {
    const std::uint32_t n = source.corner_normal[c], v = source.polygons.corners[c];
    if (n == kNoNormal) continue;
    if (first[n] == kNoNormal) first[n] = v;
    shared[n] |= first[n] != v;
  }
  std::vector<std::tuple<std::uint32_t, std::uint32_t, Vec3d>> asked;
  for_each_corner(source, positions, moved, [&](std::uint32_t n, std::uint32_t v, const Vec3d& weighted, bool) {
    if (shared[n]) asked.emplace_back(n, v, weighted);
  });
  std::stable_sort(asked.begin(), asked.end(), [](const auto& a, const auto& b) {
    return std::tie(std::get<0>(a), std::get<1>(a)) < std::tie(std::get<0>(b), std::get<1>(b));
  });
  std::vector<std::uint8_t> disagrees(value.size(), 0);
  for (std::size_t i = 0; i < asked.size();) {
    const auto [normal, vertex, ignored] = asked[i];
    Vec3d sum(0.0);
    for (; i < asked.size() && std::get<0>(asked[i]) == normal && std::get<1>(asked[i]) == vertex; ++i)
      sum += std::get<2>(asked[i]);
    if (value[normal].lengthSqr() > 0 && sum.dot(value[normal]) < kLeastCosine * sum.length()) disagrees[normal] = 1;
  }
  return static_cast<std::size_t>(std::count(disagrees.begin(), disagrees.end(), 1));
}

}  // namespace

NewNormals new_normals(const MeshFile& source, std::span<const Vec3d> positions,
                       const std::vector<std::uint8_t>& moved) {
  NewNormals normals;
  normals.value.assign(source.normal_at.size(), Vec3d(0.0));
  std::vector<std::uint8_t> affected(source.normal_at.size(), 0);
  for_each_corner(source, positions, moved,
                  [&](std::uint32_t n, std::uint32_t, const Vec3d& weighted, bool face_moved) {
                    normals.value[n] += weighted;
                    affected[n] |= face_moved;
                  });
  for (std::size_t n = 0; n < normals.value.size(); ++n) {
    const double length = normals.value[n].length();
    normals.value[n] = affected[n] && length > 0 ? normals.value[n] / length : Vec3d(0.0);
  }
  normals.disagreeing = count_disagreeing(source, positions, moved, normals.value);
  return normals;
}

}  // namespace vdb_offset::io
