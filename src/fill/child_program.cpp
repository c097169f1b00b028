// SPDX-License-Identifier: Apache-2.0
#include "child_program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>

namespace vdb_offset {
namespace {

constexpr int kNotFound = 127;

/// \return as of waitpid()
int status_of(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw FillFailed("an end that is not known");
  return status;
}

}  // namespace

void run_program(const std::vector<std::string>& words,
                 const std::vector<std::pair<std::string, std::string>>& surroundings, std::uint64_t most_memory) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  // Not after fork(): another thread may just allocate memory then.
  for (const auto& [name, value] : surroundings) ::setenv(name.c_str(), value.c_str(), 1);
  const pid_t parent = ::getpid(), child = ::fork();
  if (child < 0) throw FillFailed("no more processes");
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(1);
    if (const rlimit most{most_memory, most_memory}; most_memory > 0) ::setrlimit(RLIMIT_AS, &most);
    const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(null, standard);
    ::execvp(arguments[0], arguments.data());
    ::_exit(kNotFound);
  }
  const int status = status_of(child);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotFound) throw FillerMissing("no program " + words.front());
  if (WIFSIGNALED(status)) throw FillFailed(fmt::format("its end by signal {}", WTERMSIG(status)));
  if (WEXITSTATUS(status) != 0) throw FillFailed(fmt::format("its end with code {}", WEXITSTATUS(status)));
}

}  // namespace vdb_offset
