// SPDX-License-Identifier: Apache-2.0
#include "products/arcs/opened_mesh.h"

#include <array>
#include <limits>
#include <numeric>

#include "ground/distances/layer_heights.h"
#include "ground/mesh/point_triangle.h"
#include "ground/numbers/index_set.h"
#include "products/offset/stand_off.h"
#include "valid/faults/triangle_crossings.h"

namespace vdb_offset {
namespace {

using Triangle = std::array<Vec3d, 3>;

/// Adds the point in which a side of one triangle goes through another.
void add_piercing(const Triangle& one, const Triangle& other, Vec3d& sum, int& count) {
  const Vec3d normal = (other[1] - other[0]).cross(other[2] - other[0]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d &a = one[k], &b = one[(k + 1) % 3];
    const double from = normal.dot(a - other[0]), to = normal.dot(b - other[0]);
    if (from * to > 0 || from == to) continue;
    const Vec3d x = a + (b - a) * (from / (from - to));
    if (closest_on_triangle(x, other[0], other[1], other[2]).squared_distance > 1e-12 * normal.length()) continue;
    sum += x;
    ++count;
  }
}
/// About where two triangles meet.
Vec3d meeting_point(const Triangle& s, const Triangle& t) {
  Vec3d sum(0.0);
  int count = 0;
  add_piercing(s, t, sum, count);
  add_piercing(t, s, sum, count);
  if (count > 0) return sum / count;
  return (s[0] + s[1] + s[2] + t[0] + t[1] + t[2]) / 6.0;
}

/// Finds opened vertices whose faces meet at once, as their strips are in each other's way at any distance.
class TangleFinder {
 public:
  TangleFinder(const PreparedMesh& mesh, const OpenedSource::Faces& faces) : mesh_(mesh), faces_(faces) {}

  /// Vertices of the source's surface, sorted.
  Indices operator()() const {
    Indices vertices;
    for (const auto& [s, t] : CrossingFinder(mesh_.surface(), mesh_.source()).listed().pairs)
      add_common(s, t, vertices);
    sort_unique(vertices);
    return vertices;
  }

 private:
  /// Adds the opened vertex that two triangles are both at, and meet beside.
  void add_common(std::uint32_t s, std::uint32_t t, Indices& vertices) const {
    const Surface& surface = mesh_.surface();
    const std::span<const Vec3d> positions = mesh_.source();
    const auto at = [&](std::uint32_t triangle) {
      const auto& [a, b, c] = surface.triangles[triangle];
      return std::array{positions[a], positions[b], positions[c]};
    };
    const Vec3d meeting = meeting_point(at(s), at(t));
    double nearest = std::numeric_limits<double>::infinity();
    std::uint32_t vertex = kNone;
    for (const std::uint32_t a : surface.triangles[s])
      for (const std::uint32_t b : surface.triangles[t]) {
        const std::uint32_t v = surface.representative[a], w = surface.representative[b];
        if (v == kNone || w == kNone || faces_.vertex[v] != faces_.vertex[w]) continue;
        if (!faces_.is_opened[v] && !faces_.is_opened[w]) continue;
        const double distance = (positions[a] - meeting).lengthSqr();
        if (distance < nearest) nearest = distance, vertex = faces_.vertex[v];
      }
    if (vertex != kNone) vertices.push_back(vertex);
  }

  const PreparedMesh& mesh_;
  const OpenedSource::Faces& faces_;
};

}  // namespace

std::vector<std::uint32_t> origins_of(const Refinement& refinement) {
  std::vector<std::uint32_t> origins(refinement.source_vertices());
  std::iota(origins.begin(), origins.end(), 0u);
  for (const VertexOrigin& origin : refinement.added) origins.push_back(origin.vertex[0]);
  return origins;
}

OpenedMesh::OpenedMesh(const PreparedMesh& source, const OpenedSource::Faces& faces,
                       std::span<const Distances> distances, const Yield& yield, int threads)
    : polygons_(faces.refinement.polygons), options_(source.options()), targets_(faces.targets) {
  const Surface& surface = source.surface();
  for (std::size_t v = 0; v < polygons_.positions.size(); ++v) {
    const std::uint32_t w = faces.vertex[v];
    if (w == kNone) continue;
    const Vec3d at = source.mesh().positions[surface.representative[w]];
    polygons_.positions[v] = stand_off(at, targets_.displacement[v]);
    targets_.displacement[v] = (at + targets_.displacement[v]) - polygons_.positions[v];
  }
  options_.reserve = {};     // the source's run has asked for memory
  options_.weld = {};        // by position alone: copies stand close to each other
  options_.exact = nullptr;  // it knows the source's faces and vertices alone
  if (!options_.only.empty()) {
    options_.only.clear();
    for (const std::uint32_t f : faces.refinement.parent) options_.only.push_back(source.options().only[f]);
  }
  distances_ = copied_to(distances, origins_of(faces.refinement));
  options_.distance = distances_.back();
  space_.emplace(polygons_.view(), options_.metric);
  Yield of_opened = yield;
  of_opened.measured_faces = static_cast<std::uint32_t>(faces.refinement.faces_in_place());
  prepared_.emplace(*space_, options_, threads, farthest_of(std::span(distances_).last(1)), of_opened);
}

std::unique_ptr<OpenedMesh> open_without_tangles(const PreparedMesh& source, OpenedSource& opened,
                                                 std::span<const Distances> distances, const Yield& yield, int threads,
                                                 OpenedSource::Faces& faces) {
  // Rounds in which ridges are closed again. Not measured: one is nearly always enough.
  constexpr int kMostClosings = 4;
  for (int closings = 0;; ++closings) {
    faces = opened.faces();
    if (opened.empty()) return nullptr;
    auto mesh = std::make_unique<OpenedMesh>(source, faces, distances, yield, threads);
    const Indices tangled = closings < kMostClosings ? TangleFinder(mesh->prepared(), faces)() : Indices{};
    if (tangled.empty()) return mesh;
    opened.close(tangled);
  }
}

}  // namespace vdb_offset
