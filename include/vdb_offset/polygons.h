// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// A polygon mesh as plain spans; nothing is copied and nothing need be manifold.
/// Face f has the corners `corners[face_begin[f]] .. corners[face_begin[f + 1] - 1]`, each an index into
/// `positions` (world units). `face_begin` has one entry more than there are faces and starts with 0.
struct VDB_OFFSET_API PolygonView {
  std::span<const Vec3d> positions;
  std::span<const std::uint32_t> corners;
  std::span<const std::uint32_t> face_begin;
  /// The triangles that stand for the faces, over the same vertices, face by face: n - 2 for one of n corners. Empty:
  /// those of split_polygons() at these positions. Positions that moved keep the triangles of the source.
  std::span<const std::array<std::uint32_t, 3>> triangles = {};

  /// The triangles of a face, if they are given.
  std::span<const std::array<std::uint32_t, 3>> triangles_of(std::size_t f) const {
    return triangles.subspan(face_begin[f] - 2 * f, face_begin[f + 1] - face_begin[f] - 2);
  }
  std::size_t face_count() const { return face_begin.empty() ? 0 : face_begin.size() - 1; }
  std::span<const std::uint32_t> face(std::size_t f) const {
    return corners.subspan(face_begin[f], face_begin[f + 1] - face_begin[f]);
  }
};

/// A polygon mesh that owns its arrays; the layout is that of PolygonView.
struct VDB_OFFSET_API Polygons {
  std::vector<Vec3d> positions;
  std::vector<std::uint32_t> corners;
  std::vector<std::uint32_t> face_begin{0};

  PolygonView view() const { return {positions, corners, face_begin}; }
  std::size_t face_count() const { return face_begin.size() - 1; }

  /// Ends the face whose corners were pushed since the last call.
  void close_face() { face_begin.push_back(static_cast<std::uint32_t>(corners.size())); }
  void add_face(std::initializer_list<std::uint32_t> face) {
    corners.insert(corners.end(), face);
    close_face();
  }
};

/// Splits the faces of a mesh into the triangles that are offset, judged, and written in formats of triangles, as
/// PolygonView::triangles has them: the fan around a face's first corner; ears of a flat face of five corners or more
/// that its fan does not cover once; and where a triangle would be a line, another split. \pre faces of three corners
/// or more
VDB_OFFSET_API std::vector<std::array<std::uint32_t, 3>> split_polygons(PolygonView mesh);

}  // namespace vdb_offset
