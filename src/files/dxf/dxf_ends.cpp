// SPDX-License-Identifier: Apache-2.0
#include "dxf/dxf_ends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

namespace vdb_offset::io {
namespace {

/// Places of ends, found by cells of a grid that is as wide as the gap.
class EndPlaces {
 public:
  EndPlaces(double gap, const Vec3d& origin) : gap_(gap), origin_(origin) {}

  /// The nearest place within the gap of an end, but for one that was added for the curve `but`; the end itself, which
  /// becomes a place, if there is none.
  Vec3d place_of(const Vec3d& end, std::size_t curve, bool may_meet_itself) {
    const Place* nearest = nullptr;
    double least = gap_;
    const Cell cell = cell_of(end);
    for (std::int64_t x = -1; x <= 1; ++x)
      for (std::int64_t y = -1; y <= 1; ++y) {
        const auto [from, to] = places_.equal_range(key_of({cell[0] + x, cell[1] + y}));
        for (auto each = from; each != to; ++each) {
          const Place& place = each->second;
          const double away = (place.at - end).length();
          if (away > least || place.at[2] != end[2] || (place.curve == curve && !may_meet_itself)) continue;
          // Of places as near the first one counts, whatever the order of the table.
          if (nearest && away == least && place.number > nearest->number) continue;
          nearest = &place, least = away;
        }
      }
    if (nearest) return nearest->at;
    places_.emplace(key_of(cell), Place{end, curve, places_.size()});
    return end;
  }

 private:
  using Cell = std::array<std::int64_t, 2>;
  struct Place {
    Vec3d at;
    std::size_t curve, number;
  };

  Cell cell_of(const Vec3d& p) const {
    Cell cell;
    for (std::size_t k = 0; k < cell.size(); ++k)
      cell[k] = static_cast<std::int64_t>(std::floor((p[static_cast<int>(k)] - origin_[static_cast<int>(k)]) / gap_));
    return cell;
  }
  static std::uint64_t key_of(const Cell& cell) {
    // Primes without a pattern; cells that share a key cost time alone.
    return static_cast<std::uint64_t>(cell[0]) * 0x9e3779b97f4a7c15U ^
           static_cast<std::uint64_t>(cell[1]) * 0xc2b2ae3d27d4eb4fU;
  }

  double gap_;
  Vec3d origin_;
  std::unordered_multimap<std::uint64_t, Place> places_;
};

}  // namespace

void join_near_ends(std::vector<DxfEnds>& curves, double gap) {
  constexpr double kLonger = 10, kMuchLonger = 1000;  // extents, in gaps: shorter curves would lose their form
  if (!(gap > 0) || !std::isfinite(gap) || curves.empty()) return;
  EndPlaces places(gap, curves.front().first);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    DxfEnds& curve = curves[c];
    if (!curve.is_open || !(curve.extent > kLonger * gap)) continue;
    for (Vec3d* const end : {&curve.first, &curve.last}) {
      const Vec3d place = places.place_of(*end, c, curve.extent > kMuchLonger * gap);
      curve.shift = std::max(curve.shift, (place - *end).length());
      *end = place;
    }
  }
}

}  // namespace vdb_offset::io
