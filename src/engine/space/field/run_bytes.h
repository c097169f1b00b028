// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "space/surface/surface.h"
#include "vdb_offset/polygons.h"

/// What a run is estimated to take in memory, for its plan. The constants are fitted to peaks of 160 runs of 11 meshes
/// of 372 to 332,000 triangles, in 15 ways, and raised until 450 runs of other meshes kept to them (docs/measured.md).
namespace vdb_offset {

/// Bytes that a run takes besides its grid and the surface that the grid is made from.
struct RunBytes {
  std::size_t always = 0;      ///< As long as the run takes.
  std::size_t after_grid = 0;  ///< When the grid is gone, in its place.
};

/// The process itself: code, libraries, of which OpenVDB takes most, and allocator. And a module that writes cells.
inline constexpr std::size_t kProcessBytes = 48 << 20, kCellModuleBytes = 18 << 20;

/// Results that are made valid at the same time; each takes memory. Not measured beside other numbers.
inline constexpr std::size_t kResultsTogether = 4;

/// A surface with all that is made from it: adjacency, normals, box tree, paths.
std::size_t surface_bytes(const Surface& surface);

/// The first result, while it is made valid.
std::size_t result_bytes(const Surface& surface);
/// Results beside the first.
std::size_t further_bytes(std::size_t vertices, std::size_t results);
/// A number of layers of cells on a mesh.
std::size_t layers_bytes(PolygonView mesh, const Surface& surface, std::size_t layers);
/// Paths of results, which are kept, handed out and written.
std::size_t paths_bytes(std::size_t vertices, std::size_t results);
/// The rim and the skins of a shell as one mesh, and its text.
std::size_t shell_bytes(PolygonView mesh, const Surface& surface);
/// A mesh whose faces are split, in place of a grid: the faces that are left, and the mesh that they make.
std::size_t refinement_bytes(PolygonView mesh, const Surface& surface);
/// Vertices of which the exact surface is known.
std::size_t exact_bytes(std::size_t vertices);

}  // namespace vdb_offset
