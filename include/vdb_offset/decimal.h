// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cmath>
#include <concepts>
#include <optional>
#include <string_view>

namespace vdb_offset {

/// The number that a text is as a whole, in decimal digits as files have them: a sign if it has one, a point and an
/// exponent for a double. More digits than that can hold are rounded to the nearest. Nothing for whatever else C reads
/// as a number (`0x10`, `inf`), and for what is out of range (`1e400`, `1e-400`).
template <typename Number>
requires std::floating_point<Number> || std::integral<Number> std::optional<Number> decimal(std::string_view text) {
  if (text.starts_with('+')) {
    text.remove_prefix(1);
    if (text.starts_with('-')) return std::nullopt;
  }
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if constexpr (std::floating_point<Number>)
    if (!std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace vdb_offset
