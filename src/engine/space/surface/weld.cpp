// SPDX-License-Identifier: Apache-2.0
#include "space/surface/weld.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <string>

#include "ground/numbers/hash_mix.h"
#include "ground/system/parallel.h"
#include "space/surface/seams.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

constexpr std::uint64_t kNone64 = ~std::uint64_t{0};

using Cell = std::array<std::int64_t, 3>;
std::size_t hash(const Cell& c) {
  return mix(static_cast<std::uint64_t>(c[0]) +
             mix(static_cast<std::uint64_t>(c[1]) + mix(static_cast<std::uint64_t>(c[2]))));
}
std::size_t slots_for(std::size_t count) { return std::bit_ceil(2 * count + 16); }

/// Finds for vertices, which are taken one after the other, the first one within a tolerance. A hash table with open
/// addressing over vertex numbers.
class TolerantWelder {
 public:
  TolerantWelder(std::span<const Vec3d> positions, double tolerance)
      : positions_(positions), tolerance_(tolerance), slots_(slots_for(positions.size()), kNone) {}

  /// The first vertex seen within the tolerance of vertex v: v itself if there is none.
  std::uint32_t first_at(std::uint32_t v) {
    if (const std::uint32_t near = search_around(v); near != kNone) return near;
    std::size_t slot = hash(cell(positions_[v])) & (slots_.size() - 1);
    while (slots_[slot] != kNone) slot = (slot + 1) & (slots_.size() - 1);
    return slots_[slot] = v;
  }

 private:
  /// The cell that holds a point: a cube of side `tolerance`.
  Cell cell(const Vec3d& p) const {
    Cell c;
    for (int k = 0; k < 3; ++k) c[k] = static_cast<std::int64_t>(std::floor(p[k] / tolerance_));
    return c;
  }
  std::uint32_t search_around(std::uint32_t v) const {
    const Cell centre = cell(positions_[v]);
    std::uint32_t best = kNone;
    for (int n = 0; n < 27; ++n) {
      const Cell c = {centre[0] + n / 9 - 1, centre[1] + n / 3 % 3 - 1, centre[2] + n % 3 - 1};
      for (std::size_t s = hash(c) & (slots_.size() - 1); slots_[s] != kNone; s = (s + 1) & (slots_.size() - 1))
        if (slots_[s] < best && cell(positions_[slots_[s]]) == c &&
            (positions_[slots_[s]] - positions_[v]).length() <= tolerance_)
          best = slots_[s];
    }
    return best;
  }

  std::span<const Vec3d> positions_;
  double tolerance_;
  std::vector<std::uint32_t> slots_;
};

/// Finds the first of the vertices that have bitwise the same position, on any number of threads: all vertices are
/// added first, then each may be looked up. A position has one slot, in which the lowest vertex number stays.
class ExactWelder {
 public:
  explicit ExactWelder(std::span<const Vec3d> positions)
      : positions_(positions), slots_(slots_for(positions.size()), kNone) {}

  void add(std::uint32_t v) {
    for (std::size_t at = start(v);; at = (at + 1) & (slots_.size() - 1)) {
      const std::atomic_ref slot(slots_[at]);
      std::uint32_t known = slot.load(std::memory_order_relaxed);
      if (known == kNone && slot.compare_exchange_strong(known, v, std::memory_order_relaxed)) return;
      if (positions_[known] != positions_[v]) continue;
      while (v < known && !slot.compare_exchange_weak(known, v, std::memory_order_relaxed)) {
      }
      return;
    }
  }
  std::uint32_t first_at(std::uint32_t v) const {
    std::size_t at = start(v);
    while (positions_[slots_[at]] != positions_[v]) at = (at + 1) & (slots_.size() - 1);
    return slots_[at];
  }

