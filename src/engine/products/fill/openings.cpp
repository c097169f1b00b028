// SPDX-License-Identifier: Apache-2.0
#include "products/fill/openings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "ground/numbers/disjoint_sets.h"
#include "ground/plane/plane_mesh.h"
#include "products/fill/check_front.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;
using Edge = std::array<Index, 2>;

// How far an opening's edges may be off their plane, as a share of its size. Flat ones are off by rounding. Beyond,
// flat caps would lean visibly towards the layers' sides.
constexpr double kOffPlane = 1e-2;
// Openings are in one plane if these are so near each other, as a share of the larger one's size.
constexpr double kOneOpeningPlane = 1e-6;

/// The middle of edges, weighted by their lengths, and their normal: right-handed, as long as twice the area that they
/// enclose.
struct EdgeExtent {
  Vec3d middle{0.0}, normal{0.0};
  double size = 0;  // the largest distance from the middle
};

EdgeExtent edge_extent(std::span<const Vec3d> points, std::span<const Edge> edges) {
  EdgeExtent extent;
  double weights = 0;
  for (const auto& [a, b] : edges) {
    const double length = (points[a] - points[b]).length();
    extent.middle += (points[a] + points[b]) * (length / 2);
    weights += length;
  }
  extent.middle = weights > 0 ? extent.middle / weights : points[edges[0][0]];
  for (const auto& [a, b] : edges) {
    extent.normal += (points[a] - extent.middle).cross(points[b] - extent.middle);
    extent.size = std::max(extent.size, (points[a] - extent.middle).length());
  }
  return extent;
}

/// A plane through edges. Where they are all at one place along an axis, it is exactly at right angles to that.
OpenPlane plane_of(std::span<const Vec3d> points, std::vector<Edge> edges) {
  const EdgeExtent extent = edge_extent(points, edges);
  OpenPlane plane{extent.middle, extent.normal, std::move(edges)};
  if (!(plane.normal.length() > kOneOpeningPlane * extent.size * extent.size))
    throw InvalidInput(
        fmt::format("fill: expected openings around an area, got one without at ({:.6g}, {:.6g}, {:.6g})",
                    extent.middle[0], extent.middle[1], extent.middle[2]));
  plane.normal.normalize();
  for (int axis = 0; axis < 3; ++axis) {
    const double place = points[plane.edges[0][0]][axis];
    if (!std::ranges::all_of(plane.edges, [&](const Edge& edge) { return points[edge[0]][axis] == place; })) continue;
    const double side = plane.normal[axis] > 0 ? 1 : -1;
    plane.normal = Vec3d(0.0);
    plane.normal[axis] = side;
    plane.origin[axis] = place;
  }
  double off = 0;
  for (const auto& [a, b] : plane.edges) off = std::max(off, std::abs((points[a] - plane.origin).dot(plane.normal)));
  if (off > kOffPlane * extent.size)
    throw InvalidInput(fmt::format(
        "fill: expected flat openings, got one around ({:.6g}, {:.6g}, {:.6g}) whose edges are up to {:.3g} off "
        "a plane (cut it straight, or close it)",
        plane.origin[0], plane.origin[1], plane.origin[2], off));
  return plane;
}

/// The patches of sides, by the edges of their faces.
std::map<Edge, Index> sides_at(const VolumeMesh& volume, std::span<const Edge> edges) {
  std::set<Edge> wanted;
  const auto sorted = [](Index a, Index b) { return Edge{std::min(a, b), std::max(a, b)}; };
  for (const auto& [a, b] : edges) wanted.insert(sorted(a, b));
  std::map<Edge, Index> found;
  for (Index i = 0; i < volume.patches.size(); ++i) {
    const BoundaryPatch& patch = volume.patches[i];
    if (patch.kind != BoundaryPatch::Kind::Side) continue;
    for (std::size_t f = 0; f < patch.face_count(); ++f) {
      const auto face = patch.face(f);
      for (std::size_t k = 0; k < face.size(); ++k)
        if (const Edge edge = sorted(face[k], face[(k + 1) % face.size()]); wanted.contains(edge))
          found.emplace(edge, i);
    }
  }
  return found;
}

class Cover {
 public:
  Cover(const OpenPlane& plane, FillFront& front, VolumeMesh& volume) : plane_(plane), front_(front), volume_(volume) {}

  void make(const FillOptions& options) {
    PlaneRegion region;
    region.growth = options.growth;
    region.longest = options.longest.value_or(region.longest);
    const auto [u, v] = axes_across(plane_.normal);
    for (const auto& [a, b] : plane_.edges) {
      for (const Index p : {a, b}) {
        if (!number_.try_emplace(p, static_cast<Index>(given_.size())).second) continue;
        given_.push_back(p);
        const Vec3d from = volume_.points[p] - plane_.origin;
        region.points.emplace_back(from.dot(u), from.dot(v));
      }
      region.segments.push_back({number_.at(a), number_.at(b)});
    }
    mesh_ = mesh_plane(region);
    first_added_ = static_cast<Index>(volume_.points.size());
    for (const Vec2d& x : mesh_.added) volume_.points.push_back(plane_.origin + u * x[0] + v * x[1]);
  }

