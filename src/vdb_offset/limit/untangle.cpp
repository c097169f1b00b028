#include "vdb_offset/limit/untangle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <vector>

#include "vdb_offset/paths/propagate.h"

namespace vdb_offset {
namespace {

// Planes are renewed this often; each time L-BFGS makes at most so many steps, with so many of them remembered.
constexpr int kRenewals = 6, kSteps = 20;
constexpr std::size_t kMemory = 8;

// Who has no fewer faces folded so many times on end will hardly have, and small patches cost little.
constexpr int kFruitless = 2, kFruitlessIfSmall = 3;
constexpr std::size_t kSmall = 100;

// A step is halved this often until it gains enough; when all of it gains less than this share, the slide ends. Once
// nothing is folded in the planes that share is larger: in new ones the least energy is elsewhere.
constexpr int kHalvings = 30;
constexpr double kArmijo = 1e-4, kLeastGain = 1e-6, kLeastGainUnfolded = 0.1;

// No vertex goes farther than this, in distances, in one step.
constexpr double kLongestStep = 0.5;

/// Two directions at right angles to n and to each other.
std::array<Vec3d, 2> plane_of(const Vec3d& n) {
  const int axis = std::abs(n[0]) < std::abs(n[1]) ? (std::abs(n[0]) < std::abs(n[2]) ? 0 : 2)
                                                   : (std::abs(n[1]) < std::abs(n[2]) ? 1 : 2);
  Vec3d e(0.0);
  e[axis] = 1;
  const Vec3d u = n.cross(e).unit();
  return {u, n.cross(u)};
}

/// Four sums at a time: one would wait for each addition before the next.
double dot(std::span<const double> a, std::span<const double> b) {
  constexpr std::size_t kSums = 4;
  std::array<double, kSums> sum{};
  std::size_t i = 0;
  for (; i + kSums <= a.size(); i += kSums)
    for (std::size_t k = 0; k < kSums; ++k) sum[k] += a[i + k] * b[i + k];
  for (; i < a.size(); ++i) sum[0] += a[i] * b[i];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/// L-BFGS: what the last steps tell of the energy's curvature (Nocedal and Wright, Numerical Optimization, 2006,
/// algorithm 7.4).
class QuasiNewton {
 public:
  void remember(std::span<const double> x, std::span<const double> next_x, std::span<const double> g,
                std::span<const double> next_g) {
    double2 pair{std::vector<double>(x.size()), std::vector<double>(x.size()), 0};
    for (std::size_t k = 0; k < x.size(); ++k) {
      pair.s[k] = next_x[k] - x[k];
      pair.y[k] = next_g[k] - g[k];
    }
    const double curvature = dot(pair.s, pair.y);
    if (!(curvature > 1e-12 * std::sqrt(dot(pair.s, pair.s) * dot(pair.y, pair.y)))) return;
    pair.rho = 1 / curvature;
    pairs_.push_back(std::move(pair));
    if (pairs_.size() > kMemory) pairs_.pop_front();
  }

  /// The step to where the gradient g would vanish.
  void descend(std::span<const double> g, std::span<double> step) const {
    for (std::size_t k = 0; k < g.size(); ++k) step[k] = -g[k];
    std::array<double, kMemory> alpha{};
    for (std::size_t p = pairs_.size(); p-- > 0;) {
      alpha[p] = pairs_[p].rho * dot(pairs_[p].s, step);
      add(-alpha[p], pairs_[p].y, step);
    }
    if (pairs_.empty()) return;
    const double scale = 1 / (pairs_.back().rho * dot(pairs_.back().y, pairs_.back().y));
    for (double& s : step) s *= scale;
    for (std::size_t p = 0; p < pairs_.size(); ++p)
      add(alpha[p] - pairs_[p].rho * dot(pairs_[p].y, step), pairs_[p].s, step);
  }

 private:
  struct double2 {
    std::vector<double> s, y;  // of places and of gradients
    double rho;
  };
  static void add(double factor, std::span<const double> a, std::span<double> sum) {
    for (std::size_t k = 0; k < a.size(); ++k) sum[k] += factor * a[k];
  }

  std::deque<double2> pairs_;
};

class Patch {
 public:
  Patch(const ConstrainedSurface& constrained, const Distances& distances, const Untangler::Options& options,
        std::span<const std::uint32_t> vertices, std::span<Vec3d> way)
      : constrained_(constrained),
        surface_(constrained.surface),
        front_(constrained.front.surface()),
        distances_(distances),
        options_(options),
        free_(vertices.size()) {
    for (const auto v : vertices) {
      add_point(v, way);
      scale_ = std::max(scale_, points_.back().target);
    }
    collect_faces(vertices, way);
  }

  void untangle() {
    renew_planes();
    std::vector<Vec3d> best = places();
    const int most_fruitless = options_.thorough ? kRenewals : free_ > kSmall ? kFruitless : kFruitlessIfSmall;
    int fewest = folded_, fruitless = 0;
    for (int i = 0; i < kRenewals && (i == 0 || fewest > 0) && fruitless < most_fruitless; ++i) {
      const std::vector<Vec3d> before = places();
      slide();
      for (std::size_t k = 0; k < free_; ++k)
        if (!points_[k].stuck) return_to_distance(points_[k], before[k]);
      renew_planes();
      fruitless = folded_ < fewest ? 0 : fruitless + 1;
      if (i > 0 && folded_ > fewest) continue;
      fewest = folded_;
      best = places();
    }
    for (std::size_t k = 0; k < free_; ++k) points_[k].x = best[k];
  }

  void store(std::span<Vec3d> way) const {
    for (std::size_t i = 0; i < free_; ++i)
      way[points_[i].vertex] = round_way(points_[i].x - surface_.vertices[points_[i].vertex], points_[i].target);
  }

 private:
  struct Point {
    std::uint32_t vertex, hint;
    double target;                 // distance to the front that is asked for
    int side;                      // of the front, 1 or -1
    double distance;               // to the front when planes were renewed
    Vec3d x, normal;               // local frame; outward from the front, smoothed over the neighbours
    std::array<Vec3d, 2> tangent;  // at right angles to it
    bool stuck = false;            // planes leave it no way
  };
  struct Face {
    std::array<std::uint32_t, 3> point;
    double inverse[3];  // of the source's edges (a, b; 0, c) in the plane: 1/a, -b/(a c), 1/c
    double area;
    double edge[2][2];    // from the first corner to the others, in the face's plane
    double map[3][2][2];  // how a slide of each corner along each of its tangents shows in that plane
  };

  void add_point(std::uint32_t v, std::span<const Vec3d> way) {
    const double d = distances_[v];
    points_.push_back({v, constrained_.hint(v), std::abs(d), d < 0 ? -1 : 1, 0, surface_.vertices[v] + way[v], {}, {}});
  }

  std::uint32_t index_of(std::uint32_t v, std::span<const std::uint32_t> vertices, std::span<const Vec3d> way) {
    const auto at = std::lower_bound(vertices.begin(), vertices.end(), v);
    if (at != vertices.end() && *at == v) return static_cast<std::uint32_t>(at - vertices.begin());
    const auto known = std::find_if(points_.begin() + static_cast<std::ptrdiff_t>(free_), points_.end(),
                                    [&](const Point& p) { return p.vertex == v; });
    if (known != points_.end()) return static_cast<std::uint32_t>(known - points_.begin());
    add_point(v, way);
    return static_cast<std::uint32_t>(points_.size() - 1);
  }

  void collect_faces(std::span<const std::uint32_t> vertices, std::span<const Vec3d> way) {
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
      Face face = options_.least_edge > 0 ? sturdy_face(t)
                                          : face_of(surface_.triangles[t], length, ab.dot(ac) / length,
                                                    twice_area / length, twice_area / 2);
      for (auto& corner : face.point) corner = index_of(corner, vertices, way);
      faces_.push_back(face);
    }
  }

  /// Its points are vertices yet. The first edge is so long; so far along it and above it is the third corner.
  static Face face_of(const std::array<std::uint32_t, 3>& corners, double length, double along, double height,
                      double area) {
    return {corners, {1 / length, -along / (length * height), 1 / height}, area, {}, {}};
  }

  /// A face on its longest edge, not shorter or lower than may be; of an area in the energy by which, however slender
  /// it is, it resists what changes its height as any other.
  Face sturdy_face(std::uint32_t t) const {
    std::array<std::uint32_t, 3> corners = surface_.triangles[t];
    const auto& x = surface_.vertices;
    const auto is_longest = [&] {
      const double first = (x[corners[1]] - x[corners[0]]).lengthSqr();
      return first >= (x[corners[2]] - x[corners[1]]).lengthSqr() &&
             first >= (x[corners[0]] - x[corners[2]]).lengthSqr();
    };
    for (int turns = 0; turns < 2 && !is_longest(); ++turns)
      std::rotate(corners.begin(), corners.begin() + 1, corners.end());
    const Vec3d ab = x[corners[1]] - x[corners[0]], ac = x[corners[2]] - x[corners[0]];
    const double least = options_.least_edge * scale_, stretch = std::max(1.0, least / ab.length()),
                 length = ab.length() * stretch, along = ab.dot(ac) / ab.length() * stretch,
                 height = std::max(ab.cross(ac).length() / ab.length() * stretch, std::min(least, length / 2));
    return face_of(corners, length, along, height, height * height / 2);
  }

  void renew_planes() {
    for (Point& p : points_) {
      if (p.x == surface_.vertices[p.vertex]) {
        p.normal = surface_.vertex_normals[p.vertex];
        if (p.normal.lengthSqr() > 1e-12) p.normal.normalize();
        continue;
      }
      const TrianglePoint nearest = front_.walk_to_closest(p.x, p.hint);
      p.distance = std::sqrt(nearest.squared_distance);
      p.normal = p.distance > 0 ? (p.x - nearest.point) / (p.side * p.distance) : Vec3d(0.0);
    }
    for (int i = 0; i < options_.smoothing; ++i) smooth_normals();
    for (Point& p : points_) p.tangent = plane_of(p.normal);
    if (!front_.conormals.empty()) keep_borders();
    least_det_ = 1;
    folded_ = 0;
    for (Face& face : faces_) {
      Vec3d n(0.0);
      for (const auto i : face.point) n += points_[i].normal;
      if (!(n.lengthSqr() > 1e-12)) n = points_[face.point[0]].normal;
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
  /// Vertices of a border stay in the plane across it: they slide along the border alone. Those that planes hold do so
  /// in any case: in one of them, on the line between two, or not at all.
  void keep_borders() {
    for (Point& p : points_) {
      const std::uint32_t v = constrained_.front_vertex.empty() ? p.vertex : constrained_.front_vertex[p.vertex];
      if (v == kNone) continue;
      const bool held = front_.is_held(v);
      const Vec3d& c = front_.conormals[v];
      const Vec3d n = front_.along_border(v, p.normal);
      p.stuck = held && !(n.lengthSqr() > 1e-12);
      if (p.stuck) p.tangent.fill(Vec3d(0.0));
      if (!(held || options_.keep_borders) || c.lengthSqr() == 0 || !(n.lengthSqr() > 1e-12)) continue;
      p.normal = n.unit();
      p.tangent = {held ? front_.along_border(v, p.normal.cross(c)) : p.normal.cross(c), Vec3d(0.0)};
    }
  }

  /// Each normal becomes the mean of its own and those across the faces around.
  void smooth_normals() {
    std::vector<Vec3d> sum(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) sum[i] = points_[i].normal;
    for (const Face& face : faces_) {
      const Vec3d n = points_[face.point[0]].normal + points_[face.point[1]].normal + points_[face.point[2]].normal;
      for (const auto i : face.point) sum[i] += n;
    }
    for (std::size_t i = 0; i < points_.size(); ++i)
      points_[i].normal = sum[i].lengthSqr() > 1e-12 ? sum[i].unit() : Vec3d(0.0, 0.0, 1.0);
  }

  std::vector<Vec3d> places() const {
    std::vector<Vec3d> x(free_);
    for (std::size_t i = 0; i < free_; ++i) x[i] = points_[i].x;
    return x;
  }

  /// How a face is mapped, by rows (0, 1; 2, 3), where its edges in the plane lead from the first corner to the others.
  struct Jacobian {
    double j[4];
    double det() const { return j[0] * j[3] - j[1] * j[2]; }
  };
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
  /// The energy, and its derivative by the slides, two numbers for each point, which are 0 of those that stand still.
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
      double by_place[3][2];
      for (std::size_t row = 0; row < 2; ++row) {
        by_place[1][row] = (by_j[2 * row] * face.inverse[0] + by_j[2 * row + 1] * face.inverse[1]) * face.area;
        by_place[2][row] = by_j[2 * row + 1] * face.inverse[2] * face.area;
        by_place[0][row] = -by_place[1][row] - by_place[2][row];
      }
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t axis = 0; axis < 2; ++axis)
          derivative[2 * face.point[k] + axis] +=
              face.map[k][axis][0] * by_place[k][0] + face.map[k][axis][1] * by_place[k][1];
    }
    std::fill(derivative.begin() + static_cast<std::ptrdiff_t>(2 * free_), derivative.end(), 0.0);
    return all;
  }

