// SPDX-License-Identifier: Apache-2.0
#include "ground/process/message_channel.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <utility>

#include "ground/process/packing.h"

namespace vdb_offset {
namespace {

constexpr std::uint64_t kStart = 0x6461632d6f626476;  // of every message
constexpr std::uint64_t kRoomAtOnce = std::uint64_t{1} << 26;

struct Header {
  std::uint64_t start, kind, size;
};

/// Milliseconds that are left, rounded up; -1: any number.
int milliseconds_left(const Deadline& deadline) {
  if (!deadline) return -1;
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(*deadline - std::chrono::steady_clock::now()).count();
  if (left <= 0) throw TooLate();
  return static_cast<int>(std::min<decltype(left)>(left, std::numeric_limits<int>::max()));
}

}  // namespace

OpenFile& OpenFile::operator=(OpenFile&& other) noexcept {
  close();
  number_ = other.release();
  return *this;
}

int OpenFile::release() { return std::exchange(number_, -1); }

void OpenFile::close() {
  if (number_ >= 0) ::close(release());
}

void MessageChannel::wait(short event, const Deadline& deadline) const {
  pollfd watched{socket_.number(), event, 0};
  while (true) {
    const int ready = ::poll(&watched, 1, milliseconds_left(deadline));
    if (ready > 0) return;  // or an end, which the next call finds
    if (ready < 0 && errno != EINTR && errno != EAGAIN) throw Hangup();
  }
}

void MessageChannel::write(const void* bytes, std::size_t size, const Deadline& deadline) {
  const char* from = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t done = ::send(socket_.number(), from, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (done >= 0) {
      from += done;
      size -= static_cast<std::size_t>(done);
    } else if (errno == EAGAIN) {
      wait(POLLOUT, deadline);
    } else if (errno != EINTR) {
      throw Hangup();
    }
  }
}

void MessageChannel::read(void* bytes, std::size_t size, const Deadline& deadline) {
  char* to = static_cast<char*>(bytes);
  while (size > 0) {
    const ssize_t done = ::recv(socket_.number(), to, size, MSG_DONTWAIT);
    if (done > 0) {
      to += done;
      size -= static_cast<std::size_t>(done);
    } else if (done < 0 && errno == EAGAIN) {
      wait(POLLIN, deadline);
    } else if (done == 0 || errno != EINTR) {
      throw Hangup();
    }
  }
}

std::string MessageChannel::framed(std::uint32_t kind, std::string_view payload) {
  const Header header{kStart, kind, payload.size()};
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof(header));
  bytes += payload;
  return bytes;
}

void MessageChannel::send(std::uint32_t kind, std::string_view payload, const Deadline& deadline) {
  const Header header{kStart, kind, payload.size()};
  write(&header, sizeof(header), deadline);
  write(payload.data(), payload.size(), deadline);
}

Message MessageChannel::receive(const Deadline& deadline, std::uint64_t most) {
  Header header{};
  read(&header, sizeof(header), deadline);
  if (header.start != kStart || header.kind > std::numeric_limits<std::uint32_t>::max())
    throw BadMessage("bytes that start no message");
  if (header.size > most) throw BadMessage("a message that is too long");
  Message message{static_cast<std::uint32_t>(header.kind), {}};
  while (message.payload.size() < header.size) {
    const std::size_t from = message.payload.size();
    message.payload.resize(from + static_cast<std::size_t>(std::min(header.size - from, kRoomAtOnce)));
    read(message.payload.data() + from, message.payload.size() - from, deadline);
  }
  return message;
}

}  // namespace vdb_offset
