// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace vdb_offset {

/// A message that is not what it ought to be.
struct BadMessage : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Puts values one behind the other, as they lie in memory: both ends are programs of one machine and one version.
class Packer {
 public:
  template <class Value>
  requires std::is_trivially_copyable_v<Value> Packer& value(const Value& value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(Value));
    return *this;
  }
  Packer& text(std::string_view text) {
    value(std::uint64_t{text.size()});
    bytes_.append(text);
    return *this;
  }
  template <class Value>
  requires std::is_trivially_copyable_v<Value> Packer& list(const std::vector<Value>& list) {
    value(std::uint64_t{list.size()});
    bytes_.append(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(Value));
    return *this;
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Takes values in the order in which they were put. \throw BadMessage where there are not enough bytes
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : rest_(bytes) {}

  template <class Value>
  requires std::is_trivially_copyable_v<Value> Value value() {
    Value value;
    std::memcpy(static_cast<void*>(&value), next(1, sizeof(Value)), sizeof(Value));
    return value;
  }
  std::string text() {
    const auto size = value<std::uint64_t>();
    return std::string(next(size, 1), static_cast<std::size_t>(size));
  }
  template <class Value>
  requires std::is_trivially_copyable_v<Value> std::vector<Value> list() {
    const auto size = value<std::uint64_t>();
    const char* const bytes = next(size, sizeof(Value));
    std::vector<Value> list(static_cast<std::size_t>(size));
    if (size > 0) std::memcpy(static_cast<void*>(list.data()), bytes, list.size() * sizeof(Value));
    return list;
  }
  /// How many things follow, each of at least so many bytes.
  std::size_t count(std::size_t least_bytes) {
    const auto count = value<std::uint64_t>();
    if (count > rest_.size() / least_bytes) throw BadMessage("a list longer than its message");
    return static_cast<std::size_t>(count);
  }
  void end() const {
    if (!rest_.empty()) throw BadMessage("bytes behind the end of a message");
  }

 private:
  const char* next(std::uint64_t count, std::size_t size) {
    if (count > rest_.size() / size) throw BadMessage("a message that is cut off");
    const char* const bytes = rest_.data();
    rest_.remove_prefix(static_cast<std::size_t>(count) * size);
    return bytes;
  }

  std::string_view rest_;
};

}  // namespace vdb_offset
