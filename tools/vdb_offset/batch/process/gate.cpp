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

bool belongs_to_batch() {
  const char* const batch = std::getenv(kGateVariable);
  if (!batch) return false;
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (std::to_string(::getppid()) != batch) std::raise(SIGTERM);  // it was gone before that took effect
  return true;
}

bool wait_for_memory(std::size_t bytes) {
  const std::string asked = fmt::format("{}\n", bytes);
  if (::send(kGate, asked.data(), asked.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(asked.size())) return false;
  char go = 0;
  ssize_t count;
  while ((count = ::recv(kGate, &go, 1, 0)) < 0 && errno == EINTR) {
  }
  return count == 1;
}

}  // namespace vdb_offset::tool
