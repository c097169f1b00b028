// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace vdb_offset::tool {

/// From here on, Ctrl-C and the like (SIGINT, SIGTERM, SIGHUP, unless they are ignored) do not end the process; they
/// are to be asked for.
void catch_stops();

/// The signal that came; 0 if none did.
int stop_signal();

/// A descriptor that can be read from once a signal has come, for poll().
int stop_descriptor();

/// Ends the process as the signal would have if it had not been caught.
[[noreturn]] void end_by_stop();

}  // namespace vdb_offset::tool
