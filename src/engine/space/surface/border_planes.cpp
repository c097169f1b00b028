// SPDX-License-Identifier: Apache-2.0
#include "space/surface/border_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "ground/numbers/index_set.h"
#include "space/surface/border_loops.h"
#include "space/surface/start_direction.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

// How far a vertex may be off its plane, as a share of the largest coordinate: files that keep seven digits put points
// off by a few units of the last one.
constexpr double kSevenDigits = 1e-6;
// Largest such distance as a share of the diagonal: far from the origin, the largest coordinate says little about the
// size of the mesh. Not measured.
constexpr double kRoughest = 1e-5;
// Least cosine between a direction in a plane and the normals of the faces around a vertex, for the vertex to move
// within the plane. Not measured.
constexpr double kWithinReach = 0.2;
// The same of a plane that a border lies in, but is not held in, for it to be reported: the sine of the angle by which
// faces have to rise from it, as others do from their own border's plane. Not measured.
constexpr double kWorthTelling = 0.02;
// Share of a piece's length along which vertices must be able to move within its plane. Not measured.
constexpr double kMostInReach = 0.9;
// Least number of edges of a piece that lies in a plane: so many hardly do by chance. Fewer are enough for a plane at
// right angles to an axis, which is most likely meant. Not measured.
constexpr std::size_t kManyEdges = 4, kFewEdges = 2;
// Least width of a piece, in tolerances: a narrower one is a line, and lies in many planes. Not measured.
constexpr double kWideEnough = 8;
// Least sine between the plane of a piece and the edges beside it: if these leave the plane by less, the border bends
// smoothly, and the piece is in the plane by chance. Not measured.
constexpr double kLeaves = 0.02;
// Sine of the angle below which two planes count as one. Not measured.
constexpr double kSamePlane = 1e-4;
// How far below 1 the cosine between normals of faces in one plane may be: rounding alone. Not measured.
constexpr double kSameNormal = 1e-12;

Vec3d axis_of(int k) {
  Vec3d axis(0.0);
  axis[k] = 1;
  return axis;
}

bool is_axis(const Vec3d& normal) {
  return std::abs(normal[0]) == 1 || std::abs(normal[1]) == 1 || std::abs(normal[2]) == 1;
}

/// A vertex, and the number of a plane that holds it.
struct Hold {
  std::uint32_t vertex, plane;
  bool operator==(const Hold&) const = default;
  bool operator<(const Hold& other) const {
    return vertex != other.vertex ? vertex < other.vertex : plane < other.plane;
  }
};

/// How far from a plane a vertex counts as on it.
double plane_tolerance(const Surface& surface) {
  double largest = 0;
  for (int k = 0; k < 3; ++k)
    largest = std::max({largest, std::abs(surface.facts.lower[k]), std::abs(surface.facts.upper[k])});
  return std::min(kSevenDigits * largest, kRoughest * surface.facts.diagonal);
}

class PlaneFinder {
 public:
  PlaneFinder(Surface& surface, double reach, const LeadsOn& leads_on)
      : surface_(surface), reach_(reach), tolerance_(plane_tolerance(surface)), leads_on_(leads_on) {}

  void name(const SymmetryPlane& in_world) {
    const SymmetryPlane plane{in_world.normal, in_world.offset - in_world.normal.dot(surface_.origin)};
    const std::size_t before = holds_.size();
    const std::uint32_t number = number_of(plane, true);
    for (std::uint32_t v = 0; v < surface_.vertices.size(); ++v)
      if (is_on(plane, v)) holds_.push_back({v, number});
    if (holds_.size() == before)
      throw InvalidInput("symmetry: expected vertices on the plane " + text_of(in_world) + ", found none");
    surface_.named_planes = surface_.planes.size();
  }

  void find() {
    for (const BorderLoop& loop : border_loops(surface_)) find_in(loop);
  }

  /// Gives vertices the conormals of the planes that hold them.
  void settle() {
    if (holds_.empty()) return;
    std::sort(holds_.begin(), holds_.end());
    if (surface_.conormals.empty()) surface_.conormals.assign(surface_.vertices.size(), Vec3d(0.0));
    surface_.held.assign(surface_.vertices.size(), 0);
    for (std::size_t first = 0, last = 0; first < holds_.size(); first = last) {
      while (last < holds_.size() && holds_[last].vertex == holds_[first].vertex) ++last;
      settle(std::span(holds_).subspan(first, last - first));
    }
    std::vector<Indices> held(surface_.planes.size());
    for (const auto& [v, number] : holds_)
      if (is_wall_[number]) held[number].push_back(v);
    raise_walls(surface_, held, reach_, tolerance_);
  }

