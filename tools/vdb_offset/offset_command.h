// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "job.h"
#include "outputs.h"
#include "terminal.h"

namespace vdb_offset::tool {

/// Carries out a job that moves the mesh's own vertices, or curves' points. Returns kProcessing if a result is not
/// valid, or what a scene expects, or --strict, is not met.
ExitCode run_offset(const Job& job, const Timing& timing, ProgressBar& bar);

}  // namespace vdb_offset::tool
