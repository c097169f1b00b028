// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include "vdb_offset/api.h"

namespace vdb_offset {

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
