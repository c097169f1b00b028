// SPDX-License-Identifier: Apache-2.0
#include "document/trial.h"

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <new>

#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

// A reader takes seconds for the largest files that are met; this ends one that never comes to an end.
constexpr unsigned kMostSeconds = 300;
constexpr int kDone = 0, kTooLarge = 1, kThrown = 2;

/// Bytes of addresses that this process has now; 0 if the system does not say.
[[maybe_unused]] std::size_t addresses() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

/// Puts back what is done about the ends of children.
struct Restore {
  struct sigaction kept;
  ~Restore() { ::sigaction(SIGCHLD, &kept, nullptr); }
};

void set_limit(int what, rlim_t most) {
  const rlimit limit{most, most};
  ::setrlimit(static_cast<__rlimit_resource>(what), &limit);
}

[[noreturn]] void be_the_child(std::size_t most_memory, const std::function<void()>& work) {
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_CPU, kMostSeconds);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
#ifndef __SANITIZE_ADDRESS__  // which has terabytes of addresses
  if (const std::size_t now = addresses(); now > 0) set_limit(RLIMIT_AS, now + most_memory);
#else
  (void)most_memory;
#endif
  // As the system has them: a handler of this program would report its own end.
  for (const int signal : {SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGXCPU, SIGTERM, SIGINT, SIGALRM})
    std::signal(signal, SIG_DFL);
  // Should it wait for what the other threads, which it has not, would have given back.
  ::alarm(2 * kMostSeconds);
  try {
    work();
  } catch (const std::bad_alloc&) {
    ::_exit(kTooLarge);
  } catch (const std::length_error&) {
    ::_exit(kTooLarge);
  } catch (...) {
    ::_exit(kThrown);
  }
  ::_exit(kDone);
}

}  // namespace

bool try_in_child(const std::string& path, std::size_t most_memory, const std::function<void()>& work) {
  // Where children's ends are ignored, the system keeps none of them, as it would not for this one.
  struct sigaction kept {
  }, by_default{};
  by_default.sa_handler = SIG_DFL;
  ::sigaction(SIGCHLD, &by_default, &kept);
  const Restore restore{kept};
  const pid_t child = ::fork();
  if (child < 0) throw ReadError(path + ": cannot be read in a process of its own: " + std::strerror(errno));
  if (child == 0) be_the_child(most_memory, work);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw ReadError(path + ": the process that read it is lost: " + std::strerror(errno));
  if (WIFSIGNALED(status))
    throw InvalidInput(fmt::format("{}: expected a file that its library can read, got one that {}", path,
                                   WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGALRM
                                       ? "it comes to no end with"
                                       : fmt::format("ends it by signal {}", WTERMSIG(status))));
  if (WEXITSTATUS(status) == kTooLarge)
    throw OutOfBudget(path + ": expected a file whose content fits into memory, got one that asks for more");
  if (WEXITSTATUS(status) != kDone && WEXITSTATUS(status) != kThrown)
    throw InvalidInput(fmt::format("{}: expected a file that its library can read, got one that ends it with code {}",
                                   path, WEXITSTATUS(status)));
  return WEXITSTATUS(status) == kDone;
}

}  // namespace vdb_offset::io
