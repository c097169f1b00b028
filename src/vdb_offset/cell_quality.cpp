#include "vdb_offset/cell_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "vdb_offset/cell_faces.h"
#include "vdb_offset/parallel.h"

namespace vdb_offset {
namespace {

/// Of unit vectors along a, b and c; 0 if one of them has no length.
double unit_triple(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double lengths = a.length() * b.length() * c.length();
  return lengths > 0 ? a.cross(b).dot(c) / lengths : 0;
}

/// Points of a cell by the numbers of its corners.
struct CellPoints {
  const VolumeMesh& mesh;
  std::span<const std::uint32_t> corners;

  const Vec3d& operator[](std::size_t k) const { return mesh.points[corners[k]]; }
  double at_corner(std::size_t k, std::size_t a, std::size_t b, std::size_t c) const {
    const Vec3d& x = (*this)[k];
    return unit_triple((*this)[a] - x, (*this)[b] - x, (*this)[c] - x);
  }
};

/// All corners have one sign, and the longest edges have the least product, below 0 as well.
double tetrahedron_jacobian(const CellPoints& x, std::size_t a, std::size_t b, std::size_t c, std::size_t apex) {
  return std::numbers::sqrt2 * std::min({x.at_corner(a, b, c, apex), x.at_corner(b, c, a, apex),
                                         x.at_corner(c, a, b, apex), x.at_corner(apex, b, a, c)},
                                        [](double p, double q) { return std::abs(p) < std::abs(q); });
}

/// Each tetrahedron reaches 1 / sqrt 2 if all edges are of one length.
double pyramid_jacobian(const CellPoints& x) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 4; ++k) least = std::min(least, tetrahedron_jacobian(x, k, (k + 1) % 4, (k + 2) % 4, 4));
  least *= std::numbers::sqrt2;
  return least < 1 ? least : 2 - least;
}

/// Corners of a prism over any polygon: k below, n + k above.
double ring_corners_jacobian(const CellPoints& x, std::size_t n) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t next = (k + 1) % n, previous = (k + n - 1) % n;
    least = std::min({least, x.at_corner(k, next, previous, n + k), x.at_corner(n + k, n + previous, n + next, k)});
  }
  return least;
}

double hexahedron_jacobian(const CellPoints& x) {
  const Vec3d u = (x[1] - x[0]) + (x[2] - x[3]) + (x[5] - x[4]) + (x[6] - x[7]);
  const Vec3d v = (x[3] - x[0]) + (x[2] - x[1]) + (x[7] - x[4]) + (x[6] - x[5]);
  const Vec3d w = (x[4] - x[0]) + (x[5] - x[1]) + (x[6] - x[2]) + (x[7] - x[3]);
  return std::min(unit_triple(u, v, w), ring_corners_jacobian(x, 4));
}

Vec3d twice_area(std::span<const Vec3d> points, std::span<const std::uint32_t> face) {
  Vec3d sum(0.0);
  const Vec3d base = points[face[0]];
  for (std::size_t k = 2; k < face.size(); ++k) sum += (points[face[k - 1]] - base).cross(points[face[k]] - base);
  return sum;
}

/// The neighbours of a face's corner.
struct Around {
  std::uint32_t previous, next;
};
Around around(std::span<const std::uint32_t> face, std::size_t k) {
  return {face[(k + face.size() - 1) % face.size()], face[(k + 1) % face.size()]};
}

/// The faces of a prism over a polygon: the base seen from below, the top, and sides that stand on the base's edges.
/// Corners that are in both base and top have two edges or four.
double polyhedron_jacobian(const VolumeMesh& mesh, std::span<const std::uint32_t> cell) {
  const auto base = cell.subspan(2, cell[1]), top = cell.subspan(3 + cell[1], cell[2 + cell[1]]);
  const Vec3d down = twice_area(mesh.points, base);
  const auto triple = [&](std::uint32_t at, Around in_face, std::uint32_t across) {
    const Vec3d& x = mesh.points[at];
    return unit_triple(mesh.points[in_face.previous] - x, mesh.points[in_face.next] - x, mesh.points[across] - x);
  };
  constexpr double kStraight = 1e-6;  // sine of the angle by which a corner has to turn
  double least = std::numeric_limits<double>::infinity();
  const std::size_t n = base.size();
  for (std::size_t k = 0; k < n; ++k) {
    const std::uint32_t below = base[k], above = top[(n - k) % n];
    const Around ring = around(base, k);
    const Vec3d& x = mesh.points[below];
    if (unit_triple(x - mesh.points[ring.previous], mesh.points[ring.next] - x, down) < kStraight || below == above)
      continue;
    least = std::min({least, triple(below, ring, above), triple(above, around(top, (n - k) % n), below)});
  }
  return std::isfinite(least) ? least : 0;
}

