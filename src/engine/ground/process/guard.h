// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace vdb_offset {

/// Makes this process two: the one that returns does the work; the other waits for its end, and passes it to the
/// program that started the worker (files/cad/worker_process.h). If that program goes, both do.
void start_guard();

}  // namespace vdb_offset
