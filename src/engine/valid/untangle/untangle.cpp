// SPDX-License-Identifier: Apache-2.0
#include "valid/untangle/untangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "ground/system/assert.h"
#include "motion/paths/propagate.h"
#include "valid/untangle/quasi_newton.h"

namespace vdb_offset {
namespace {

// Planes are renewed this often; each time the energy falls by at most so many steps. Not measured.
constexpr int kRenewals = 6, kSteps = 20;

// A patch is given up after this many renewals without fewer folded faces: it will hardly have fewer later. Small
// patches, of up to kSmall vertices, get one more, as they cost little. Not measured.
constexpr int kFruitless = 2, kFruitlessIfSmall = 3;
constexpr std::size_t kSmall = 100;

// A step is halved at most so often until the energy falls by at least the share kArmijo of what its slope promises
// (Nocedal and Wright, Numerical Optimization, 2006, 3.1).
constexpr int kHalvings = 30;
constexpr double kArmijo = 1e-4;

// Share of the energy: when a step gains less, the slide ends. Larger once nothing is folded in the planes: in new
// planes the least energy is elsewhere. Not measured.
constexpr double kLeastGain = 1e-6, kLeastGainUnfolded = 0.1;

// No vertex moves farther than this, in distances, in one step. Not measured.
constexpr double kLongestStep = 0.5;

// chi, by which the energy is divided, is smoothed over this share of the most negative determinant of the faces, and
// over a least one; both constants are squares. Not measured.
constexpr double kSmoothing2 = 0.04, kLeastSmoothing2 = 1e-12;

// Squared length below which a sum of unit normals has cancelled out, and has no direction. Reasoned: rounding.
constexpr double kCancelled = 1e-12;

/// Two directions at right angles to n and to each other.
std::array<Vec3d, 2> plane_of(const Vec3d& n) {
  const int axis = std::abs(n[0]) < std::abs(n[1]) ? (std::abs(n[0]) < std::abs(n[2]) ? 0 : 2)
                                                   : (std::abs(n[1]) < std::abs(n[2]) ? 1 : 2);
  Vec3d e(0.0);
  e[axis] = 1;
  const Vec3d u = n.cross(e).unit();
  return {u, n.cross(u)};
}

/// The vertices of a patch and those around it, and the faces of the patch's vertices.
class UntangledPatch {
 public:
  UntangledPatch(const ConstrainedSurface& constrained, const Distances& distances, const Untangler::Options& options,
                 std::span<const std::uint32_t> vertices, std::span<Vec3d> displacement)
      : constrained_(constrained),
        surface_(constrained.surface),
        moving_part_(constrained.moving_part.surface()),
        distances_(distances),
        options_(options),
        free_(vertices.size()) {
    for (const auto v : vertices) {
      add_point(v, displacement);
      scale_ = std::max(scale_, points_.back().target);
    }
    collect_faces(vertices, displacement);
  }

  void untangle() {
    renew_planes();
    std::vector<Vec3d> best = positions();
    const int most_fruitless = options_.thorough ? kRenewals : free_ > kSmall ? kFruitless : kFruitlessIfSmall;
    int fewest = folded_, fruitless = 0;
    for (int i = 0; i < kRenewals && (i == 0 || fewest > 0) && fruitless < most_fruitless; ++i) {
      const std::vector<Vec3d> before = positions();
      slide();
      for (std::size_t k = 0; k < free_; ++k)
        if (!points_[k].stuck) return_to_distance(points_[k], before[k]);
      renew_planes();
      fruitless = folded_ < fewest ? 0 : fruitless + 1;
      if (i > 0 && folded_ > fewest) continue;
      fewest = folded_;
      best = positions();
    }
    for (std::size_t k = 0; k < free_; ++k) points_[k].x = best[k];
  }

  void store(std::span<Vec3d> displacement) const {
    for (std::size_t i = 0; i < free_; ++i)
      displacement[points_[i].vertex] =
          round_displacement(points_[i].x - surface_.vertices[points_[i].vertex], points_[i].target);
  }

 private:
  struct Point {
    std::uint32_t vertex, hint;
    double target;                 // distance to the moving part that is asked for
    int side;                      // of the moving part, 1 or -1
    double distance;               // to the moving part when planes were renewed
    Vec3d x, normal;               // local frame; outward from the moving part, smoothed over the neighbours
    std::array<Vec3d, 2> tangent;  // at right angles to the normal
    bool stuck = false;            // planes that hold it let it move nowhere
  };
  struct Face {
    std::array<std::uint32_t, 3> point;  // indices in points_
    double inverse[3];                   // of the source's edges (a, b; 0, c) in the plane: 1/a, -b/(a c), 1/c
    double area;
    double edge[2][2];    // from the first corner to the others, in the face's plane
    double map[3][2][2];  // how a slide of each corner along each of its tangents shows in that plane
  };