 private:
  static std::string text_of(const SymmetryPlane& plane) {
    std::string text;
    for (int k = 0; k < 3; ++k) {
      if (plane.normal[k] == 0) continue;
      if (!text.empty()) text += " + ";
      if (plane.normal[k] != 1) text += std::to_string(plane.normal[k]) + ' ';
      text += "xyz"[k];
    }
    return text + " = " + std::to_string(plane.offset);
  }

  bool is_on(const SymmetryPlane& plane, std::uint32_t v) const {
    return std::abs(plane.height(surface_.vertices[v])) <= tolerance_;
  }

  std::uint32_t number_of(const SymmetryPlane& plane, bool is_wall) {
    const auto same = std::find_if(surface_.planes.begin(), surface_.planes.end(), [&](const SymmetryPlane& known) {
      return known.normal == plane.normal && std::abs(known.offset - plane.offset) <= tolerance_;
    });
    const auto number = static_cast<std::uint32_t>(same - surface_.planes.begin());
    if (same == surface_.planes.end()) {
      surface_.planes.push_back(plane);
      is_wall_.push_back(is_wall);
    }
    is_wall_[number] = is_wall_[number] || is_wall;
    return number;
  }

  /// Whether a direction at right angles to these conormals leads away from all faces around a vertex. False if the
  /// vertex's normal is along the conormals but for rounding: there is no such direction then.
  bool leads_off(std::uint32_t v, std::span<const Vec3d> conormals, double least) const {
    const Vec3d& normal = surface_.vertex_normals[v];
    Vec3d along = normal;
    for (const Vec3d& c : conormals) along -= c * c.dot(along);
    return along.length() > least * normal.length() && least_cosine(surface_, v, along.unit()) >= least;
  }

  /// Whether a direction within the plane leads away from all faces around a vertex.
  bool is_in_reach(std::uint32_t v, const Vec3d& normal) const { return leads_off(v, {&normal, 1}, kWithinReach); }

  /// Whether that is so along most of a piece.
  bool is_in_reach(std::span<const std::uint32_t> piece, const Vec3d& normal, double least) const {
    double reached = 0;
    for (std::size_t i = 1; i < piece.size(); ++i)
      if (leads_off(piece[i], {&normal, 1}, least) && leads_off(piece[i - 1], {&normal, 1}, least))
        reached += length_of(piece.subspan(i - 1, 2));
    return reached >= kMostInReach * length_of(piece);
  }

  /// Whether one of the faces around a vertex lies in the plane: its offset leaves the plane, and the vertex with it.
  bool has_face_in(const SymmetryPlane& plane, std::uint32_t v) const {
    const auto around = surface_.triangles_around(v);
    return std::any_of(around.begin(), around.end(), [&](std::uint32_t t) {
      const auto& corners = surface_.triangles[t];
      return surface_.triangle_normals[t].lengthSqr() > 0 &&
             std::all_of(corners.begin(), corners.end(), [&](std::uint32_t w) { return is_on(plane, w); });
    });
  }

  /// What a set of vertices lies in.
  enum class Shape { Line, Plane, Neither };
  struct Fit {
    Shape shape;
    SymmetryPlane plane;
  };

  /// The plane that vertices lie in: one at right angles to an axis if the tolerance allows it.
  Fit fit(std::span<const std::uint32_t> piece) const {
    const auto at = [&](std::uint32_t v) -> const Vec3d& { return surface_.vertices[v]; };
    const auto farthest = [&](auto&& distance) {
      return *std::max_element(piece.begin(), piece.end(),
                               [&](std::uint32_t a, std::uint32_t b) { return distance(at(a)) < distance(at(b)); });
    };
    const Vec3d a = at(piece.front()), b = at(farthest([&](const Vec3d&x) { return (x - a).lengthSqr(); }));
    const double length = (b - a).length();
    if (!(length > 0)) return {Shape::Line, {}};
    const Vec3d along = (b - a) / length;
    const auto beside = [&](const Vec3d& x) { return (x - a) - along * along.dot(x - a); };
    const Vec3d aside = beside(at(farthest([&](const Vec3d& x) { return beside(x).lengthSqr(); })));
    if (!(aside.length() > kWideEnough * tolerance_)) return {Shape::Line, {}};
    Vec3d normal = along.cross(aside).unit();
    for (int k = 0; k < 3; ++k)
      if (spread(piece, axis_of(k)).second <= 2 * tolerance_) normal = axis_of(k);
    const auto [middle, width] = spread(piece, normal);
    return {width <= 4 * tolerance_ ? Shape::Plane : Shape::Neither, {normal, middle}};
  }

