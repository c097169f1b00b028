// SPDX-License-Identifier: Apache-2.0
// Proofs of random triangles, against brute force.
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <queue>
#include <random>
#include <utility>
#include <vector>

#include "ground/system/parallel.h"
#include "support/proved_mesh.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;
using test::ProvedMesh;

namespace {

using Shares = std::array<double, 3>;

double at_shares(const Shares& shares, const std::array<double, 3>& of_corners) {
  return shares[0] * of_corners[0] + shares[1] * of_corners[1] + shares[2] * of_corners[2];
}

enum class Search { Found, None, Unknown };

/// How far the points of a triangle are off, by brute force.
class PointErrors {
 public:
  PointErrors(const ProvedMesh& on, const OffsetTriangle& triangle) : on_(on), triangle_(triangle) {
    for (int i = 0; i <= kSteps; ++i)
      for (int j = 0; i + j <= kSteps; ++j) grid_.push_back({1.0 * i / kSteps, 1.0 * j / kSteps, 0});
    for (Shares& shares : grid_) shares[2] = std::max(0.0, 1 - shares[0] - shares[1]);
    for (const Shares& shares : grid_) error_.push_back(error_at(shares));
  }

  double error_at(const Shares& shares) const {
    const double asked = at_shares(shares, triangle_.asked), off = on_.distance(at(shares)) - asked;
    if (!(off > 0 && triangle_.may_keep_to_plane)) return std::abs(off);
    return std::min(off, std::abs(at_shares(shares, triangle_.over_plane) - asked));
  }
  /// The largest error of a point of the grid, in tolerances.
  double most_in_tolerances(const std::array<double, 3>& tolerance) const {
    double most = 0;
    for (std::size_t i = 0; i < grid_.size(); ++i) most = std::max(most, error_[i] / at_shares(grid_[i], tolerance));
    return most;
  }
  /// The largest error of a point of the grid.
  double most() const { return *std::max_element(error_.begin(), error_.end()); }
  /// Looks for a point that is off by more than its tolerance and a slack, where there may be one at all: in the piece
  /// that may have the one that is off the most, which is halved. Gives up after some points.
  Search find_off(const std::array<double, 3>& tolerance, double slack, int most_points) const {
    struct Piece {
      std::array<Shares, 3> corners;
      double bound;  // of what a point may be off beyond its tolerance
      bool operator<(const Piece& other) const { return bound < other.bound; }
    };
    std::priority_queue<Piece> pieces;
    const auto found = [&](const std::array<Shares, 3>& corners) {
      Shares middle;
      for (std::size_t k = 0; k < 3; ++k) middle[k] = (corners[0][k] + corners[1][k] + corners[2][k]) / 3;
      pieces.push({corners, bound_around(middle, corners, tolerance) + slack});
      return error_at(middle) - at_shares(middle, tolerance) > -slack;
    };
    if (found({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}})) return Search::Found;
    for (int points = 1; points < most_points && pieces.top().bound > 0; points += 2) {
      const std::array<Shares, 3> whole = pieces.top().corners;
      pieces.pop();
      std::size_t longest = 0;
      const auto length = [&](std::size_t k) { return (at(whole[(k + 1) % 3]) - at(whole[k])).length(); };
      for (std::size_t k = 1; k < 3; ++k)
        if (length(k) > length(longest)) longest = k;
      Shares middle;
      for (std::size_t k = 0; k < 3; ++k) middle[k] = (whole[longest][k] + whole[(longest + 1) % 3][k]) / 2;
      for (const std::size_t end : {longest, (longest + 1) % 3}) {
        std::array<Shares, 3> piece = whole;
        piece[end] = middle;
        if (found(piece)) return Search::Found;
      }
    }
    return pieces.top().bound > 0 ? Search::Unknown : Search::None;
  }

 private:
  static constexpr int kSteps = 16;

  Vec3d at(const Shares& shares) const {
    const auto& [a, b, c] = triangle_.corners;
    return a * shares[0] + b * shares[1] + c * shares[2];
  }
  /// What no point of a piece is off by beyond its tolerance, as distances change no faster than from point to point.
  double bound_around(const Shares& middle, const std::array<Shares, 3>& corners,
                      const std::array<double, 3>& tolerance) const {
    const double asked = at_shares(middle, triangle_.asked), off = on_.distance(at(middle)) - asked;
    double change = 0, least = tolerance[0] + tolerance[1] + tolerance[2], off_plane = 0;
    for (const Shares& corner : corners) {
      const double of_corner = at_shares(corner, triangle_.asked);
      change = std::max(change, (at(corner) - at(middle)).length() + std::abs(of_corner - asked));
      least = std::min(least, at_shares(corner, tolerance));
      off_plane = std::max(off_plane, std::abs(at_shares(corner, triangle_.over_plane) - of_corner));
    }
    const double too_near = change - off, too_far = change + off;
    return std::max(too_near, triangle_.may_keep_to_plane ? std::min(off_plane, too_far) : too_far) - least;
  }