  /// Lets the energy fall, with L-BFGS directions and halved steps, then puts the points where they have slid to.
  void slide() {
    const std::size_t n = 2 * points_.size();
    const double folded = std::min(least_det_, 0.0), epsilon = std::sqrt(1e-12 + 0.04 * folded * folded);
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

  /// The share of a step to try first: all of it, if no point goes too far by that.
  double first_step(std::span<const double> step, bool scaled_by_nothing) const {
    double longest2 = 0;
    for (std::size_t k = 0; k < step.size(); k += 2)
      longest2 = std::max(longest2, step[k] * step[k] + step[k + 1] * step[k + 1]);
    const double most = kLongestStep * scale_ / std::sqrt(longest2);
    return scaled_by_nothing ? most : std::min(1.0, most);
  }

  void move_points(std::span<const double> slide) {
    for (std::size_t i = 0; i < free_; ++i) {
      Point& p = points_[i];
      const Vec3d way = p.tangent[0] * slide[2 * i] + p.tangent[1] * slide[2 * i + 1];
      const double length = way.length(), free = kFreeShare * p.distance;
      p.x += length > free ? way * (free / length) : way;
    }
  }

  /// Along the smoothed normal to the distance. On the way out phi is concave there, as the least of the distances to
  /// what is near, so that Newton's steps settle; where they do not, the vertex stays where it was. The triangles
  /// around the last answer are asked what is near, and the exact query only whether that is so. A vertex of a fold,
  /// which no direction leads away from, may stand on the surface yet: it steps off.
  void return_to_distance(Point& p, const Vec3d& before) const {
    constexpr int kMostSteps = 40;
    constexpr double kSettled = 1e-9, kLeastSlope = 0.1, kStepOff = 0.02;
    const Vec3d away = p.normal * p.side;
    for (int i = 0; i < kMostSteps; ++i) {
      TrianglePoint nearest = front_.walk_to_closest(p.x, p.hint);
      double distance = std::sqrt(nearest.squared_distance);
      if (std::abs(distance - p.target) <= kSettled * p.target) {
        const Closest closest = constrained_.front(p.x, p.hint);
        if (std::abs(closest.distance - p.target) <= kSettled * p.target) return;
        p.hint = closest.triangle;
        distance = closest.distance;
        nearest.point = closest.point;
      }
      if (!(distance > 1e-3 * p.target)) {
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
  const Surface& front_;
  const Distances& distances_;
  Untangler::Options options_;
  std::size_t free_;  // the first points are the patch's, the others stand around it
  double scale_ = 0;  // the farthest that a point of the patch goes
  std::vector<Point> points_;
  std::vector<Face> faces_;
  double least_det_ = 1;  // of the faces, as planes were renewed, and how many are folded over
  int folded_ = 0;
};

}  // namespace

void Untangler::operator()(std::span<const std::uint32_t> patch, std::span<Vec3d> way) const {
  Patch work(constrained_, distances_, options_, patch, way);
  work.untangle();
  work.store(way);
}

}  // namespace vdb_offset
