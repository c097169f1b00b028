// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "space/surface/surface.h"

namespace vdb_offset {

/// Where neighbours disagree about the outside, turns the smaller part, by area, of each orientable sheet (faces joined
/// over edges with two faces) to agree with the rest. Triangles change the order of their corners, never their number.
void settle_orientation(Surface& surface);

/// Counts the closed components (joined over edges, each with two faces that agree) and those among them that face the
/// wrong way as a whole: they have a negative signed volume, unless they are cavities, which lie inside an odd number
/// of other closed components; and the cavities of those, if they are turned round with them. With FixDirectionOnly
/// they are turned, so that outward is out of the solid; with FixCavities what lies inside an odd number of others and
/// points outward is, too, and else counted. `component_of` is the component of each triangle. Cost:
/// O(triangles); and three rays through a tree of boxes for each of several closed components, if the box of
/// one lies in another's. The result does not depend on the number of threads.
void settle_outside(Surface& surface, const std::vector<std::uint32_t>& component_of, Orient orient);

}  // namespace vdb_offset
