#include "terminal.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstring>

#include "vdb_offset/file_replace.h"

namespace vdb_offset::tool {
namespace {

volatile std::sig_atomic_t caught = 0;

// The second signal ends the process at once: the handler is taken away by the first.
void remember(int signal) { caught = signal; }

// All that a signal handler may touch.
char lost_input[4096];

void end_for_lost_input(int) {
  const ssize_t ignored = ::write(STDERR_FILENO, lost_input, std::strlen(lost_input));
  static_cast<void>(ignored);
  remove_temporary_file();
  _exit(2);
}

}  // namespace

ProgressBar::ProgressBar(bool wanted) : active_(wanted && isatty(STDERR_FILENO)) {}
ProgressBar::~ProgressBar() { clear(); }

void ProgressBar::show(Stage stage, double share) {
  if (!active_) return;
  constexpr int kWidth = 40;
  const int filled = static_cast<int>(share * kWidth);
  std::string line =
      fmt::format("{:<10} [{:#<{}}{:.<{}}] {:3.0f} %", name(stage), "", filled, "", kWidth - filled, 100 * share);
  if (line == shown_) return;
  shown_ = std::move(line);
  fmt::print(stderr, "\r{}", shown_);
  std::fflush(stderr);
}

void ProgressBar::clear() {
  if (!shown_.empty()) fmt::print(stderr, "\r{:{}}\r", "", shown_.size());
  shown_.clear();
}

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = remember;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);  // nohup and background jobs stay so
  }
  std::signal(SIGXFSZ, SIG_IGN);  // a file that grows too large is an error of writing like any other
}

void tell_of_lost_input(const std::string& path) {
  const std::string message =
      fmt::format("vdb_offset: {:.4000}: expected a file that stays as it is, got one that was cut short\n", path);
  std::copy_n(message.c_str(), message.size() + 1, lost_input);
  std::signal(SIGBUS, end_for_lost_input);
}

int interrupted() { return caught; }

}  // namespace vdb_offset::tool