  void add_point(std::uint32_t v, std::span<const Vec3d> displacement) {
    const double d = distances_[v];
    points_.push_back(
        {v, constrained_.hint(v), std::abs(d), d < 0 ? -1 : 1, 0, surface_.vertices[v] + displacement[v], {}, {}});
  }

  std::uint32_t index_of(std::uint32_t v, std::span<const std::uint32_t> vertices,
                         std::span<const Vec3d> displacement) {
    const auto at = std::lower_bound(vertices.begin(), vertices.end(), v);
    if (at != vertices.end() && *at == v) return static_cast<std::uint32_t>(at - vertices.begin());
    const auto known = std::find_if(points_.begin() + static_cast<std::ptrdiff_t>(free_), points_.end(),
                                    [&](const Point& p) { return p.vertex == v; });
    if (known != points_.end()) return static_cast<std::uint32_t>(known - points_.begin());
    add_point(v, displacement);
    return static_cast<std::uint32_t>(points_.size() - 1);
  }

  void collect_faces(std::span<const std::uint32_t> vertices, std::span<const Vec3d> displacement) {
    std::vector<std::uint32_t> triangles;
    for (const auto v : vertices)
      for (const auto t : surface_.triangles_around(v)) triangles.push_back(t);
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());
    for (const auto t : triangles) {
      const auto& [a, b, c] = surface_.triangles[t];
      const Vec3d ab = surface_.vertices[b] - surface_.vertices[a], ac = surface_.vertices[c] - surface_.vertices[a];
      const double length = ab.length(), twice_area = ab.cross(ac).length();
      if (is_needle(twice_area * twice_area, std::max(ab.lengthSqr(), ac.lengthSqr()))) continue;
      const double along = ab.dot(ac) / length, height = twice_area / length;
      Face face{surface_.triangles[t], {1 / length, -along / (length * height), 1 / height}, twice_area / 2, {}, {}};
      for (auto& corner : face.point) corner = index_of(corner, vertices, displacement);
      faces_.push_back(face);
    }
  }

  void renew_planes() {
    for (Point& p : points_) {
      if (p.x == surface_.vertices[p.vertex]) {
        p.normal = surface_.vertex_normals[p.vertex];
        if (p.normal.lengthSqr() > kCancelled) p.normal.normalize();
        continue;
      }
      const TrianglePoint nearest = moving_part_.walk_to_closest(p.x, p.hint);
      p.distance = std::sqrt(nearest.squared_distance);
      p.normal = p.distance > 0 ? (p.x - nearest.point) / (p.side * p.distance) : Vec3d(0.0);
    }
    for (int i = 0; i < options_.smoothing; ++i) smooth_normals();
    for (Point& p : points_) p.tangent = plane_of(p.normal);
    if (!moving_part_.conormals.empty()) keep_borders();
    least_det_ = 1;
    folded_ = 0;
    for (Face& face : faces_) {
      Vec3d n(0.0);
      for (const auto i : face.point) n += points_[i].normal;
      if (!(n.lengthSqr() > kCancelled)) n = points_[face.point[0]].normal;
      const std::array<Vec3d, 2> plane = plane_of(n.unit());
      for (std::size_t row = 0; row < 2; ++row) {
        for (std::size_t k = 0; k < 3; ++k)
          for (std::size_t axis = 0; axis < 2; ++axis)
            face.map[k][axis][row] = plane[row].dot(points_[face.point[k]].tangent[axis]);
        for (std::size_t k = 0; k < 2; ++k)
          face.edge[k][row] = plane[row].dot(points_[face.point[k + 1]].x - points_[face.point[0]].x);
      }
      const double det = jacobian_of(face, face.edge).det();
      least_det_ = std::min(least_det_, det);
      folded_ += det <= 0;
    }
  }

  /// Vertices of a border stay in the plane across it: they slide along the border alone. Vertices that planes hold
  /// stay in these in any case: in one plane, on the line of two, or where they are.
  void keep_borders() {
    for (Point& p : points_) {
      const std::uint32_t v = constrained_.part_vertex.empty() ? p.vertex : constrained_.part_vertex[p.vertex];
      if (v == kNone) continue;
      const bool held = moving_part_.is_held(v);
      const Vec3d& c = moving_part_.conormals[v];
      const Vec3d n = moving_part_.along_border(v, p.normal);
      p.stuck = held && !(n.lengthSqr() > kCancelled);
      if (p.stuck) p.tangent.fill(Vec3d(0.0));
      if (!(held || options_.keep_borders) || c.lengthSqr() == 0 || !(n.lengthSqr() > kCancelled)) continue;
      p.normal = n.unit();
      p.tangent = {held ? moving_part_.along_border(v, p.normal.cross(c)) : p.normal.cross(c), Vec3d(0.0)};
    }
  }