  /// The middle of the lowest and highest position along a normal, and the distance between these.
  std::pair<double, double> spread(std::span<const std::uint32_t> piece, const Vec3d& normal) const {
    double low = normal.dot(surface_.vertices[piece.front()]), high = low;
    for (const auto v : piece) {
      const double height = normal.dot(surface_.vertices[v]);
      low = std::min(low, height);
      high = std::max(high, height);
    }
    return {(low + high) / 2, high - low};
  }

  double length_of(std::span<const std::uint32_t> piece) const {
    double length = 0;
    for (std::size_t i = 1; i < piece.size(); ++i)
      length += (surface_.vertices[piece[i]] - surface_.vertices[piece[i - 1]]).length();
    return length;
  }

  /// Holds the vertices of a piece in its plane, if most of them can move within the plane.
  bool hold_piece(std::span<const std::uint32_t> piece, const SymmetryPlane& plane, bool is_wall = true) {
    if (!is_in_reach(piece, plane.normal, kWithinReach)) {
      if (is_wall && is_in_reach(piece, plane.normal, kWorthTelling))
        surface_.left_planes.push_back({plane, {piece.begin(), piece.end()}});
      return false;
    }
    Indices held;
    for (std::size_t i = 0; i < piece.size(); ++i)
      if (!leads_on_at(piece, i, plane)) held.push_back(piece[i]);
    if (held.empty()) return false;
    const std::uint32_t number = number_of(plane, is_wall && held.size() == piece.size());
    for (const auto v : held)
      if (!has_face_in(plane, v)) holds_.push_back({v, number});
    return true;
  }

  /// Whether the mesh leads on out of a plane at a vertex of a piece, beyond all edges that the piece has there.
  bool leads_on_at(std::span<const std::uint32_t> piece, std::size_t i, const SymmetryPlane& plane) const {
    if (!leads_on_) return false;
    const auto beyond = [&](std::size_t other) { return leads_on_(piece[i], piece[other], plane.normal); };
    return (i == 0 || beyond(i - 1)) && (i + 1 == piece.size() || beyond(i + 1));
  }

  void find_in(const BorderLoop& loop) {
    std::vector<std::uint32_t> all = loop.vertices;
    if (loop.closed) {
      const Fit whole = fit(all);
      std::rotate(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(sharpest_corner(all)), all.end());
      all.push_back(all.front());
      if (whole.shape == Shape::Plane && (hold_piece(all, whole.plane) || hold_runs(all, whole.plane))) return;
      if (whole.shape == Shape::Plane) return;
    }
    std::size_t first = 0;
    while (first + 1 < all.size()) first = hold_from(all, first);
  }

