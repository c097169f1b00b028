// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "job.h"
#include "outputs.h"
#include "terminal.h"

namespace vdb_offset::tool {

/// Carries out a job with layers. Returns kProcessing if what --strict asks for is not met.
ExitCode run_layers(const Job& job, const Timing& timing, ProgressBar& bar);

}  // namespace vdb_offset::tool
