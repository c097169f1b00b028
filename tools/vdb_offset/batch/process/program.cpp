// SPDX-License-Identifier: Apache-2.0
#include "batch/process/program.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <system_error>

#include "batch/process/child.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

constexpr int kNotFound = 127;  // the exit code of a program that could not be started, as shells have it

/// Starts a program in a group of its own, so that Ctrl-C does not reach it, with these standard streams. It gets
/// SIGTERM when this process ends.
pid_t start(const std::vector<std::string>& words, int input, int output) {
  std::vector<char*> line;
  line.reserve(words.size() + 1);
  for (const std::string& word : words) line.push_back(const_cast<char*>(word.c_str()));
  line.push_back(nullptr);
  const pid_t process = ::fork();
  if (process < 0) throw std::system_error(errno, std::generic_category(), words.front());
  if (process > 0) return process;
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  ::setpgid(0, 0);
  ::dup2(input, STDIN_FILENO);
  ::dup2(output, STDOUT_FILENO);
  ::dup2(output, STDERR_FILENO);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(signal, SIG_DFL);
  ::execvp(line.front(), line.data());
  ::_exit(kNotFound);
}

int wait_for(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// A file without a name that holds a text, from its beginning.
Descriptor file_of(const std::string& text) {
  Descriptor file(::memfd_create("input", MFD_CLOEXEC));
  if (file.number() < 0 || ::write(file.number(), text.data(), text.size()) != static_cast<ssize_t>(text.size()))
    throw std::system_error(errno, std::generic_category(), "memfd");
  ::lseek(file.number(), 0, SEEK_SET);
  return file;
}

}  // namespace

Answer ask_program(const std::vector<std::string>& words, const char* option) {
  int pipe[2];
  if (::pipe2(pipe, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  const Descriptor printed(pipe[0]);
  Descriptor output(pipe[1]);
  const pid_t process = start(words, file_of("").number(), output.number());
  output.close();
  Answer answer;
  std::array<char, 4096> bytes;
  for (ssize_t count; (count = ::read(printed.number(), bytes.data(), bytes.size())) > 0 || errno == EINTR;) {
    if (count > 0) answer.printed.append(bytes.data(), static_cast<std::size_t>(count));
    errno = 0;
  }
  answer.exit_code = wait_for(process);
  while (!answer.printed.empty() && answer.printed.back() == '\n') answer.printed.pop_back();
  if (answer.exit_code == kNotFound && answer.printed.empty())
    throw InvalidInput(fmt::format("{}: expected the program '{}' on the PATH, got none", option, words.front()));
  return answer;
}

Program::Program(const std::vector<std::string>& words, const char* option, const std::string& input,
                 const std::string& log) {
  ask_program({words.front(), "--version"}, option);  // to find out whether there is one
  const Descriptor file(::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (file.number() < 0) throw WriteError(fmt::format("{}: cannot be written: {}", log, std::strerror(errno)));
  process_ = start(words, file_of(input).number(), file.number());
}

Program::~Program() {
  if (process_ < 0) return;
  signal(SIGTERM);
  wait_for(process_);
}

bool Program::is_at_work() {
  if (process_ < 0) return false;
  int status = 0;
  if (::waitpid(process_, &status, WNOHANG) == process_) process_ = -1;
  return process_ >= 0;
}

void Program::signal(int number) const {
  if (process_ >= 0) ::kill(process_, number);
}

}  // namespace vdb_offset::tool
