// SPDX-License-Identifier: Apache-2.0
// Takes vertices out of flat parts of a closed mesh by collapsing edges. A vertex may go if it and all neighbours lie
// within a tolerance of one plane, or of two planes whose straight edge runs through it. It is merged into the
// neighbour with which the thinnest triangle around is widest, unless a triangle would turn round or become too thin,
// or the two have other common neighbours than those of their edge, so that the mesh stays manifold. Neighbours of what
// has gone are tried again until nothing goes any more. merge_flats_soundly() looks for crossings after that, and
// starts over with vertices around them held, in rings twice as wide each time; if that does not help, the mesh stays
// as it was. No vertex that is left has moved. Meshes with next to nothing flat are left alone.
#include "products/iso/merge_flats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "products/iso/mend.h"

namespace vdb_offset {
namespace {

// The most triangles around a vertex that is taken out: with more, it waits until some of them have gone. Bounds the
// cost of a trial, which grows with their square. Not measured.
constexpr std::size_t kMostAround = 14;
// The least height of a triangle, as a share of its longest edge, that merging may make, unless there was one as thin:
// 1 to 50. Not measured.
constexpr double kThin = 0.02;
// The least sine of the angle between two flat parts (3 degrees): below it, the edge between them is too vague for its
// vertices to be merged along it. Not measured.
constexpr double kLeastMergedAngle = 0.05;
// The least cosine between normals of one plane (0.8 degrees), but for triangles with next to no area. For a quick test
// that leaves out most vertices of curved parts; not measured.
constexpr double kAlikeNormals = 0.9999;
// The least height of a triangle, in tolerances, that gives a plane. Not measured.
constexpr double kClearHeight = 8;
// The least share of vertices in flat parts for which merging is worth its time. Not measured.
constexpr double kWorthMerging = 0.02;
// The most trials of merging. With each, vertices stay in rings twice as wide around crossings: at last 16 edges. Not
// measured.
constexpr int kMostMergeTrials = 5;

using List = std::vector<std::uint32_t>;

struct FlatPlane {
  Vec3d point, normal;
  double height(const Vec3d& x) const { return normal.dot(x - point); }
};

class FlatMerger {
 public:
  FlatMerger(Surface& mesh, double tolerance, std::span<const std::uint8_t> stays)
      : mesh_(mesh),
        tolerance_(tolerance),
        stays_(stays),
        stars_(mesh.vertices.size()),
        is_gone_(mesh.triangles.size(), 0),
        is_changed_(mesh.triangles.size(), 0) {}

  /// Takes out vertices until none can be. Vertices that lost a neighbour, or got others, are tried again.
  MergedFlats run() {
    MergedFlats merged;
    List turn = find_flat();
    if (static_cast<double>(turn.size()) < kWorthMerging * static_cast<double>(mesh_.vertices.size())) return merged;
    std::size_t& taken = merged.vertices;
    while (!turn.empty()) {
      touched_.clear();
      for (const auto v : turn) taken += try_to_take(v);
      std::sort(touched_.begin(), touched_.end());
      touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
      turn.swap(touched_);
    }
    if (taken > 0) close_ranks(merged);
    return merged;
  }

 private:
  /// The vertices inside flat parts, and on straight edges between two. For most vertices of curved parts the normals
  /// around them suffice.
  List find_flat() const {
    std::vector<Vec3d> normal(mesh_.triangles.size());
    for_each_index(normal.size(), [&](std::size_t t) {
      const Vec3d cross = cross_of(corners_of(mesh_.triangles[t]));
      normal[t] = cross.lengthSqr() > 0 ? cross.unit() : Vec3d(0.0);
    });
    std::vector<std::uint8_t> is_flat(mesh_.vertices.size(), 0);
    for_each_index(is_flat.size(), [&](std::size_t v) {
      const auto vertex = static_cast<std::uint32_t>(v);
      is_flat[v] = !has_to_stay(vertex) && has_two_normals(vertex, normal) && flat_around(vertex).has_value();
    });
    List flat;
    for (std::uint32_t v = 0; v < is_flat.size(); ++v)
      if (is_flat[v]) flat.push_back(v);
    return flat;
  }

