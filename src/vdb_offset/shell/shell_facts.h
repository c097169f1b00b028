#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/base/rounding.h"
#include "vdb_offset/shell.h"

namespace vdb_offset {

/// A shell's vertices as they will be written: what has not moved keeps its bytes.
std::vector<Vec3d> written_positions(PolygonView mesh, const Shell& shell, const Rounding& precision);

/// For each vertex of the mesh: 1 within two rings of where it crosses itself.
std::vector<std::uint8_t> find_near_crossings(PolygonView mesh, const WeldOptions& weld);

/// Counts all facts of a shell but its rim's, by what will be written of it. `mesh` holds the faces that it is made of,
/// `place` is of each vertex of the shell (see weld_by_position()).
void count_facts(PolygonView mesh, const WeldOptions& weld, const Rounding& precision,
                 std::span<const std::uint32_t> place, Shell& shell);

}  // namespace vdb_offset
