// SPDX-License-Identifier: Apache-2.0
// Sorts a surface into the parts that give way together in a fit. Flood fills over edges find two kinds of regions:
// triangles between sharp edges, and in these the triangles that lie in the plane of their region's first one. A flat
// region is a face of its own if it is at least four times as large as any flat region that is smoothly joined to it.
// All corners on such a face are one part; elsewhere each vertex is a part by itself in each region between sharp
// edges, so that one side of a sharp edge can go without the other. Triangles that may not give way are in no part.
// Numbers follow the order of triangles. How far a part goes is decided in fit.cpp.
#include "products/offset/fit_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "ground/mesh/planes_around.h"
#include "space/surface/creases.h"

namespace vdb_offset {
namespace {

// The least angle between the normals on both sides of a sharp edge: that of creases.
const double kSharpCosine = std::cos(20 * std::numbers::pi / 180);
// How many times as large as a region that is smoothly joined to it a flat one is at least, if it is a face of its own:
// beside a fillet, whose facets are narrow, but not one facet of a cylinder among others. Not measured.
constexpr double kFarLarger = 4;

}  // namespace

/// Finds regions of triangles that are joined across edges, first those between sharp edges, then flat ones in them.
class FitParts::Finder {
 public:
  Finder(const Surface& surface, std::span<const std::uint8_t> only)
      : surface_(surface), only_(only), on_crease_(vertices_on_creases(surface)) {
    smooth_ = regions([&](std::uint32_t, std::uint32_t a, std::uint32_t b) { return !is_sharp(a, b); });
    flat_ = regions([&](std::uint32_t first, std::uint32_t a, std::uint32_t b) {
      return !is_sharp(a, b) && is_in_plane(first, b / 3);
    });
  }

  void operator()(FitParts& parts) {
    const std::vector<std::uint32_t> flat_part = number_flat_faces(parts);
    // The part of each vertex in each smooth region: that of a flat face there, if it is on one.
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> part_of;
    for (const bool flat : {true, false})
      for (std::uint32_t t = 0; t < surface_.triangles.size(); ++t) {
        if (smooth_[t] == kNone || (flat_part[flat_[t]] != kNone) != flat) continue;
        for (const auto v : surface_.triangles[t]) {
          const auto next = flat ? flat_part[flat_[t]] : static_cast<std::uint32_t>(parts.count_);
          const bool is_new = part_of.try_emplace({smooth_[t], v}, next).second;
          parts.count_ += !flat && is_new;
        }
      }
    for (std::uint32_t t = 0; t < surface_.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        parts.of_corner_[t][k] = smooth_[t] == kNone ? kNone : part_of.at({smooth_[t], surface_.triangles[t][k]});
  }

 private:
  bool may_give_way(std::uint32_t triangle) const { return only_.empty() || only_[surface_.face[triangle]]; }
  const Vec3d& normal(std::uint32_t triangle) const { return surface_.triangle_normals[triangle]; }

  /// Whether two triangles at the half-edges a and b of one edge meet at a sharp one.
  bool is_sharp(std::uint32_t a, std::uint32_t b) const {
    return on_crease_[surface_.from(a)] && on_crease_[surface_.to(a)] && normal(a / 3).lengthSqr() > 0 &&
           normal(b / 3).lengthSqr() > 0 && normal(a / 3).dot(normal(b / 3)) <= kSharpCosine;
  }
  /// Whether a triangle is in the plane of another one, as far as it has a plane.
  bool is_in_plane(std::uint32_t first, std::uint32_t t) const {
    if (normal(t).lengthSqr() == 0) return true;
    const double tilt = surface_.tilt(t);
    return tilt > kMostTilt || (normal(first) - normal(t)).length() < kOnePlaneSine + tilt;
  }

  /// Numbers the regions of triangles that are joined, in the order of their first triangles.
  template <class IsJoined>
  std::vector<std::uint32_t> regions(IsJoined&& is_joined) const {
    std::vector<std::uint32_t> region(surface_.triangles.size(), kNone), stack;
    std::uint32_t count = 0;
    for (std::uint32_t first = 0; first < region.size(); ++first) {
      if (region[first] != kNone || !may_give_way(first)) continue;
      region[first] = count;
      stack.push_back(first);
      while (!stack.empty()) {
        const std::uint32_t t = stack.back();
        stack.pop_back();
        for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
          const std::uint32_t twin = surface_.next_around_edge[h];
          if (twin == h || surface_.next_around_edge[twin] != h || region[twin / 3] != kNone ||
              !may_give_way(twin / 3) || !is_joined(first, h, twin))
            continue;
          region[twin / 3] = count;
          stack.push_back(twin / 3);
        }
      }
      ++count;
    }
    return region;
  }

  /// Numbers the flat regions that are faces of their own, from 0; kNone of the others.
  std::vector<std::uint32_t> number_flat_faces(FitParts& parts) const {
    std::vector<double> extent, of_neighbour;
    for (std::uint32_t t = 0; t < flat_.size(); ++t) {
      if (flat_[t] == kNone) continue;
      if (flat_[t] >= extent.size()) extent.resize(flat_[t] + 1, 0.0);
      extent[flat_[t]] += surface_.extent(t);
    }
    of_neighbour.resize(extent.size(), 0.0);
    for (std::uint32_t h = 0; h < surface_.next_around_edge.size(); ++h) {
      const std::uint32_t t = h / 3, other = surface_.next_around_edge[h] / 3;
      if (flat_[t] == kNone || flat_[t] == flat_[other] || smooth_[t] != smooth_[other]) continue;
      of_neighbour[flat_[t]] = std::max(of_neighbour[flat_[t]], extent[flat_[other]]);
    }
    std::vector<std::uint32_t> number(extent.size(), kNone);
    for (std::size_t i = 0; i < number.size(); ++i)
      if (extent[i] >= kFarLarger * of_neighbour[i]) number[i] = static_cast<std::uint32_t>(parts.flat_count_++);
    parts.count_ = parts.flat_count_;
    return number;
  }

  const Surface& surface_;
  std::span<const std::uint8_t> only_;
  std::vector<std::uint8_t> on_crease_;
  std::vector<std::uint32_t> smooth_, flat_;  // of each triangle, the region that it is in
};

FitParts::FitParts(const Surface& surface, std::span<const std::uint8_t> only)
    : of_corner_(surface.triangles.size()), surface_(surface) {
  Finder(surface, only)(*this);
}

std::uint32_t FitParts::at(std::uint32_t triangle, std::uint32_t vertex) const {
  const auto& corners = surface_.triangles[triangle];
  return of_corner_[triangle][corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2];
}

}  // namespace vdb_offset