  /// The index of the vertex at which a closed border turns most.
  std::size_t sharpest_corner(std::span<const std::uint32_t> all) const {
    std::size_t sharpest = 0;
    double least = 2;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Vec3d& at = surface_.vertices[all[i]];
      const Vec3d in = at - surface_.vertices[all[(i + all.size() - 1) % all.size()]],
                  out = surface_.vertices[all[(i + 1) % all.size()]] - at;
      const double cosine = in.dot(out) / std::sqrt(in.lengthSqr() * out.lengthSqr());
      if (!(cosine < least)) continue;
      least = cosine;
      sharpest = i;
    }
    return sharpest;
  }

  /// Holds those pieces of a plane border from which the faces rise out of the plane: they may rise along some of its
  /// sides only.
  bool hold_runs(std::span<const std::uint32_t> all, const SymmetryPlane& plane) {
    bool any = false;
    for (std::size_t first = 0, last = 0; first < all.size(); first = last + 1) {
      const auto rises = [&](std::size_t i) { return is_in_reach(all[i], plane.normal); };
      for (last = first; last < all.size() && rises(last);) ++last;
      if (last - first > kManyEdges) any = hold_piece(all.subspan(first, last - first), plane) || any;
    }
    return any;
  }

  /// Finds the longest piece that begins at a vertex of a border and lies in a plane or on a line, and holds it.
  /// Returns where the next piece begins.
  std::size_t hold_from(std::span<const std::uint32_t> all, std::size_t first) {
    const std::size_t straight = end_of_line(all, first), last = longest_from(all, first, straight);
    // A piece that goes one edge beyond a straight line gives no plane: a line and an edge always lie in one.
    if (straight - first >= kFewEdges && last <= straight + 1) {
      hold_line(all.subspan(first, straight - first + 1));
      return straight;
    }
    const auto piece = all.subspan(first, last - first + 1);
    const Fit found = fit(piece);
    const bool on_axis = is_axis(found.plane.normal);
    if (found.shape != Shape::Plane || last - first < (on_axis ? kFewEdges : kManyEdges) ||
        !leaves_at_ends(all, first, last, found.plane))
      return first + 1;
    hold_piece(piece, found.plane);
    return last;
  }

  /// Whether a border leaves the plane of a piece abruptly before and behind it. A smooth border that is
  /// not plane also lies nearly in a plane for a few edges, but leaves it gradually.
  bool leaves_at_ends(std::span<const std::uint32_t> all, std::size_t first, std::size_t last,
                      const SymmetryPlane& plane) const {
    const bool closed = all.front() == all.back();
    const auto leaves = [&](std::uint32_t from, std::uint32_t to) {
      const Vec3d &a = surface_.vertices[from], &b = surface_.vertices[to];
      return std::abs(plane.height(b)) > std::max(kLeaves * (b - a).length(), kWideEnough * tolerance_);
    };
    if ((first > 0 || closed) && !leaves(all[first], all[first > 0 ? first - 1 : all.size() - 2])) return false;
    const bool at_end = last + 1 == all.size();
    return (at_end && !closed) || leaves(all[last], all[at_end ? 1 : last + 1]);
  }

  /// The last vertex of the straight piece that begins at vertex `first` of a border.
  std::size_t end_of_line(std::span<const std::uint32_t> all, std::size_t first) const {
    const Vec3d &a = surface_.vertices[all[first]], along = surface_.vertices[all[first + 1]] - a;
    std::size_t last = first + 1;
    for (; last + 1 < all.size(); ++last) {
      const Vec3d to = surface_.vertices[all[last + 1]] - a;
      const double far = along.dot(to);
      if (!(far > 0 && (to - along * (far / along.lengthSqr())).length() <= 2 * tolerance_)) break;
    }
    return last;
  }

  /// The last vertex, at least `known`, up to which all vertices from `first` on lie in a plane. Found by doubling the
  /// step while they do, then by bisection.
  std::size_t longest_from(std::span<const std::uint32_t> all, std::size_t first, std::size_t known) const {
    const auto holds = [&](std::size_t last) {
      return fit(all.subspan(first, last - first + 1)).shape != Shape::Neither;
    };
    std::size_t low = known, high = all.size();
    for (std::size_t step = 1; low + 1 < high; step *= 2) {
      const std::size_t next = std::min(low + step, high - 1);
      if (!holds(next)) high = next;
      else low = next;
      if (high < all.size()) break;
    }
    while (low + 1 < high) {
      const std::size_t middle = (low + high) / 2;
      (holds(middle) ? low : high) = middle;
    }
    return low;
  }

  /// Holds a straight piece along which all faces are in one plane, in the plane at right angles to these faces. That
  /// is no wall: the surface may bend farther on, and pass it.
  void hold_line(std::span<const std::uint32_t> piece) {
    const Vec3d along = surface_.vertices[piece.back()] - surface_.vertices[piece.front()];
    if (piece.size() <= kFewEdges) return;
    Vec3d across(0.0);
    for (std::size_t i = 1; i + 1 < piece.size(); ++i) {
      const Vec3d& c = surface_.conormals[piece[i]];
      if (c.lengthSqr() == 0) return;
      if (i == 1) across = c;
      else if (!(across.dot(c) >= 1 - kSameNormal)) return;
    }
    across -= along * (across.dot(along) / along.lengthSqr());
    if (!(across.lengthSqr() > 0.5)) return;
    across.normalize();
    for (int k = 0; k < 3; ++k)
      if (std::abs(across[k]) >= 1 - kSameNormal || turns_to_axis(piece, across, k)) across = axis_of(k);
    hold_piece(piece, {across, spread(piece, across).first}, false);
  }

  /// Whether the faces along a straight piece stand for a curved surface that meets the plane of the piece across an
  /// axis at right angles, as half a pipe meets the plane through its axis: as much as normals turn towards the next
  /// faces, they turn the other way towards the piece.
  bool turns_to_axis(std::span<const std::uint32_t> piece, const Vec3d& across, int k) const {
    constexpr double kNearAxis = 0.86;  // cosine: 30 degrees; pipes of six sides turn so much. Reasoned.
    if (std::abs(across[k]) < kNearAxis || spread(piece, axis_of(k)).second > 2 * tolerance_) return false;
    double off_faces = 0, off_piece = 0;
    for (std::size_t i = 1; i + 1 < piece.size(); ++i)
      for (const auto t : surface_.triangles_around(piece[i]))
        for (const auto w : surface_.triangles[t]) {
          Vec3d farther = surface_.vertex_normals[w];
          if (surface_.conormals[w].lengthSqr() > 0 || !farther.normalize()) continue;
          const Vec3d& n = surface_.triangle_normals[t];
          off_faces += n[k];
          off_piece += 2 * n.dot(farther) * n[k] - farther[k];
        }
    return std::abs(off_piece) < std::abs(off_faces) / 2;
  }

  /// Gives one vertex its conormals: it stays in one plane, on the line where two meet, or at the point where three do.
  /// Planes that were not named by the user are left out where the vertex could not leave its faces otherwise. Planes
  /// at right angles to an axis come first, as conormals after the first are rounded.
  void settle(std::span<Hold> all) {
    const std::uint32_t v = all.front().vertex;
    const auto normal_of = [&](const Hold& each) -> const Vec3d& { return surface_.planes[each.plane].normal; };
    std::stable_partition(all.begin(), all.end(), [&](const Hold& each) { return is_axis(normal_of(each)); });
    std::stable_partition(all.begin(), all.end(), [&](const Hold& each) { return each.plane < surface_.named_planes; });
    std::array<Vec3d, 3> conormal{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};
    std::uint8_t count = 0;
    for (const Hold& each : all) {
      Vec3d left = normal_of(each);
      for (std::uint8_t i = 0; i < count; ++i) left -= conormal[i] * conormal[i].dot(left);
      if (!(left.length() > kSamePlane)) continue;
      conormal[count] = left.unit();
      if (each.plane >= surface_.named_planes && count > 0 &&
          (count == 2 || !leads_off(v, std::span(conormal).first(count + 1u), kWithinReach / 2)))
        continue;
      if (++count == 3) break;
    }
    surface_.held[v] = count;
    surface_.conormals[v] = conormal[0];
    if (count == 2) surface_.second_conormals.emplace_back(v, conormal[1]);
  }

  Surface& surface_;
  double reach_, tolerance_;
  const LeadsOn& leads_on_;
  std::vector<std::uint8_t> is_wall_;  // of each plane: 1 if it may be a wall
  std::vector<Hold> holds_;
};

}  // namespace

