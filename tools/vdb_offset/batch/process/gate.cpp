// SPDX-License-Identifier: Apache-2.0
#include "batch/process/gate.h"

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string>

namespace vdb_offset::tool {

namespace {

bool send_message(char kind, const std::string& text) {
  std::string message(1, kind);
  message.append(text).append(1, '\0');
  return ::send(kGate, message.data(), message.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(message.size());
}

}  // namespace

bool belongs_to_batch() {
  const char* const batch = std::getenv(kGateVariable);
  int kind = 0;
  socklen_t size = sizeof kind;
  // The variable may be a user's own.
  if (!batch || ::getsockopt(kGate, SOL_SOCKET, SO_TYPE, &kind, &size) != 0) return false;
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (std::to_string(::getppid()) != batch) std::raise(SIGTERM);  // it was gone before that took effect
  return true;
}

void report_file_read(const std::string& path) { send_message(kHasReadFile, path); }

bool wait_for_memory(std::size_t bytes) {
  if (!send_message(kAsksForMemory, fmt::format("{}", bytes))) return false;
  char go = 0;
  ssize_t count;
  while ((count = ::recv(kGate, &go, 1, 0)) < 0 && errno == EINTR) {
  }
  return count == 1;
}

}  // namespace vdb_offset::tool
