// SPDX-License-Identifier: Apache-2.0
#include "cells_inside.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "ground/mesh/exact_predicates.h"

namespace vdb_offset {
namespace {

class CellsInside {
 public:
  CellsInside(const FillDomain& domain, FilledDomain& filled) : domain_(domain), filled_(filled) {}

  void keep() {
    for (std::uint32_t c = 0; c < filled_.cells.size(); ++c)
      for (std::size_t k = 0; k < 4; ++k) sides_.push_back({face(c, k), c, filled_.cells[c][k]});
    std::sort(sides_.begin(), sides_.end(), [](const Side& a, const Side& b) { return a.corners < b.corners; });
    std::vector<std::uint32_t> left;
    std::vector<std::uint8_t> is_inside(filled_.cells.size(), 0);
    const auto reach = [&](std::uint32_t cell) {
      if (is_inside[cell] == 0) is_inside[cell] = 1, left.push_back(cell);
    };
    for (const auto& triangle : domain_.triangles)
      for (Side& side : behind(sorted(triangle))) {
        side.is_border = true;
        if (side_of_plane({point(triangle[0]), point(triangle[1]), point(triangle[2])}, point(side.apex)) < 0)
          reach(side.cell);
      }
    while (!left.empty()) {
      const std::uint32_t cell = left.back();
      left.pop_back();
      for (std::size_t k = 0; k < 4; ++k)
        for (const Side& side : behind(face(cell, k)))
          if (!side.is_border) reach(side.cell);
    }
    std::uint32_t c = 0;
    std::erase_if(filled_.cells, [&](const auto&) { return is_inside[c++] == 0; });
  }

 private:
  using Face = std::array<std::uint32_t, 3>;
  struct Side {
    Face corners;
    std::uint32_t cell, apex;
    bool is_border = false;
  };

  static Face sorted(Face face) {
    std::sort(face.begin(), face.end());
    return face;
  }
  Face face(std::uint32_t cell, std::size_t left_out) const {
    const auto& corners = filled_.cells[cell];
    return sorted({corners[(left_out + 1) % 4], corners[(left_out + 2) % 4], corners[(left_out + 3) % 4]});
  }
  const Vec3d& point(std::uint32_t p) const {
    const std::size_t known = domain_.points.size();
    return p < known ? domain_.points[p] : filled_.added[p - known];
  }
  /// The sides of cells on a face, one or two.
  std::span<Side> behind(const Face& face) {
    const auto is_before = [](const Side& side, const Face& corners) { return side.corners < corners; };
    const auto first = std::lower_bound(sides_.begin(), sides_.end(), face, is_before);
    auto last = first;
    while (last != sides_.end() && last->corners == face) ++last;
    return {first, last};
  }

  const FillDomain& domain_;
  FilledDomain& filled_;
  std::vector<Side> sides_;  // by their corners
};

}  // namespace

void keep_cells_inside(const FillDomain& domain, FilledDomain& filled) { CellsInside(domain, filled).keep(); }

}  // namespace vdb_offset
