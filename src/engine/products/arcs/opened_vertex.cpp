// SPDX-License-Identifier: Apache-2.0
#include "products/arcs/opened_vertex.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "ground/mesh/miter_point.h"
#include "ground/mesh/planes_around.h"
#include "products/arcs/round_patch.h"
#include "products/arcs/slerp.h"

namespace vdb_offset {
namespace {

// The most angle between the directions of two neighbouring sectors: beyond, no direction lies between them. Not
// measured.
constexpr double kMostArc = 2.9;
// The least slope of a ridge over the plane of the flank on which it ends: below, the arc is as long as the flank. Not
// measured.
constexpr double kLeastRise = 0.2;
// How far the corner of a flank goes beyond the point in which its plane meets those of a ridge, in distances, so that
// faces beside it have an area. Not measured.
constexpr double kBeyondTip = 0.1;

/// The normals of the planes in a sector, on the side that the vertex goes to, without what leads out of the planes
/// that the vertex has to stay in. Faces of any size count, as each needs its copies.
std::vector<Vec3d> normals_in(const Surface& surface, const RidgeFan& fan, std::uint32_t sector) {
  std::vector<std::uint32_t> faces;
  for (std::size_t i = 0; i < fan.triangles.size(); ++i)
    if (fan.sector[i] == sector) faces.push_back(fan.triangles[i]);
  std::vector<Vec3d> normals =
      planes_of(
          surface, faces, [&](std::uint32_t t) { return surface.triangle_normals[t] * fan.side; },
          [&](std::uint32_t t) { return std::min(surface.tilt(t), kMostTilt); })
          .normals;
  for (Vec3d& normal : normals) normal = surface.along_border(fan.vertex, normal);
  return normals;
}

/// What is at a right angle to an axis, of unit length.
Vec3d across(const Vec3d& direction, const Vec3d& axis) { return (direction - axis * direction.dot(axis)).unit(); }

class ArcLayer {
 public:
  ArcLayer(const Surface& surface, const RidgeFinder& finder, const ArcSteps& steps, double step, OpenedVertex& vertex)
      : surface_(surface), finder_(finder), steps_(steps), step_(step), made_(vertex), fan_(vertex.fan) {}

  bool lay() {
    if (fan_.sectors < 2) return !fan_.is_at_border && lay_end();
    for (const Vec3d& point : made_.points)
      if (!add(point)) return false;
    made_.arc.assign(fan_.triangles.size(), {});
    for (std::size_t i = 0; i < fan_.triangles.size(); ++i)
      if (fan_.is_open[i] && !lay_arc(i)) return false;
    return fan_.sectors == 2 || fan_.is_at_border || lay_patch();
  }

 private:
  /// Adds a direction, which lies along the border if the vertex is on one. False if it leads nowhere there.
  bool add(const Vec3d& way) {
    Vec3d direction = fan_.is_at_border ? surface_.along_border(fan_.vertex, way) : way;
    if (!direction.normalize()) return false;
    made_.directions.push_back(direction);
    return true;
  }
  Vec3d axis_of(std::size_t edge) const {
    return (surface_.vertices[fan_.across[edge]] - surface_.vertices[fan_.vertex]).unit();
  }

  /// Copies from the sector before an edge to that behind it, evenly around the edge, as at its other end. Where two
  /// sectors meet in two edges, both have one arc.
  bool lay_arc(std::size_t edge) {
    const std::uint32_t from = fan_.sector[edge], to = fan_.sector[fan_.next(edge)];
    std::vector<std::uint32_t>& arc = made_.arc[edge];
    for (std::size_t i = 0; i < edge && fan_.sectors == 2 && !fan_.is_at_border; ++i)
      if (fan_.is_open[i]) {
        arc.assign(made_.arc[i].rbegin(), made_.arc[i].rend());
        return true;
      }
    const Vec3d axis = axis_of(edge), a = made_.directions[from], b = made_.directions[to];
    const double reach_a = a.cross(axis).length(), reach_b = b.cross(axis).length();
    if (reach_a < kLeastRise || reach_b < kLeastRise) return false;
    const double angle = angle_between(across(a, axis), across(b, axis));
    if (angle > kMostArc) return false;
    const std::size_t count = steps_(fan_, edge);
    arc.push_back(from);
    for (std::size_t i = 1; i < count; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(count);
      arc.push_back(static_cast<std::uint32_t>(made_.directions.size()));
      // As seen along the edge, directions turn by the same angle each time.
      if (!add(a * (std::sin((1 - share) * angle) / reach_a) + b * (std::sin(share * angle) / reach_b))) return false;
    }
    arc.push_back(to);
    return true;
  }

