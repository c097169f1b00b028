// SPDX-License-Identifier: Apache-2.0
// Rossignac, Borrel: Multi-resolution 3D approximations for rendering complex scenes. 1993.
#include "page/view_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "ground/mesh/triangulate.h"

namespace vdb_offset::io {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// Whether an element's side is a side of the polygon that it is cut from.
class SidesOfPolygon {
 public:
  explicit SidesOfPolygon(std::span<const std::uint32_t> polygon) {
    for (std::size_t k = 0; k < polygon.size(); ++k) sides_.emplace_back(polygon[k], polygon[(k + 1) % polygon.size()]);
    std::sort(sides_.begin(), sides_.end());
  }

  bool contain(std::uint32_t from, std::uint32_t to) const {
    return std::binary_search(sides_.begin(), sides_.end(), std::pair{from, to});
  }

 private:
  std::vector<std::pair<std::uint32_t, std::uint32_t>> sides_;
};

/// The mesh's own triangles; corners are the mesh's vertices.
ViewMesh triangles_of(PolygonView mesh) {
  ViewMesh view;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto polygon = mesh.face(f);
    if (polygon.size() < 3) continue;
    triangles.clear();
    triangulate(mesh.positions, polygon, triangles);
    const SidesOfPolygon sides(polygon);
    for (const auto& triangle : triangles) {
      std::uint8_t edges = 0;
      for (unsigned k = 0; k < 3; ++k)
        if (sides.contain(triangle[k], triangle[(k + 1) % 3])) edges |= static_cast<std::uint8_t>(1U << k);
      view.corners.insert(view.corners.end(), triangle.begin(), triangle.end());
      view.face.push_back(static_cast<std::uint32_t>(f));
      view.edges.push_back(edges);
    }
  }
  return view;
}

ViewMesh segments_of(PolygonView curves) {
  ViewMesh view;
  view.size_of_element = 2;
  for (std::size_t f = 0; f < curves.face_count(); ++f) {
    const auto curve = curves.face(f);
    for (std::size_t k = 1; k < curve.size(); ++k) {
      view.corners.insert(view.corners.end(), {curve[k - 1], curve[k]});
      view.face.push_back(static_cast<std::uint32_t>(f));
      view.edges.push_back(1);
    }
  }
  return view;
}

/// Numbers the vertices that are in use, and the corners by them.
void number_vertices(ViewMesh& view, std::size_t vertices) {
  std::vector<std::uint32_t> number(vertices, kNone);
  for (const std::uint32_t v : view.corners) number[v] = 0;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (number[v] == kNone) continue;
    number[v] = static_cast<std::uint32_t>(view.vertices.size());
    view.vertices.push_back(v);
  }
  for (std::uint32_t& v : view.corners) v = number[v];
}

/// The box around the vertices in use, how large their elements are, and where their faces point to.
struct Shape {
  Vec3d low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};
  double size = 0;                      ///< Area; of curves length.
  std::vector<std::uint8_t> direction;  ///< Of each vertex: the main one of six. Of curves: none.
};

std::uint8_t main_direction(const Vec3d& normal) {
  int axis = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
  return static_cast<std::uint8_t>(2 * axis + (normal[axis] < 0 ? 1 : 0));
}

Shape shape_of(std::span<const Vec3d> positions, const ViewMesh& whole) {
  Shape shape;
  const std::size_t size = whole.size_of_element;
  std::vector<Vec3d> normals(size == 3 ? positions.size() : 0, Vec3d(0.0));
  for (std::size_t e = 0; e < whole.element_count(); ++e) {
    const std::uint32_t* const corner = &whole.corners[size * e];
    for (std::size_t k = 0; k < size; ++k)
      for (int axis = 0; axis < 3; ++axis) {
        shape.low[axis] = std::min(shape.low[axis], positions[corner[k]][axis]);
        shape.high[axis] = std::max(shape.high[axis], positions[corner[k]][axis]);
      }
    const Vec3d along = positions[corner[1]] - positions[corner[0]];
    if (size == 2) {
      shape.size += along.length();
      continue;
    }
    const Vec3d normal = along.cross(positions[corner[2]] - positions[corner[0]]);
    shape.size += normal.length() / 2;
    for (std::size_t k = 0; k < size; ++k) normals[corner[k]] += normal;
  }
  shape.direction.resize(positions.size());
  std::transform(normals.begin(), normals.end(), shape.direction.begin(), main_direction);
  return shape;
}

/// Of each vertex, the one that stands for all in its cell.
std::vector<std::uint32_t> clustered(std::span<const Vec3d> positions, const Shape& shape,
                                     std::span<const float> weight, double cell) {
  constexpr std::uint64_t kBits = 20, kMost = (std::uint64_t{1} << kBits) - 1;  // three of them, and a direction
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    std::uint64_t key = shape.direction[v];
    for (int axis = 0; axis < 3; ++axis) {
      const double at = std::clamp((positions[v][axis] - shape.low[axis]) / cell, 0.0, static_cast<double>(kMost));
      key = key << kBits | static_cast<std::uint64_t>(at);
    }
    keys[v] = {key, v};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> stands(positions.size());
  for (std::size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
    std::uint32_t best = keys[begin].second;
    for (end = begin; end < keys.size() && keys[end].first == keys[begin].first; ++end)
      if (weight[keys[end].second] > weight[best]) best = keys[end].second;
    for (std::size_t k = begin; k < end; ++k) stands[keys[k].second] = best;
  }
  return stands;
}

/// What is left of the elements if each vertex is replaced: those whose corners still differ.
ViewMesh replaced(const ViewMesh& whole, std::span<const std::uint32_t> stands) {
  ViewMesh view;
  const std::size_t size = view.size_of_element = whole.size_of_element;
  for (std::size_t e = 0; e < whole.element_count(); ++e) {
    std::array<std::uint32_t, 3> corner{};
    for (std::size_t k = 0; k < size; ++k) corner[k] = stands[whole.corners[size * e + k]];
    if (corner[0] == corner[1] || (size == 3 && (corner[1] == corner[2] || corner[2] == corner[0]))) continue;
    view.corners.insert(view.corners.end(), corner.begin(), corner.begin() + static_cast<std::ptrdiff_t>(size));
    view.face.push_back(whole.face[e]);
    view.edges.push_back(whole.edges[e]);
  }
  return view;
}

ViewMesh decimated(std::span<const Vec3d> positions, const ViewMesh& whole, std::span<const float> weight,
                   std::size_t most) {
  const Shape shape = shape_of(positions, whole);
  const double count = static_cast<double>(most);
  // A cell of a triangle's size leaves about two triangles; of curves, about one segment.
  double cell = whole.size_of_element == 3 ? std::sqrt(2 * shape.size / count) : shape.size / count;
  // Without a size to go by, all is in few places.
  if (!(cell > 0)) cell = std::max((shape.high - shape.low).length() / count, std::numeric_limits<double>::min());
  constexpr double kStep = 1.15;  // how much coarser the next try is; not measured
  for (;; cell *= kStep) {
    ViewMesh view = replaced(whole, clustered(positions, shape, weight, cell));
    if (view.element_count() <= most) return view;
  }
}

}  // namespace

ViewMesh view_of(PolygonView mesh, bool are_curves, std::span<const float> weight, std::size_t most) {
  ViewMesh view = are_curves ? segments_of(mesh) : triangles_of(mesh);
  const std::size_t elements = view.element_count();
  if (elements > most) view = decimated(mesh.positions, view, weight, most);
  view.elements_of_mesh = elements;
  number_vertices(view, mesh.positions.size());
  return view;
}

}  // namespace vdb_offset::io
