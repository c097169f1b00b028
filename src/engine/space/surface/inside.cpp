// SPDX-License-Identifier: Apache-2.0
#include "space/surface/inside.h"

#include <algorithm>

namespace vdb_offset {

RayTree::RayTree(const Surface& surface, const std::function<bool(std::size_t)>& is_in) : surface_(surface) {
  tree_.build(surface.triangles.size(), [&](std::size_t t) { return is_in(t) ? box_of(t) : FloatBox{}; });
}

FloatBox RayTree::box_of(std::size_t t) const {
  FloatBox box;
  for (const auto v : surface_.triangles[t]) {
    const Vec3d p = leaned(surface_.vertices[v]);
    for (std::size_t k = 0; k < 3; ++k) {
      box.lower[k] = std::min(box.lower[k], below(p[static_cast<int>(k)]));
      box.upper[k] = std::max(box.upper[k], above(p[static_cast<int>(k)]));
    }
  }
  return box;
}

int RayTree::pass(std::size_t t, const Vec3d& start, double& height) const {
  const auto& corner = surface_.triangles[t];
  Vec3d p[3];
  for (std::size_t k = 0; k < 3; ++k) p[k] = leaned(surface_.vertices[corner[k]]) - start;
  int left = 0;
  double weight[3], total = 0, sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const bool ordered = corner[i] < corner[j];
    const Vec3d &from = ordered ? p[i] : p[j], &to = ordered ? p[j] : p[i];
    const double side = from[0] * to[1] - to[0] * from[1];
    left += (side >= 0) == ordered;
    weight[k] = ordered ? side : -side;
    total += weight[k];
    sum += weight[k] * p[k][2];
  }
  if ((left != 0 && left != 3) || total == 0) return 0;
  height = sum / total;
  return left == 3 ? 1 : -1;
}

namespace {

/// The triangles of the solid parts, and the fans that fill their holes.
std::unique_ptr<const Surface> filled(const Surface& surface, const Solidity& solidity) {
  auto all = std::make_unique<Surface>();
  all->origin = surface.origin;
  all->vertices = surface.vertices;
  all->triangles = surface.triangles;  // numbers stay: triangles of other parts become empty
  for (std::size_t t = 0; t < all->triangles.size(); ++t)
    if (!solidity.is_solid[solidity.part_of[t]]) all->triangles[t] = {0, 0, 0};
  for (const Hole& hole : solidity.holes) {
    const auto centre = static_cast<std::uint32_t>(all->vertices.size());
    all->vertices.push_back(centre_of(surface, hole));
    for (std::size_t i = 0; i < hole.rim.size(); ++i)
      all->triangles.push_back({centre, hole.rim[i], hole.rim[(i + 1) % hole.rim.size()]});
  }
  return all;
}

}  // namespace

Inside::Inside(const Surface& surface, const Solidity& solidity, Orient orient)
    : filled_(filled(surface, solidity)),
      rays_(*filled_,
            [&](std::size_t t) { return t >= solidity.part_of.size() || solidity.is_solid[solidity.part_of[t]]; }),
      surface_(*filled_) {
  if (solidity.solid_parts() == 0) return;
  sense_ = solidity.volume < 0 ? -1 : 1;
  is_turned_ = sense_ < 0 && orient == Orient::Keep;
  has_holes_ = solidity.hole_count() > 0;
}

Inside::Inside(const Surface& surface, Orient orient) : rays_(surface), surface_(surface) {
  const MeshFacts& facts = surface.facts;
  if (!facts.closed() || !facts.oriented()) return;
  const bool all_wrong =
      orient == Orient::Keep && facts.closed_components > 0 && facts.inside_out_components == facts.closed_components;
  sense_ = all_wrong ? -1 : 1;
  is_turned_ = all_wrong;
}

bool Inside::operator()(const Vec3d& x) const {
  if (sense_ == 0) return false;
  int winding = 0;
  rays_.cast(x, [&](std::size_t, int turn) { winding += turn; });
  return winding * sense_ > 0;
}

bool Inside::is_buried(std::uint32_t triangle, const Vec3d& x, double close) const {
  const auto normal_of = [&](std::size_t t) {
    const auto& [a, b, c] = surface_.triangles[t];
    const Vec3d normal =
        (surface_.vertices[b] - surface_.vertices[a]).cross(surface_.vertices[c] - surface_.vertices[a]);
    return normal.lengthSqr() > 0 ? normal.unit() : Vec3d(0.0);
  };
  // kLeastSlope: cosine between ray and normal below which the ray runs along the triangle, and is on neither side of
  // it. kAround: the length of ray around the point, in units of `close`, along which triangles are tested for being
  // close: the more a triangle leans against the ray, the farther off the ray meets it. Not measured.
  constexpr double kLeastSlope = 1e-6, kAround = 1e3;
  const double slope = normal_of(triangle).dot(RayTree::direction());
  if (sense_ == 0 || std::abs(slope) < kLeastSlope) return false;
  // Winding numbers: just ahead of all triangles at the point, and what these add just behind them.
  int ahead = 0, here = slope > 0 ? 1 : -1;
  rays_.cast_from_behind(x, kAround * close, [&](std::size_t t, int turn, double height) {
    if (t == triangle) return;
    const bool is_here = std::abs(height) < kAround * close &&
                         std::abs(normal_of(t).dot(x - surface_.vertices[surface_.triangles[t][0]])) < close;
    if (is_here) here += turn;
    else if (height > 0) ahead += turn;
  });
  return ahead * sense_ > 0 && (ahead + here) * sense_ > 0;
}

}  // namespace vdb_offset
