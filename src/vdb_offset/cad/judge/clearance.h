// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/cad/judge/soup.h"

namespace vdb_offset::cad {

/// How near the triangles of two soups come to each other, as far as corners and middles of each tell; `most` if that
/// is less.
double gap_between(const Soup& one, const Soup& other, double most);

}  // namespace vdb_offset::cad
