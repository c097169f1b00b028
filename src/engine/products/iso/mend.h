// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "space/surface/surface.h"
#include "vdb_offset/iso_surface.h"

namespace vdb_offset {

/// Counts the faults of a mesh, of all pairs of its triangles. \pre the mesh is built
MeshFaults find_faults(const Surface& mesh);
/// The triangles with faults that some triangles take part in. Both are sorted.
std::vector<std::uint32_t> find_faulty(const Surface& mesh, std::span<const std::uint32_t> some);

/// A position on the surface that a mesh is to approximate, near a wish, world coordinates; none if there is none near.
using Onto = std::function<std::optional<Vec3d>(const Vec3d& wish)>;

/// Takes crossings and needles out of a mesh, one by one: moves vertices along the surface to where the faces around
/// them have fewer faults, flips edges, and where neither helps splits edges, with a new vertex on the surface. Each
/// move or flip lowers the number of faults. Splits do not, and come in rounds of their own: these end when they lead
/// nowhere, and the mesh with the fewest faults is kept. A closed and manifold mesh stays so. The mesh's vertices,
/// triangles and stars change; its other members are those of the mesh as it was. \pre the mesh is built and not
/// placed. Cost: a search for crossings, and a few dozen trials for each fault. The result does not depend on the
/// number of threads.
MendStatistics mend(Surface& mesh, const Onto& onto);

}  // namespace vdb_offset