 private:
  /// The slot at which the search begins: a hash of the position's bits, where -0 counts as 0.
  std::size_t start(std::uint32_t v) const {
    Cell bits;
    for (int k = 0; k < 3; ++k) bits[static_cast<std::size_t>(k)] = std::bit_cast<std::int64_t>(positions_[v][k] + 0.0);
    return hash(bits) & (slots_.size() - 1);
  }

  std::span<const Vec3d> positions_;
  std::vector<std::uint32_t> slots_;
};

/// For each vertex that faces use, the first one that it is welded with, which may be itself; kNone for others.
std::vector<std::uint32_t> find_firsts(PolygonView polygons, const WeldOptions& options) {
  const std::size_t count = polygons.positions.size();
  std::vector<std::uint32_t> first(count, kNone);
  for_each_index(polygons.corners.size(), [&](std::size_t i) {
    const std::uint32_t v = polygons.corners[i];
    std::atomic_ref(first[v]).store(v, std::memory_order_relaxed);
  });
  if (!options.enabled) return first;
  if (options.tolerance > 0) {
    TolerantWelder welder(polygons.positions, options.tolerance);
    for (std::uint32_t v = 0; v < count; ++v)
      if (first[v] != kNone) first[v] = welder.first_at(v);
    return first;
  }
  ExactWelder welder(polygons.positions);
  for_each_index(count, [&](std::size_t v) {
    if (first[v] != kNone) welder.add(static_cast<std::uint32_t>(v));
  });
  for_each_index(count, [&](std::size_t v) {
    if (first[v] != kNone) first[v] = welder.first_at(static_cast<std::uint32_t>(v));
  });
  return first;
}

void require_tolerance(PolygonView polygons, const WeldOptions& options) {
  if (!(options.precision >= 0 && options.precision < 1))
    throw InvalidInput("weld: expected a precision from 0 to 1, got " + std::to_string(options.precision));
  if (!(options.tolerance >= 0) || !std::isfinite(options.tolerance))
    throw InvalidInput("weld: expected a tolerance >= 0, got " + std::to_string(options.tolerance));
  if (options.tolerance == 0) return;
  for (const auto v : polygons.corners)
    for (int k = 0; k < 3; ++k)
      if (std::abs(polygons.positions[v][k]) > 0x1p52 * options.tolerance)
        throw InvalidInput("weld: expected a tolerance above the rounding of the coordinates (use bit-equal welding)");
}

}  // namespace

void require_usable(PolygonView polygons, std::uint32_t least_corners) {
  if (polygons.face_count() == 0) throw InvalidInput("mesh: expected at least one face, got none");
  // Three half-edges for each corner are more than needed: a face has two triangles fewer than corners.
  if (polygons.corners.size() >= (std::size_t{1} << 31) / 3)
    throw InvalidInput("mesh: expected fewer than 2^31 half-edges, got " + std::to_string(polygons.corners.size()) +
                       " face corners");
  if (polygons.face_begin.front() != 0 || polygons.face_begin.back() != polygons.corners.size())
    throw InvalidInput("mesh: expected face_begin to run from 0 to the number of corners");
  const auto first_of = [](std::size_t count, auto&& is_wrong) {
    std::atomic<std::uint64_t> first = kNone64;
    for_each_index(count, [&](std::size_t i) {
      if (is_wrong(i)) lower_to(first, i);
    });
    return first.load();
  };
  const std::uint64_t f = first_of(polygons.face_count(), [&](std::size_t i) {
    const std::uint32_t begin = polygons.face_begin[i], end = polygons.face_begin[i + 1];
    return begin > end || end - begin < least_corners;
  });
  if (f != kNone64)
    throw InvalidInput("mesh: expected at least " + std::to_string(least_corners) + " corners in face " +
                       std::to_string(f));
  const auto& corners = polygons.corners;
  const auto& positions = polygons.positions;
  if (const std::uint64_t i = first_of(corners.size(), [&](std::size_t c) { return corners[c] >= positions.size(); });
      i != kNone64)
    throw InvalidInput("mesh: expected vertex indices below " + std::to_string(positions.size()) + ", got " +
                       std::to_string(corners[i]));
  if (const std::uint64_t i =
          first_of(corners.size(), [&](std::size_t c) { return !positions[corners[c]].isFinite(); });
      i != kNone64)
    throw InvalidInput("mesh: expected finite coordinates, got a NaN or an infinity at vertex " +
                       std::to_string(corners[i]));
  if (polygons.triangles.empty()) return;
  if (polygons.triangles.size() + 2 * polygons.face_count() != corners.size())
    throw InvalidInput("mesh: expected two triangles fewer than corners for each face, " +
                       std::to_string(corners.size() - 2 * polygons.face_count()) + ", got " +
                       std::to_string(polygons.triangles.size()));
  for (const auto& triangle : polygons.triangles)
    for (const auto v : triangle)
      if (v >= positions.size())
        throw InvalidInput("mesh: expected corners of triangles below " + std::to_string(positions.size()) + ", got " +
                           std::to_string(v));
}

