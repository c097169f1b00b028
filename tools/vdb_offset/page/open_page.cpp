// SPDX-License-Identifier: Apache-2.0
// Starts a browser. It gets a session of its own and no terminal: what it prints is not for the user, and Ctrl-C is not
// for it. A shell is not asked, so that no name of a file can be taken for more than a name.
#include "page/open_page.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <thread>
#include <vector>

namespace vdb_offset::tool {
namespace {

using Words = std::vector<std::string>;

/// The words of a command of $BROWSER, with the page for each %s, or behind them if there is none.
Words words_of(const std::string& command, const std::string& page) {
  Words words;
  bool is_named = false;
  std::istringstream in(command);
  for (std::string word; in >> word;) {
    if (const std::size_t at = word.find("%s"); at != std::string::npos) {
      word.replace(at, 2, page);
      is_named = true;
    }
    words.push_back(word);
  }
  if (!is_named) words.push_back(page);
  return words;
}

/// The commands to try, one after the other: $BROWSER holds several with colons between.
std::vector<Words> browsers(const std::string& page) {
  const char* const given = std::getenv("BROWSER");
  std::vector<Words> commands;
  std::istringstream in(given ? given : "");
  for (std::string command; std::getline(in, command, ':');)
    if (command.find_first_not_of(' ') != std::string::npos) commands.push_back(words_of(command, page));
  if (commands.empty()) commands.push_back({"xdg-open", page});
  return commands;
}

/// Becomes a program that goes on by itself. Only returns if that fails.
void become(char* const* line) {
  ::setsid();
  const int nothing = ::open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nothing, stream);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(signal, SIG_DFL);
  ::execvp(line[0], line);
}

/// Starts a program. Returns what is known to have gone wrong; it is not waited for longer than a second.
std::string started(const Words& words) {
  constexpr int kNotFound = 127;
  std::vector<char*> line;
  line.reserve(words.size() + 1);
  for (const std::string& word : words) line.push_back(const_cast<char*>(word.c_str()));
  line.push_back(nullptr);
  const pid_t process = ::fork();
  if (process == 0) {
    become(line.data());
    ::_exit(kNotFound);
  }
  if (process < 0) return std::strerror(errno);
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(1);
  int status = 0;
  for (pid_t ended = 0; ended == 0;) {
    ended = ::waitpid(process, &status, WNOHANG);
    if (ended < 0 || (ended == 0 && std::chrono::steady_clock::now() > end)) return {};
    if (ended == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotFound) return "not found";
  return WIFEXITED(status) ? fmt::format("exit code {}", WEXITSTATUS(status)) : "killed";
}

}  // namespace

std::string open_page(const std::string& path) {
  std::string failed;
  for (const Words& words : browsers(std::filesystem::absolute(path).string())) {
    const std::string why = started(words);
    if (why.empty()) return {};
    failed += fmt::format("{}{}: {}", failed.empty() ? "" : ", ", words.front(), why);
  }
  return failed;
}

}  // namespace vdb_offset::tool
