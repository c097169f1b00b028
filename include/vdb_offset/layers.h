// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/options.h"
#include "vdb_offset/periodic.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// The positions of vertices in each layer, from the wall outward: one stack for each vertex.
class VDB_OFFSET_API VertexStacks {
 public:
  VertexStacks() = default;
  /// Positions are not set: memory is first touched by the threads that set them, in parallel.
  VertexStacks(std::size_t vertices, std::size_t layers)
      : vertices_(vertices),
        layers_(layers),
        positions_(std::make_unique_for_overwrite<Vec3d[]>(vertices * (layers + 1))) {}

  VertexStacks(const VertexStacks& other) : VertexStacks(other.vertices_, other.layers_) {
    std::copy_n(other.positions_.get(), vertices_ * (layers_ + 1), positions_.get());
  }
  VertexStacks(VertexStacks&&) = default;
  VertexStacks& operator=(const VertexStacks& other) { return *this = VertexStacks(other); }
  VertexStacks& operator=(VertexStacks&&) = default;
  ~VertexStacks() = default;

  std::size_t vertices() const { return vertices_; }
  std::size_t layers() const { return layers_; }
  /// The stack of a vertex, world coordinates: layers() + 1 positions, the first of them on the wall.
  std::span<Vec3d> of(std::size_t vertex) { return {positions_.get() + vertex * (layers_ + 1), layers_ + 1}; }
  std::span<const Vec3d> of(std::size_t vertex) const {
    return {positions_.get() + vertex * (layers_ + 1), layers_ + 1};
  }
  /// Whether all layers of a vertex are at one position.
  bool is_flat(std::size_t vertex) const { return of(vertex).front() == of(vertex).back(); }

 private:
  std::size_t vertices_ = 0, layers_ = 0;
  std::unique_ptr<Vec3d[]> positions_;
};

/// The stacks of a mesh's vertices, of which several may share one.
class VDB_OFFSET_API SharedStacks {
 public:
  SharedStacks() = default;
  /// \param stack of each vertex: the index of its stack
  SharedStacks(VertexStacks stacks, std::vector<std::uint32_t> stack)
      : stacks_(std::move(stacks)), stack_(std::move(stack)) {}

  std::size_t vertices() const { return stack_.size(); }
  std::size_t layers() const { return stacks_.layers(); }
  std::span<const Vec3d> of(std::size_t vertex) const { return stacks_.of(stack_[vertex]); }
  bool is_flat(std::size_t vertex) const { return stacks_.is_flat(stack_[vertex]); }

  /// Puts the wall's end of all stacks, and flat ones as a whole, where the vertices are.
  void put_on_wall(std::span<const Vec3d> positions);

  /// The positions of all vertices in one layer, 0 for the wall.
  std::vector<Vec3d> surface(std::size_t layer) const;

 private:
  VertexStacks stacks_;
  std::vector<std::uint32_t> stack_;
};

/// What cells have to fulfil to be valid.
enum class CellRules : std::uint8_t {
  AnySolver,  ///< Positive volumes and Jacobians (see GrowthColumns).
  OpenFoam,   ///< In addition, OpenFOAM's checkMesh must find no face of a cell oriented wrongly (cells.h).
};

/// What growing layers found and did.
struct LayerStatistics {
  std::size_t wrong_columns = 0;     ///< Columns that had an invalid cell before anything was thinned.
  std::size_t straightened = 0;      ///< Vertices whose layers stand on a straight line, to make such cells valid.
  std::size_t rounds = 0;            ///< Rounds in which layers were thinned or let out again.
  std::size_t thinned_vertices = 0;  ///< Vertices of the surface that keep less than all of their heights.
  std::size_t flat_vertices = 0;     ///< Vertices of the surface that keep no height, although they were asked to.
  /// Vertices of the outermost surface that keep all of their heights, and have edges shorter than a fifth of the
  /// wall's, and than half of what is left of these along the vertices' normals: at concave edges where there was no
  /// room to spread them.
  std::size_t crowded_vertices = 0;
  double least_edge = 1;  ///< The shortest of these edges, as a share of the wall's; 1 if there is none.
  FaceError first_faces;  ///< Of the surface at the first height; OffsetStatistics::faces are the outermost one's.
};

/// What growing knows of the mesh's faces. What it does not know is looked for when cells are numbered.
struct KnownSides {
  /// Each side of a column of cells has one partner, and no column repeats another.
  bool paired = false;
  /// Layers rise from all faces on the side that the heights' sign says.
  bool none_turned = false;
};