template <class Visit>
void for_each_edge_length(const VolumeMesh& mesh, std::size_t cell, Visit&& visit) {
  for_each_cell_face(mesh.cell_types[cell], mesh.cell(cell), [&](std::span<const std::uint32_t> face) {
    for (std::size_t k = 0; k < face.size(); ++k)
      visit((mesh.points[face[k]] - mesh.points[face[(k + 1) % face.size()]]).lengthSqr());
  });
}

template <class Measure>
VolumeField measured(const VolumeMesh& mesh, const char* name, Measure&& measure) {
  VolumeField field{name, std::vector<float>(mesh.cell_count())};
  for_each_index(mesh.cell_count(), [&](std::size_t c) { field.values[c] = static_cast<float>(measure(mesh, c)); });
  return field;
}

}  // namespace

double scaled_jacobian(const VolumeMesh& mesh, std::size_t cell) {
  const CellPoints x{mesh, mesh.cell(cell)};
  switch (mesh.cell_types[cell]) {
    case CellType::Tetrahedron:
      return tetrahedron_jacobian(x, 0, 1, 2, 3);
    case CellType::Pyramid:
      return pyramid_jacobian(x);
    case CellType::Prism:
      return 2 / std::numbers::sqrt3 * ring_corners_jacobian(x, 3);
    case CellType::Hexahedron:
      return hexahedron_jacobian(x);
    case CellType::Polyhedron:
      break;
  }
  return polyhedron_jacobian(mesh, mesh.cell(cell));
}

double aspect_ratio(const VolumeMesh& mesh, std::size_t cell) {
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for_each_edge_length(mesh, cell, [&](double length_squared) {
    least = std::min(least, length_squared);
    most = std::max(most, length_squared);
  });
  return least > 0 ? std::sqrt(most / least) : std::numeric_limits<double>::infinity();
}

double six_volumes_below(std::span<const Vec3d> points, std::span<const std::uint32_t> face, const Vec3d& origin) {
  const std::size_t n = face.size();
  const auto first = static_cast<std::size_t>(std::min_element(face.begin(), face.end()) - face.begin());
  const auto corner = [&](std::size_t k) { return points[face[(first + k) % n]] - origin; };
  const Vec3d fan = corner(0);
  double sum = 0;
  for (std::size_t k = 2; k < n; ++k) sum += fan.dot(corner(k - 1).cross(corner(k)));
  return sum;
}

double cell_volume(const VolumeMesh& mesh, std::size_t cell) {
  const auto corners = mesh.cell(cell);
  const CellType type = mesh.cell_types[cell];
  const Vec3d origin = mesh.points[corners[type == CellType::Polyhedron ? 2 : 0]];
  double sum = 0;
  for_each_cell_face(type, corners,
                     [&](std::span<const std::uint32_t> face) { sum += six_volumes_below(mesh.points, face, origin); });
  return sum / 6;
}

VolumeField scaled_jacobian_field(const VolumeMesh& mesh) { return measured(mesh, "scaled_jacobian", scaled_jacobian); }
VolumeField aspect_ratio_field(const VolumeMesh& mesh) { return measured(mesh, "aspect_ratio", aspect_ratio); }

double total_volume(const VolumeMesh& mesh) {
  constexpr std::size_t kBlock = 4096;  // of cells that are summed in order
  std::vector<double> sums((mesh.cell_count() + kBlock - 1) / kBlock, 0);
  for_each_index(
      sums.size(),
      [&](std::size_t b) {
        const std::size_t end = std::min(mesh.cell_count(), (b + 1) * kBlock);
        for (std::size_t c = b * kBlock; c < end; ++c) sums[b] += cell_volume(mesh, c);
      },
      1);
  double sum = 0;
  for (const double part : sums) sum += part;
  return sum;
}

double wall_angle(std::span<const Vec3d> wall, std::span<const Vec3d> first, std::span<const std::uint32_t> face) {
  const Vec3d normal = twice_area(wall, face);
  Vec3d rise(0.0);
  for (const auto v : face) rise += first[v] - wall[v];
  // By the tangent, which knows small angles.
  const double along = std::abs(normal.dot(rise)), across = normal.cross(rise).length();
  return along > 0 ? std::atan2(across, along) * 180 / std::numbers::pi : 90;
}

}  // namespace vdb_offset