  /// Whether the triangles around a vertex have at most two different normals, but for small differences.
  bool has_two_normals(std::uint32_t v, const std::vector<Vec3d>& normal) const {
    const auto star = around(v);
    if (star.size() < 3) return false;
    const Vec3d& first = normal[star[0]];
    const Vec3d* second = nullptr;
    for (const auto t : star) {
      if (first.dot(normal[t]) > kAlikeNormals || (second && second->dot(normal[t]) > kAlikeNormals)) continue;
      if (second) return false;
      second = &normal[t];
    }
    return true;
  }

  std::span<const std::uint32_t> around(std::uint32_t v) const {
    return stars_[v].empty() ? mesh_.triangles_around(v) : std::span<const std::uint32_t>(stars_[v]);
  }
  List& star(std::uint32_t v) {
    if (stars_[v].empty()) stars_[v].assign(around(v).begin(), around(v).end());
    return stars_[v];
  }
  bool has(std::uint32_t triangle, std::uint32_t v) const {
    const auto& corners = mesh_.triangles[triangle];
    return corners[0] == v || corners[1] == v || corners[2] == v;
  }
  std::array<Vec3d, 3> corners_of(const std::array<std::uint32_t, 3>& corners) const {
    return {mesh_.vertices[corners[0]], mesh_.vertices[corners[1]], mesh_.vertices[corners[2]]};
  }
  static Vec3d cross_of(const std::array<Vec3d, 3>& p) { return (p[1] - p[0]).cross(p[2] - p[0]); }
  static double longest_squared(const std::array<Vec3d, 3>& p) {
    return std::max({(p[1] - p[0]).lengthSqr(), (p[2] - p[1]).lengthSqr(), (p[0] - p[2]).lengthSqr()});
  }

  /// The plane through a vertex with the normal of the largest of some triangles; none if all are too small to give one
  /// one.
  std::optional<FlatPlane> plane_of_largest(std::span<const std::uint32_t> triangles, std::uint32_t v) const {
    double most = 0;
    Vec3d cross(0.0);
    for (const auto t : triangles)
      if (const Vec3d c = cross_of(corners_of(mesh_.triangles[t])); c.lengthSqr() > most) {
        most = c.lengthSqr();
        cross = c;
      }
    const double length = std::sqrt(most);
    if (!(length > kClearHeight * tolerance_ * kClearHeight * tolerance_)) return std::nullopt;
    return FlatPlane{mesh_.vertices[v], cross / length};
  }

  /// Whether a triangle lies in a plane, and faces as the plane does: a sliver may be folded over within the tolerance.
  bool is_in(const FlatPlane& plane, std::uint32_t triangle) const {
    for (const auto w : mesh_.triangles[triangle])
      if (std::abs(plane.height(mesh_.vertices[w])) > tolerance_) return false;
    return plane.normal.dot(cross_of(corners_of(mesh_.triangles[triangle]))) > 0;
  }

  /// The flat parts around a vertex: one plane, or two.
  struct Flat {
    std::array<FlatPlane, 2> plane;
    std::vector<std::uint8_t> plane_of;  // of each triangle around: 0 or 1
    List targets;  // neighbours that the vertex may be merged into: all, or the two along the edge
  };

  std::optional<Flat> flat_around(std::uint32_t v) const {
    const auto star = around(v);
    const auto first = plane_of_largest(star, v);
    if (!first) return std::nullopt;
    Flat flat{{*first, *first}, std::vector<std::uint8_t>(star.size(), 0), {}};
    List rest;
    for (std::size_t i = 0; i < star.size(); ++i)
      if (!is_in(*first, star[i])) {
        flat.plane_of[i] = 1;
        rest.push_back(star[i]);
      }
    if (rest.empty()) {
      for (const auto t : star)
        for (const auto w : mesh_.triangles[t])
          if (w != v && std::find(flat.targets.begin(), flat.targets.end(), w) == flat.targets.end())
            flat.targets.push_back(w);
      return flat;
    }
    const auto second = plane_of_largest(rest, v);
    if (!second || first->normal.cross(second->normal).length() < kLeastMergedAngle) return std::nullopt;
    for (const auto t : rest)
      if (!is_in(*second, t)) return std::nullopt;
    flat.plane[1] = *second;
    if (!find_edge(v, flat)) return std::nullopt;
    return flat;
  }