  /// Where a ridge ends on a flank: its faces L and R meet a third one, C, in two creases. The strip then ends in an
  /// arc on the plane of C, from the crease of L to that of R; and the corner of C goes a little beyond the point in
  /// which all three planes meet, with a patch between it and the arc. False if the vertex is none like that.
  bool lay_end() {
    const auto ridge =
        static_cast<std::size_t>(std::find(fan_.is_open.begin(), fan_.is_open.end(), 1) - fan_.is_open.begin());
    if (!part_at_flank(ridge)) return false;
    const std::uint32_t left = fan_.sector[fan_.next(ridge)], right = fan_.sector[ridge], flank = 3 - left - right;
    std::array<Vec3d, 3> normal;
    for (std::uint32_t s = 0; s < 3; ++s) {
      const auto point = miter_point(normals_in(surface_, fan_, s));
      if (!point) return false;
      normal[s] = point->position.unit();
    }
    const Vec3d axis = axis_of(ridge), &up = normal[flank], a = across(normal[right], axis),
                b = across(normal[left], axis);
    const double rise = axis.dot(up);
    const auto tip = miter_point(normal);
    if (std::abs(rise) < kLeastRise || angle_between(a, b) > kMostArc || !tip) return false;
    // On the cylinder around the ridge and the plane of the flank.
    const auto on_flank = [&](double share) {
      const Vec3d direction = slerp(a, b, share);
      return direction + axis * ((1 - direction.dot(up)) / rise);
    };
    Vec3d beyond = tip->position - on_flank(0.5);
    beyond -= up * beyond.dot(up);
    if (!beyond.normalize()) return false;
    made_.points.assign(3, Vec3d(0.0));
    made_.points[flank] = tip->position + beyond * kBeyondTip;
    made_.points[right] = on_flank(0);
    made_.points[left] = on_flank(1);
    std::vector<std::uint32_t>& arc = made_.arc[ridge];
    arc.push_back(right);
    const std::size_t count = steps_(fan_, ridge);
    for (std::size_t i = 1; i < count; ++i) {
      arc.push_back(static_cast<std::uint32_t>(made_.points.size()));
      made_.points.push_back(on_flank(static_cast<double>(i) / static_cast<double>(count)));
    }
    arc.push_back(left);
    for (const Vec3d& point : made_.points) made_.directions.push_back(point.unit());
    return lay_patch_on(flank, up, arc);
  }

  /// Parts the sector of a vertex with one ridge in three, by the two concave edges in it. False if it has not two.
  bool part_at_flank(std::size_t ridge) {
    if (std::count(fan_.is_open.begin(), fan_.is_open.end(), 1) != 1) return false;
    std::vector<std::size_t> creases;
    for (std::size_t i = fan_.next(ridge); i != ridge; i = fan_.next(i))
      if (finder_.bend(fan_, i) < -finder_.least_bend()) creases.push_back(i);
    if (creases.size() != 2) return false;
    for (const std::size_t crease : creases) fan_.is_open[crease] = 1;
    fan_.part();
    made_.arc.assign(fan_.triangles.size(), {});
    for (const std::size_t crease : creases) made_.arc[crease] = {fan_.sector[crease], fan_.sector[fan_.next(crease)]};
    return true;
  }

  /// Triangles on a flank between its corner and an arc. False if some would be turned round.
  bool lay_patch_on(std::uint32_t flank, const Vec3d& up, const std::vector<std::uint32_t>& arc) {
    const std::vector<Vec3d>& points = made_.points;
    for (std::size_t i = 0; i + 1 < arc.size(); ++i) {
      const Vec3d area = (points[arc[i]] - points[flank]).cross(points[arc[i + 1]] - points[flank]);
      if (!(area.dot(up) * fan_.side > 0)) return false;
      made_.patch.push_back({flank, arc[i], arc[i + 1]});
    }
    return true;
  }

  bool lay_patch() {
    std::vector<std::uint32_t> around;
    for (const auto& arc : made_.arc)
      for (std::size_t i = 0; i + 1 < arc.size(); ++i) around.push_back(arc[i]);
    std::vector<Vec3d> loop;
    loop.reserve(around.size());
    for (const std::uint32_t copy : around) loop.push_back(made_.directions[copy]);
    const std::optional<RoundPatch> patch = round_patch(loop, step_, fan_.side);
    if (!patch) return false;
    const auto first_inner = static_cast<std::uint32_t>(made_.directions.size() - loop.size());
    const auto number = [&](std::uint32_t i) { return i < loop.size() ? around[i] : first_inner + i; };
    for (const auto& [a, b, c] : patch->triangles) made_.patch.push_back({number(a), number(b), number(c)});
    made_.directions.insert(made_.directions.end(), patch->inner.begin(), patch->inner.end());
    return true;
  }

  const Surface& surface_;
  const RidgeFinder& finder_;
  const ArcSteps& steps_;
  double step_;
  OpenedVertex& made_;
  RidgeFan& fan_;
};

}  // namespace

bool find_sectors(const Surface& surface, OpenedVertex& vertex) {
  vertex.points.clear();
  for (std::uint32_t s = 0; s < vertex.fan.sectors; ++s) {
    const auto point = miter_point(normals_in(surface, vertex.fan, s));
    if (!point) return false;
    vertex.points.push_back(point->position);
  }
  return true;
}

bool lay_arcs(const Surface& surface, const RidgeFinder& finder, const ArcSteps& steps, double step,
              OpenedVertex& vertex) {
  return ArcLayer(surface, finder, steps, step, vertex).lay();
}

}  // namespace vdb_offset
