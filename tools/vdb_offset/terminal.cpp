// SPDX-License-Identifier: Apache-2.0
#include "terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>

#include "messages.h"
#include "vdb_offset/output_files.h"

namespace vdb_offset::tool {
namespace {

constexpr int kInterrupts[] = {SIGINT, SIGTERM, SIGHUP};

/// Ends the process as the signal would have if it had not been caught, so that shells and scripts see it.
void end_by(int signal) {
  if (!remove_temporaries()) return;
  std::signal(signal, SIG_DFL);
  std::raise(signal);  // takes effect once the handler has returned
}

// All that the signal handler uses: the message before and behind the name of the input, and that name.
constexpr char kBeforeName[] = "vdb_offset: ",
               kBehindName[] = ", or another input: expected a file that stays as it is, got one that was cut short\n";
std::string lost_input;

void write_error(const char* text, std::size_t size) {
  const ssize_t ignored = ::write(STDERR_FILENO, text, size);
  static_cast<void>(ignored);
}

void end_for_lost_input(int) {
  write_error(kBeforeName, sizeof kBeforeName - 1);
  write_error(lost_input.data(), lost_input.size());
  write_error(kBehindName, sizeof kBehindName - 1);
  remove_temporaries();
  _exit(2);
}

}  // namespace

ProgressBar::ProgressBar(bool wanted) : active_(wanted && isatty(STDERR_FILENO)) {}
ProgressBar::~ProgressBar() { clear(); }

void ProgressBar::show(Stage stage, double share) {
  if (!active_) return;
  constexpr int kWidth = 40;  // characters
  const int filled = static_cast<int>(share * kWidth);
  std::string line =
      fmt::format("{:<10} [{:#<{}}{:.<{}}] {:3.0f} %", name(stage), "", filled, "", kWidth - filled, 100 * share);
  if (line == shown_) return;
  shown_ = std::move(line);
  print("\r" + shown_);
}

void ProgressBar::clear() {
  if (!shown_.empty()) print(fmt::format("\r{:{}}\r", "", shown_.size()));
  shown_.clear();
}

// If the terminal has been closed, nothing more is drawn, and the run goes on.
void ProgressBar::print(const std::string& text) {
  active_ = std::fwrite(text.data(), 1, text.size(), stderr) == text.size() && std::fflush(stderr) == 0;
}

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = end_by;
  for (const int signal : kInterrupts) sigaddset(&action.sa_mask, signal);
  for (const int signal : kInterrupts) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN)
      sigaction(signal, &action, nullptr);  // signals that nohup or a shell ignores stay ignored
  }
  std::signal(SIGXFSZ, SIG_IGN);  // a file that is too large is then an error of writing like any other
}

void ignore_interrupts() {
  for (const int signal : kInterrupts) std::signal(signal, SIG_IGN);
}

void tell_of_lost_input(const std::string& path) {
  lost_input = readable(path);
  std::signal(SIGBUS, end_for_lost_input);
}

}  // namespace vdb_offset::tool
