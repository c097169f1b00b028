// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/layer_plan.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/periodic.h"
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
  enum class Kind : std::uint8_t {
    Wall,
    Outer,     ///< The outermost layer, or the farfield.
    Side,      ///< Where layers end, and openings.
    Symmetry,  ///< A plane of symmetry.
    Empty,     ///< The two ends of a plane mesh that is one cell thick.
    Inlet,
    Outlet,
    Periodic,  ///< One of two, of which the mesh's motion takes the first to the second.
  };
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
  /// Of a mesh that is one period of a shape: it takes each face of the first patch of kind Periodic to that with the
  /// same number of the second one, whose corners run the other way round from the same first one.
  std::optional<PeriodicMotion> motion;

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

/// The names of a refinement's faces, as of an opened wall: those of the faces that they are pieces of, or lie beside.
VDB_OFFSET_API WallNames names_of_pieces(WallNames walls, const Refinement& refinement);

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

/// What became of a face of the mesh.
enum class FaceRole : std::uint8_t {
  Bare,        ///< It was not asked to carry layers.
  Full,        ///< It carries one cell in each layer, or two prisms on a split quad; none of its corners is flat.
  Transition,  ///< Some of its corners keep no height: it carries cells of other types, which close the layers there.
  Flat,        ///< None of its corners keeps any height: it is left out.
  Degenerate,  ///< It has fewer than three positions, or one of them twice: it is left out.
  Repeated,    ///< It lies over the corners of an earlier face, either way round: it is left out.
};

inline constexpr std::size_t kFaceRoleCount = 6;

/// The role's name in reports.
VDB_OFFSET_API const char* name(FaceRole role);

/// What making cells found.
struct LayerCellFacts {
  std::vector<FaceRole> role;       ///< Of each face of the input.
  std::vector<std::uint8_t> cells;  ///< Of each face of the input: the number of cells in each layer.
  /// The same in the first layer, where that differs from the others: over a wall with fans. Else empty.
  std::vector<std::uint8_t> first_cells;
  std::size_t turned_faces = 0;      ///< Faces whose cells lie on the side opposite to the sign of the heights.
  std::size_t border_sides = 0;      ///< Sides of a layer's cells on edges of one face that carries cells.
  std::size_t unpaired_sides = 0;    ///< Sides of a layer's cells on other edges, without a cell of opposite direction.
  std::size_t split_points = 0;      ///< Points of the wall that were added for unpaired sides.
  std::size_t coincident_sides = 0;  ///< Unpaired sides that have the points of other sides nevertheless.
};

/// Measures of the cells over layers.
struct LayerQuality {
  std::vector<CellType> types;  ///< Of the cells of the first layer.
  /// Of the cells of any other layer, where these differ: over a wall with fans. Else empty, and all are as the first.
  std::vector<CellType> upper_types;
  /// Of all cells, layer by layer (see cell_quality.h).
  std::vector<float> scaled_jacobian, aspect_ratio;
  /// Degrees, of the cells of the first layer: at the wall, in the column that the cell is in (see cell_quality.h). Not
  /// a number over opened edges, where a column has no face on the wall.
  std::vector<float> wall_angle;
  double volume = 0;  ///< Of all cells, world units^3; of cells in a plane their area, world units^2.
  std::size_t points = 0;
  bool plane = false;  ///< The layers are on curves.
  /// On curves: the shortest segment of any layer, as a share of the segment of the wall that it stands on.
  double least_segment = 1;
};

struct LayerCells;

