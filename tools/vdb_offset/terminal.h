#pragma once

#include <string>

#include "vdb_offset/progress.h"

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
  bool active_;
  std::string shown_;
};

/// Makes Ctrl-C (and a polite kill) set a flag instead of ending the process, so that files are tidied up.
void catch_interrupts();
/// Input files are mapped: one that is cut short while it is read ends the process by SIGBUS. From here on it ends with
/// a message about `path`, no temporary file and exit code 2.
void tell_of_lost_input(const std::string& path);
/// The signal that came, or 0.
int interrupted();

}  // namespace vdb_offset::tool
