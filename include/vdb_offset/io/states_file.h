// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "vdb_offset/api.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/statistics.h"

namespace vdb_offset::io {

/// What became of each vertex of a mesh.
struct VertexStates {
  std::span<const VertexState> state;
  std::span<const double> achieved;  ///< World units, as is the target.
  const Distances& target;           ///< Negative is inward.
};

/// True of the endings that write_states() knows: .csv and .ply.
VDB_OFFSET_API bool is_states_file(const std::string& path);

/// Writes one line or one vertex for each of the mesh's: CSV `vertex,state,target,achieved`; or PLY (binary, the mesh
/// itself with the vertex properties state, 0 to 4 in the order of VertexState, target and achieved), which a viewer
/// can colour by. \throw WriteError
VDB_OFFSET_API void write_states(const std::string& path, PolygonView mesh, const VertexStates& states);

}  // namespace vdb_offset::io
