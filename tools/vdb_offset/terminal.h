// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <deque>
#include <string>
#include <utility>

#include "vdb_offset/run.h"

namespace vdb_offset::tool {

/// A time in words, as "2 h 05 min", "3 min 20 s", "12 s" or "1.2 s".
std::string time_in_words(double seconds);

/// Draws one bar for a whole run on standard error if that is a terminal, and nothing at all if not: the share that is
/// done, what is being done, and how long the rest will take. A run reads, works (what the library reports) and writes.
class ProgressBar {
 public:
  explicit ProgressBar(bool wanted);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// How much of the run reading takes, as a share of it.
  void expect_reading(double share) { read_until_ = share; }
  /// Once all is read: how much of the rest writing takes, as a share of that, and what it is to be called.
  void expect_writing(double share, const char* called = "writing") {
    work_until_ = read_until_ + (1 - read_until_) * (1 - share);
    writing_ = called;
  }

  /// Of work that is several calls of the library: of which part of it shares are from here on.
  void expect_work_between(double from, double to) { work_part_ = {from, to}; }

  /// Shares of the part of the run that the stage belongs to.
  void show(Stage stage, double share);
  /// Calls show(). \pre this lives as long
  ProgressCallback callback() {
    return [this](Stage stage, double share) {
      show(stage, share);
      return true;
    };
  }
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  double share_of_run(Stage stage, double share) const;
  /// How long the rest takes if it goes on as over the last half of the time so far, in words; empty if it is too early
  /// to say.
  std::string time_left(double share);
  void print(const std::string& text);

  bool active_;
  double read_until_ = 0.05, work_until_ = 0.95;  ///< Shares of the run.
  const char* writing_ = "writing";
  std::pair<double, double> work_part_{0, 1};  ///< Shares of the work.
  Clock::time_point begun_ = Clock::now();
  std::deque<std::pair<double, double>> shares_;  ///< Of the run, after so many seconds: the latest half of the time.
  double shown_share_ = 0;
  std::string shown_;
};

/// From here on, Ctrl-C and the like (SIGINT, SIGTERM, SIGHUP) end the process by that signal at once, whatever it is
/// doing, and remove its temporary files; not while outputs are put in place.
void catch_interrupts();
/// For when the outputs are complete: what comes now changes nothing.
void ignore_interrupts();
/// Input files are mapped: one that is cut short while it is read ends the process by SIGBUS. From here on it ends with
/// a message about `path`, no temporary file and exit code 2.
void report_lost_input(const std::string& path);

}  // namespace vdb_offset::tool
