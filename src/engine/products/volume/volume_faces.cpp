// SPDX-License-Identifier: Apache-2.0
// Matches the faces of a volume mesh: for each face of each cell the cell behind it comes out. Sides of cells are
// sorted by the lowest point of their face in parallel, and the sides at one point by their other corners; two with
// equal corners are one face between two cells. A face that three cells share, or one cell has twice, is refused, and
// so are patches that do not hold each face without a second cell exactly once. Threads may list the sides at a point
// in any order, but sorting settles it: the result does not depend on them. Faces are equal by their corners, whichever
// way these run; that neighbours run in opposite directions is not checked here.
#include "products/volume/volume_faces.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <memory>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "products/volume/cell_faces.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

template <class Face>
std::uint32_t lowest_corner(const Face& face, std::size_t size) {
  std::uint32_t lowest = face[0];
  for (std::size_t k = 1; k < size; ++k) lowest = std::min(lowest, face[k]);
  return lowest;
}

/// Calls visit(local, face) for all faces of a cell. The stream of a polyhedron is read once.
template <class Visit>
void for_each_face(const VolumeMesh& mesh, std::size_t c, Visit&& visit) {
  const auto corners = mesh.cell(c);
  if (mesh.cell_types[c] != CellType::Polyhedron) {
    const LocalFaces& faces = kCellFaces[static_cast<std::size_t>(mesh.cell_types[c])];
    for (std::uint32_t local = 0; local < faces.count; ++local)
      visit(local, CellFace{corners.data(), faces.faces[local].local_corners, faces.faces[local].size});
    return;
  }
  for (std::uint32_t local = 0, at = 1; local < corners[0]; ++local, at += corners[at] + 1)
    visit(local, CellFace{&corners[at + 1], nullptr, corners[at]});
}

/// The sides of all cells, sorted by the lowest corner of their faces: those of point p are at begin[p] ..
/// begin[p + 1] - 1, in an order that depends on the threads.
struct SidesByPoint {
  std::vector<std::uint64_t> begin;
  std::vector<VolumeFaces::Side> sides;
};

SidesByPoint by_lowest_corner(const VolumeMesh& mesh, std::size_t side_count) {
  SidesByPoint result;
  const std::unique_ptr<std::atomic<std::uint32_t>[]> left(new std::atomic<std::uint32_t>[mesh.points.size()]());
  for_each_index(mesh.cell_count(), [&](std::size_t c) {
    for_each_face(mesh, c, [&](std::uint32_t, const CellFace& face) {
      left[lowest_corner(face, face.size)].fetch_add(1, std::memory_order_relaxed);
    });
  });
  result.begin.resize(mesh.points.size() + 1);
  for (std::size_t p = 0; p < mesh.points.size(); ++p) result.begin[p + 1] = result.begin[p] + left[p];
  result.sides.resize(side_count);
  for_each_index(mesh.cell_count(), [&](std::size_t c) {
    for_each_face(mesh, c, [&](std::uint32_t local, const CellFace& face) {
      const std::uint32_t p = lowest_corner(face, face.size);
      const std::uint32_t slot = left[p].fetch_sub(1, std::memory_order_relaxed) - 1;
      result.sides[result.begin[p] + slot] = {static_cast<std::uint32_t>(c), local};
    });
  });
  return result;
}

/// A side, with a key of the face's corners. Of faces with three corners and the same lowest one, equal keys mean equal
/// faces.
struct KeyedSide {
  std::uint64_t key;
  VolumeFaces::Side side;
  bool operator<(const KeyedSide& other) const {
    if (key != other.key) return key < other.key;
    return side.cell != other.side.cell ? side.cell < other.side.cell : side.local < other.side.local;
  }
};

/// Buffers of a thread, reused from point to point.
struct MatchBuffers {
  std::vector<KeyedSide> sides;
  std::vector<std::uint32_t> first, second;
};

}  // namespace

std::size_t face_count(CellType type, std::span<const std::uint32_t> corners) {
  return type == CellType::Polyhedron ? corners[0] : kCellFaces[static_cast<std::size_t>(type)].count;
}

CellFace face(const VolumeMesh& mesh, std::size_t c, std::size_t local) {
  const auto corners = mesh.cell(c);
  VDB_OFFSET_ASSERT(local < face_count(mesh.cell_types[c], corners));
  if (mesh.cell_types[c] != CellType::Polyhedron) {
    const LocalFace& known = kCellFaces[static_cast<std::size_t>(mesh.cell_types[c])].faces[local];
    return {corners.data(), known.local_corners, known.size};
  }
  std::size_t at = 1;
  for (; local > 0; --local) at += corners[at] + 1;
  return {&corners[at + 1], nullptr, corners[at]};
}

