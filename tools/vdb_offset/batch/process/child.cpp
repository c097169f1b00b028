// SPDX-License-Identifier: Apache-2.0
#include "batch/process/child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "batch/process/gate.h"
#include "messages.h"

namespace vdb_offset::tool {
namespace {

constexpr std::string_view kPrefix = "vdb_offset: ";  // of messages
constexpr std::size_t kMostTold = 1 << 16;            // bytes of messages that are kept

void require_done(int error, const char* what) {
  if (error != 0) throw std::system_error(error, std::generic_category(), what);
}

/// The environment of a child: this process's own, and whose child it is.
std::vector<std::string> environment_of_child() {
  const std::string mark = std::string(kGateVariable) + "=";
  std::vector<std::string> variables;
  for (char** variable = environ; *variable; ++variable)
    if (!std::string_view(*variable).starts_with(mark)) variables.emplace_back(*variable);
  variables.push_back(mark + std::to_string(::getpid()));
  return variables;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> list;
  list.reserve(texts.size() + 1);
  for (std::string& text : texts) list.push_back(text.data());
  list.push_back(nullptr);
  return list;
}

/// Starts a process with these ends of its standard error and gate, nothing to read, and nothing on standard output.
pid_t spawn(std::vector<std::string> words, int errors, int gate) {
  posix_spawn_file_actions_t files;
  require_done(posix_spawn_file_actions_init(&files), "vdb_offset batch");
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&files, errors, STDERR_FILENO);
  posix_spawn_file_actions_adddup2(&files, gate, kGate);
  // Whoever ignores SIGTERM, a model's process has to end with the batch.
  posix_spawnattr_t attributes;
  require_done(posix_spawnattr_init(&attributes), "vdb_offset batch");
  sigset_t term;
  sigemptyset(&term);
  sigaddset(&term, SIGTERM);
  posix_spawnattr_setsigdefault(&attributes, &term);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
  std::vector<std::string> variables = environment_of_child();
  pid_t process = -1;
  // This very program, even if another has taken its place on the disk meanwhile.
  const int error =
      posix_spawn(&process, "/proc/self/exe", &files, &attributes, pointers(words).data(), pointers(variables).data());
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  require_done(error, "vdb_offset batch");
  return process;
}

}  // namespace

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  close();
  number_ = other.release();
  return *this;
}

int Descriptor::release() { return std::exchange(number_, -1); }

void Descriptor::close() {
  if (number_ >= 0) ::close(release());
}

std::string this_program() { return std::filesystem::read_symlink("/proc/self/exe").string(); }

std::string on_one_line(std::string_view text) {
  std::string line;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view message = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (message.starts_with(kPrefix)) message.remove_prefix(kPrefix.size());
    if (message.empty()) continue;
    if (!line.empty()) line += "; ";
    line += message;
  }
  return line.empty() ? line : readable(line);
}

Child::Child(std::span<const std::string> words) {
  int pipe[2], sockets[2];
  if (::pipe2(pipe, O_CLOEXEC) != 0) require_done(errno, "pipe");
  errors_ = Descriptor(pipe[0]);
  const Descriptor errors_of_child(pipe[1]);
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0) require_done(errno, "socketpair");
  gate_ = Descriptor(sockets[0]);
  const Descriptor gate_of_child(sockets[1]);
  ::fcntl(errors_.number(), F_SETFL, O_NONBLOCK);
  ::fcntl(gate_.number(), F_SETFL, O_NONBLOCK);
  std::vector<std::string> line{"vdb_offset"};
  line.insert(line.end(), words.begin(), words.end());
  process_ = spawn(std::move(line), errors_of_child.number(), gate_of_child.number());
}

void Child::read_errors() {
  std::array<char, 4096> bytes;
  for (ssize_t count; (count = ::read(errors_.number(), bytes.data(), bytes.size())) > 0;)
    if (told_.size() < kMostTold) told_.append(bytes.data(), static_cast<std::size_t>(count));
}

bool Child::read_gate() {
  std::array<char, 4096> bytes;
  ssize_t count;
  while ((count = ::recv(gate_.number(), bytes.data(), bytes.size(), 0)) > 0)
    at_gate_.append(bytes.data(), static_cast<std::size_t>(count));
  const bool is_there = count < 0 && (errno == EAGAIN || errno == EINTR);
  for (std::size_t end; (end = at_gate_.find('\0')) != std::string::npos; at_gate_.erase(0, end + 1)) {
    const std::string text = at_gate_.substr(1, end - 1);
    if (at_gate_.front() == kHasReadFile) files_read_.push_back(text);
    else std::from_chars(text.data(), text.data() + text.size(), wanted_);
  }
  return is_there;
}

void Child::let_go() { ::send(gate_.number(), "", 1, MSG_NOSIGNAL); }

void Child::signal(int number) const { ::kill(process_, number); }

Ending Child::wait() {
  int status = 0;
  rusage usage{};
  while (::wait4(process_, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  read_errors();
  Ending ending{.peak_memory = static_cast<std::size_t>(usage.ru_maxrss) * 1024, .message = on_one_line(told_)};
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    ending.exit_code = 128 + signal;
    ending.message +=
        fmt::format("{}ended by signal {} ({})", ending.message.empty() ? "" : "; ", signal, ::strsignal(signal));
  } else {
    ending.exit_code = WEXITSTATUS(status);
  }
  return ending;
}

}  // namespace vdb_offset::tool