  /// Finds the two neighbours at which the planes meet, in a row with the vertex between them. Returns false if there
  /// are no such.
  bool find_edge(std::uint32_t v, Flat& flat) const {
    const auto star = around(v);
    for (std::size_t i = 0; i < star.size(); ++i)
      for (std::size_t j = 0; j < star.size(); ++j) {
        if (flat.plane_of[i] != 0 || flat.plane_of[j] != 1) continue;
        for (const auto w : mesh_.triangles[star[i]])
          if (w != v && has(star[j], w)) flat.targets.push_back(w);
      }
    if (flat.targets.size() != 2 || flat.targets[0] == flat.targets[1]) return false;
    const Vec3d a = mesh_.vertices[flat.targets[0]] - mesh_.vertices[v],
                b = mesh_.vertices[flat.targets[1]] - mesh_.vertices[v], along = b - a;
    return a.dot(b) < 0 && a.cross(along).lengthSqr() <= 4 * tolerance_ * tolerance_ * along.lengthSqr();
  }

  static double thinness(const std::array<Vec3d, 3>& p, double cross) { return cross / longest_squared(p); }

  /// The height of the thinnest triangle as a share of its longest edge, if v were merged into w; none if a triangle
  /// would turn round.
  std::optional<double> thinnest_after(std::uint32_t v, std::uint32_t w, const Flat& flat) const {
    const auto star = around(v);
    double least = 1;
    for (std::size_t i = 0; i < star.size(); ++i) {
      if (has(star[i], w)) continue;
      auto corners = mesh_.triangles[star[i]];
      std::replace(corners.begin(), corners.end(), v, w);
      const std::array<Vec3d, 3> p = corners_of(corners);
      const double cross = flat.plane[flat.plane_of[i]].normal.dot(cross_of(p)),
                   longest = std::sqrt(longest_squared(p));
      if (!(cross > kClearHeight * tolerance_ * longest)) return std::nullopt;
      least = std::min(least, thinness(p, cross));
    }
    return least;
  }

  /// Whether v and w have no common neighbours but those of the two triangles at their edge.
  bool keeps_manifold(std::uint32_t v, std::uint32_t w) const {
    std::size_t common = 0;
    List seen{w};
    for (const auto t : around(v))
      for (const auto x : mesh_.triangles[t]) {
        if (x == v || std::find(seen.begin(), seen.end(), x) != seen.end()) continue;
        seen.push_back(x);
        const auto star = around(x);
        common += std::any_of(star.begin(), star.end(), [&](std::uint32_t s) { return has(s, w); });
      }
    return common == 2;
  }

  bool has_to_stay(std::uint32_t v) const { return !stays_.empty() && stays_[v]; }

  bool try_to_take(std::uint32_t v) {
    const auto star = around(v);
    if (has_to_stay(v) || star.size() < 3 || star.size() > kMostAround || is_gone_[star[0]] || !has(star[0], v))
      return false;
    const auto flat = flat_around(v);
    if (!flat) return false;
    double thinnest = 1;
    for (const auto t : star) {
      const std::array<Vec3d, 3> p = corners_of(mesh_.triangles[t]);
      thinnest = std::min(thinnest, thinness(p, cross_of(p).length()));
    }
    std::uint32_t best = kNone;
    double least = std::min(kThin, thinnest);
    for (const auto w : flat->targets) {
      const auto after = thinnest_after(v, w, *flat);
      if (!after || *after < least || (best != kNone && *after == least) || !keeps_manifold(v, w)) continue;
      best = w;
      least = *after;
    }
    if (best == kNone) return false;
    collapse(v, best);
    return true;
  }

