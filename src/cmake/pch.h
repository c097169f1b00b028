// SPDX-License-Identifier: Apache-2.0
// Precompiled: the headers that cost most to read. No source relies on it. None of OpenVDB's whose mere inclusion makes
// a program need its library: only src/vdb_offset/grids/openvdb may.
#pragma once

#include <openvdb/Types.h>
#include <openvdb/util/NodeMasks.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <string>
#include <vector>
