// SPDX-License-Identifier: Apache-2.0
#include "gltf/uri.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace vdb_offset::io::gltf {
namespace {

constexpr std::string_view kBase64Digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::string_view kHexadecimal = "0123456789ABCDEF";
constexpr std::string_view kData = "data:", kBase64 = ";base64,";

bool is_letter_or_digit(char c) { return (c >= '0' && c <= '9') || ((c | 32) >= 'a' && (c | 32) <= 'z'); }

std::optional<std::string> from_base64(std::string_view text) {
  static const std::array<int, 256> kValue = [] {
    std::array<int, 256> table;
    table.fill(-1);
    for (std::size_t i = 0; i < kBase64Digits.size(); ++i)
      table[static_cast<std::uint8_t>(kBase64Digits[i])] = static_cast<int>(i);
    return table;
  }();
  if (text.size() % 4 == 1) return std::nullopt;
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const int digit = kValue[static_cast<std::uint8_t>(c)];
    if (digit < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xff);
  }
  return bytes;
}

std::optional<std::string> without_percents(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%') {
      text += uri[i];
      continue;
    }
    int value = 0;
    for (int k = 0; k < 2; ++k) {
      const char digit = ++i < uri.size() ? uri[i] : ' ';
      const std::size_t found = kHexadecimal.find(digit >= 'a' && digit <= 'f' ? static_cast<char>(digit - 32) : digit);
      if (found == std::string_view::npos) return std::nullopt;
      value = value * 16 + static_cast<int>(found);
    }
    text += static_cast<char>(value);
  }
  return text;
}

bool has_scheme(std::string_view uri) {
  const auto end = std::find_if(uri.begin(), uri.end(),
                                [](char c) { return !is_letter_or_digit(c) && c != '+' && c != '-' && c != '.'; });
  return end != uri.end() && *end == ':';
}

}  // namespace

bool is_data_uri(std::string_view uri) { return uri.starts_with(kData); }

std::optional<DataUri> parse_data_uri(std::string_view uri) {
  const std::size_t comma = uri.find(',');
  if (!is_data_uri(uri) || comma == std::string_view::npos || !uri.substr(0, comma + 1).ends_with(kBase64))
    return std::nullopt;
  std::string_view text = uri.substr(comma + 1);
  const std::size_t filled = text.size() % 4 == 0 ? std::min<std::size_t>(2, text.size()) : 0;
  std::size_t fill = 0;
  while (fill < filled && text.ends_with('=')) {
    text.remove_suffix(1);
    ++fill;
  }
  std::optional<std::string> bytes = from_base64(text);
  if (!bytes) return std::nullopt;
  return DataUri{std::string(uri.substr(0, comma + 1)), std::move(*bytes), text.size() % 4 == 0 || fill > 0};
}

std::string base64(std::string_view bytes, bool padded) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      if (k <= count) text += kBase64Digits[bits >> (18 - 6 * k) & 63];
      else if (padded) text += '=';
  }
  return text;
}

std::optional<std::string> relative_path(std::string_view uri) {
  if (uri.empty() || has_scheme(uri)) return std::nullopt;
  std::optional<std::string> path = without_percents(uri);
  if (!path || path->front() == '/' || path->front() == '\\' || path->find('\0') != std::string::npos)
    return std::nullopt;
  return path;
}

std::string as_uri(std::string_view path) {
  std::string uri;
  for (const char c : path) {
    if (is_letter_or_digit(c) || std::string_view("-._~/").find(c) != std::string_view::npos) {
      uri += c;
      continue;
    }
    const auto byte = static_cast<std::uint8_t>(c);
    uri += '%';
    uri += kHexadecimal[byte >> 4];
    uri += kHexadecimal[byte & 15];
  }
  return uri;
}

}  // namespace vdb_offset::io::gltf