  const ProvedMesh& on_;
  const OffsetTriangle& triangle_;  // in the frame of the surface
  std::vector<Shares> grid_;
  std::vector<double> error_;
};

/// Triangles beside a surface, tiny and large, some of them slivers, whose corners are at their distance or nearly so.
class RandomTriangles {
 public:
  RandomTriangles(const ProvedMesh& on, unsigned seed) : on_(on), random_(seed) {}

  /// In the frame of the surface.
  OffsetTriangle next() {
    const Surface& surface = on_.surface;
    const auto t = static_cast<std::uint32_t>(random_() % surface.triangles.size());
    const auto& v = surface.triangles[t];
    const double u = unit(), w = unit() * (1 - u), size = surface.facts.diagonal;
    const Vec3d foot = surface.vertices[v[0]] * (1 - u - w) + surface.vertices[v[1]] * u + surface.vertices[v[2]] * w;
    const double height = 0.2 * size * std::pow(10.0, -2 * unit()), radius = height * std::pow(10.0, 1.5 * unit() - 1);
    const Vec3d normal = surface.triangle_normals[t] * (unit() < 0.5 ? -1 : 1), middle = foot + normal * height;
    const double thin = unit() < 0.3 ? 1e-4 : 1, tilt = unit() < 0.5 ? 0.05 : 1;
    const Vec3d along = normal.cross(somewhere()).unit(), across = normal.cross(along);
    OffsetTriangle triangle;
    const double uneven = std::array{0.0, 0.01, 0.2}[random_() % 3], tolerance = height * std::pow(10.0, -4 * unit());
    for (std::size_t k = 0; k < 3; ++k) {
      triangle.corners[k] =
          middle +
          (along * signed_unit() + across * (thin * signed_unit()) + normal * (thin * tilt * signed_unit())) * radius;
      triangle.asked[k] = on_.distance(triangle.corners[k]) * (1 + uneven * signed_unit());
      triangle.tolerance[k] = tolerance * (1 + 0.5 * signed_unit());
      triangle.over_plane[k] = normal.dot(triangle.corners[k] - foot);
    }
    triangle.may_keep_to_plane = unit() < 0.5;
    // Faces of miters have all of their corners at the distance from the plane, however far they are from the surface.
    const auto least = *std::min_element(triangle.over_plane.begin(), triangle.over_plane.end());
    if (triangle.may_keep_to_plane && unit() < 0.5 && least > 0.1 * height)
      for (std::size_t k = 0; k < 3; ++k) triangle.asked[k] = triangle.over_plane[k] * (1 + uneven * signed_unit());
    return triangle;
  }

 private:
  double unit() { return static_cast<double>(random_()) / 4294967296.0; }
  double signed_unit() { return 2 * unit() - 1; }
  Vec3d somewhere() {
    const double x = signed_unit(), y = signed_unit();
    return Vec3d(x, y, signed_unit());
  }

  const ProvedMesh& on_;
  std::mt19937 random_;
};

Polygons scaled(Polygons mesh, double scale) {
  for (Vec3d& p : mesh.positions) p *= scale;
  return mesh;
}

/// Triangles in any place, through each other.
Polygons soup_of(int count, unsigned seed) {
  std::mt19937 random(seed);
  const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
  Polygons mesh;
  for (int i = 0; i < 3 * count; ++i) {
    const double x = unit(), y = unit();
    mesh.positions.emplace_back(x, y, unit());
    mesh.corners.push_back(static_cast<std::uint32_t>(i));
    if (i % 3 == 2) mesh.close_face();
  }
  return mesh;
}

std::array<double, 3> beyond(const std::array<double, 3>& tolerance, double share) {
  return {tolerance[0] * share, tolerance[1] * share, tolerance[2] * share};
}

struct Verdicts {
  int proven = 0, off = 0, open = 0;
  int wrong_proofs = 0;   ///< Proven, and a point is off.
  int wrong_off = 0;      ///< Off, and no point is.
  int unknown_off = 0;    ///< Off, and too near the edge for brute force.
  int wrong_errors = 0;   ///< Off, by less than all tolerances, or by more than any point is.
  int proven_easily = 0;  ///< Of those with three times the tolerance that the points of the grid need.
  int easy = 0;
};

