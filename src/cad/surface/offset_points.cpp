// SPDX-License-Identifier: Apache-2.0
#include "surface/offset_points.h"

#include <algorithm>
#include <cmath>
#include <math_Jacobi.hxx>
#include <math_Matrix.hxx>
#include <math_Vector.hxx>
#include <optional>

namespace vdb_offset::cad {
namespace {

// Share of the largest below which an eigenvalue says nothing: of two planes less than a quarter of a degree apart.
constexpr double kLeastBend = 1e-6;
// A residue of so many distances is rounding.
constexpr double kRounding = 1e-14;
// Quadratic convergence from a point that is a hundredth off takes four.
constexpr int kMostSteps = 12;
// A point that would end farther from its start than so many distances is led astray.
constexpr double kFarthest = 1;

/// How far a point is from where it ought to be.
struct Residue {
  gp_Vec step;      // the shortest that would mend it
  double most = 0;  // of all faces
};

/// The shortest step with gradient . step = lack for all pairs, in the sense of least squares.
gp_Vec shortest_step(std::span<const std::pair<gp_Vec, double>> wanted) {
  math_Matrix squares(1, 3, 1, 3, 0.0);
  double sum[3] = {};
  for (const auto& [gradient, lack] : wanted)
    for (int i = 1; i <= 3; ++i) {
      sum[i - 1] += gradient.Coord(i) * lack;
      for (int j = 1; j <= 3; ++j) squares(i, j) += gradient.Coord(i) * gradient.Coord(j);
    }
  math_Jacobi axes(squares);
  double largest = 0;
  for (int k = 1; k <= 3; ++k) largest = std::max(largest, axes.Value(k));
  gp_Vec step(0, 0, 0);
  for (int k = 1; k <= 3; ++k) {
    if (!(axes.Value(k) > kLeastBend * largest)) continue;
    math_Vector axis(1, 3);
    axes.Vector(k, axis);
    const gp_Vec along(axis(1), axis(2), axis(3));
    step += along * ((along.X() * sum[0] + along.Y() * sum[1] + along.Z() * sum[2]) / axes.Value(k));
  }
  return step;
}

std::optional<Residue> residue_at(std::span<const SidedSurface> surfaces, const gp_Pnt& point,
                                  std::span<io::CadPlace> places) {
  std::vector<std::pair<gp_Vec, double>> wanted;
  Residue residue;
  for (io::CadPlace& place : places) {
    const SidedSurface& face = surfaces[place.face];
    const Foot foot = face.surface.foot(point, place.u, place.v);
    place.u = foot.u;
    place.v = foot.v;
    const auto normal = face.surface.normal(foot.u, foot.v);
    if (!normal) return std::nullopt;
    const double lack = place.distance - face.side * foot.distance;
    wanted.emplace_back(*normal * face.side, lack);
    residue.most = std::max(residue.most, std::abs(lack));
  }
  residue.step = shortest_step(wanted);
  return residue;
}

gp_Pnt offset_point(std::span<const SidedSurface> surfaces, const io::CadAim& aim, std::span<io::CadPlace> places) {
  const gp_Pnt start(aim.x, aim.y, aim.z);
  gp_Pnt best = start, point = start;
  double least = INFINITY;
  for (int i = 0; i < kMostSteps; ++i) {
    const auto residue = residue_at(surfaces, point, places);
    if (!residue || !(residue->most < least)) break;
    best = point;
    least = residue->most;
    if (least <= kRounding * aim.scale) break;
    point.Translate(residue->step);
    if (point.Distance(start) > kFarthest * aim.scale) break;
  }
  return best;
}

}  // namespace

std::vector<Vec3d> offset_points(std::span<const SidedSurface> surfaces, std::span<const io::CadAim> aims,
                                 std::span<const io::CadPlace> places) {
  std::vector<io::CadPlace> moving(places.begin(), places.end());
  std::vector<Vec3d> points;
  std::size_t first = 0;
  for (const io::CadAim& aim : aims) {
    const gp_Pnt p = offset_point(surfaces, aim, std::span(moving).subspan(first, aim.places));
    first += aim.places;
    points.emplace_back(p.X(), p.Y(), p.Z());
  }
  return points;
}

}  // namespace vdb_offset::cad
