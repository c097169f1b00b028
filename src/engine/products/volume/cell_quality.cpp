// SPDX-License-Identifier: Apache-2.0
// Measures cells: scaled Jacobian, aspect ratio, volume, and the angle at the wall. The scaled Jacobian is the least
// triple product of unit edge vectors over the corners, as in Verdict, and 1 for a regular cell; of prisms and
// hexahedra squares with a sign are compared, and one root is taken at the end. Pyramids have that of their worst
// tetrahedron, polyhedra that of a prism over a polygon, and plane cells the least sine of a corner. Volumes are sums
// over faces, each a fan from its corner of the lowest number, so that cells on both sides agree on a bent face. The
// volume of all cells is summed up over the boundary, in blocks of a fixed size that are added in order. Cells are
// measured as they are; what is invalid is decided elsewhere.
#include "products/volume/cell_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "products/volume/cell_faces.h"
#include "products/volume/polygon_prism.h"
#include "products/volume/prism_quality.h"

namespace vdb_offset {
namespace {

/// The positions of a cell's corners.
struct CellPoints {
  const VolumeMesh& mesh;
  std::span<const std::uint32_t> corners;

  const Vec3d& operator[](std::size_t k) const { return mesh.points[corners[k]]; }
  double at_corner(std::size_t k, std::size_t a, std::size_t b, std::size_t c) const {
    const Vec3d& x = (*this)[k];
    return unit_triple((*this)[a] - x, (*this)[b] - x, (*this)[c] - x);
  }
};

/// The scaled Jacobian of a tetrahedron: its triple products are the same at all corners, so that the scaled one is
/// least in size where the edges are longest. That one counts if it is below 0, too.
double tetrahedron_jacobian(const CellPoints& x, std::size_t a, std::size_t b, std::size_t c, std::size_t apex) {
  return std::numbers::sqrt2 * std::min({x.at_corner(a, b, c, apex), x.at_corner(b, c, a, apex),
                                         x.at_corner(c, a, b, apex), x.at_corner(apex, b, a, c)},
                                        [](double p, double q) { return std::abs(p) < std::abs(q); });
}

/// The scaled Jacobian of a pyramid: the least of its four tetrahedra, scaled so that a pyramid with edges of one
/// length, where each has 1 / sqrt 2, has 1.
double pyramid_jacobian(const CellPoints& x) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 4; ++k) least = std::min(least, tetrahedron_jacobian(x, k, (k + 1) % 4, (k + 2) % 4, 4));
  least *= std::numbers::sqrt2;
  return least < 1 ? least : 2 - least;
}

/// The least and the largest squared length of a cell's edges.
struct EdgeLengths {
  double least = std::numeric_limits<double>::infinity(), most = 0;

  void add(double squared) {
    least = std::min(least, squared);
    most = std::max(most, squared);
  }
  double ratio() const { return least > 0 ? std::sqrt(most / least) : std::numeric_limits<double>::infinity(); }
};

Vec3Of<double> one_lane(const Vec3d& x) { return {x[0], x[1], x[2]}; }

CellQuality prism_quality(const CellPoints& x) {
  const PrismLevel<double> below({one_lane(x[0]), one_lane(x[1]), one_lane(x[2])}),
      above({one_lane(x[3]), one_lane(x[4]), one_lane(x[5])});
  return prism_quality_of(prism_squares(below, above));
}

Vec3Of<double2> differences(const Vec3d& from, const Vec3d& to, const Vec3d& other_from, const Vec3d& other_to) {
  return {double2{to[0] - from[0], other_to[0] - other_from[0]}, double2{to[1] - from[1], other_to[1] - other_from[1]},
          double2{to[2] - from[2], other_to[2] - other_from[2]}};
}

