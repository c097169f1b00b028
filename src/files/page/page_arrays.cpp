// SPDX-License-Identifier: Apache-2.0
#include "page/page_arrays.h"

#include <algorithm>
#include <bit>
#include <string_view>

#include "bytes/compression.h"

namespace vdb_offset::io {
namespace {

std::string base64_of(std::string_view bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace

void PageArrays::begin(const std::string& name, const char* type, std::size_t count) {
  bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0');
  directory_[name] = {{"type", type}, {"at", bytes_.size()}, {"count", count}};
}

void PageArrays::append(std::uint32_t bits) {
  for (int k = 0; k < 4; ++k) bytes_ += static_cast<char>(bits >> (8 * k) & 0xff);
}

void PageArrays::add(const std::string& name, std::span<const float> numbers) {
  begin(name, "float32", numbers.size());
  for (const float number : numbers) append(std::bit_cast<std::uint32_t>(number));
}

void PageArrays::add(const std::string& name, std::span<const std::uint32_t> numbers) {
  begin(name, "uint32", numbers.size());
  for (const std::uint32_t number : numbers) append(number);
}

void PageArrays::add(const std::string& name, std::span<const std::uint8_t> numbers) {
  begin(name, "uint8", numbers.size());
  bytes_.append(numbers.begin(), numbers.end());
}

std::string PageArrays::packed() const { return base64_of(compress(Compression::Gzip, bytes_)); }

}  // namespace vdb_offset::io
