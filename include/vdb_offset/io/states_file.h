// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/statistics.h"
#include "vdb_offset/volume_mesh.h"

namespace vdb_offset::io {

/// What became of each vertex of a mesh.
struct VertexStates {
  std::span<const VertexState> state;
  std::span<const double> achieved;  ///< World units, as is the target.
  const Distances& target;           ///< Negative is inward.
};

/// What else of a result a viewer can show.
struct ResultFaces {
  std::span<const float> error;       ///< As OffsetResult::face_errors; may be empty.
  const WallNames* groups = nullptr;  ///< What the source calls its faces.
  bool are_curves = false;            ///< The "faces" are plane curves.
  std::span<const FaceFault> fault;   ///< As OffsetResult::face_faults; may be empty.
};

/// True of the endings that write_states() knows: .csv, .ply and .vtp.
VDB_OFFSET_API bool is_states_file(const std::string& path);

/// Writes one line or one vertex for each of the mesh's: CSV `vertex,state,target,achieved`; or the mesh itself, which
/// a viewer can colour: PLY (binary, vertex properties state, in the order of VertexState, target and achieved), or
/// VTK's .vtp (point data share, state, achieved and target, cell data face_error, fault and group, as far as they are
/// known; words for states, faults and groups as field data state_words, fault_words and group_words). share is
/// achieved by target, NaN where the target is 0. \throw WriteError
VDB_OFFSET_API void write_states(const std::string& path, PolygonView mesh, const VertexStates& states,
                                 const ResultFaces& faces = {});

/// True of the ending that write_path_lines() knows: .vtp.
VDB_OFFSET_API bool is_lines_file(const std::string& path);

/// Writes the paths of vertices (OffsetResult::paths) as lines, with cell data state, achieved, target and vertex.
/// Vertices that stay have none. \throw WriteError
VDB_OFFSET_API void write_path_lines(const std::string& path, const std::vector<std::vector<Vec3d>>& paths,
                                     const VertexStates& states);

}  // namespace vdb_offset::io