  void collapse(std::uint32_t v, std::uint32_t w) {
    const List triangles(around(v).begin(), around(v).end());
    List& of_w = star(w);
    for (const auto t : triangles) {
      for (const auto x : mesh_.triangles[t])
        if (x != v) touched_.push_back(x);
      if (has(t, w)) {
        is_gone_[t] = 1;
        std::erase(of_w, t);
        for (const auto x : mesh_.triangles[t])
          if (x != v && x != w) std::erase(star(x), t);
        continue;
      }
      std::replace(mesh_.triangles[t].begin(), mesh_.triangles[t].end(), v, w);
      is_changed_[t] = 1;
      of_w.push_back(t);
    }
  }

  /// Removes what was merged from the mesh, and notes the numbers that the rest had.
  void close_ranks(MergedFlats& merged) {
    std::vector<std::uint32_t> number(mesh_.vertices.size(), kNone);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::size_t t = 0; t < is_gone_.size(); ++t)
      if (!is_gone_[t]) {
        if (is_changed_[t]) merged.changed.push_back(static_cast<std::uint32_t>(triangles.size()));
        merged.triangle_before.push_back(static_cast<std::uint32_t>(t));
        triangles.push_back(mesh_.triangles[t]);
        for (const auto v : triangles.back()) number[v] = 0;
      }
    std::uint32_t count = 0;
    for (std::size_t v = 0; v < number.size(); ++v)
      if (number[v] != kNone) {
        number[v] = count;
        merged.vertex_before.push_back(static_cast<std::uint32_t>(v));
        mesh_.vertices[count++] = mesh_.vertices[v];
      }
    mesh_.vertices.resize(count);
    for (auto& corners : triangles)
      for (auto& v : corners) v = number[v];
    mesh_.triangles = std::move(triangles);
    list_incident_triangles(mesh_);
  }

  Surface& mesh_;
  double tolerance_;
  std::span<const std::uint8_t> stays_;
  std::vector<List> stars_;  // of vertices whose triangles have changed; empty for others, which have the mesh's
  std::vector<std::uint8_t> is_gone_, is_changed_;  // of each triangle
  List touched_;
};

/// Marks the neighbours of marked vertices, up to so many edges away.
void widen(std::vector<std::uint8_t>& marked, const Surface& mesh, int edges) {
  List rim;
  for (std::uint32_t v = 0; v < marked.size(); ++v)
    if (marked[v]) rim.push_back(v);
  for (List next; edges > 0; --edges, rim.swap(next)) {
    next.clear();
    for (const auto v : rim)
      for (const auto t : mesh.triangles_around(v))
        for (const auto w : mesh.triangles[t])
          if (!std::exchange(marked[w], 1)) next.push_back(w);
  }
}

}  // namespace

MergedFlats merge_flats(Surface& mesh, double tolerance, std::span<const std::uint8_t> stays) {
  VDB_OFFSET_ASSERT(tolerance >= 0 && (stays.empty() || stays.size() == mesh.vertices.size()));
  VDB_OFFSET_ASSERT(mesh.incident.size() == 3 * mesh.triangles.size());  // it is built
  return FlatMerger(mesh, tolerance, stays).run();
}

std::size_t merge_flats_soundly(Surface& mesh, double tolerance) {
  const Surface before{.vertices = mesh.vertices,
                       .triangles = mesh.triangles,
                       .incident = mesh.incident,
                       .incident_begin = mesh.incident_begin};
  std::vector<std::uint8_t> stays;
  for (int trial = 0; trial < kMostMergeTrials; ++trial) {
    const MergedFlats merged = merge_flats(mesh, tolerance, stays);
    const List faulty = merged.vertices > 0 ? find_faulty(mesh, merged.changed) : List();
    if (faulty.empty()) return merged.vertices;
    std::vector<std::uint8_t> around(before.vertices.size(), 0);
    for (const auto t : faulty) {
      for (const auto v : mesh.triangles[t]) around[merged.vertex_before[v]] = 1;
      for (const auto v : before.triangles[merged.triangle_before[t]]) around[v] = 1;
    }
    widen(around, before, 1 << trial);
    stays.resize(around.size(), 0);
    for (std::size_t v = 0; v < around.size(); ++v) stays[v] |= around[v];
    mesh.vertices = before.vertices;
    mesh.triangles = before.triangles;
    mesh.incident = before.incident;
    mesh.incident_begin = before.incident_begin;
  }
  return 0;
}

}  // namespace vdb_offset
