// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "job.h"
#include "outputs.h"
#include "terminal.h"

namespace vdb_offset::tool {

/// Carries out a job with layers. Returns kProcessing if --strict was given and cannot be content.
ExitCode run_layers(const Job& job, const Timing& timing, ProgressBar& bar);

}  // namespace vdb_offset::tool
