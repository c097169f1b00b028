#pragma once

#include <cstdint>
#include <vector>

#include "vdb_offset/layers.h"
#include "vdb_offset/volume_mesh.h"
#include "vdb_offset/wall_names.h"

namespace vdb_offset {

/// What became of a face of the mesh.
enum class FaceRole : std::uint8_t {
  Bare,        ///< Asked to carry nothing.
  Full,        ///< One cell in each layer, or two prisms on a split quad; none of its corners is flat.
  Transition,  ///< Some of its corners keep no height: its cells are those of other types that close the layers there.
  Flat,        ///< None of its corners keeps any height: left out.
  Degenerate,  ///< Left out: fewer than three places, or one that it comes by twice.
  Repeated,    ///< Left out: over the corners of an earlier one, either way round.
};
inline constexpr std::size_t kFaceRoleCount = 6;
const char* name(FaceRole role);

/// What making cells found.
struct LayerCellFacts {
  std::vector<FaceRole> role;        ///< Of each face of the input.
  std::vector<std::uint8_t> cells;   ///< Of each face of the input: how many in each layer.
  std::size_t turned_faces = 0;      ///< Whose cells lie on the side that the heights' sign does not say.
  std::size_t border_sides = 0;      ///< In each layer, on edges of one face that carries cells.
  std::size_t unpaired_sides = 0;    ///< On other edges: no cell of opposite direction is left for them.
  std::size_t split_points = 0;      ///< Of the wall: added so that unpaired sides have points of their own.
  std::size_t coincident_sides = 0;  ///< Unpaired ones that have the points of other sides nevertheless.
};

/// Fills layers with cells. Over each face that carries layers stands one in each: a prism on a triangle, a hexahedron
/// on a quad, a polyhedron on more corners; on a quad in two triangles (LayersResult::carries), two prisms. Vertices
/// that are welded give one point in each layer; one whose positions are those of the wall in all layers (a flat one)
/// gives a single point, and the cells there are the cones, from that point, over the sides that do not hold it:
/// pyramids and tetrahedra; over a quad with two flat corners in a row, a prism on its side. All faces match those of
/// the neighbours and of the layers below and above; every one that a single cell has is in one patch. Where the cells
/// of an edge cannot be paired, two by two and of opposite directions (on edges of three faces, or where faces disagree
/// about the outside), what is left over has its face in the patch of sides; points there are split, so that these
/// faces are not those of other cells as well.
///
/// Points: those of the wall in the order of the mesh's vertices, split ones behind them; then the same for each layer
/// without the flat ones. Cells: layer by layer from the wall, in the order of faces. Patches: one for each of
/// patch_names(), which may have no faces, "outer", and "sides" if there are any.
/// Point fields: layer (0: wall), share, height (asked of the point, world units, signed), state (of VertexState).
/// Cell fields: layer (from 1), face (of the input; exact up to 2^24), patch, scaled_jacobian, aspect_ratio.
/// The result does not depend on the number of threads. Cost: O(cells).
/// \throw InvalidInput as weld_by_position(), for layers or names that are not this mesh's, and for more than 2^32
/// points or cells.
VolumeMesh make_cells(PolygonView mesh, const LayersResult& layers, const WeldOptions& weld, const WallNames& names,
                      LayerCellFacts* facts = nullptr);

}  // namespace vdb_offset
