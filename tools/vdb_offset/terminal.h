// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "vdb_offset/run.h"

namespace vdb_offset::tool {

/// Draws a bar per stage on standard error if that is a terminal, and nothing at all if not.
class ProgressBar {
 public:
  explicit ProgressBar(bool wanted);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(Stage stage, double share);
  void clear();

 private:
  void print(const std::string& text);

  bool active_;
  std::string shown_;
};

/// From here on, Ctrl-C and the like (SIGINT, SIGTERM, SIGHUP) end the process by that signal at once, whatever it is
/// doing, and remove its temporary files; not while outputs are put in place.
void catch_interrupts();
/// For when the outputs are complete: what comes now changes nothing.
void ignore_interrupts();
/// Input files are mapped: one that is cut short while it is read ends the process by SIGBUS. From here on it ends with
/// a message about `path`, no temporary file and exit code 2.
void tell_of_lost_input(const std::string& path);

}  // namespace vdb_offset::tool
