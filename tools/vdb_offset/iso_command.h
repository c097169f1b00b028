#pragma once

#include "args.h"
#include "inputs.h"
#include "outputs.h"
#include "terminal.h"

namespace vdb_offset::tool {

/// A run with --mode iso, from the source on. \throw Error for a surface that is not valid, and then no file is
/// written.
void run_iso(Arguments& args, Source& source, Clock::time_point start, ProgressBar& bar);

}  // namespace vdb_offset::tool
