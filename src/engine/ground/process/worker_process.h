// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

#include "ground/process/message_channel.h"

namespace vdb_offset {

/// A worker, as vdb_offset_cad, in a process of its own. Nothing of this process is changed for it: neither how signals
/// are dealt with nor which children it may wait for.
class WorkerProcess {
 public:
  /// \param model a file for it to read; null: none
  /// \throw std::system_error if there is no such program, or the system has no more processes
  WorkerProcess(const std::string& program, const OpenFile* model);
  /// Ends it.
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  MessageChannel& messages() { return messages_; }
  /// How it ended, as of waitpid(), once its messages have ended; nothing if that is not known.
  std::optional<int> how_it_ended();

 private:
  MessageChannel messages_;
  OpenFile end_;
  pid_t process_ = -1;
};

}  // namespace vdb_offset
