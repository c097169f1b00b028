// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Types of cells, and the order of their corners, as in Gmsh, CGNS and SU2; VTK has prisms the other way round.
enum class CellType : std::uint8_t {
  Tetrahedron,  ///< 0 1 2, whose normal by the right hand points to 3.
  Pyramid,      ///< 0 1 2 3 around the base, whose normal points to 4.
  Prism,        ///< 0 1 2, whose normal points to 3 4 5 above them.
  Hexahedron,   ///< 0 1 2 3, whose normal points to 4 5 6 7 above them.
  Polyhedron,   ///< A stream: number of faces, then for each its number of corners and these, seen from outside ccw.
  Triangle,     ///< Of a plane mesh, as are quadrilaterals: ccw seen from where its normal points to.
  Quadrilateral,
};
inline constexpr std::size_t kCellTypeCount = 7;
/// The type's name in reports, in the plural.
VDB_OFFSET_API const char* name(CellType type);

/// A field of numbers, one for each point, or for each cell.
struct VolumeField {
  std::string name;
  std::vector<float> values;
};

/// A named part of the boundary of a volume mesh.
struct VDB_OFFSET_API BoundaryPatch {
  enum class Kind : std::uint8_t { Wall, Outer, Side };
  std::string name;  ///< No two patches have one name.
  Kind kind = Kind::Wall;
  /// Points of the faces, which run ccw seen from outside the volume. Faces of a plane mesh have two points each, in
  /// the order of the cell's corners.
  std::vector<std::uint32_t> corners;
  std::vector<std::uint32_t> face_begin{0};  ///< One more than faces.
  std::vector<std::uint32_t> cell;           ///< The cell behind each face.

  std::size_t face_count() const { return face_begin.size() - 1; }
  std::span<const std::uint32_t> face(std::size_t f) const {
    return std::span(corners).subspan(face_begin[f], face_begin[f + 1] - face_begin[f]);
  }
};

/// Cells of mixed types that share their points and faces, and the boundary, each face of which is in one patch. A
/// plane mesh has only triangles and quadrilaterals; its faces are edges, and its volume is an area.
struct VDB_OFFSET_API VolumeMesh {
  std::vector<Vec3d> points;  ///< World units.
  std::vector<CellType> cell_types;
  std::vector<std::uint32_t> corners;        ///< Of all cells, one after the other.
  std::vector<std::uint64_t> cell_begin{0};  ///< Into `corners`; one more than cells.
  std::vector<BoundaryPatch> patches;
  std::vector<VolumeField> point_fields, cell_fields;
  Vec3d normal{0.0};  ///< Of a plane mesh, unit length; zero of others.

  bool plane() const;
  std::size_t cell_count() const { return cell_types.size(); }
  std::span<const std::uint32_t> cell(std::size_t c) const {
    return std::span(corners).subspan(cell_begin[c], cell_begin[c + 1] - cell_begin[c]);
  }
};

/// A block of hexahedra: points in a grid, i fastest, k from the wall to the outer surface. If nk is 1, a block of
/// quadrilaterals in a plane: j from the wall to the outer curve.
struct StructuredBlock {
  std::uint32_t ni = 0, nj = 0, nk = 0;  ///< Points in each direction.
  std::vector<Vec3d> points;             ///< ni nj nk of them, world units.
  std::vector<VolumeField> point_fields;
};

/// The names of the parts of a mesh: one for each face.
struct WallNames {
  std::vector<std::string> names;
  std::vector<std::uint32_t> of_face;  ///< Index into `names`, of each face of the input. Empty: all are "wall".
};

/// \throw InvalidInput unless each of so many faces has one of the names, or no face has any
VDB_OFFSET_API void require_names(const WallNames& walls, std::size_t faces);

/// The names of the boundary patches of a volume mesh, in the order of `names`; {"wall"} if there are none. They hold
/// only ASCII letters, digits and _ - . and start with a letter, as OpenFOAM's words and SU2's tags ask for: other
/// characters become _, and a name that starts otherwise gets wall_ in front. Where two names would be equal, or one
/// would be "outer" or "sides", the later gets _2, _3 ... behind it.
VDB_OFFSET_API std::vector<std::string> patch_names(const WallNames& walls);

/// The quality of a volume mesh in OpenFOAM's terms.
struct FoamQuality {
  static constexpr double kMostDegrees = 70, kMostSkewness = 4;  ///< checkMesh warns above these.

  std::size_t wrong_faces = 0;  ///< Faces whose pyramid from the centre of a cell has a volume not above 0.
  double non_orthogonality =
      0;  ///< Largest angle between a face's normal and the line between cells' centres, degrees.
  double mean_non_orthogonality = 0;  ///< The angle of the mean cosine over the faces between two cells, degrees.
  double skewness = 0;  ///< Largest distance of a face's centre from that line, as a share of the face's size there.
  std::size_t non_orthogonal_faces = 0, skew_faces = 0;  ///< Faces beyond the limits.
};

}  // namespace vdb_offset
