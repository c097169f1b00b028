// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ground/numbers/rounding.h"
#include "vdb_offset/shell.h"

namespace vdb_offset {

/// The positions of a mesh's vertices, with those that count as one at one of them: nothing else shows that they are
/// one in a file whose vertices are not numbered.
std::vector<Vec3d> positions_as_welded(PolygonView mesh, const WeldOptions& weld);

/// The positions of a shell's vertices as they will be written. Vertices that have not moved keep their bytes.
std::vector<Vec3d> written_positions(PolygonView mesh, const Shell& shell, const Rounding& precision);

/// Finds the triangles of a shell's faces. \param mesh the faces that the shell is made from
void split_shell(PolygonView mesh, Shell& shell);

/// For each vertex of the mesh: 1 if it is within two rings of where the mesh crosses itself.
std::vector<std::uint8_t> find_near_crossings(PolygonView mesh, const WeldOptions& weld);

/// Counts all facts of a shell but those of its rim, on positions as they will be written.
/// \param mesh the faces that the shell is made from
/// \param welded_to of each vertex of the shell the first vertex that counts as one with it (see weld_by_position())
void count_facts(PolygonView mesh, const WeldOptions& weld, const Rounding& precision,
                 std::span<const std::uint32_t> welded_to, Shell& shell);

}  // namespace vdb_offset
