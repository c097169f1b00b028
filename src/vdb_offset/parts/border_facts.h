#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vdb_offset/statistics.h"
#include "vdb_offset/surface/border_planes.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// \param way of each vertex of the surface
/// \param excepted of each vertex: 1 if it goes elsewhere for other reasons; empty: none
BorderFacts border_facts(const Surface& surface, std::span<const Vec3d> way, std::span<const std::uint8_t> excepted);

}  // namespace vdb_offset
