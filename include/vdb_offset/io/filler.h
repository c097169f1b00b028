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

/// A filler that runs in a program of its own, vdb_offset_fill, whose end does not reach this process. It throws
/// FillFailed where the domain is not filled, be it that the program crashes or takes too long; OutOfBudget where it
/// asks for more memory than it may, or has to, by the number of the domain's triangles; ReadError if there is no such
/// program.
VDB_OFFSET_API Filler make_filler(FillWith with, FillerLimits limits);

}  // namespace vdb_offset::io