/// The quality of a hexahedron. Base and top are computed at once, in two lanes.
CellQuality hexahedron_quality(const CellPoints& x) {
  EdgeLengths lengths;
  Vec3Of<double2> along[4], up[4];
  double2 along2[4], up2[4];
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    along[k] = differences(x[k], x[next], x[4 + k], x[4 + next]);
    up[k] = differences(x[k], x[4 + k], x[k], x[4 + k]);
    along2[k] = along[k].dot(along[k]);
    up2[k] = up[k].dot(up[k]);
    for (const double squared : {along2[k][0], along2[k][1], up2[k][0]}) lengths.add(squared);
  }
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t previous = (k + 3) % 4;
    const double2 square =
        unit_square(along[previous].cross(along[k]).dot(up[k]), along2[previous] * along2[k] * up2[k]);
    least = std::min({least, square[0], square[1]});
  }
  const Vec3d u = (x[1] - x[0]) + (x[2] - x[3]) + (x[5] - x[4]) + (x[6] - x[7]);
  const Vec3d v = (x[3] - x[0]) + (x[2] - x[1]) + (x[7] - x[4]) + (x[6] - x[5]);
  const Vec3d w = (x[4] - x[0]) + (x[5] - x[1]) + (x[6] - x[2]) + (x[7] - x[3]);
  const CellQuality corners = quality_of(QualitySquares<double>{least, lengths.least, lengths.most});
  return {std::min(unit_triple(u, v, w), corners.jacobian), corners.aspect};
}

/// Twice the area vector of a face with corners at(0), at(1) ...
template <class At>
Vec3d twice_area(std::size_t corners, At&& at) {
  Vec3d sum(0.0);
  for (std::size_t k = 2; k < corners; ++k) sum += (at(k - 1) - at(0)).cross(at(k) - at(0));
  return sum;
}

/// The scaled Jacobian of a polyhedron: a prism over a polygon, whose faces are the base seen from below, the top, and
/// sides on the base's edges. Corners that are in both base and top are flat.
double polyhedron_jacobian(const VolumeMesh& mesh, std::span<const std::uint32_t> cell) {
  const auto base = cell.subspan(2, cell[1]), top = cell.subspan(3 + cell[1], cell[2 + cell[1]]);
  thread_local PolygonPrism prism;
  const std::size_t n = base.size();
  prism.below.resize(n), prism.above.resize(n), prism.flat.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t below = base[(n - k) % n];
    prism.below[k] = mesh.points[below];
    prism.above[k] = mesh.points[top[k]];
    prism.flat[k] = below == top[k];
  }
  return scaled_jacobian(prism);
}

/// The scaled Jacobian of a cell of a plane mesh: the least sine of its corners, for triangles relative to a regular
/// one.
double plane_jacobian(const CellPoints& x, const Vec3d& normal) {
  const std::size_t n = x.corners.size();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3d next = x[(k + 1) % n] - x[k], last = x[(k + n - 1) % n] - x[k];
    const double lengths = next.length() * last.length();
    least = std::min(least, lengths > 0 ? next.cross(last).dot(normal) / lengths : 0);
  }
  return n == 3 ? least * 2 / std::numbers::sqrt3 : least;
}

/// Twice the signed area between an edge and `origin`: the sum over a closed boundary is twice the area inside it.
double twice_area_below(const VolumeMesh& mesh, std::span<const std::uint32_t> edge, const Vec3d& origin) {
  return (mesh.points[edge[0]] - origin).cross(mesh.points[edge[1]] - origin).dot(mesh.normal);
}

}  // namespace

double scaled_jacobian(const VolumeMesh& mesh, std::size_t cell) {
  VDB_OFFSET_ASSERT(cell < mesh.cell_count() && mesh.cell_begin.size() == mesh.cell_count() + 1);
  const CellPoints x{mesh, mesh.cell(cell)};
  switch (mesh.cell_types[cell]) {
    case CellType::Tetrahedron:
      return tetrahedron_jacobian(x, 0, 1, 2, 3);
    case CellType::Pyramid:
      return pyramid_jacobian(x);
    case CellType::Prism:
      return prism_quality(x).jacobian;
    case CellType::Hexahedron:
      return hexahedron_quality(x).jacobian;
    case CellType::Triangle:
    case CellType::Quadrilateral:
      return plane_jacobian(x, mesh.normal);
    case CellType::Polyhedron:
      break;
  }
  return polyhedron_jacobian(mesh, mesh.cell(cell));
}

