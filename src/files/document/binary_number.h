// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

/// How a file stores a number: 'f' for floating-point, 'i' and 'u' for whole ones with and without a sign.
struct NumberType {
  char kind;
  std::uint8_t bytes;
};

template <class T>
double load(const char* raw) {
  T value;
  std::memcpy(&value, raw, sizeof value);
  return static_cast<double>(value);
}

inline double binary_number(const char* at, NumberType type, Encoding encoding) {
  static_assert(std::endian::native == std::endian::little, "numbers of the other order are turned round");
  char raw[8];
  if (encoding == Encoding::BigEndian) std::reverse_copy(at, at + type.bytes, raw);
  else std::memcpy(raw, at, type.bytes);
  if (type.kind == 'f') return type.bytes == 4 ? load<float>(raw) : load<double>(raw);
  if (type.kind == 'u')
    return type.bytes == 1   ? load<std::uint8_t>(raw)
           : type.bytes == 2 ? load<std::uint16_t>(raw)
           : type.bytes == 4 ? load<std::uint32_t>(raw)
                             : load<std::uint64_t>(raw);
  return type.bytes == 1   ? load<std::int8_t>(raw)
         : type.bytes == 2 ? load<std::int16_t>(raw)
         : type.bytes == 4 ? load<std::int32_t>(raw)
                           : load<std::int64_t>(raw);
}

}  // namespace vdb_offset::io
