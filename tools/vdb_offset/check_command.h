// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "request/command_line.h"
#include "request/request.h"
#include "vdb_offset/offset.h"

namespace vdb_offset::tool {

/// What the command line of `check` asks for, and that of `view` of two meshes.
struct CheckRequest {
  /// The options with which OFFSET was made of SOURCE, as far as they are given, and this command's own.
  Request made;
  std::string distance, distance_from, distance_xy, distance_z;
  std::optional<AxisDistances> axes;
  bool json = false;
  bool may_differ = false;  ///< OFFSET may have other vertices and faces; then it is shown, and not measured.
  bool are_curves = false;  ///< Found by measure().
};

/// Declares the options that say how the offset was made.
void declare_measuring(CommandLine& line, CheckRequest& request);
/// Settles what these options say. \throw UsageError if they do not go together
void require_measuring(const CommandLine& line, CheckRequest& request);

/// Measures OFFSET, and writes the states and the page that are asked for. None if it cannot be measured, and may be
/// so. \throw UsageError, ReadError, InvalidInput, WriteError
std::optional<CheckResult> measure(CheckRequest& request);

/// True of a command line that asks for `vdb_offset check SOURCE OFFSET`.
bool is_check(int argc, const char* const* argv);

/// Measures a mesh as an offset of another and prints what it finds. Returns 0 if that is valid, 3 if not, or if
/// --strict asks for more. \throw UsageError, ReadError, InvalidInput
int run_check(int argc, const char* const* argv);

}  // namespace vdb_offset::tool