  /// Each normal becomes the mean of itself and those of the faces around it.
  void smooth_normals() {
    std::vector<Vec3d> sum(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) sum[i] = points_[i].normal;
    for (const Face& face : faces_) {
      const Vec3d n = points_[face.point[0]].normal + points_[face.point[1]].normal + points_[face.point[2]].normal;
      for (const auto i : face.point) sum[i] += n;
    }
    for (std::size_t i = 0; i < points_.size(); ++i)
      points_[i].normal = sum[i].lengthSqr() > kCancelled ? sum[i].unit() : Vec3d(0.0, 0.0, 1.0);
  }

  std::vector<Vec3d> positions() const {
    std::vector<Vec3d> x(free_);
    for (std::size_t i = 0; i < free_; ++i) x[i] = points_[i].x;
    return x;
  }

  /// The linear map from a face of the source to its image in the plane, by rows (0, 1; 2, 3).
  struct Jacobian {
    double j[4];
    double det() const { return j[0] * j[3] - j[1] * j[2]; }
  };
  /// \param edge from the image's first corner to the others, in the plane
  static Jacobian jacobian_of(const Face& face, const double (&edge)[2][2]) {
    Jacobian map{};
    for (std::size_t row = 0; row < 2; ++row) {
      map.j[2 * row] = edge[0][row] * face.inverse[0];
      map.j[2 * row + 1] = edge[0][row] * face.inverse[1] + edge[1][row] * face.inverse[2];
    }
    return map;
  }

