#pragma once

namespace vdb_offset {

/// The library's version, "major.minor.patch".
const char* version();

}  // namespace vdb_offset