Welding find_welding(PolygonView polygons, const WeldOptions& options) {
  require_usable(polygons, 1);
  return weld_usable(polygons, options);
}

Welding weld_usable(PolygonView polygons, const WeldOptions& options) {
  require_tolerance(polygons, options);
  Welding welding{find_firsts(polygons, options), {}, {}};
  if (!options.enabled) return welding;
  if (options.tolerance == 0 && options.close_seams) {
    const ClosedSeams closed = close_seams(polygons, options.precision, welding.first);
    welding.seams = closed.facts;
    weld_slivers(polygons, welding.first, welding.seams);
    if (options.join_hanging) welding.hanging = closed.tolerance;
  } else if (options.tolerance > 0 && options.join_hanging) {
    welding.hanging = options.tolerance;
  }
  return welding;
}

Welding restricted(Welding welding, PolygonView some_faces) {
  std::vector<std::uint32_t> first(welding.first.size(), kNone);
  for (const auto v : some_faces.corners) {
    const std::uint32_t one = welding.first[v];
    first[v] = first[one] = one;  // `one` may be in none of these faces, but has the position
  }
  welding.first = std::move(first);
  return welding;
}

void give_vertices(PolygonView polygons, const Welding& welding, Surface& surface) {
  const std::size_t count = polygons.positions.size();
  const std::vector<std::uint32_t>& first = welding.first;
  surface.welded.assign(count, kNone);
  surface.representative.reserve(count);
  for (std::uint32_t v = 0; v < count; ++v) {
    if (first[v] != v) continue;
    surface.welded[v] = static_cast<std::uint32_t>(surface.representative.size());
    surface.representative.push_back(v);
  }
  for_each_index(count, [&](std::size_t v) {
    if (first[v] != kNone && first[v] != v) surface.welded[v] = surface.welded[first[v]];
  });
  surface.vertices.resize(surface.representative.size());
  for_each_index(surface.vertices.size(),
                 [&](std::size_t w) { surface.vertices[w] = polygons.positions[surface.representative[w]]; });
  surface.facts.vertices = count;
  surface.facts.seams = welding.seams;
  surface.facts.unused_vertices = static_cast<std::size_t>(std::count(first.begin(), first.end(), kNone));
  surface.facts.welded_vertices = surface.vertices.size();
}

std::vector<std::uint32_t> first_at_position(const Surface& surface) {
  std::vector<std::uint32_t> first(surface.welded.size(), kNone);
  for_each_index(first.size(), [&](std::size_t v) {
    if (surface.welded[v] != kNone) first[v] = surface.representative[surface.welded[v]];
  });
  return first;
}

std::vector<std::uint32_t> weld_by_position(PolygonView polygons, const WeldOptions& options) {
  return find_welding(polygons, options).first;
}

}  // namespace vdb_offset