/// Fills layers with cells. Over each face that carries layers stands one cell in each layer: a prism on a triangle, a
/// hexahedron on a quad, a polyhedron on more corners; on a quad in two triangles (LayersResult::carries), two prisms.
/// Vertices that are welded give one point in each layer. A flat vertex, which is at its position on the wall in all
/// layers, gives a single point, and the cells there are the cones from that point over the sides that do not hold it:
/// pyramids and tetrahedra; over a quad with two flat corners in a row, a prism on its side. All faces match those of
/// the neighbours and of the layers below and above; every face that a single cell has is in one patch. Where the cells
/// at an edge cannot be paired, two by two and of opposite directions (on edges of three faces, or where faces disagree
/// about the outside), the faces of unpaired cells are in the patch of sides; points there are split, so that no other
/// cell has these faces as well. Sides that are connected belong to one opening, which has a patch of its own; of more
/// than 64 openings the smallest share the last patch.
///
/// Points: those of the wall in the order of the mesh's vertices, split points behind them; then those of each layer,
/// in that order, without the flat ones. Cells: layer by layer from the wall, in the order of faces. Patches: one for
/// each of patch_names(), which may have no faces, "outer", and "sides" if the surface has an opening, or "sides_1",
/// "sides_2"
/// ... if it has several; over borders that a motion takes to each other "periodic_1" and "periodic_2". Point fields:
/// layer (0: wall), share, height (asked of the point, world units, signed), achieved, state (of VertexState). Cell
/// fields: layer (from 1), face (of the input; exact up to 2^24), patch, scaled_jacobian, aspect_ratio. The result does
/// not depend on the number of threads. Cost: O(cells).
///
/// \throw InvalidInput for faces that are no polygons, for layers that cannot be this mesh's, by their counts and
/// positions, for more than 2^32 points or cells, and as require_names()
VDB_OFFSET_API VolumeMesh make_cells(PolygonView mesh, const LayersResult& layers, const WallNames& names,
                                     LayerCellFacts* facts = nullptr);

/// The cells over layers, numbered and measured, but not made: enough for a report, in a third of the memory.
class VDB_OFFSET_API MeasuredCells {
 public:
  /// Keeps a reference to `layers`. The result does not depend on the number of threads. Cost: O(cells).
  /// \throw InvalidInput as make_cells()
  MeasuredCells(PolygonView mesh, const LayersResult& layers);
  MeasuredCells(MeasuredCells&&) noexcept;
  MeasuredCells& operator=(MeasuredCells&&) noexcept;
  ~MeasuredCells();

  const LayerCellFacts& facts() const;
  const LayerQuality& quality() const { return quality_; }

  /// Makes the cells, as make_cells() does; the measures go into the mesh. \throw InvalidInput as require_names()
  VolumeMesh make(const WallNames& names) &&;

 private:
  const LayersResult* layers_;
  std::unique_ptr<LayerCells> cells_;
  LayerQuality quality_;
};

/// Makes one structured block of the layers on a grid of quads: i and j over the grid, k from the wall outward. All
/// cells but inverted_cells() have positive volumes. Row and column 0 are at the corner of the grid with the lowest
/// vertex. A grid that is closed in a direction, as a tube is, is cut open, and its first points are repeated as the
/// last. Point fields: share, height and state, as make_cells() has them. \throw InvalidInput as require_layers_of(),
/// and unless the faces that carry layers are quads that make one such grid, with its vertices welded.
VDB_OFFSET_API StructuredBlock make_block(PolygonView mesh, const LayersResult& layers);

/// Counts a block's hexahedra whose scaled Jacobian (cell_quality.h) is not above 0: cells of no height where layers
/// end, which a block cannot leave out, and cells on quads that would otherwise carry two prisms. \pre nk > 1
VDB_OFFSET_API std::size_t inverted_cells(const StructuredBlock& block);

