#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "vdb_offset/iso_surface.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

/// Of all pairs of a mesh's triangles. \pre the mesh is built
MeshFaults find_faults(const Surface& mesh);
/// The triangles that have faults in which some, sorted, take part: sorted.
std::vector<std::uint32_t> find_faulty(const Surface& mesh, std::span<const std::uint32_t> some);

/// A place near a wish on the surface that a mesh is to approximate, world coordinates; none if there is none near.
using Onto = std::function<std::optional<Vec3d>(const Vec3d& wish)>;

/// Takes crossings and needles out of a mesh, one by one: moves vertices along the surface to where the faces around
/// have fewer faults, flips edges, and where neither helps splits them, with a new vertex on the surface. Whatever it
/// does lowers the number of faults, but for splits, which come in rounds of their own: these end when they lead
/// nowhere, and the mesh with the fewest faults is kept. What is closed and manifold stays so. The mesh's vertices,
/// triangles and stars change; what else it tells is of the mesh as it was. \pre the mesh is built and not placed.
/// Cost: a search for crossings, and a few dozen tries for each fault. The result does not depend on the number of
/// threads.
MendStatistics mend(Surface& mesh, const Onto& onto);

}  // namespace vdb_offset