double SymmetryPlane::height(const Vec3d& x) const { return normal.dot(x) - offset; }

void hold_in_planes(Surface& surface, const SymmetryOptions& options, double reach, const LeadsOn& leads_on) {
  if (surface.conormals.empty() && options.planes.empty()) return;
  PlaneFinder finder(surface, reach, leads_on);
  for (const SymmetryPlane& plane : options.planes) finder.name(plane);
  if (options.find && surface.facts.boundary_left > 0) finder.find();
  finder.settle();
}

PlaneNormals planes_along(const Surface& surface, std::span<const std::uint32_t> vertices, bool is_on_border) {
  PlaneNormals found;
  if (!std::all_of(vertices.begin(), vertices.end(), [&](std::uint32_t v) { return surface.is_held(v); })) return found;
  const double tolerance = plane_tolerance(surface);
  const std::size_t count = is_on_border ? surface.planes.size() : surface.named_planes;
  // Planes at right angles to an axis come first, as normals after the first are rounded.
  for (const bool on_axis : {true, false})
    for (std::size_t i = 0; i < count && found.count < 3; ++i) {
      const SymmetryPlane& plane = surface.planes[i];
      const auto is_off = [&](std::uint32_t v) { return std::abs(plane.height(surface.vertices[v])) > 2 * tolerance; };
      if (is_axis(plane.normal) != on_axis || std::any_of(vertices.begin(), vertices.end(), is_off)) continue;
      const Vec3d left = found.within(plane.normal);
      if (left.length() > kSamePlane) found.normal[found.count++] = left.unit();
    }
  return found;
}

}  // namespace vdb_offset
