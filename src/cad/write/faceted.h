// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <array>
#include <cstdint>
#include <span>

#include "vdb_offset/numbers.h"

namespace vdb_offset::cad {

/// Triangles as planar faces that share their edges: a solid if they are closed, else a shell.
TopoDS_Shape faceted_shape(std::span<const Vec3d> positions, std::span<const std::array<std::uint32_t, 3>> triangles);

}  // namespace vdb_offset::cad
