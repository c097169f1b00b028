#pragma once

#include "vdb_offset/distances.h"
#include "vdb_offset/propagate.h"
#include "vdb_offset/workpiece.h"

namespace vdb_offset {

/// Gives the border vertices of a part new paths, along what stays of the mesh, to their distances from the part.
///
/// A vertex slides over the faces that stay around it, away from the part; where those turn away from the side that the
/// part goes to by more than 30 degrees, as the sides of a box do from its lid, along their extension instead. Where
/// they meet in one crease at the vertex it follows that, and where in more, it stays. On the faces it follows the
/// surface's bends (steps along the tangent and back to the closest point); along an extension it goes straight.
/// Such vertices are bound to their paths from then on. Their distances and paths are those of the front's vertices.
/// The result does not depend on the number of threads.
void slide_borders(Workpiece& work, const ClosestQuery& front, const Distances& distances, Paths& paths);

}  // namespace vdb_offset