/// Layers on a mesh: one surface for each height, of the mesh's vertices and faces.
struct VDB_OFFSET_API LayersResult {
  SharedStacks stacks;  ///< Of the input's vertices: on the wall, which is the mesh itself, and at each height.
  /// Of each input vertex: the first vertex that it moves with; kNone if it is in no face. Empty on curves.
  std::vector<std::uint32_t> welded_to;
  /// Over a wall whose sharp edges are opened (see grow_fanned_layers()), of each vertex: the first one on its point of
  /// the wall. Empty: over each point there is one stack.
  std::vector<std::uint32_t> foot;
  std::vector<Distances> heights;   ///< Asked of each input vertex, one set a layer; all of one sign.
  std::vector<double> share;        ///< Of each input vertex: the share of its heights that it keeps, 0 .. 1.
  std::vector<VertexState> states;  ///< Of the outermost surface's vertices.
  /// Exact distance of the outermost surface's vertices, and of the first layer's, world units; of mitered vertices
  /// that of the faces beside them.
  std::vector<double> achieved, first_achieved;
  /// Of each face of the input: 0 if it carries no layers, since it is not offset or has no area; 1 if it carries
  /// layers; 2 or 3 if it is a quad that carries them as two triangles, on both sides of its diagonal from corner 0
  /// or 1. Empty: all faces carry layers.
  std::vector<std::uint8_t> carries;
  /// Of grow_periodic_layers() alone.
  std::optional<PeriodicPairs> periodic;
  KnownSides known;
  OffsetStatistics statistics;
  LayerStatistics layer_statistics;

  /// Number of layers.
  std::size_t count() const { return heights.size(); }
};

/// Grows layers of cells on a mesh's faces. One march passes all heights, and exact distances are at each of them (1e-6
/// relative) where a vertex keeps all of its heights. The cells over the faces are valid by `rules`, and cross neither
/// each other nor the wall: where they would, all layers of the vertices there are thinned by one share, which changes
/// by no more than a bounded step from neighbour to neighbour. A vertex that cannot move at all has the share 0, and
/// its cells have no height there.
/// \param heights of the layers from the wall outward: all above 0 or all below, in rising order of size at each
/// vertex; 0 in all layers leaves a vertex where it is
/// \param options without effect: `distance`, `collision` and `keep_paths`
/// \throw InvalidInput as offset_several(), and for heights that do not rise, or are of both signs.
VDB_OFFSET_API LayersResult grow_layers(PolygonView mesh, std::span<const Distances> heights,
                                        const OffsetOptions& options, CellRules rules = CellRules::AnySolver);

/// grow_layers() on one period of a shape, whose other periods count as well: layers on borders are as they would be
/// inside of the whole shape, and the motion takes those of one border to those of the other, to rounding. Obstacles
/// stay where they are. Figures of faces, of what was limited and of the grid are those of the mesh with its copies.
/// \throw InvalidInput as grow_layers() and find_periodic_pairs(), and for an angle that a whole circle is no multiple
/// of
VDB_OFFSET_API LayersResult grow_periodic_layers(PolygonView mesh, std::span<const Distances> heights,
                                                 const OffsetOptions& options, const PeriodicMotion& motion,
                                                 CellRules rules = CellRules::AnySolver);

/// Layers on a mesh whose sharp edges are opened into fans.
struct VDB_OFFSET_API FannedLayers {
  /// The mesh with its opened edges: its faces in their order, then the faces of fans (see Refinement::over_ridges),
  /// which have no area. Not set where no edge is opened.
  std::optional<Refinement> wall;
  LayersResult layers;  ///< Of the wall's vertices and faces; without one, of the mesh's.
};

/// grow_layers() with fans of cells over sharp convex edges and corners, where one vertex alone would leave its
/// neighbours far apart in the outer layers. Each vertex on such an edge gets copies that share its point of the wall,
/// each with layers of its own; between the copies lie prisms along the edge in the first layer, tetrahedra over
/// corners, and hexahedra and prisms above. Where an edge is no longer sharp its fan ends in a point, beside two cells
/// that are parted into pyramids and tetrahedra. A vertex without room for a fan has none.
/// \param angle edges that bend by more than this are opened, and neighbours in a fan are no farther apart; degrees, 0
/// or 5 .. 180. 0: none is opened.
/// \throw InvalidInput as grow_layers(), and for another angle
VDB_OFFSET_API FannedLayers grow_fanned_layers(PolygonView mesh, std::span<const Distances> heights,
                                               const OffsetOptions& options, double angle,
                                               CellRules rules = CellRules::AnySolver);

}  // namespace vdb_offset
