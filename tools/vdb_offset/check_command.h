// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace vdb_offset::tool {

/// True of a command line that asks for `vdb_offset check SOURCE OFFSET`.
bool is_check(int argc, const char* const* argv);

/// Measures a mesh as an offset of another and prints what it finds. Returns 0 if that is valid, 3 if not, or if
/// --strict asks for more. \throw UsageError, ReadError, InvalidInput
int run_check(int argc, const char* const* argv);

}  // namespace vdb_offset::tool