/// Figures of the layers on a part of the wall, or on all of it. On curves, faces are segments and areas lengths.
struct LayerFigures {
  std::string name;  ///< Of the patch.
  std::array<std::size_t, kFaceRoleCount> faces_by_role{};
  std::array<std::size_t, kCellTypeCount> cells_by_type{};
  std::size_t cells = 0, transition_cells = 0;
  std::size_t fan_cells = 0;      ///< In fans over opened edges, whose faces count for nothing but cells.
  double area = 0;                ///< Of the faces that were asked to carry layers, world units^2.
  double layers_reached = 0;      ///< Number of layers times the share of heights kept, mean over that area.
  double coverage = 0;            ///< Share of that area whose faces have all of their heights at all of their corners.
  Spread asked, reached;          ///< Thickness of all layers, means over faces' corners, by area; world units.
  std::size_t full_vertices = 0;  ///< Vertices that keep all of their heights. Copies of a position count separately.
  /// Relative errors of the first heights of those vertices: the largest, and the 99 % quantile.
  double first_error = 0, first_error_99 = 0;
  Spread scaled_jacobian, aspect_ratio;  ///< Of cells (see cell_quality.h).
  std::size_t inverted_cells = 0;        ///< Cells whose scaled Jacobian is not above 0.
  /// Cells whose scaled Jacobian is below kPoorJacobian, and faces of the wall with an angle whose sine is: needles, on
  /// which no cell can be better.
  std::size_t poor_cells = 0, needles = 0;
  static constexpr double kPoorJacobian = 0.01;  ///< Solvers warn of cells below about this, or do not converge.
  Spread wall_angle;                             ///< Degrees, of the cells at the wall: 0 is best.
};

/// What filling the rest of the domain found and made: see fill_volume().
struct FillReport {
  std::size_t tetrahedra = 0, pyramids = 0, split_cells = 0;
  std::size_t triangles = 0;  ///< In place of tetrahedra, of layers on curves.
  std::size_t added_points = 0;
  std::size_t front = 0;   ///< Triangles that the tetrahedra had to keep.
  double volume = 0;       ///< Of tetrahedra and pyramids, world units^3.
  Spread scaled_jacobian;  ///< Of both (see cell_quality.h).
  Spread jump;             ///< Volumes of tetrahedra at the layers by those of the cells behind, 1 or more either way.
  double seconds = 0;      ///< That the filler took.
  /// Planes that openings end at along one straight line, which lies in many planes: these are at right angles to the
  /// faces beside it, and across no axis.
  std::vector<SymmetryPlane> guessed_planes;
};

/// A patch of a mesh's boundary, and the plane that all of it lies in, if it does, with its normal out of the mesh.
struct PatchFacts {
  std::string name;
  BoundaryPatch::Kind kind = BoundaryPatch::Kind::Wall;
  std::size_t faces = 0;
  std::optional<SymmetryPlane> plane;
};

/// The patches of a mesh that have faces. Walls and the farfield are in no plane.
VDB_OFFSET_API std::vector<PatchFacts> patch_facts(const VolumeMesh& mesh);
/// A kind's name in reports.
VDB_OFFSET_API const char* name(BoundaryPatch::Kind kind);

struct LayerReport {
  std::size_t layers = 0;
  LayerFigures all;
  std::vector<LayerFigures> patches;  ///< In the order of the walls in VolumeMesh::patches.
  bool plane = false;                 ///< Layers on curves.
  double least_segment = 1;           ///< See LayerQuality.
  double volume = 0;                  ///< Of all cells, world units^3; on curves their area, ^2.
  std::size_t points = 0;
  LayerGrowth growth;  ///< As asked for.
  LayerStatistics growing;
  std::optional<FillReport> fill;  ///< If the rest of the domain was filled.
  std::optional<PeriodicFacts> periodic;
  std::vector<PatchFacts> boundary;      ///< Of a mesh of cells that is written.
  std::optional<FoamQuality> foam;       ///< If a mesh has been written for OpenFOAM.
  std::size_t inverted_block_cells = 0;  ///< Cells of a structured block that was written, with a Jacobian not above 0.
  std::size_t turned_faces = 0, border_sides = 0, unpaired_sides = 0, split_points = 0, coincident_sides = 0;
};

/// Sums up layers and the cells over them, for each boundary patch and for all.
/// \param names of the faces
/// \throw InvalidInput as require_names()
VDB_OFFSET_API LayerReport report_layers(PolygonView mesh, const LayersResult& layers, const WallNames& names,
                                         const LayerCellFacts& facts, const LayerQuality& quality);

/// A few lines of text for a terminal, each with a line end.
VDB_OFFSET_API std::string summary(const LayerReport& report);

}  // namespace vdb_offset