VolumeFaces::VolumeFaces(const VolumeMesh& mesh) : begin_(mesh.cell_count() + 1) {
  for (std::size_t c = 0; c < mesh.cell_count(); ++c)
    begin_[c + 1] = begin_[c] + face_count(mesh.cell_types[c], mesh.cell(c));
  behind_.assign(begin_.back(), kNone);
  match(mesh);
  require_boundary(mesh);
}

void VolumeFaces::match(const VolumeMesh& mesh) {
  const SidesByPoint by_point = by_lowest_corner(mesh, side_count());
  tbb::enumerable_thread_specific<MatchBuffers> buffers;
  std::atomic<std::uint64_t> crowded = kNone;
  for_each_index(mesh.points.size(), [&](std::size_t p) {
    auto& [sides, first, second] = buffers.local();
    const auto corners_of = [&](const Side& side, std::vector<std::uint32_t>& corners) {
      const CellFace known = face(mesh, side.cell, side.local);
      sort_corners(known, known.size, corners);
    };
    sides.clear();
    for (std::uint64_t i = by_point.begin[p]; i < by_point.begin[p + 1]; ++i) {
      corners_of(by_point.sides[i], first);
      // The faces of plane cells have two corners.
      sides.push_back({std::uint64_t{first[1]} << 32 | first.back(), by_point.sides[i]});
    }
    std::sort(sides.begin(), sides.end());
    for (std::size_t i = 0; i < sides.size(); ++i) {
      corners_of(sides[i].side, first);
      std::uint32_t& behind = behind_[begin_[sides[i].side.cell] + sides[i].side.local];
      for (std::size_t j = i + 1; j < sides.size() && sides[j].key == sides[i].key; ++j) {
        corners_of(sides[j].side, second);
        if (first != second) continue;
        std::uint32_t& other = behind_[begin_[sides[j].side.cell] + sides[j].side.local];
        if (behind != kNone || other != kNone || sides[i].side.cell == sides[j].side.cell)
          lower_to(crowded, sides[i].side.cell);
        behind = sides[j].side.cell;
        other = sides[i].side.cell;
      }
    }
  });
  if (crowded != kNone)
    throw InvalidInput(
        fmt::format("volume mesh: cell {}: expected one other cell at a face, got itself or two", crowded.load()));
}

std::uint32_t VolumeFaces::local_of(const VolumeMesh& mesh, std::uint32_t c, std::uint32_t behind,
                                    std::span<const std::uint32_t> sorted_corners) const {
  VDB_OFFSET_ASSERT(std::is_sorted(sorted_corners.begin(), sorted_corners.end()));
  thread_local std::vector<std::uint32_t> corners;
  const auto cells = this->behind(c);
  for (std::uint32_t local = 0; local < cells.size(); ++local) {
    if (cells[local] != behind) continue;
    const CellFace known = face(mesh, c, local);
    sort_corners(known, known.size, corners);
    if (std::equal(corners.begin(), corners.end(), sorted_corners.begin(), sorted_corners.end())) return local;
  }
  return kNone;
}

void VolumeFaces::require_boundary(const VolumeMesh& mesh) const {
  const auto open = static_cast<std::uint64_t>(std::count(behind_.begin(), behind_.end(), kNone));
  std::vector<std::uint64_t> taken;
  std::vector<std::uint32_t> corners;
  for (const BoundaryPatch& patch : mesh.patches)
    for (std::size_t f = 0; f < patch.face_count(); ++f) {
      const std::uint32_t c = patch.cell[f];
      sort_corners(patch.face(f), patch.face(f).size(), corners);
      const std::uint32_t local = c < mesh.cell_count() ? local_of(mesh, c, kNone, corners) : kNone;
      if (local == kNone)
        throw InvalidInput(
            fmt::format("volume mesh: patch {}, face {}: expected a face of cell {} alone", patch.name, f, c));
      taken.push_back(begin_[c] + local);
    }
  std::sort(taken.begin(), taken.end());
  if (open != taken.size() || std::adjacent_find(taken.begin(), taken.end()) != taken.end())
    throw InvalidInput(
        fmt::format("volume mesh: expected each face of the boundary in one patch, got {} faces that one cell has and "
                    "{} in patches",
                    open, taken.size()));
}

void VolumeFaces::upper_faces(std::size_t c, std::vector<Side>& sides) const {
  sides.clear();
  const auto cells = behind(c);
  for (std::uint32_t local = 0; local < cells.size(); ++local)
    if (cells[local] != kNone && cells[local] > c) sides.push_back({cells[local], local});
  std::sort(sides.begin(), sides.end(),
            [](const Side& a, const Side& b) { return a.cell != b.cell ? a.cell < b.cell : a.local < b.local; });
}

}  // namespace vdb_offset
