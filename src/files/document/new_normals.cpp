// SPDX-License-Identifier: Apache-2.0
// Computes normals of a file anew where faces moved. The corners that name each normal are listed by a counting sort;
// the new normal is the sum, over these corners, of the unit normal there times the corner's angle, brought to length
// 1. It is computed only if a vertex of one of those faces moved; any other normal is marked as one that stays. In
// files that are no rows, vertices with equal positions and normals, as seams split them, share the new one. STL gets
// the normal of each facet. OBJ normals that stand for vertices with clearly different ones now are counted. Positions
// are taken as they will be written. Normals are summed up in the file's order, each by one thread, so that the result
// does not depend on their number.
#include "document/new_normals.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <numeric>

#include "document/rows.h"
#include "ground/numbers/rounding.h"
#include "ground/system/parallel.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {
namespace {

// Least cosine between the normals of vertices that share one, about two degrees: farther apart, they disagree. Not
// measured.
constexpr double kLeastCosine = 0.9994;

/// A face corner.
struct Corner {
  std::uint32_t face, index;  // index within all corners
};

/// The corners that name each normal: those of normal n are corners[begin[n] .. begin[n + 1]), in the file's order.
struct Users {
  std::vector<std::uint32_t> begin;
  std::vector<Corner> corners;

  std::span<const Corner> of(std::size_t normal) const {
    return std::span(corners).subspan(begin[normal], begin[normal + 1] - begin[normal]);
  }
};

/// A position and the normal of the vertex there, by their bits: normals may be no numbers.
std::array<std::uint64_t, 6> bits_of(const Vec3d& position, const Vec3d& normal) {
  std::array<std::uint64_t, 6> bits;
  for (int k = 0; k < 3; ++k) {
    bits[k] = std::bit_cast<std::uint64_t>(position[k] + 0.0);  // of both zeros the same
    bits[k + 3] = std::bit_cast<std::uint64_t>(normal[k] + 0.0);
  }
  return bits;
}

/// Which normal each corner names.
class CornerNormals {
 public:
  explicit CornerNormals(const MeshFile& source) : source_(source) {
    if (const Rows* const rows = source.document->rows()) corner_normal_ = rows->corner_normal;
    else join_split_vertices();
  }

  std::uint32_t operator()(std::size_t corner) const {
    if (source_.document->normals_of() == NormalsOf::Corners)
      return corner_normal_.empty() ? kNoNormal : corner_normal_[corner];
    return of_vertex(source_.polygons.corners[corner]);
  }
  /// The normal that a vertex shares, in formats that have one for each.
  std::uint32_t of_vertex(std::uint32_t v) const { return shared_.empty() ? v : shared_[v]; }

 private:
  /// Vertices that a seam of the texture splits have the same position and normal. They share the new one too, else the
  /// seam would be seen.
  void join_split_vertices() {
    const std::vector<Vec3d> normals = read_attributes(source_).normals.value;
    if (normals.size() != source_.polygons.positions.size()) return;
    const std::vector<Vec3d>& positions = source_.polygons.positions;
    std::vector<std::uint32_t> order(normals.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](std::uint32_t v) { return bits_of(positions[v], normals[v]); };
    tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      const auto of_a = key(a), of_b = key(b);
      return of_a != of_b ? of_a < of_b : a < b;
    });
    shared_.resize(normals.size());
    for (std::size_t i = 0; i < order.size(); ++i)
      shared_[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? shared_[order[i - 1]] : order[i];
  }

  const MeshFile& source_;
  std::span<const std::uint32_t> corner_normal_;
  std::vector<std::uint32_t> shared_;
};

/// Calls visit(face, corner, normal) for the corners that name a normal, in the file's order.
template <class Visit>
void for_each_user(const MeshFile& source, const CornerNormals& normal_of, std::span<const std::uint32_t> faces,
                   Visit&& visit) {
  const PolygonView mesh = source.polygons.view();
  const std::size_t count = faces.empty() ? mesh.face_count() : faces.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t f = faces.empty() ? static_cast<std::uint32_t>(i) : faces[i];
    for (std::uint32_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c)
      if (const std::uint32_t n = normal_of(c); n != kNoNormal) visit(f, c, n);
  }
}

Users find_users(const MeshFile& source, const CornerNormals& normal_of, std::span<const std::uint32_t> faces) {
  Users users;
  users.begin.assign(source.normal_count + 2, 0);
  for_each_user(source, normal_of, faces, [&](auto, auto, std::uint32_t n) { ++users.begin[n + 2]; });
  std::partial_sum(users.begin.begin(), users.begin.end(), users.begin.begin());
  users.corners.resize(users.begin.back());
  for_each_user(source, normal_of, faces, [&](std::uint32_t f, std::uint32_t c, std::uint32_t n) {
    users.corners[users.begin[n + 1]++] = {f, c};
  });
  users.begin.pop_back();
  return users;
}

