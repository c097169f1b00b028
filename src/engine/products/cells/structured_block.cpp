// SPDX-License-Identifier: Apache-2.0
// Makes one structured block of the layers on a grid of quads. Quads are connected by welded vertices. The walk begins
// at a corner of the grid, at its border if it has no corner, else anywhere, and there at the lowest vertex; it goes
// from quad to quad over opposite sides, row by row. Each quad has to be met once, and each place of the grid has to
// have one vertex: a grid that is not regular is refused, with the quad. A grid that is closed in a direction repeats
// its first points as the last. If layers go inward, i and j change places, so that volumes are positive. Positions are
// those of the stacks. inverted_cells() counts hexahedra that are not valid, and mends none.
#include "vdb_offset/cells.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <string>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "products/cells/number_cells.h"
#include "products/volume/cell_quality.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// A quad seen from one of its corners, which is at the low end of i and j. The next corner is along i from there, the
/// last along j.
struct View {
  std::uint32_t face, corner;
  bool operator==(const View&) const = default;
};

/// A grid of quads, connected by the positions of its vertices.
class QuadGrid {
 public:
  QuadGrid(PolygonView mesh, const LayersResult& layers) {
    require_layers_of(mesh, layers);
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      if (!layers.carries.empty() && layers.carries[f] == 0) continue;
      const auto face = mesh.face(f);
      if (face.size() != 4)
        throw InvalidInput("structured block: expected quads, got face " + std::to_string(f) + " (counted from 0) of " +
                           std::to_string(face.size()) + " corners");
      for (const auto v : face) corners_.push_back(layers.welded_to[v]);
    }
    if (corners_.empty()) throw InvalidInput("structured block: expected quads, got none");
    begin_.assign(mesh.positions.size() + 2, 0);
    for (const auto v : corners_) ++begin_[v + 2];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    around_.resize(corners_.size());
    for (std::uint32_t c = 0; c < corners_.size(); ++c) around_[begin_[corners_[c] + 1]++] = c;
  }

  /// The vertices row by row; each row has `width()` of them.
  std::vector<std::uint32_t> rows() {
    View first = start();
    const std::uint32_t faces_in_row = count(first, &QuadGrid::next_in_row);
    const std::uint32_t faces_in_column = count(first, &QuadGrid::next_in_column);
    if (std::size_t{faces_in_row} * faces_in_column != corners_.size() / 4)
      throw InvalidInput("structured block: expected a grid of quads, got " + std::to_string(corners_.size() / 4) +
                         " quads of which the first row has " + std::to_string(faces_in_row) +
                         " and the first column " + std::to_string(faces_in_column));
    width_ = faces_in_row + 1;
    std::vector<std::uint32_t> vertices(std::size_t{width_} * (faces_in_column + 1), kNone);
    std::vector<std::uint8_t> seen(corners_.size() / 4, 0);
    for (std::uint32_t j = 0; j < faces_in_column; ++j) {
      View quad = first;
      for (std::uint32_t i = 0; i < faces_in_row; ++i) {
        if (std::exchange(seen[quad.face], 1)) irregular(quad);
        set(vertices[j * width_ + i], at(quad, 0), quad);
        set(vertices[j * width_ + i + 1], at(quad, 1), quad);
        set(vertices[(j + 1) * width_ + i + 1], at(quad, 2), quad);
        set(vertices[(j + 1) * width_ + i], at(quad, 3), quad);
        if (i + 1 < faces_in_row && !next_in_row(quad)) irregular(quad);
      }
      if (j + 1 < faces_in_column && !next_in_column(first)) irregular(first);
    }
    return vertices;
  }

  std::uint32_t width() const { return width_; }

 private:
  std::uint32_t at(const View& quad, std::uint32_t k) const { return corners_[4 * quad.face + (quad.corner + k) % 4]; }

  [[noreturn]] static void irregular(const View& quad) {
    throw InvalidInput("structured block: expected rows of as many quads, got an irregular grid at quad " +
                       std::to_string(quad.face) + " (counted from 0)");
  }
  static void set(std::uint32_t& entry, std::uint32_t vertex, const View& quad) {
    if (entry != kNone && entry != vertex) irregular(quad);
    entry = vertex;
  }

  std::size_t faces_around(std::uint32_t v) const { return begin_[v + 1] - begin_[v]; }

  /// The corner at a of the quad that has a side from a to b; kNone if there is none.
  std::uint32_t side(std::uint32_t a, std::uint32_t b) const {
    for (std::uint32_t i = begin_[a]; i < begin_[a + 1]; ++i) {
      const std::uint32_t c = around_[i];
      if (corners_[c / 4 * 4 + (c + 1) % 4] == b) return c;
    }
    return kNone;
  }

  bool next_in_row(View& quad) const {
    const std::uint32_t c = side(at(quad, 2), at(quad, 1));  // from the last corner of the next quad to its first
    if (c == kNone) return false;
    quad = {c / 4, (c + 1) % 4};
    return true;
  }
  bool next_in_column(View& quad) const {
    const std::uint32_t c = side(at(quad, 3), at(quad, 2));  // from the first corner of the next quad to its second
    if (c == kNone) return false;
    quad = {c / 4, c % 4};
    return true;
  }

  /// Where to start: at a corner of the grid; if it has none, at its border; else anywhere.
  View start() const {
    std::uint32_t best = kNone;
    int rank = 3;
    for (std::uint32_t c = 0; c < corners_.size(); ++c) {
      const View quad{c / 4, c % 4};
      const bool border = side(at(quad, 1), at(quad, 0)) == kNone, last = side(at(quad, 0), at(quad, 3)) == kNone;
      const int here = border && last && faces_around(corners_[c]) == 1 ? 0 : border ? 1 : 2;
      if (here < rank || (here == rank && corners_[c] < corners_[best])) best = c;
      rank = std::min(rank, here);
    }
    return {best / 4, best % 4};
  }

  std::uint32_t count(const View& first, bool (QuadGrid::*next)(View&) const) const {
    std::uint32_t number = 1;
    for (View quad = first; (this->*next)(quad) && quad != first; ++number)
      if (number > corners_.size() / 4) irregular(quad);
    return number;
  }

  std::vector<std::uint32_t> corners_;
  std::vector<std::uint32_t> around_, begin_;  // corners at each vertex
  std::uint32_t width_ = 0;
};

}  // namespace

