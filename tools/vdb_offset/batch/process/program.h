// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace vdb_offset::tool {

/// What another program did.
struct Answer {
  int exit_code = 0;
  std::string printed;  ///< On standard output, then on standard error; without line ends behind it.
};

/// Runs a program that is found on the PATH, and waits for its end. Signals that stop the batch do not reach it. \throw
/// InvalidInput if there is none; `option` begins the message.
Answer ask_program(const std::vector<std::string>& words, const char* option);

/// A program that works beside this one, and ends with it.
class Program {
 public:
  /// `input` is what it reads; what it says on standard output and error goes to the file `log`. \throw InvalidInput
  Program(const std::vector<std::string>& words, const char* option, const std::string& input, const std::string& log);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

  bool is_at_work();
  void signal(int number) const;

 private:
  pid_t process_ = -1;
};

}  // namespace vdb_offset::tool
