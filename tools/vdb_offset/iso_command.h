// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "job.h"
#include "outputs.h"
#include "terminal.h"

namespace vdb_offset::tool {

/// Carries out a job with --mode iso. \throw Error for a surface that is not valid, and then no file is written.
ExitCode run_iso(const Job& job, const Timing& timing, ProgressBar& bar);

}  // namespace vdb_offset::tool
