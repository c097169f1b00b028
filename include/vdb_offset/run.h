// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>

#include "vdb_offset/api.h"

namespace vdb_offset {

/// The stages of a run, in the order in which they happen.
enum class Stage { Read, Rasterise, Sweep, Gradient, Propagate, Capture, Limit, Refine, Layers, Measure, Fill, Write };

inline constexpr std::size_t kStageCount = 12;

/// Name of a stage as reports and progress bars spell it.
VDB_OFFSET_API const char* name(Stage stage);

/// Called with the stage at hand and the share of the whole call that is done: from 0 to 1, never less than before, and
/// 1 at the end. How stages share it follows from the plan of the run, so that it grows about evenly in time. Return
/// false to cancel: the call that works then throws Cancelled. Calls never overlap, but come from whichever thread has
/// something to report.
using ProgressCallback = std::function<bool(Stage, double)>;

/// Called before the memory of a run is taken, with the bytes that it is estimated to hold at most. May wait until
/// there is room for them. Return false to cancel: the call that works then throws Cancelled. A run of several steps,
/// as one to a tolerance, calls it before each.
using ReserveCallback = std::function<bool(std::size_t bytes)>;

/// Bytes that this process may still take: what the system has free, or its control group leaves, if less.
VDB_OFFSET_API std::size_t available_memory();

/// Most bytes that this process has held at once since it started (its resident set).
VDB_OFFSET_API std::size_t peak_memory();

/// Most bytes that this process is to hold, 0 for no limit, as it is at first. It counts for what is not planned as a
/// whole: files as they are decompressed and read, scenes as they are built, lists that may grow to anything.
VDB_OFFSET_API void set_memory_limit(std::size_t bytes);

VDB_OFFSET_API std::size_t memory_limit();

/// Base of everything the library throws on purpose. Messages read `stage or file: expected X, got Y (hint)`.
struct VDB_OFFSET_API Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A mesh, a scene, a file's content or an option that breaks a stated precondition.
struct VDB_OFFSET_API InvalidInput : Error {
  using Error::Error;
};

/// An option whose value cannot be understood, or names what the mesh does not have.
struct VDB_OFFSET_API InvalidOption : Error {
  using Error::Error;
};

/// An expression that cannot be understood. The message holds the column, counted from 1.
struct VDB_OFFSET_API InvalidExpression : InvalidOption {
  using InvalidOption::InvalidOption;
};

/// A file that cannot be opened or read. The message starts with the file's name.
struct VDB_OFFSET_API ReadError : Error {
  using Error::Error;
};

/// A file that cannot be written. Nothing is left behind at the destination.
struct VDB_OFFSET_API WriteError : Error {
  using Error::Error;
};

/// The work was refused before it started because it would not fit; the message holds the figures.
struct VDB_OFFSET_API OutOfBudget : Error {
  using Error::Error;
};

/// The progress callback asked to stop.
struct VDB_OFFSET_API Cancelled : Error {
  Cancelled() : Error("cancelled") {}
};

}  // namespace vdb_offset
