// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/layers.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

/// What is to be filled with tetrahedra: the inside of a closed surface of triangles, which may have several shells.
struct FillDomain {
  std::vector<Vec3d> points;                            ///< World units, relative to a point in the middle.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< Ccw seen from outside of the domain.
  std::vector<Vec3d> outside;                           ///< Points beyond some of its shells, as in holes of it.
  double growth = 1.3;                                  ///< How many times as long as its neighbours an edge may be.
  double longest = 0;                                   ///< No edge is to be longer; world units.
};

/// What a filler made.
struct FilledDomain {
  std::vector<Vec3d> added;                         ///< Points that it added, numbered behind those of the domain.
  std::vector<std::array<std::uint32_t, 4>> cells;  ///< The normal of the first three points to the fourth.
};

/// A program that makes tetrahedra.
enum class FillWith : std::uint32_t {
  /// Netgen (Schoeberl, NETGEN: An advancing front 2D/3D-mesh generator based on abstract rules, 1997), by its library.
  Netgen = 1,
  /// TetGen (Si, TetGen, a Delaunay-based quality tetrahedral mesh generator, 2015), the program tetgen, if it is
  /// installed: 10 to 30 times as fast as Netgen, with worse cells. Of sizes it uses the longest edge alone.
  TetGen = 2,
  /// gmsh (Geuzaine, Remacle, Gmsh: a three-dimensional finite element mesh generator with built-in pre- and
  /// post-processing facilities, 2009), the program gmsh, if it is installed: its Delaunay mesher, 2 to 5 times as
  /// fast as Netgen.
  Gmsh = 3,
};

/// Fills a domain, of which it keeps all points and all triangles. Its result is checked by who calls it.
/// \throw FillFailed with what it found, and as it likes
using Filler = std::function<FilledDomain(const FillDomain&)>;

/// A domain that cannot be filled, or a filler's result that is none.
struct VDB_OFFSET_API FillFailed : Error {
  using Error::Error;
};

/// The surface far away from bodies that the mesh around them ends at.
struct Farfield {
  enum class Shape : std::uint8_t { Sphere, Box, Given };
  Shape shape = Shape::Sphere;
  /// The radius of the sphere around the middle of the wall's box; or how far the box goes beyond the wall's on each
  /// side. World units, or in `lengths` of the wall: the longest side of its box.
  double size = 20;
  bool in_lengths = true;
  Polygons surface;  ///< With Shape::Given: closed, faces ccw seen from outside.
};

/// What becomes of faces of the layers with more than three corners that tetrahedra lie on.
enum class FillQuads : std::uint8_t {
  Split,     ///< They are parted into triangles, and the cells behind them are polyhedra.
  Pyramids,  ///< A pyramid stands on each.
};

struct FillOptions {
  /// Used only where the domain is around bodies, and not inside of a surface.
  Farfield farfield;
  double growth = 1.3;            ///< > 1: how many times as long as its neighbours an edge may be.
  std::optional<double> longest;  ///< World units, > 0: no edge is to be longer. None: as long as the domain is.
  FillQuads quads = FillQuads::Split;
  bool caps = true;  ///< Whether openings of the surface are covered; else they are refused.
  /// Called before the filler of a volume is, with the layers' cells and all patches that the mesh is to have, to which
  /// faces are added later. What it throws ends filling.
  std::function<void(const VolumeMesh&)> before;
  ProgressCallback progress;
};

/// Fills the rest of the domain that layers begin with tetrahedra: the inside of a closed surface with layers inside of
/// it; or the outside of bodies, out to the farfield. Faces of the wall without layers are kept as they are. Flat
/// openings of the surface are covered with triangles: inside, as in a pipe, by caps, which join the patches of sides
/// around them; outside, as around half a body on a plane, out to the farfield, by planes of symmetry. The mesh has the
/// points and cells of the layers in their order, then pyramids, then tetrahedra. The patch "outer" is gone; "farfield"
/// has the triangles of the farfield, if there is one, and "symmetry" those of a plane of symmetry, with the layers'
/// sides there.
///
/// It is proven that each face of the domain is a face of the mesh once, that each inner face belongs to two cells,
/// that all new cells have volumes above 0, by exact predicates, and that these sum up to the domain's volume, to 1e-9.
/// \param mesh the wall that the layers were grown on, with `layers`, the facts about their `cells`, and these
/// themselves, as make_cells() gives them
/// \param names of the wall's faces, as for make_cells()
/// \throw InvalidInput for openings that are not flat, and for those of bodies that are not in one plane or two
/// parallel ones; FillFailed where it crosses itself, and where the filler fails
VDB_OFFSET_API VolumeMesh fill_volume(PolygonView mesh, const LayersResult& layers, const LayerCellFacts& facts,
                                      const WallNames& names, VolumeMesh cells, const FillOptions& options,
                                      const Filler& filler, FillReport* report = nullptr);

/// fill_volume() of layers on curves: with triangles in their plane, made here. The farfield is a circle or a square.
/// \throw InvalidInput for curves that are not closed
VDB_OFFSET_API VolumeMesh fill_plane(CurveCells cells, const LayersResult& layers, const FillOptions& options,
                                     FillReport* report = nullptr);

/// A plane mesh as a solid one, one cell thick along its normal: triangles become prisms, quadrilaterals hexahedra. Its
/// two ends are the patch "front_and_back", of kind Empty. \throw InvalidInput for a mesh that is not plane
VDB_OFFSET_API VolumeMesh extruded(const VolumeMesh& plane, double thickness);

}  // namespace vdb_offset
