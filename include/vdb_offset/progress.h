// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "vdb_offset/api.h"

namespace vdb_offset {

/// The stages of a run, in the order in which they happen.
enum class Stage { Read, Rasterise, Sweep, Gradient, Propagate, Capture, Limit, Layers, Measure, Write };

inline constexpr std::size_t kStageCount = 10;

/// Name of a stage as reports and progress bars spell it.
VDB_OFFSET_API const char* name(Stage stage);

/// Called with a stage and the share of it that is done, 0..1. Return false to cancel: the call that works
/// then throws Cancelled. Calls never overlap, but come from whichever thread has something to tell.
using ProgressCallback = std::function<bool(Stage, double)>;

}  // namespace vdb_offset
