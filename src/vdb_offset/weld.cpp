#include "vdb_offset/weld.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>

#include "vdb_offset/error.h"
#include "vdb_offset/mix.h"

namespace vdb_offset {
namespace {

/// Finds the first vertex that stands where another one does. Open addressing over vertex numbers.
class Welder {
 public:
  Welder(std::span<const Vec3d> positions, const WeldOptions& options, std::size_t count)
      : positions_(positions), tolerance_(options.tolerance), slots_(std::bit_ceil(2 * count + 16), kNone) {}

  /// The first vertex seen within the tolerance of vertex v: v itself if there is none.
  std::uint32_t first_at(std::uint32_t v) {
    if (tolerance_ > 0)
      if (const std::uint32_t near = search_around(v); near != kNone) return near;
    const auto key = cell(positions_[v]);
    std::size_t slot = hash(key) & (slots_.size() - 1);
    for (; slots_[slot] != kNone; slot = (slot + 1) & (slots_.size() - 1))
      if (tolerance_ == 0 && positions_[slots_[slot]] == positions_[v]) return slots_[slot];
    return slots_[slot] = v;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  /// The position's bits for exact welding (with -0 as 0), else the cell of side `tolerance` around it.
  Cell cell(const Vec3d& p) const {
    Cell c;
    for (int k = 0; k < 3; ++k)
      c[k] = tolerance_ > 0 ? static_cast<std::int64_t>(std::floor(p[k] / tolerance_))
                            : std::bit_cast<std::int64_t>(p[k] + 0.0);
    return c;
  }
  static std::size_t hash(const Cell& c) {
    return mix(static_cast<std::uint64_t>(c[0]) +
               mix(static_cast<std::uint64_t>(c[1]) + mix(static_cast<std::uint64_t>(c[2]))));
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

void require_tolerance(PolygonView polygons, const WeldOptions& options) {
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
  // The guard leaves room for the two triangles fewer than corners that each face gives.
  if (polygons.corners.size() >= (std::size_t{1} << 31) / 3)
    throw InvalidInput("mesh: expected fewer than 2^31 half-edges, got " + std::to_string(polygons.corners.size()) +
                       " face corners");
  if (polygons.face_begin.front() != 0 || polygons.face_begin.back() != polygons.corners.size())
    throw InvalidInput("mesh: expected face_begin to run from 0 to the number of corners");
  for (std::size_t f = 0; f < polygons.face_count(); ++f)
    if (polygons.face_begin[f] > polygons.face_begin[f + 1] ||
        polygons.face_begin[f + 1] - polygons.face_begin[f] < least_corners)
      throw InvalidInput("mesh: expected at least " + std::to_string(least_corners) + " corners in face " +
                         std::to_string(f));
  for (const auto v : polygons.corners)
    if (v >= polygons.positions.size())
      throw InvalidInput("mesh: expected vertex indices below " + std::to_string(polygons.positions.size()) + ", got " +
                         std::to_string(v));
  for (const auto v : polygons.corners)
    if (!polygons.positions[v].isFinite())
      throw InvalidInput("mesh: expected finite coordinates, got a NaN or an infinity at vertex " + std::to_string(v));
}

void weld(PolygonView polygons, const WeldOptions& options, Surface& surface) {
  require_tolerance(polygons, options);
  const std::size_t count = polygons.positions.size();
  std::vector<std::uint8_t> used(count, 0);
  for (const auto v : polygons.corners) used[v] = 1;
  surface.welded.assign(count, kNone);
  Welder welder(polygons.positions, options, options.enabled ? count : 0);
  for (std::uint32_t v = 0; v < count; ++v) {
    if (!used[v]) continue;
    const std::uint32_t first = options.enabled ? welder.first_at(v) : v;
    if (first == v) {
      surface.welded[v] = static_cast<std::uint32_t>(surface.vertices.size());
      surface.vertices.push_back(polygons.positions[v]);
      surface.representative.push_back(v);
    } else {
      surface.welded[v] = surface.welded[first];
    }
  }
  surface.facts.vertices = count;
  surface.facts.unused_vertices = static_cast<std::size_t>(std::count(used.begin(), used.end(), 0));
  surface.facts.welded_vertices = surface.vertices.size();
}

std::vector<std::uint32_t> weld_by_position(PolygonView polygons, const WeldOptions& options) {
  require_usable(polygons, 1);
  Surface surface;
  weld(polygons, options, surface);
  std::vector<std::uint32_t> first(polygons.positions.size(), kNone);
  for (std::size_t v = 0; v < first.size(); ++v)
    if (surface.welded[v] != kNone) first[v] = surface.representative[surface.welded[v]];
  return first;
}

}  // namespace vdb_offset
