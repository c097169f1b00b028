// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

// How the models of a batch share the memory: each is a process of its own, which states its estimate and waits until
// there is room for it. The two ends of a socket: one in the process of the batch, one in that of the model.

namespace vdb_offset::tool {

/// The descriptor of the model's end in its process, and the variable of the environment that holds the number of the
/// batch's process.
constexpr int kGate = 3;
constexpr const char* kGateVariable = "VDB_OFFSET_BATCH";

// What a message of a model begins with; behind it stand a number of bytes or a path, and a zero byte.
constexpr char kAsksForMemory = 'm', kHasReadFile = 'f';

/// Whether this process is that of a model of a batch. If so, it ends with the batch, whatever ends that.
bool belongs_to_batch();

/// Reports to the batch a file that was read, which the command line does not name.
void report_file_read(const std::string& path);

/// Reports to the batch how many bytes this process will need, and waits until it may go on. False if the batch is
/// gone.
bool wait_for_memory(std::size_t bytes);

}  // namespace vdb_offset::tool
