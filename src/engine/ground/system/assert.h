// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Checks what must hold whatever the input: an invariant, or what a caller has promised (\pre). A failure is a defect
/// of this library, never of its input, and ends the process with file, line and the condition. Builds with
/// VDB_OFFSET_ASSERTIONS (Debug, sanitizers) evaluate the condition; all others do not, so that it may be costly.
#ifdef VDB_OFFSET_ASSERTIONS

#include <cstdio>
#include <cstdlib>

#define VDB_OFFSET_ASSERT(...)                                                                         \
  do {                                                                                                 \
    if (!(__VA_ARGS__)) {                                                                              \
      std::fprintf(stderr, "vdb_offset: %s:%d: %s does not hold\n", __FILE__, __LINE__, #__VA_ARGS__); \
      std::abort();                                                                                    \
    }                                                                                                  \
  } while (false)

#else

#define VDB_OFFSET_ASSERT(...) static_cast<void>(sizeof((__VA_ARGS__) ? 1 : 0))

#endif