  struct Energy {
    double sum = 0;
    bool folded = false;  // any of the faces
  };
  /// The energy, and its derivative by the slides: two numbers for each point, 0 for points that are not of the patch.
  /// chi, by which the energy is divided, is about det for det > 0, small and positive below.
  Energy energy(std::span<const double> slide, double epsilon, std::span<double> derivative) const {
    std::fill(derivative.begin(), derivative.end(), 0.0);
    const double lambda = options_.area_weight;
    Energy all;
    for (const Face& face : faces_) {
      double moved[3][2], edge[2][2];
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t row = 0; row < 2; ++row)
          moved[k][row] =
              face.map[k][0][row] * slide[2 * face.point[k]] + face.map[k][1][row] * slide[2 * face.point[k] + 1];
      for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t row = 0; row < 2; ++row)
          edge[k][row] = face.edge[k][row] + (moved[k + 1][row] - moved[0][row]);
      const Jacobian map = jacobian_of(face, edge);
      const auto& j = map.j;
      const double det = map.det(), root = std::sqrt(epsilon * epsilon + det * det),
                   by_chi = det > 0 ? 2 / (det + root) : 2 * (root - det) / (epsilon * epsilon);
      const double e = (j[0] * j[0] + j[1] * j[1] + j[2] * j[2] + j[3] * j[3] + lambda * (det * det + 1)) * by_chi;
      all.sum += face.area * e;
      all.folded |= det <= 0;
      const double by_det = (2 * lambda * det) * by_chi - e / root, twice = 2 * by_chi;
      const double by_j[4] = {twice * j[0] + by_det * j[3], twice * j[1] - by_det * j[2], twice * j[2] - by_det * j[1],
                              twice * j[3] + by_det * j[0]};
      double by_position[3][2];
      for (std::size_t row = 0; row < 2; ++row) {
        by_position[1][row] = (by_j[2 * row] * face.inverse[0] + by_j[2 * row + 1] * face.inverse[1]) * face.area;
        by_position[2][row] = by_j[2 * row + 1] * face.inverse[2] * face.area;
        by_position[0][row] = -by_position[1][row] - by_position[2][row];
      }
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t axis = 0; axis < 2; ++axis)
          derivative[2 * face.point[k] + axis] +=
              face.map[k][axis][0] * by_position[k][0] + face.map[k][axis][1] * by_position[k][1];
    }
    std::fill(derivative.begin() + static_cast<std::ptrdiff_t>(2 * free_), derivative.end(), 0.0);
    return all;
  }

  /// Lets the energy fall, with L-BFGS directions and halved steps, then puts the points where they have slid to.
  void slide() {
    const std::size_t n = 2 * points_.size();
    const double folded = std::min(least_det_, 0.0),
                 epsilon = std::sqrt(kLeastSmoothing2 + kSmoothing2 * folded * folded);
    std::vector<double> x(n, 0.0), g(n), step(n), next(n), next_g(n);
    QuasiNewton model;
    double e = energy(x, epsilon, g).sum;
    for (int i = 0; i < kSteps; ++i) {
      model.descend(g, step);
      const double slope = dot(g, step);
      if (!(slope < 0)) break;
      double t = first_step(step, i == 0);
      Energy next_e{e};
      for (int halvings = 0; halvings < kHalvings; ++halvings, t /= 2) {
        for (std::size_t k = 0; k < n; ++k) next[k] = x[k] + t * step[k];
        next_e = energy(next, epsilon, next_g);
        if (next_e.sum <= e + kArmijo * t * slope) break;
      }
      if (!(next_e.sum <= e + kArmijo * t * slope)) break;
      model.remember(x, next, g, next_g);
      x.swap(next);
      g.swap(next_g);
      const double gained = e - next_e.sum;
      e = next_e.sum;
      if (gained < (next_e.folded || options_.thorough ? kLeastGain : kLeastGainUnfolded) * e) break;
    }
    move_points(x);
  }

  /// The share of a step to try first: all of it, unless a point would go too far by that. A first step, which no
  /// earlier step has scaled, goes as far as may be.
  double first_step(std::span<const double> step, bool is_unscaled) const {
    double longest2 = 0;
    for (std::size_t k = 0; k < step.size(); k += 2)
      longest2 = std::max(longest2, step[k] * step[k] + step[k + 1] * step[k + 1]);
    const double most = kLongestStep * scale_ / std::sqrt(longest2);
    return is_unscaled ? most : std::min(1.0, most);
  }

  void move_points(std::span<const double> slide) {
    for (std::size_t i = 0; i < free_; ++i) {
      Point& p = points_[i];
      const Vec3d moved = p.tangent[0] * slide[2 * i] + p.tangent[1] * slide[2 * i + 1];
      const double length = moved.length(), free = kFreeShare * p.distance;
      p.x += length > free ? moved * (free / length) : moved;
    }
  }

  /// Moves a point along its smoothed normal to its distance. Outward phi is concave along the normal, as the least of
  /// the distances to what is near, so that Newton's steps converge; where they do not, the point stays where it was.
  /// The triangles around the last answer give the distance, and the exact query says whether that is right. A vertex
  /// of a fold, which no direction leads away from, may still stand on the surface: it steps off.
  void return_to_distance(Point& p, const Vec3d& before) const {
    // Newton's steps; the share of the distance that the result may be off by (reasoned: far below the promised 1e-6);
    // the least slope that a step is computed with; the step off the surface and what counts as on it, in distances.
    // Not measured.
    constexpr int kMostSteps = 40;
    constexpr double kSettled = 1e-9, kLeastSlope = 0.1, kStepOff = 0.02, kOnSurface = 1e-3;
    const Vec3d away = p.normal * p.side;
    for (int i = 0; i < kMostSteps; ++i) {
      TrianglePoint nearest = moving_part_.walk_to_closest(p.x, p.hint);
      double distance = std::sqrt(nearest.squared_distance);
      if (std::abs(distance - p.target) <= kSettled * p.target) {
        const Closest closest = constrained_.moving_part(p.x, p.hint);
        if (std::abs(closest.distance - p.target) <= kSettled * p.target) return;
        p.hint = closest.triangle;
        distance = closest.distance;
        nearest.point = closest.point;
      }
      if (!(distance > kOnSurface * p.target)) {
        if (i > 0) break;
        p.x += away * (kStepOff * p.target);
        continue;
      }
      const double slope = away.dot(p.x - nearest.point) / distance, free = kFreeShare * distance;
      p.x += away * std::clamp((p.target - distance) / std::max(slope, kLeastSlope), -free, free);
      if (!((p.x - before).length() < 2 * p.target)) break;
    }
    p.x = before;
  }

  const ConstrainedSurface& constrained_;
  const Surface& surface_;
  const Surface& moving_part_;
  const Distances& distances_;
  Untangler::Options options_;
  std::size_t free_;  // number of the patch's points, which are the first; the others stand around the patch
  double scale_ = 0;  // largest distance that is asked of a point of the patch
  std::vector<Point> points_;
  std::vector<Face> faces_;
  double least_det_ = 1;  // of the faces when planes were renewed
  int folded_ = 0;        // number of faces that were folded over then
};

}  // namespace

void Untangler::operator()(std::span<const std::uint32_t> patch, std::span<Vec3d> displacement) const {
  VDB_OFFSET_ASSERT(displacement.size() == constrained_.surface.vertices.size());
  VDB_OFFSET_ASSERT(std::is_sorted(patch.begin(), patch.end()));
  UntangledPatch work(constrained_, distances_, options_, patch, displacement);
  work.untangle();
  work.store(displacement);
}

}  // namespace vdb_offset
