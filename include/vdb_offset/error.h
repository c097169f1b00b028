#pragma once

#include <stdexcept>
#include <string>

namespace vdb_offset {

/// Base of everything the library throws on purpose. Messages read `place: expected X, got Y (hint)`.
struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A mesh, a scene, a file's content or an option that breaks a stated precondition.
struct InvalidInput : Error {
  using Error::Error;
};

/// An option whose value cannot be understood, or names what the mesh does not have.
struct InvalidOption : Error {
  using Error::Error;
};

/// An expression that cannot be understood. The message holds the column, counted from 1.
struct InvalidExpression : InvalidOption {
  using InvalidOption::InvalidOption;
};

/// A file that cannot be opened or read. The message starts with the file's name.
struct ReadError : Error {
  using Error::Error;
};

/// A file that cannot be written. Nothing is left behind at the destination.
struct WriteError : Error {
  using Error::Error;
};

/// The work was refused before it started because it would not fit; the message holds the figures.
struct OutOfBudget : Error {
  using Error::Error;
};

/// The progress callback asked to stop.
struct Cancelled : Error {
  Cancelled() : Error("cancelled") {}
};

}  // namespace vdb_offset
