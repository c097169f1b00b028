// SPDX-License-Identifier: Apache-2.0
#include "products/fill/openings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "ground/mesh/triangulate.h"
#include "ground/numbers/disjoint_sets.h"
#include "ground/plane/plane_mesh.h"
#include "products/fill/check_front.h"
#include "products/fill/plane_lines.h"
#include "products/volume/free_name.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;
using OpenEdge = std::array<Index, 2>;

// How far an opening's edges may be off their plane, as a share of its size. Flat ones are off by rounding. Beyond,
// flat caps would lean visibly towards the layers' sides.
constexpr double kOffPlane = 1e-2;
// The same of periodic openings, which both lean alike: rails between two periods lie in no plane. Not measured.
constexpr double kPeriodicOffPlane = 0.3;
// Normals that are to be along an axis have at least this component. Reasoned: openings' edges are this flat.
constexpr double kAcross = 0.999;
// Openings are in one plane if these are so near each other, as a share of the larger one's size.
constexpr double kOneOpeningPlane = 1e-6;

/// The middle of edges, weighted by their lengths, and their normal: right-handed, as long as twice the area that they
/// enclose.
struct EdgeExtent {
  Vec3d middle{0.0}, normal{0.0};
  double size = 0;  // the largest distance from the middle
};

EdgeExtent edge_extent(std::span<const Vec3d> points, std::span<const OpenEdge> edges) {
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

/// A plane through edges, with a normal of any length. Where they are all at one place along an axis, it is exactly at
/// right angles to that.
OpenPlane plane_through(std::span<const Vec3d> points, std::vector<OpenEdge> edges, const Vec3d& normal,
                        double most_off = kOffPlane) {
  const EdgeExtent extent = edge_extent(points, edges);
  OpenPlane plane{extent.middle, normal, std::move(edges)};
  plane.normal.normalize(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    const double place = points[plane.edges[0][0]][axis];
    const bool is_across = std::abs(plane.normal[axis]) > kAcross;
    if (!is_across ||
        !std::ranges::all_of(plane.edges, [&](const OpenEdge& edge) { return points[edge[0]][axis] == place; }))
      continue;
    const double side = plane.normal[axis] > 0 ? 1 : -1;
    plane.normal = Vec3d(0.0);
    plane.normal[axis] = side;
    plane.origin[axis] = place;
  }
  double off = 0;
  for (const auto& [a, b] : plane.edges) off = std::max(off, std::abs((points[a] - plane.origin).dot(plane.normal)));
  if (off > most_off * extent.size)
    throw InvalidInput(fmt::format(
        "fill: expected flat openings, got one around ({:.6g}, {:.6g}, {:.6g}) whose edges are up to {:.3g} off "
        "a plane (cut it straight, or close it)",
        plane.origin[0], plane.origin[1], plane.origin[2], off));
  return plane;
}

/// The plane that edges around an area lie in.
OpenPlane plane_of(std::span<const Vec3d> points, std::vector<OpenEdge> edges, double most_off = kOffPlane) {
  const EdgeExtent extent = edge_extent(points, edges);
  if (!(extent.normal.length() > kOneOpeningPlane * extent.size * extent.size))
    throw InvalidInput(
        fmt::format("fill: expected openings around an area, got one without at ({:.6g}, {:.6g}, {:.6g})",
                    extent.middle[0], extent.middle[1], extent.middle[2]));
  return plane_through(points, std::move(edges), extent.normal, most_off);
}

/// The patches of sides, by the edges of their faces.
std::map<OpenEdge, Index> sides_at(const VolumeMesh& volume, std::span<const OpenEdge> edges) {
  std::set<OpenEdge> wanted;
  const auto sorted = [](Index a, Index b) { return OpenEdge{std::min(a, b), std::max(a, b)}; };
  for (const auto& [a, b] : edges) wanted.insert(sorted(a, b));
  std::map<OpenEdge, Index> found;
  for (Index i = 0; i < volume.patches.size(); ++i) {
    const BoundaryPatch& patch = volume.patches[i];
    if (patch.kind != BoundaryPatch::Kind::Side && patch.kind != BoundaryPatch::Kind::Periodic) continue;
    for (std::size_t f = 0; f < patch.face_count(); ++f) {
      const auto face = patch.face(f);
      for (std::size_t k = 0; k < face.size(); ++k)
        if (const OpenEdge edge = sorted(face[k], face[(k + 1) % face.size()]); wanted.contains(edge))
          found.emplace(edge, i);
    }
  }
  return found;
}

/// Twice the area vector of a patch, out of the mesh.
Vec3d area_of(const VolumeMesh& volume, const BoundaryPatch& patch) {
  Vec3d sum(0.0);
  for (std::size_t f = 0; f < patch.face_count(); ++f) sum += area_vector(volume.points, patch.face(f));
  return sum;
}

/// Finds the planes of open edges, loop by loop.
class OpenPlaneFinder {
 public:
  OpenPlaneFinder(const VolumeMesh& volume, std::span<const OpenEdge> edges)
      : volume_(volume), sides_(sides_at(volume, edges)) {}

  std::vector<OpenPlane> run(std::span<const OpenEdge> edges) {
    std::vector<std::vector<OpenEdge>> on_known;  // loops over several planes without sides, as those of the farfield
    for (std::vector<OpenEdge>& loop : loops_of(edges)) {
      const std::map<Index, std::vector<OpenEdge>> by_side = parted_by_sides(loop);
      if (by_side.size() > 1) add_parted(by_side);
      else if (const Index side = by_side.empty() ? kNone : by_side.begin()->first; is_periodic(side))
        add_periodic(plane_of(volume_.points, std::move(loop), kPeriodicOffPlane), side);
      else if (is_flat(loop)) add(plane_of(volume_.points, std::move(loop)));
      else on_known.push_back(std::move(loop));
    }
    for (const auto& loop : on_known) add_to_known(loop);
    turn_by_largest();
    if (volume_.motion) settle_periodic();
    return std::move(planes_);
  }

 private:
  static std::vector<std::vector<OpenEdge>> loops_of(std::span<const OpenEdge> edges) {
    std::map<Index, Index> number;
    for (const auto& edge : edges)
      for (const Index p : edge) number.try_emplace(p, static_cast<Index>(number.size()));
    DisjointSets joined(number.size());
    for (const auto& [a, b] : edges) joined.join(number[a], number[b]);
    std::map<Index, std::vector<OpenEdge>> of_loop;
    for (const auto& edge : edges) of_loop[joined.first(number[edge[0]])].push_back(edge);
    std::vector<std::vector<OpenEdge>> loops;
    loops.reserve(of_loop.size());
    for (auto& [first, loop] : of_loop) loops.push_back(std::move(loop));
    return loops;
  }

  /// Edges by the patch of sides that they belong to, those without one by kNone.
  std::map<Index, std::vector<OpenEdge>> parted_by_sides(const std::vector<OpenEdge>& loop) const {
    std::map<Index, std::vector<OpenEdge>> parted;
    for (const OpenEdge& edge : loop) {
      const auto side = sides_.find({std::min(edge[0], edge[1]), std::max(edge[0], edge[1])});
      parted[side == sides_.end() ? kNone : side->second].push_back(edge);
    }
    if (parted.size() == 2 && parted.contains(kNone)) return {};  // one plane, of which some edges have no layers
    return parted;
  }

  bool is_flat(const std::vector<OpenEdge>& loop) const {
    try {
      plane_of(volume_.points, loop);
      return true;
    } catch (const InvalidInput&) {
      if (planes_.empty()) throw;
      return false;
    }
  }

  void add_parted(const std::map<Index, std::vector<OpenEdge>>& by_side) {
    for (const auto& [side, edges] : by_side) {
      if (side == kNone) continue;
      OpenPlane plane = plane_through(volume_.points, edges, area_of(volume_, volume_.patches[side]),
                                      is_periodic(side) ? kPeriodicOffPlane : kOffPlane);
      plane.meets_others = true;
      if (is_periodic(side)) add_periodic(std::move(plane), side);
      else add(std::move(plane));
    }
    if (const auto bare = by_side.find(kNone); bare != by_side.end()) add_to_known(bare->second);
  }

  /// Adds edges to the known planes that they lie in.
  void add_to_known(const std::vector<OpenEdge>& edges) {
    const double size = edge_extent(volume_.points, edges).size;
    for (const OpenEdge& edge : edges) {
      const auto lies_in = [&](const OpenPlane& plane) {
        return std::ranges::all_of(edge, [&](Index p) {
          return std::abs((volume_.points[p] - plane.origin).dot(plane.normal)) < kOneOpeningPlane * size;
        });
      };
      const auto plane = std::ranges::find_if(planes_, lies_in);
      if (plane == planes_.end()) plane_of(volume_.points, edges);
      else plane->edges.push_back(edge);
    }
  }

  bool are_one(const OpenPlane& plane, const OpenPlane& other) const {
    const double size =
        std::max(edge_extent(volume_.points, plane.edges).size, edge_extent(volume_.points, other.edges).size);
    return plane.normal.cross(other.normal).length() < kOneOpeningPlane &&
           std::abs((plane.origin - other.origin).dot(other.normal)) < kOneOpeningPlane * size;
  }

  bool is_periodic(Index patch) const {
    return patch != kNone && volume_.patches[patch].kind == BoundaryPatch::Kind::Periodic;
  }

  /// Adds a plane of a periodic patch, which others in one plane with it belong to.
  void add_periodic(OpenPlane plane, Index patch) {
    plane.patch = patch;
    auto known = std::ranges::find(planes_, patch, &OpenPlane::patch);
    if (known == planes_.end())
      known = std::ranges::find_if(
          planes_, [&](const OpenPlane& other) { return other.patch == kNone && are_one(plane, other); });
    if (known == planes_.end()) return planes_.push_back(std::move(plane));
    known->patch = patch;
    known->edges.insert(known->edges.end(), plane.edges.begin(), plane.edges.end());
  }

  /// Makes the plane of the second periodic patch what the motion makes of that of the first one, which has the axis of
  /// a turn in it if it is near enough to that.
  void settle_periodic() {
    std::array<OpenPlane*, 2> both{};
    for (OpenPlane& plane : planes_)
      if (plane.patch != kNone) both[both[0] == nullptr ? 0 : 1] = &plane;
    if (both[1] == nullptr) return;
    if (both[1]->patch < both[0]->patch) std::swap(both[0], both[1]);
    const PeriodicMotion& motion = *volume_.motion;
    if (motion.angle != 0) put_through_axis(motion, *both[0]);
    both[1]->origin = motion(both[0]->origin);
    both[1]->normal = -motion.turned(both[0]->normal);
  }

  void put_through_axis(const PeriodicMotion& motion, OpenPlane& plane) const {
    Vec3d axis = motion.axis;
    axis.normalize(0.0);
    const Vec3d out = plane.origin - motion.point, radial = out - axis * axis.dot(out);
    Vec3d normal = plane.normal - axis * axis.dot(plane.normal);
    normal -= radial * (radial.dot(normal) / radial.lengthSqr());
    if (!normal.normalize(0.0)) return;
    const double most = kPeriodicOffPlane * edge_extent(volume_.points, plane.edges).size;
    for (const OpenEdge& edge : plane.edges)
      if (std::abs((volume_.points[edge[0]] - motion.point).dot(normal)) > most) return;
    plane.normal = normal;
  }

  void add(OpenPlane plane) {
    const auto known = std::ranges::find_if(planes_, [&](const OpenPlane& other) { return are_one(plane, other); });
    if (known == planes_.end()) {
      planes_.push_back(std::move(plane));
      return;
    }
    known->edges.insert(known->edges.end(), plane.edges.begin(), plane.edges.end());
    if (plane.meets_others && !known->meets_others) known->meets_others = true, known->normal = plane.normal;
  }

  /// The larger ones of several loops in a plane are around the others, and say what is outside.
  void turn_by_largest() {
    for (OpenPlane& plane : planes_)
      if (!plane.meets_others && edge_extent(volume_.points, plane.edges).normal.dot(plane.normal) < 0)
        plane.normal = -plane.normal;
  }

  const VolumeMesh& volume_;
  std::map<OpenEdge, Index> sides_;
  std::vector<OpenPlane> planes_;
};

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
    mesh_ = meshed(region);
    first_added_ = static_cast<Index>(volume_.points.size());
    for (const Vec2d& x : mesh_.added) volume_.points.push_back(plane_.origin + u * x[0] + v * x[1]);
  }

  /// Puts the triangles into patches: those of connected ones around which sides lie, or else a new one.
  void add_to(const std::string& name, bool is_symmetric) {
    if (plane_.patch != kNone) return add_all_to(plane_.patch);
    const std::map<OpenEdge, Index> sides = sides_at(volume_, plane_.edges);
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
        volume_.patches.push_back({.name = free_name(volume_, name), .kind = kind_of(is_symmetric)});
      }
      front_.triangles.push_back({{point(triangle[0]), point(triangle[1]), point(triangle[2])}, kNone, here});
    }
  }

 private:
  void add_all_to(Index patch) {
    for (const auto& [a, b, c] : mesh_.triangles)
      front_.triangles.push_back({{point(a), point(b), point(c)}, kNone, patch});
  }

  PlaneMesh meshed(const PlaneRegion& region) const {
    try {
      return mesh_plane(region);
    } catch (const InvalidInput& error) {
      const Vec3d& place = plane_.origin;
      throw InvalidInput(fmt::format(
          "fill: expected an opening around ({:.6g}, {:.6g}, {:.6g}) that a plane can cover, got another ({}; "
          "close the surface there)",
          place[0], place[1], place[2], error.what()));
    }
  }

  static BoundaryPatch::Kind kind_of(bool is_symmetric) {
    return is_symmetric ? BoundaryPatch::Kind::Symmetry : BoundaryPatch::Kind::Side;
  }

  /// The sides of all bodies that end at the plane belong to it.
  void make_symmetric(const std::map<OpenEdge, Index>& sides, const std::string& name) {
    std::set<Index> patches;
    for (const auto& [edge, side] : sides) patches.insert(side);
    for (const Index i : patches) {
      volume_.patches[i].name = free_name(volume_, name);
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
  first.normalize(0.0);
  return {first, normal.cross(first)};
}

std::vector<OpenPlane> open_planes(const VolumeMesh& volume, std::span<const OpenEdge> edges) {
  return OpenPlaneFinder(volume, edges).run(edges);
}

std::vector<SymmetryPlane> guessed_planes(std::span<const Vec3d> points, std::span<const OpenPlane> planes) {
  std::vector<SymmetryPlane> guessed;
  for (const OpenPlane& plane : planes) {
    const Vec3d &first = points[plane.edges[0][0]], &n = plane.normal;
    Vec3d along = points[plane.edges[0][1]] - first;
    along.normalize(0.0);
    const bool is_across = std::abs(n[0]) == 1 || std::abs(n[1]) == 1 || std::abs(n[2]) == 1;
    const double size = edge_extent(points, plane.edges).size;
    const bool is_line = std::ranges::all_of(plane.edges, [&](const OpenEdge& edge) {
      const Vec3d to = points[edge[1]] - first;
      return (to - along * along.dot(to)).length() < kOffPlane * size;
    });
    if (is_line && !is_across && plane.patch == kNone) guessed.push_back({n, n.dot(plane.origin)});
  }
  return guessed;
}

bool is_enclosed_by(std::span<const Vec3d> points, std::span<const FrontTriangle> front,
                    std::span<const OpenPlane> openings) {
  std::vector<Vec3d> all(points.begin(), points.end());
  std::vector<OpenPlane> planes(openings.begin(), openings.end());
  const PlaneLines lines = find_plane_lines(points, openings);
  if (!lines.is_closed) return false;
  // One edge along each line does, as areas alone count.
  constexpr double kCoarse = 1e6;
  close_along(lines, kCoarse, std::numeric_limits<double>::infinity(), all, planes);
  std::vector<FrontTriangle> closed(front.begin(), front.end());
  for (const OpenPlane& plane : planes) {
    const auto middle = static_cast<Index>(all.size());
    all.push_back(plane.origin);
    for (const auto& [a, b] : plane.edges) closed.push_back({{a, b, middle}, kNone, kNone});
  }
  return is_enclosed(all, closed);
}

void cover(const OpenPlane& plane, const FillOptions& options, const std::string& name, bool is_symmetric,
           FillFront& front, VolumeMesh& volume) {
  Cover made(plane, front, volume);
  made.make(options);
  made.add_to(name, is_symmetric);
}

}  // namespace vdb_offset
