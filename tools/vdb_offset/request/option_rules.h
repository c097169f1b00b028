// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "request/command_line.h"
#include "request/request.h"

namespace vdb_offset::tool {

/// \throw UsageError if an option was given without one that it needs, or beside one that excludes it. `is_iso`: what
/// --mode says.
void require_together(const CommandLine& line, bool is_iso);

/// \throw UsageError if values do not go together, or a file's name has no ending that says what it is to hold. What
/// depends on whether INPUT holds curves is for require_for_input().
void require_sound(const Request& request);
/// Requires an ending that files of states have; check's rule as well. \throw UsageError
void require_states_file(const Request& request);

/// \throw UsageError unless --html names a page, InvalidOption if this build has none
void require_page(const Request& request);
/// Requires miters where there is a limit of them; check's rule as well. \throw UsageError
void require_miters(const Request& request);

}  // namespace vdb_offset::tool