void judge_triangle(const ProvedMesh& on, OffsetTriangle triangle, Verdicts& verdicts) {
  const PointErrors errors(on, triangle);
  // Rounding of coordinates as large as the mesh, and twice what the prover allows for.
  const double rounding = 1e-13 * on.surface.facts.diagonal + 2e-11 * triangle.asked[0];
  const double needed = errors.most_in_tolerances(triangle.tolerance);
  for (const double share : {0.5, 0.99, 0.9999, 1.0001, 1.01, 3.0}) {
    OffsetTriangle tried = triangle;
    for (double& tolerance : tried.tolerance) tolerance *= share * needed;
    const double least = *std::min_element(tried.tolerance.begin(), tried.tolerance.end()), slack = rounding / least;
    const Proof proof = OffsetProver(on.query)(tried);
    verdicts.proven += proof.certainty == Certainty::Proven;
    verdicts.open += proof.certainty == Certainty::Open;
    verdicts.easy += share == 3;
    verdicts.proven_easily += share == 3 && proof.certainty == Certainty::Proven;
    if (proof.certainty != Certainty::Off) {
      verdicts.wrong_proofs +=
          proof.certainty == Certainty::Proven &&
          (share < 1 - 1e-9 - slack || errors.find_off(beyond(tried.tolerance, 1 + slack), 0, 100) == Search::Found);
      verdicts.wrong_errors += proof.error != 0;
      continue;
    }
    ++verdicts.off;
    if (share > 1) {
      const Search search = errors.find_off(tried.tolerance, slack * least, 3000);
      verdicts.wrong_off += search == Search::None;
      verdicts.unknown_off += search == Search::Unknown;
    }
    verdicts.wrong_errors += proof.error < least * (1 - 1e-9) ||
                             (proof.error > errors.most() &&
                              errors.find_off({proof.error, proof.error, proof.error}, rounding, 1000) == Search::None);
  }
}

Verdicts judge_on(const Polygons& mesh, int count, unsigned seed) {
  const ProvedMesh on(mesh);
  RandomTriangles triangles(on, seed);
  Verdicts verdicts;
  for (int i = 0; i < count; ++i) judge_triangle(on, triangles.next(), verdicts);
  return verdicts;
}

}  // namespace

TEST_CASE("prover: no proof is contradicted by a point, and what is off has a point that is", "[prover]") {
  const std::vector<std::pair<const char*, Polygons>> kMeshes = {
      {"ball", shapes::icosphere(1, 1)},
      {"cube", shapes::box(Vec3d(1), 1, true)},
      {"corner", shapes::room_corner(1, 2)},
      {"bumps", shapes::bumpy_sphere(1, 0.6, 1.5, 3, 1)},
      {"waves", shapes::patch(1, 0.3, 4)},
      {"slit", shapes::plates(1, 0.2, 0.1, 1)},
      {"soup", soup_of(12, 5)},
      {"tiny", scaled(shapes::box(Vec3d(1, 0.5, 0.02), 1, true), 1e-9)},
      {"huge", scaled(shapes::icosphere(1, 0), 1e9)}};
  Verdicts all;
  for (const auto& [name, mesh] : kMeshes) {
    CAPTURE(name);
    const Verdicts verdicts = judge_on(mesh, 100, 1);
    CHECK(verdicts.wrong_proofs == 0);
    CHECK(verdicts.wrong_off == 0);
    CHECK(verdicts.wrong_errors == 0);
    all.proven += verdicts.proven;
    all.off += verdicts.off;
    all.open += verdicts.open;
    all.unknown_off += verdicts.unknown_off;
    all.easy += verdicts.easy;
    all.proven_easily += verdicts.proven_easily;
  }
  // Half of the tolerances are too small for a point of the grid. What is left open is near the edge, or a crease of
  // the distance runs along the triangle.
  CAPTURE(all.proven, all.off, all.open, all.unknown_off, all.proven_easily, all.easy);
  CHECK(all.off > (all.proven + all.off + all.open) * 2 / 5);
  CHECK(all.proven_easily > all.easy * 9 / 10);
}

TEST_CASE("prover: verdicts do not depend on threads, nor on what was asked before", "[prover]") {
  const ProvedMesh on(shapes::bumpy_sphere(1, 0.6, 1.5, 3, 2));
  RandomTriangles random(on, 2);
  std::vector<OffsetTriangle> triangles;
  for (int i = 0; i < 2000; ++i) triangles.push_back(random.next());
  const OffsetProver prover(on.query);
  std::vector<Proof> backward(triangles.size());
  for (std::size_t i = triangles.size(); i-- > 0;) backward[i] = prover(triangles[i]);
  for (const int threads : {1, 2, 5}) {
    std::vector<Proof> proofs(triangles.size());
    tbb::task_arena(threads).execute([&] {
      for_each_index(
          proofs.size(), [&](std::size_t i) { proofs[i] = prover(triangles[i]); }, 1);
    });
    std::size_t different = 0;
    for (std::size_t i = 0; i < proofs.size(); ++i)
      different += proofs[i].certainty != backward[i].certainty || proofs[i].error != backward[i].error;
    CHECK(different == 0);
  }
}
