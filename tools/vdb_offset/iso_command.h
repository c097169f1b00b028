#pragma once

#include "args.h"
#include "inputs.h"
#include "outputs.h"
#include "terminal.h"

namespace vdb_offset::tool {

/// A run with --mode iso, from the source on. Returns whether --strict can be content: all surfaces are closed and
/// manifold, and do not cross themselves.
bool run_iso(Arguments& args, Source& source, Clock::time_point start, ProgressBar& bar);

}  // namespace vdb_offset::tool
