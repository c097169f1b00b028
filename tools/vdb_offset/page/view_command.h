// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace vdb_offset::tool {

/// True of a command line that asks for `vdb_offset view FILE [RESULT]`.
bool is_view(int argc, const char* const* argv);

/// Writes a page that shows a mesh, or a mesh and its offset, and opens it in a browser. Returns 0.
/// \throw UsageError, ReadError, InvalidInput, WriteError
int run_view(int argc, const char* const* argv);

}  // namespace vdb_offset::tool
