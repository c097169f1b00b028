// SPDX-License-Identifier: Apache-2.0
#include "space/surface/creases.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>

#include "ground/mesh/miter_point.h"
#include "ground/mesh/planes_around.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

// The least angle between the normals on both sides of a crease, in radians.
constexpr double kSharpBend = 20 * std::numbers::pi / 180;
// How many times as much a surface bends at each of a vertex's creases as at any other edge there, if the planes around
// the vertex do not meet in one point once they have moved.
constexpr double kDistinctBend = 3;
// Planes of at least so many that meet in one point are the tip of a cone: three meet in one anyhow.
constexpr std::size_t kFewestOfTip = 4;
// Edges that are as sharp as this are creases, however few they are: the rim of a flat pyramid has three. 60 degrees,
// not measured.
constexpr double kUnmistakable = 60 * std::numbers::pi / 180;
// How far a plane may be from the point that three others meet in, for all to meet as nearly as kOnePlaneSine says: as
// a share of the distance, times the volume that the normals of the three span. Reasoned: each of the three moves the
// point by as much at most.
constexpr double kNearlyMeets = 10 * kOnePlaneSine;
// Share by which one angle may differ as seen from both ends of its edge. Reasoned: single precision.
constexpr double kSameBend = 1e-6;
// A line of fewer edges than this that ends in the surface is no crease, nor is a net of fewer.
constexpr std::size_t kShortestCrease = 4;

/// Finds which vertices have edges that may be creases, and then which of these edges make lines.
class CreaseFinder {
 public:
  explicit CreaseFinder(const Surface& surface) : surface_(surface) {
    least_.resize(surface.vertices.size());
    for_each_index(least_.size(), [&](std::size_t v) { least_[v] = least_sharp_angle(static_cast<std::uint32_t>(v)); });
  }

  std::vector<std::uint8_t> operator()() {
    list_edges();
    for (const Edge& edge : edges_) {
      std::uint32_t v = edge.from;
      while (v != kNone && is_end(v)) v = leave_short_line_out(v);
    }
    leave_small_nets_out();
    std::vector<std::uint8_t> on_crease(least_.size(), 0);
    for_each_index(on_crease.size(), [&](std::size_t v) { on_crease[v] = is_tip(static_cast<std::uint32_t>(v)); });
    for (const Edge& edge : edges_)
      if (edge.holds) on_crease[edge.from] = 1;
    return on_crease;
  }

 private:
  /// An edge that may be a crease, as seen from one of its vertices.
  struct Edge {
    std::uint32_t from, to;
    double angle = 0;
    bool holds = true;

    bool operator<(const Edge& other) const { return std::pair(from, to) < std::pair(other.from, other.to); }
  };

