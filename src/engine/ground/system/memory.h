// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "vdb_offset/run.h"
namespace vdb_offset {

/// Bytes that this process holds now (its resident set).
std::size_t held_memory();

/// Whether so many more bytes keep within the limit.
bool fits_memory(std::size_t bytes);

/// To be called before so many more bytes are taken. \throw OutOfBudget if they would pass the limit; `where` begins
/// the message.
void require_memory(std::size_t bytes, const std::string& where);

/// Calls the callback, if there is one. \throw Cancelled if it says so
void reserve_memory(const ReserveCallback& callback, std::size_t bytes);

/// Appends to a list of unknown final length. \throw OutOfBudget before it passes the limit
template <class T>
void append_within_limit(std::vector<T>& list, const T& item, const char* where) {
  constexpr std::size_t kSmall = std::size_t{1}
                                 << 20;  // bytes; smaller lists are not worth asking the system for the memory in use
  if (list.size() == list.capacity() && list.size() * sizeof(T) >= kSmall)
    require_memory(2 * list.size() * sizeof(T), where);
  list.push_back(item);
}

/// Watches over lists that grow item by item, as a file is read.
class MemoryWatch {
 public:
  /// An item takes so many bytes, in all lists together. Keeps a reference.
  MemoryWatch(const std::string& where, std::size_t bytes) : where_(where), bytes_(bytes) {}
  /// To be called before each item is added. \throw OutOfBudget
  void add() {
    // Lists grow by doubling: the limit is only looked at when a list is about to take twice the room.
    if (++count_ < next_) return;
    next_ *= 2;
    require_memory(next_ * bytes_, where_);
  }

 private:
  const std::string& where_;
  std::size_t bytes_, count_ = 0, next_ = std::size_t{1} << 15;
};

}  // namespace vdb_offset
