// SPDX-License-Identifier: Apache-2.0
#pragma once

/// What a shared library shows to those who link it; all else is hidden.
#if defined(__GNUC__)
#define VDB_OFFSET_API __attribute__((visibility("default")))
#else
#define VDB_OFFSET_API
#endif

// Of these headers; the build reads them, too.
#define VDB_OFFSET_VERSION_MAJOR 0
#define VDB_OFFSET_VERSION_MINOR 2
#define VDB_OFFSET_VERSION_PATCH 0
#define VDB_OFFSET_VERSION "0.2.0"

namespace vdb_offset {

/// The version of the library that is linked, "major.minor.patch".
VDB_OFFSET_API const char* version();

}  // namespace vdb_offset
