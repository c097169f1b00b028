// SPDX-License-Identifier: Apache-2.0
#pragma once

/// What a shared library shows to those who link it; all else is hidden.
#if defined(__GNUC__)
#define VDB_OFFSET_API __attribute__((visibility("default")))
#else
#define VDB_OFFSET_API
#endif
