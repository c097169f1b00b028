// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace vdb_offset {

/// From here on, progress is reported through this socket; before, it is not.
void report_progress_to(int socket);

/// From the worker, or a process that it has started: reports how much of the part of the request at hand is done, 0 to
/// 1, to the program that asked. Never waits: a report that finds no room is left out.
void report_progress(double share);

/// While this lives, what is reported is one part of the part that it lies in.
class ProgressPart {
 public:
  ProgressPart(double from, double to);
  ~ProgressPart();
  ProgressPart(const ProgressPart&) = delete;
  ProgressPart& operator=(const ProgressPart&) = delete;

 private:
  double from_before_, to_before_;
};

}  // namespace vdb_offset