/// The face's normal at a corner times the corner's angle.
Vec3d weighted_normal(PolygonView mesh, std::span<const Vec3d> positions, const Corner& corner) {
  const auto face = mesh.face(corner.face);
  const std::size_t k = corner.index - mesh.face_begin[corner.face], size = face.size();
  const Vec3d& tip = positions[face[k]];
  const Vec3d next = positions[face[(k + 1) % size]] - tip, previous = positions[face[(k + size - 1) % size]] - tip,
              across = next.cross(previous);
  const double sine = across.length();
  return sine > 0 ? across * (std::atan2(sine, next.dot(previous)) / sine) : Vec3d(0.0);
}

bool any_moved(std::span<const std::uint32_t> face, const std::vector<std::uint8_t>& moved) {
  return std::any_of(face.begin(), face.end(), [&](auto v) { return moved[v] != 0; });
}

Vec3d unit_or_zero(const Vec3d& v) {
  const double length = v.length();
  return length > 0 ? v / length : Vec3d(0.0);
}

/// Whether vertices that share a normal have different ones now.
bool disagree(PolygonView mesh, std::span<const Vec3d> positions, std::span<const Corner> users, const Vec3d& mean) {
  const auto vertex = [&](const Corner& corner) { return mesh.corners[corner.index]; };
  const auto same = [&](const Corner& a) { return vertex(a) == vertex(users.front()); };
  if (std::all_of(users.begin(), users.end(), same)) return false;
  std::vector<Corner> by_vertex(users.begin(), users.end());
  std::stable_sort(by_vertex.begin(), by_vertex.end(),
                   [&](const Corner& a, const Corner& b) { return vertex(a) < vertex(b); });
  for (std::size_t i = 0; i < by_vertex.size();) {
    const std::uint32_t v = vertex(by_vertex[i]);
    Vec3d sum(0.0);
    for (; i < by_vertex.size() && vertex(by_vertex[i]) == v; ++i)
      sum += weighted_normal(mesh, positions, by_vertex[i]);
    if (sum.dot(mean) < kLeastCosine * sum.length()) return true;
  }
  return false;
}

/// New normals for STL, which has one for each facet.
NewNormals facet_normals(PolygonView mesh, std::span<const Vec3d> positions, const std::vector<std::uint8_t>& moved) {
  NewNormals normals;
  normals.value.assign(mesh.face_count(), Vec3d(0.0));
  for_each_index(mesh.face_count(), [&](std::size_t f) {
    const auto face = mesh.face(f);
    const Vec3d &a = positions[face[0]], &b = positions[face[1]], &c = positions[face[2]];
    if (any_moved(face, moved)) normals.value[f] = unit_or_zero((b - a).cross(c - a));
  });
  return normals;
}

NewNormals normals_of_moved(const MeshFile& source, PolygonView mesh, std::span<const std::uint32_t> faces,
                            const std::vector<std::uint8_t>& moved) {
  const std::span<const Vec3d> positions = mesh.positions;
  if (source.document->normals_of() == NormalsOf::Facets) return facet_normals(mesh, positions, moved);
  NewNormals normals;
  normals.value.assign(source.normal_count, Vec3d(0.0));
  if (std::none_of(moved.begin(), moved.end(), [](auto each) { return each != 0; })) return normals;
  const CornerNormals normal_of(source);
  const Users users = find_users(source, normal_of, faces);
  const bool is_of_corners = source.document->normals_of() == NormalsOf::Corners;
  std::atomic<std::size_t> disagreeing = 0;
  for_each_index(normals.value.size(), [&](std::size_t n) {
    Vec3d sum(0.0);
    bool affected = false;
    for (const Corner& corner : users.of(n)) {
      sum += weighted_normal(mesh, positions, corner);
      affected = affected || any_moved(mesh.face(corner.face), moved);
    }
    if (!affected) return;
    normals.value[n] = unit_or_zero(sum);
    if (is_of_corners && disagree(mesh, positions, users.of(n), normals.value[n])) ++disagreeing;
  });
  normals.disagreeing = disagreeing;
  if (!source.document->rows())
    for (std::uint32_t v = 0; v < normals.value.size(); ++v) normals.value[v] = normals.value[normal_of.of_vertex(v)];
  return normals;
}

}  // namespace

NewNormals new_normals(const MeshFile& source, std::span<const Vec3d> positions, const Rounding& precision,
                       const PlacedFaces& placed) {
  if (source.normal_count == 0) return {};
  std::vector<Vec3d> stored(positions.size());
  std::vector<std::uint8_t> moved(positions.size());
  for_each_index(positions.size(), [&](std::size_t v) {
    const Vec3d& before = source.polygons.positions[placed.origin.empty() ? v : placed.origin[v]];
    moved[v] = has_moved(before, positions[v], precision);
    stored[v] = moved[v] ? precision(before, positions[v]) : before;
  });
  const std::span<const std::uint32_t> corners =
      placed.corners.empty() ? std::span(source.polygons.corners) : placed.corners;
  return normals_of_moved(source, {stored, corners, source.polygons.face_begin}, placed.faces, moved);
}

}  // namespace vdb_offset::io