double aspect_ratio(const VolumeMesh& mesh, std::size_t cell) {
  EdgeLengths lengths;
  for_each_cell_face(mesh.cell_types[cell], mesh.cell(cell), [&](std::span<const std::uint32_t> face) {
    for (std::size_t k = 0; k < face.size(); ++k)
      lengths.add((mesh.points[face[k]] - mesh.points[face[(k + 1) % face.size()]]).lengthSqr());
  });
  return lengths.ratio();
}

double cell_volume(const VolumeMesh& mesh, std::size_t cell) {
  VDB_OFFSET_ASSERT(cell < mesh.cell_count());
  const auto corners = mesh.cell(cell);
  const CellType type = mesh.cell_types[cell];
  const Vec3d origin = mesh.points[corners[type == CellType::Polyhedron ? 2 : 0]];
  double sum = 0;
  for_each_cell_face(type, corners, [&](std::span<const std::uint32_t> face) {
    sum += mesh.plane() ? twice_area_below(mesh, face, origin) : six_volumes_below(mesh.points, face, origin);
  });
  return sum / (mesh.plane() ? 2 : 6);
}

CellQuality cell_quality(const VolumeMesh& mesh, std::size_t cell) {
  const CellPoints x{mesh, mesh.cell(cell)};
  const CellType type = mesh.cell_types[cell];
  return type == CellType::Prism        ? prism_quality(x)
         : type == CellType::Hexahedron ? hexahedron_quality(x)
                                        : CellQuality{scaled_jacobian(mesh, cell), aspect_ratio(mesh, cell)};
}

std::array<VolumeField, 2> quality_fields(const VolumeMesh& mesh) {
  std::array<VolumeField, 2> fields{VolumeField{"scaled_jacobian", {}}, VolumeField{"aspect_ratio", {}}};
  for_each_index(
      fields.size(), [&](std::size_t i) { fields[i].values.resize(mesh.cell_count()); }, 1);
  for_each_index(mesh.cell_count(), [&](std::size_t c) {
    const CellQuality quality = cell_quality(mesh, c);
    fields[0].values[c] = static_cast<float>(quality.jacobian);
    fields[1].values[c] = static_cast<float>(quality.aspect);
  });
  return fields;
}

double enclosed_volume(const VolumeMesh& mesh) {
  // Faces that one thread adds up in order. The sum depends on it in its last bits; not measured beside other sizes.
  constexpr std::size_t kBlock = 4096;
  double sum = 0;
  for (const BoundaryPatch& patch : mesh.patches) {
    std::vector<double> sums((patch.face_count() + kBlock - 1) / kBlock, 0);
    for_each_index(
        sums.size(),
        [&](std::size_t b) {
          const std::size_t end = std::min(patch.face_count(), (b + 1) * kBlock);
          for (std::size_t f = b * kBlock; f < end; ++f)
            sums[b] += mesh.plane() ? twice_area_below(mesh, patch.face(f), mesh.points[0])
                                    : six_volumes_below(mesh.points, patch.face(f), mesh.points[0]);
        },
        1);
    for (const double part : sums) sum += part;
  }
  return sum / (mesh.plane() ? 2 : 6);
}

double wall_angle(std::span<const Vec3d> wall, std::span<const Vec3d> first) {
  VDB_OFFSET_ASSERT(wall.size() > 1 && first.size() == wall.size());
  Vec3d rise(0.0);
  for (std::size_t k = 0; k < wall.size(); ++k) rise += first[k] - wall[k];
  const bool edge = wall.size() == 2;
  const Vec3d axis = edge ? wall[1] - wall[0] : twice_area(wall.size(), [&](std::size_t k) { return wall[k]; });
  // Computed from the tangent, as the cosine hardly changes at small angles.
  double along = std::abs(axis.dot(rise)), across = axis.cross(rise).length();
  if (edge) std::swap(along, across);
  return along > 0 ? std::atan2(across, along) * 180 / std::numbers::pi : 90;
}

}  // namespace vdb_offset
