// SPDX-License-Identifier: Apache-2.0
#include "ground/process/guard.h"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

#include "ground/process/message_channel.h"

namespace vdb_offset {
namespace {

/// Waits for the worker's end, which closes `alive`, and reports it; or for that of the program, and ends the worker.
[[noreturn]] void guard(pid_t worker, int alive) {
  ::close(kWorkerMessages);
  ::close(kWorkerModel);
  pollfd watched[] = {{alive, POLLIN, 0}, {kWorkerEnd, POLLRDHUP, 0}};
  while (::poll(watched, 2, -1) < 0 && errno == EINTR) {
  }
  if (watched[0].revents == 0) ::kill(worker, SIGKILL);
  int status = 0;
  while (::waitpid(worker, &status, 0) < 0)
    if (errno != EINTR) ::_exit(1);
  ::send(kWorkerEnd, &status, sizeof(status), MSG_NOSIGNAL);
  ::_exit(0);
}

}  // namespace

void start_guard() {
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  int alive[2];
  if (::pipe(alive) != 0) ::_exit(1);
  const pid_t worker = ::fork();
  if (worker < 0) ::_exit(1);
  if (worker > 0) {
    ::close(alive[1]);
    guard(worker, alive[0]);
  }
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::close(alive[0]);
  ::close(kWorkerEnd);
}

}  // namespace vdb_offset