  /// The triangle across a half-edge of a triangle at a vertex, beyond needles, which have no normal; kNone at a border
  /// and where more than two faces meet.
  std::uint32_t across(std::uint32_t vertex, std::uint32_t half_edge) const {
    for (std::size_t i = 0; i < surface_.triangles_around(vertex).size(); ++i) {
      const std::uint32_t other = surface_.next_around_edge[half_edge];
      if (other == half_edge || surface_.next_around_edge[other] != half_edge) return kNone;
      const std::uint32_t t = other / 3;
      if (surface_.triangle_normals[t].lengthSqr() > 0) return t;
      // The needle's other edge at the vertex.
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t next = 3 * t + k;
        if (next != other && (surface_.from(next) == vertex || surface_.to(next) == vertex)) half_edge = next;
        else continue;
        break;
      }
    }
    return kNone;
  }

  /// Calls visit(other vertex, cosine of the bend) for each edge of a vertex, from each of its triangles.
  template <class Visit>
  void visit_bends(std::uint32_t vertex, Visit&& visit) const {
    for (const auto t : surface_.triangles_around(vertex)) {
      const Vec3d& normal = surface_.triangle_normals[t];
      if (normal.lengthSqr() == 0) continue;
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t from = surface_.from(h), to = surface_.to(h);
        if (from != vertex && to != vertex) continue;
        if (const std::uint32_t other = across(vertex, h); other != kNone)
          visit(from == vertex ? to : from, normal.dot(surface_.triangle_normals[other]));
      }
    }
  }

  /// Whether more than two faces meet at an edge of a vertex.
  bool branches(std::uint32_t vertex) const {
    for (const auto t : surface_.triangles_around(vertex))
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
        if ((surface_.from(h) == vertex || surface_.to(h) == vertex) &&
            surface_.next_around_edge[surface_.next_around_edge[h]] != h)
          return true;
    return false;
  }

  PlanesAround planes_at(std::uint32_t vertex) const {
    PlanesAround planes =
        planes_around(surface_, vertex, [&](std::uint32_t t) -> const Vec3d& { return surface_.triangle_normals[t]; });
    for (Vec3d& normal : planes.normals) normal = surface_.along_border(vertex, normal);
    return planes;
  }

  /// Whether all planes around a vertex go by the point that three of them meet in once they have moved, or nearly so;
  /// true where it is not known. For speed: in scans they nearly never do.
  bool may_meet(std::uint32_t vertex) const {
    if (!surface_.conormals.empty() && surface_.conormals[vertex].lengthSqr() > 0) return true;
    const auto around = surface_.triangles_around(vertex);
    const auto& normals = surface_.triangle_normals;
    const Vec3d first = normals[around[0]];
    Vec3d second = first, third = first;
    for (const auto t : around)
      if (first.dot(normals[t]) < first.dot(second)) second = normals[t];
    const Vec3d across = first.cross(second);
    for (const auto t : around)
      if (std::abs(across.dot(normals[t])) > std::abs(across.dot(third))) third = normals[t];
    const double volume = across.dot(third);
    const Vec3d point = across + second.cross(third) + third.cross(first);  // times the volume
    return std::all_of(around.begin(), around.end(), [&](std::uint32_t t) {
      return normals[t].lengthSqr() == 0 || std::abs(normals[t].dot(point) - volume) <= kNearlyMeets;
    });
  }

  /// Whether the planes around a vertex meet in one point once they have moved.
  bool planes_meet(std::uint32_t vertex) const {
    if (!may_meet(vertex)) return false;
    const auto point = miter_point(planes_at(vertex).normals);
    return point && point->excess <= kOnePlaneSine;
  }

  /// Whether a vertex is the tip of a cone whose planes all bend from its axis by as much as creases do. None of its
  /// edges need be one, as the cone may have any number of sides.
  bool is_tip(std::uint32_t vertex) const {
    static const double kCosine = std::cos(kSharpBend);
    const auto around = surface_.triangles_around(vertex);
    const auto& normals = surface_.triangle_normals;
    // For speed: around the axis of a tip, some plane bends from any other one by more than that.
    if (std::none_of(around.begin(), around.end(),
                     [&](std::uint32_t t) { return normals[t].dot(normals[around[0]]) <= kCosine; }) ||
        !may_meet(vertex) || branches(vertex))
      return false;
    const PlanesAround planes = planes_at(vertex);
    if (planes.normals.size() < kFewestOfTip) return false;
    const auto point = miter_point(planes.normals);
    return point && point->excess <= kOnePlaneSine && point->position.length() * kCosine >= 1;
  }

  /// The least angle of the edges at a vertex that may be creases; infinite if none may. There may be several jumps
  /// among the angles, as where a finely curved flank meets a flat face: the lowest one counts. Where all planes meet
  /// in one point, sharp edges need be no sharper than others: a chamfer along a coarse round corner bends little more
  /// than that.
  float least_sharp_angle(std::uint32_t vertex) const {
    static const double kCosine = std::cos(kSharpBend);
    if (branches(vertex)) return std::numeric_limits<float>::infinity();
    bool any = false;
    visit_bends(vertex, [&](std::uint32_t, double cosine) { any = any || cosine <= kCosine; });
    if (!any) return std::numeric_limits<float>::infinity();
    std::vector<double> angles{0};
    visit_bends(vertex,
                [&](std::uint32_t, double cosine) { angles.push_back(std::acos(std::clamp(cosine, -1.0, 1.0))); });
    std::sort(angles.begin(), angles.end());
    const auto sharp = std::lower_bound(angles.begin(), angles.end(), kSharpBend);
    for (auto angle = sharp; angle != angles.end(); ++angle)
      if (*angle >= kDistinctBend * *(angle - 1) || (angle == sharp && planes_meet(vertex)))
        return static_cast<float>(*angle * (1 - kSameBend));
    return std::numeric_limits<float>::infinity();
  }

  /// A line may end at a vertex of the border, or of a plane that vertices stay in: it goes on beyond.
  bool may_end_at(std::uint32_t vertex) const {
    return !surface_.conormals.empty() && surface_.conormals[vertex].lengthSqr() > 0;
  }

  void list_edges() {
    for (std::uint32_t v = 0; v < least_.size(); ++v) {
      if (std::isinf(least_[v])) continue;
      visit_bends(v, [&](std::uint32_t other, double cosine) {
        const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
        if (!(angle >= least_[v] && angle >= least_[other])) return;
        edges_.push_back({v, other, angle});
        edges_.push_back({other, v, angle});
      });
    }
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end(),
                             [](const Edge& a, const Edge& b) { return a.from == b.from && a.to == b.to; }),
                 edges_.end());
  }

  std::vector<Edge>::iterator begin_of(std::uint32_t vertex) {
    return std::lower_bound(edges_.begin(), edges_.end(), Edge{vertex, 0});
  }
  /// Calls visit(edge) for each edge of a vertex that is left.
  template <class Visit>
  void visit_edges(std::uint32_t vertex, Visit&& visit) {
    for (auto edge = begin_of(vertex); edge != edges_.end() && edge->from == vertex; ++edge)
      if (edge->holds) visit(*edge);
  }
  std::size_t edge_count(std::uint32_t vertex) {
    std::size_t count = 0;
    visit_edges(vertex, [&](const Edge&) { ++count; });
    return count;
  }
  bool is_end(std::uint32_t vertex) { return edge_count(vertex) == 1 && !may_end_at(vertex); }

  /// Leaves a line out that begins at an end, if it is short. Returns the vertex where it ended, or kNone.
  std::uint32_t leave_short_line_out(std::uint32_t end) {
    std::vector<std::uint32_t> line{end};
    for (std::uint32_t before = kNone, at = end; line.size() <= kShortestCrease;) {
      std::uint32_t next = kNone;
      visit_edges(at, [&](const Edge& edge) {
        if (edge.to != before) next = edge.to;
      });
      VDB_OFFSET_ASSERT(next != kNone);
      line.push_back(next);
      if (may_end_at(next)) return kNone;
      if (edge_count(next) != 2) break;
      before = std::exchange(at, next);
    }
    if (line.size() > kShortestCrease) return kNone;
    for (std::size_t i = 0; i + 1 < line.size(); ++i)
      for (const auto& [from, to] : {std::pair(line[i], line[i + 1]), std::pair(line[i + 1], line[i])})
        std::lower_bound(edges_.begin(), edges_.end(), Edge{from, to})->holds = false;
    return line.back();
  }

  /// Leaves out edges that are connected with few others, as the three around a triangle.
  void leave_small_nets_out() {
    std::vector<std::uint8_t> seen(least_.size(), 0);
    for (const Edge& edge : edges_) {
      if (!edge.holds || std::exchange(seen[edge.from], 1)) continue;
      std::vector<std::uint32_t> net{edge.from};
      std::size_t ends_of_edges = 0;
      bool goes_on = false;
      double least = edge.angle;
      for (std::size_t i = 0; i < net.size(); ++i) {
        goes_on |= may_end_at(net[i]);
        visit_edges(net[i], [&](const Edge& other) {
          ++ends_of_edges;
          least = std::min(least, other.angle);
          if (!std::exchange(seen[other.to], 1)) net.push_back(other.to);
        });
      }
      if (goes_on || least >= kUnmistakable || ends_of_edges >= 2 * kShortestCrease) continue;
      for (const auto v : net) visit_edges(v, [&](Edge& other) { other.holds = false; });
    }
  }

  const Surface& surface_;
  std::vector<float> least_;  // of each vertex: the least angle of its edges that may be creases
  std::vector<Edge> edges_;   // sorted
};

}  // namespace

std::vector<std::uint8_t> vertices_on_creases(const Surface& surface) { return CreaseFinder(surface)(); }

}  // namespace vdb_offset
