#pragma once

#include "args.h"
#include "inputs.h"
#include "outputs.h"
#include "terminal.h"

namespace vdb_offset::tool {

/// A run with --layers, from the source on. Returns whether --strict can be content: every cell is valid, and every
/// vertex keeps all of its heights.
bool run_layers(Arguments& args, Source& source, Clock::time_point start, ProgressBar& bar);

}  // namespace vdb_offset::tool
