// SPDX-License-Identifier: Apache-2.0
#include "ground/process/worker_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <system_error>
#include <utility>

namespace vdb_offset {
namespace {

void require_no(int error, const char* what) {
  if (error != 0) throw std::system_error(error, std::generic_category(), what);
}

/// Two ends, whose numbers none of the worker's own is overwritten by.
std::pair<OpenFile, OpenFile> make_sockets() {
  int sockets[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0) require_no(errno, "socketpair");
  return {OpenFile(sockets[0]), OpenFile(sockets[1])};
}

OpenFile beyond_the_workers(int number) {
  const int copy = ::fcntl(number, F_DUPFD_CLOEXEC, kWorkerEnd + 1);
  if (copy < 0) require_no(errno, "dup");
  return OpenFile(copy);
}

struct SpawnActions {
  posix_spawn_file_actions_t list;
  SpawnActions() { require_no(posix_spawn_file_actions_init(&list), "posix_spawn"); }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&list); }
};

struct SpawnAttributes {
  posix_spawnattr_t list;
  SpawnAttributes() { require_no(posix_spawnattr_init(&list), "posix_spawn"); }
  ~SpawnAttributes() { posix_spawnattr_destroy(&list); }
};

/// Signals as a program finds them that nobody has meddled with; and no keys of a terminal reach the worker, which ends
/// with its parent.
void set_attributes(posix_spawnattr_t& attributes) {
  sigset_t all, none;
  sigfillset(&all);
  sigemptyset(&none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
}

pid_t spawn(const std::string& program, int messages, const OpenFile* model, int end) {
  const SpawnActions files;
  auto* const list = const_cast<posix_spawn_file_actions_t*>(&files.list);
  posix_spawn_file_actions_addopen(list, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(list, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(list, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(list, messages, kWorkerMessages);
  // Never left free: the worker's guard closes it, whatever has its number by then.
  if (model) posix_spawn_file_actions_adddup2(list, model->number(), kWorkerModel);
  else posix_spawn_file_actions_addopen(list, kWorkerModel, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(list, end, kWorkerEnd);
  SpawnAttributes attributes;
  set_attributes(attributes.list);
  std::string name = program.substr(program.rfind('/') + 1);
  char* const words[] = {name.data(), nullptr};
  pid_t process = -1;
  require_no(posix_spawn(&process, program.c_str(), list, &attributes.list, words, environ), program.c_str());
  return process;
}

}  // namespace

WorkerProcess::WorkerProcess(const std::string& program, const OpenFile* model) {
  auto [messages, messages_of_worker] = make_sockets();
  auto [end, end_of_worker] = make_sockets();
  const OpenFile its_messages = beyond_the_workers(messages_of_worker.number());
  const OpenFile its_model = model ? beyond_the_workers(model->number()) : OpenFile();
  const OpenFile its_end = beyond_the_workers(end_of_worker.number());
  messages_ = MessageChannel(std::move(messages));
  end_ = std::move(end);
  process_ = spawn(program, its_messages.number(), model ? &its_model : nullptr, its_end.number());
}

WorkerProcess::~WorkerProcess() {
  // Never by its number, which may be another's where this process ignores the ends of its children.
  messages_.close();
  end_.close();
  while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::optional<int> WorkerProcess::how_it_ended() {
  constexpr int kMostMilliseconds = 2000;  // the worker's guard has only to notice
  pollfd watched{end_.number(), POLLIN, 0};
  while (::poll(&watched, 1, kMostMilliseconds) < 0 && errno == EINTR) {
  }
  int status = 0;
  if (::recv(end_.number(), &status, sizeof(status), MSG_DONTWAIT) != sizeof(status)) return std::nullopt;
  return status;
}

}  // namespace vdb_offset