StructuredBlock make_block(PolygonView mesh, const LayersResult& layers) {
  QuadGrid grid(mesh, layers);
  const std::vector<std::uint32_t> rows = grid.rows();
  const bool inward = layers.heights.back().farthest() < 0;
  const auto width = grid.width(), height = static_cast<std::uint32_t>(rows.size() / width);
  StructuredBlock block;
  // i and j are swapped if layers go to the back of the grid, so that cells have positive volumes.
  block.ni = inward ? height : width;
  block.nj = inward ? width : height;
  block.nk = static_cast<std::uint32_t>(layers.count() + 1);
  const std::size_t in_layer = rows.size();
  block.points.resize(in_layer * block.nk);
  block.point_fields = {{"share", std::vector<float>(block.points.size())},
                        {"height", std::vector<float>(block.points.size())},
                        {"state", std::vector<float>(block.points.size())}};
  for_each_index(block.points.size(), [&](std::size_t p) {
    const std::size_t k = p / in_layer, i = p % in_layer % block.ni, j = p % in_layer / block.ni;
    const std::uint32_t v = inward ? rows[i * width + j] : rows[j * width + i];
    block.points[p] = layers.stacks.of(v)[k];
    block.point_fields[0].values[p] = static_cast<float>(layers.share[v]);
    block.point_fields[1].values[p] = static_cast<float>(k == 0 ? 0 : layers.heights[k - 1][v]);
    block.point_fields[2].values[p] = static_cast<float>(layers.states[v]);
  });
  return block;
}

std::size_t inverted_cells(const StructuredBlock& block) {
  VDB_OFFSET_ASSERT(block.ni > 1 && block.nj > 1 && block.nk > 1);
  VDB_OFFSET_ASSERT(block.points.size() == std::size_t{block.ni} * block.nj * block.nk);
  const std::size_t row = block.ni, sheet = row * block.nj;
  const auto cells_in_row = static_cast<std::size_t>(block.ni - 1), cells_in_sheet = cells_in_row * (block.nj - 1);
  std::atomic<std::size_t> count = 0;
  for_each_index(cells_in_sheet * (block.nk - 1), [&](std::size_t c) {
    thread_local VolumeMesh cell;
    const std::size_t k = c / cells_in_sheet, j = c % cells_in_sheet / cells_in_row, i = c % cells_in_row;
    const std::size_t at = k * sheet + j * row + i;
    cell.cell_types = {CellType::Hexahedron};
    cell.corners = {0, 1, 2, 3, 4, 5, 6, 7};
    cell.cell_begin = {0, 8};
    cell.points.clear();
    for (const std::size_t level : {at, at + sheet})
      for (const std::size_t corner : {level, level + 1, level + row + 1, level + row})
        cell.points.push_back(block.points[corner]);
    if (!(scaled_jacobian(cell, 0) > 0)) ++count;
  });
  return count;
}

}  // namespace vdb_offset
