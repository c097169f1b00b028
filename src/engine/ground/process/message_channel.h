// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace vdb_offset {

/// Descriptors that the worker starts with, beside the three that every program has, which are those of /dev/null.
inline constexpr int kWorkerMessages = 3;  ///< A socket: messages.
inline constexpr int kWorkerModel = 4;     ///< The bytes of a file, if there is one.
inline constexpr int kWorkerEnd = 5;  ///< A socket: how it ended, an int as of waitpid(); it ends when this closes.

/// A file descriptor that is closed at the end.
class OpenFile {
 public:
  OpenFile() = default;
  explicit OpenFile(int number) : number_(number) {}
  OpenFile(OpenFile&& other) noexcept : number_(other.release()) {}
  OpenFile& operator=(OpenFile&& other) noexcept;
  ~OpenFile() { close(); }

  int number() const { return number_; }
  int release();
  void close();

 private:
  int number_ = -1;
};

/// When a message has to have come.
using Deadline = std::optional<std::chrono::steady_clock::time_point>;

/// The other end did not keep to the deadline.
struct TooLate {};
/// The other end is gone.
struct Hangup {};

/// The kind of a message that says how much of a request is done, a double. Other kinds are the programs' own.
inline constexpr std::uint32_t kProgressMessage = 6;

struct Message {
  std::uint32_t kind = 0;
  std::string payload;
};

/// One end of a socket that messages go through. Does not raise SIGPIPE.
class MessageChannel {
 public:
  MessageChannel() = default;
  explicit MessageChannel(OpenFile socket) : socket_(std::move(socket)) {}

  /// A message as it goes through the socket.
  static std::string framed(std::uint32_t kind, std::string_view payload);

  /// \throw TooLate, Hangup
  void send(std::uint32_t kind, std::string_view payload, const Deadline& deadline);
  /// What comes is kept as it comes: a length that is named and not kept to takes no memory. \throw TooLate, Hangup,
  /// BadMessage if it does not start as messages do, or is longer than `most` bytes
  Message receive(const Deadline& deadline, std::uint64_t most);
  void close() { socket_.close(); }

 private:
  void wait(short event, const Deadline& deadline) const;
  void write(const void* bytes, std::size_t size, const Deadline& deadline);
  void read(void* bytes, std::size_t size, const Deadline& deadline);

  OpenFile socket_;
};

}  // namespace vdb_offset
