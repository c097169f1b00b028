// SPDX-License-Identifier: Apache-2.0
#include "batch/process/stop.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <system_error>

namespace vdb_offset::tool {
namespace {

volatile std::sig_atomic_t stopped_by = 0;
int ends[2] = {-1, -1};  // of a pipe: to read from, and for the handler to write to

void note(int signal) {
  const int error = errno;
  stopped_by = signal;
  const ssize_t ignored = ::write(ends[1], "", 1);
  static_cast<void>(ignored);
  errno = error;
}

}  // namespace

void catch_stops() {
  if (::pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  struct sigaction action {};
  action.sa_handler = note;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

int stop_signal() { return stopped_by; }

int stop_descriptor() { return ends[0]; }

void end_by_stop() {
  std::signal(stopped_by, SIG_DFL);
  std::raise(stopped_by);
  std::_Exit(128 + stopped_by);
}

}  // namespace vdb_offset::tool
