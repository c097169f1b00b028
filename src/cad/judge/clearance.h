// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <gp_Pnt.hxx>
#include <vector>

#include "judge/soup.h"

namespace vdb_offset::cad {

/// How near the triangles of two soups come to each other; `most` if that is less.
double gap_between(const Soup& one, const Soup& other, double most);

/// A soup of the triangles of each connected part, whose corners are in the same places.
std::vector<Soup> connected_parts(const std::vector<gp_Pnt>& points,
                                  const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace vdb_offset::cad
