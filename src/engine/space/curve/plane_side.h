// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "space/curve/ribbon.h"

namespace vdb_offset {

/// Which side of the line from a to b point c lies on: 1 left, -1 right, 0 on it. Exact.
int side_of(const Vec2d& a, const Vec2d& b, const Vec2d& c);

}  // namespace vdb_offset
