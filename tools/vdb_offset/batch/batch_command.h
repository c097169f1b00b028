// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace vdb_offset::tool {

/// True of a command line that asks for `vdb_offset batch DIR OUT`.
bool is_batch(int argc, const char* const* argv);

/// Offsets all models of a folder. Returns 0 if all are done, 3 if one failed. Ends by the signal if a stop was asked
/// for. \throw UsageError, ReadError, InvalidInput, WriteError
int run_batch(int argc, const char* const* argv);

}  // namespace vdb_offset::tool
