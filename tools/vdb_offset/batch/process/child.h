// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "batch/record.h"

namespace vdb_offset::tool {

/// A descriptor of this process alone, closed with its owner.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(other.release()) {}
  Descriptor& operator=(Descriptor&& other) noexcept;
  ~Descriptor() { close(); }
  int number() const { return number_; }
  int release();
  void close();

 private:
  int number_;
};

/// The path of this program.
std::string this_program();

/// What a process has reported, as one line: without the prefix of messages, and with semicolons between them.
std::string on_one_line(std::string_view text);

/// A model's process: this program with another command line.
class Child {
 public:
  /// \throw std::system_error if no process can be started
  explicit Child(std::span<const std::string> words);

  /// The ends of what it writes on standard error, and of its gate (see gate.h), for poll().
  int errors() const { return errors_.number(); }
  int gate() const { return gate_.number(); }

  /// Takes in what it has written on standard error.
  void read_errors();
  /// Takes in what it asks for and reports (see gate.h). False once it has ended.
  bool read_gate();
  /// The bytes that it asks for since the last call; 0 if it asks for none.
  std::size_t wanted() { return std::exchange(wanted_, 0); }
  /// The files that it has read besides those that its command line names.
  const std::vector<std::string>& files_read() const { return files_read_; }
  /// Lets it go on.
  void let_go();
  void signal(int number) const;
  /// Waits for its end. `seconds` are left to the caller.
  Ending wait();

 private:
  pid_t process_ = -1;
  Descriptor errors_, gate_;
  std::string told_, at_gate_;
  std::size_t wanted_ = 0;
  std::vector<std::string> files_read_;
};

}  // namespace vdb_offset::tool