  /// Puts the triangles into patches: those of connected ones around which sides lie, or else a new one.
  void add_to(const std::string& name, bool is_symmetric) {
    const std::map<Edge, Index> sides = sides_at(volume_, plane_.edges);
    if (is_symmetric) make_symmetric(sides, name);
    DisjointSets pieces(given_.size() + mesh_.added.size());
    for (const auto& [a, b, c] : mesh_.triangles) pieces.join(a, b), pieces.join(b, c);
    std::vector<Index> patch(given_.size() + mesh_.added.size(), kNone);
    for (const auto& [edge, side] : sides) {
      Index& here = patch[pieces.first(number_.at(edge[0]))];
      here = std::min(here, side);
    }
    for (const auto& triangle : mesh_.triangles) {
      Index& here = patch[pieces.first(triangle[0])];
      if (here == kNone) {
        here = static_cast<Index>(volume_.patches.size());
        volume_.patches.push_back({.name = unused(name), .kind = kind_of(is_symmetric)});
      }
      front_.triangles.push_back({{point(triangle[0]), point(triangle[1]), point(triangle[2])}, kNone, here});
    }
  }

 private:
  static BoundaryPatch::Kind kind_of(bool is_symmetric) {
    return is_symmetric ? BoundaryPatch::Kind::Symmetry : BoundaryPatch::Kind::Side;
  }

  /// The name, or with a number behind it if a patch has it.
  std::string unused(const std::string& name) const {
    std::string tried = name;
    for (int n = 2; std::ranges::find(volume_.patches, tried, &BoundaryPatch::name) != volume_.patches.end(); ++n)
      tried = fmt::format("{}_{}", name, n);
    return tried;
  }

  /// The sides of all bodies that end at the plane belong to it.
  void make_symmetric(const std::map<Edge, Index>& sides, const std::string& name) {
    std::set<Index> patches;
    for (const auto& [edge, side] : sides) patches.insert(side);
    for (const Index i : patches) {
      volume_.patches[i].name = unused(name);
      volume_.patches[i].kind = BoundaryPatch::Kind::Symmetry;
    }
  }

  Index point(Index p) const {
    return p < given_.size() ? given_[p] : first_added_ + p - static_cast<Index>(given_.size());
  }

  const OpenPlane& plane_;
  FillFront& front_;
  VolumeMesh& volume_;
  PlaneMesh mesh_;
  std::vector<Index> given_;       // points of the mesh, by the region's numbers
  std::map<Index, Index> number_;  // and the other way round
  Index first_added_ = 0;
};

}  // namespace

std::array<Vec3d, 2> axes_across(const Vec3d& normal) {
  int least = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(normal[k]) < std::abs(normal[least])) least = k;
  Vec3d along(0.0);
  along[least] = 1;
  Vec3d first = along - normal * normal[least];
  first.normalize();
  return {first, normal.cross(first)};
}

std::vector<OpenPlane> open_planes(std::span<const Vec3d> points, std::span<const Edge> edges) {
  std::map<Index, Index> number;
  for (const auto& edge : edges)
    for (const Index p : edge) number.try_emplace(p, static_cast<Index>(number.size()));
  DisjointSets loops(number.size());
  for (const auto& [a, b] : edges) loops.join(number[a], number[b]);
  std::map<Index, std::vector<Edge>> of_loop;
  for (const auto& edge : edges) of_loop[loops.first(number[edge[0]])].push_back(edge);
  std::vector<OpenPlane> planes;
  for (auto& [loop, its_edges] : of_loop) {
    OpenPlane plane = plane_of(points, std::move(its_edges));
    const auto is_same = [&](const OpenPlane& other) {
      const double size = std::max(edge_extent(points, plane.edges).size, edge_extent(points, other.edges).size);
      return plane.normal.cross(other.normal).length() < kOneOpeningPlane &&
             std::abs((plane.origin - other.origin).dot(other.normal)) < kOneOpeningPlane * size;
    };
    const auto known = std::ranges::find_if(planes, is_same);
    if (known == planes.end()) planes.push_back(std::move(plane));
    else known->edges.insert(known->edges.end(), plane.edges.begin(), plane.edges.end());
  }
  // The larger ones of several loops in a plane are around the others, and say what is outside.
  for (OpenPlane& plane : planes)
    if (edge_extent(points, plane.edges).normal.dot(plane.normal) < 0) plane.normal = -plane.normal;
  return planes;
}

bool is_enclosed_by(std::span<const Vec3d> points, std::span<const FrontTriangle> front,
                    std::span<const OpenPlane> openings) {
  std::vector<Vec3d> with_middles(points.begin(), points.end());
  std::vector<FrontTriangle> closed(front.begin(), front.end());
  for (const OpenPlane& plane : openings) {
    const auto middle = static_cast<Index>(with_middles.size());
    with_middles.push_back(plane.origin);
    for (const auto& [a, b] : plane.edges) closed.push_back({{a, b, middle}, kNone, kNone});
  }
  return is_enclosed(with_middles, closed);
}

void cover(const OpenPlane& plane, const FillOptions& options, const std::string& name, bool is_symmetric,
           FillFront& front, VolumeMesh& volume) {
  Cover made(plane, front, volume);
  made.make(options);
  made.add_to(name, is_symmetric);
}

}  // namespace vdb_offset
