// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gp_Pnt.hxx>
#include <vector>

#include "judge/soup.h"

namespace vdb_offset::cad {

/// Of so many points, how many there are from one to the next of which turns() is looked for in reasonable time.
std::size_t step_of_turns(const Soup& soup, std::size_t points);

/// Points spread over a soup by area, the same on every machine: a stratified choice of triangles; and one point in
/// every face's largest triangle, behind these and in the order of faces.
std::vector<SoupPoint> spread(const Soup& soup, int count);

gp_Pnt middle_of(const Soup::Triangle& triangle);

/// Triangles of a closed shell, or of a solid, that lie in what others enclose, or are turned: they cross none of them
/// where they end on each other, but just outside of each there is not nothing, or just inside not material, once. Of
/// so many that are looked at. \param scale what is small is small compared to this \param may_fold triangles may lie
/// on each other, back to back: both sides of them are alike
std::vector<int> turned_triangles(const Soup& soup, double scale, int samples, bool may_fold);

}  // namespace vdb_offset::cad
