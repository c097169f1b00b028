// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/cells.h"

namespace vdb_offset {

/// A face of a cell, ccw seen from outside.
struct CellFace {
  const std::uint32_t* corners;  ///< The corners of the cell, or of a polyhedron's face.
  const std::uint8_t*
      local_corners;  ///< The numbers of the face's corners among the cell's; null if `corners` are the face's.
  std::size_t size;

  std::uint32_t operator[](std::size_t k) const { return local_corners ? corners[local_corners[k]] : corners[k]; }
};

/// Number of faces of a cell.
std::size_t face_count(CellType type, std::span<const std::uint32_t> corners);

/// Sorts the corners of a face: two faces are the same if their sorted corners are.
template <class Face>
void sort_corners(const Face& face, std::size_t size, std::vector<std::uint32_t>& corners) {
  corners.clear();
  for (std::size_t k = 0; k < size; ++k) corners.push_back(face[k]);
  std::sort(corners.begin(), corners.end());
}

/// Face `local` of cell c, counted from 0. Cost: O(1), for polyhedra O(local).
CellFace face(const VolumeMesh& mesh, std::size_t c, std::size_t local);

/// Tells for each face of each cell which cell lies behind it.
class VolumeFaces {
 public:
  /// Stands for a cell behind a face on the boundary, where there is none.
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// A face of a cell and the cell behind it.
  struct Side {
    std::uint32_t cell, local;
  };

  /// Matches faces by their corners, in parallel; the result does not depend on the number of threads. Memory: 13 bytes
  /// for each side of a face, of which 4 stay. \throw InvalidInput for a face that more than two cells have, and
  /// unless the faces of the patches are those that one cell has, each once.
  explicit VolumeFaces(const VolumeMesh& mesh);

  /// The cell behind each face of cell c, kNone on the boundary.
  std::span<const std::uint32_t> behind(std::size_t c) const {
    return std::span(behind_).subspan(begin_[c], begin_[c + 1] - begin_[c]);
  }
  /// The faces of cell c with cells of higher numbers behind them, in the order of these numbers.
  void upper_faces(std::size_t c, std::vector<Side>& sides) const;

  /// The face of cell c with these sorted corners and this cell, or kNone, behind it; kNone if there is none.
  std::uint32_t local_of(const VolumeMesh& mesh, std::uint32_t c, std::uint32_t behind,
                         std::span<const std::uint32_t> sorted_corners) const;

  std::size_t side_count() const { return behind_.size(); }
  /// The number of cell c's face 0 among all sides.
  std::uint64_t first_side(std::size_t c) const { return begin_[c]; }

 private:
  void match(const VolumeMesh& mesh);
  void require_boundary(const VolumeMesh& mesh) const;

  std::vector<std::uint64_t> begin_;
  std::vector<std::uint32_t> behind_;
};

}  // namespace vdb_offset
