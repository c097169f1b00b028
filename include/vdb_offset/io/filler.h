// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "vdb_offset/api.h"
#include "vdb_offset/fill.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {

/// What a filler may take.
struct FillerLimits {
  double seconds = 3600;          ///< How long filling may take.
  std::uint64_t most_memory = 0;  ///< How many bytes it may ask for; 0: any.
  ProgressCallback progress;      ///< Called with Stage::Fill, so that filling can be cancelled.
};

/// Netgen (Schoeberl, NETGEN: An advancing front 2D/3D-mesh generator based on abstract rules, 1997), in a program of
/// its own, vdb_offset_fill, whose end does not reach this process. The filler throws FillFailed where Netgen does not
/// fill the domain, be it that it crashes or takes too long; OutOfBudget where it asks for more memory than it may;
/// ReadError if there is no such program.
VDB_OFFSET_API Filler netgen_filler(FillerLimits limits);

/// TetGen (Si, TetGen, a Delaunay-based quality tetrahedral mesh generator, 2015), the program tetgen, as far as it is
/// installed: 10 to 30 times as fast as Netgen, with worse cells. Of the domain's sizes it uses the longest edge alone.
/// As netgen_filler(), and ReadError where tetgen is not installed.
VDB_OFFSET_API Filler tetgen_filler(FillerLimits limits);

}  // namespace vdb_offset::io
