// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/math/Vec2.h>
#include <openvdb/math/Vec3.h>

#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>

namespace vdb_offset {

using openvdb::math::Vec2d;
using openvdb::math::Vec3d;

/// The number of no vertex, face or other thing.
inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// The frames of its own in which a file has its vertices.
class FileFrames;

/// What a file keeps of a coordinate. Validity is judged on what is kept.
struct Precision {
  enum class Kind { Double, Single, Digits };

  Kind kind = Kind::Double;
  int digits = 17;  ///< Significant decimal digits; for Kind::Digits, 1 .. 17.
  /// Positions are so many times as large as the file has them.
  Vec3d scale{1.0};
  /// Vertices that have not moved are written anew as well, as in a file of another format; else they keep their bytes.
  bool rounds_all = false;
  /// The file has vertices in other frames than the mesh's, and the numbers that it keeps are those. \pre scale is 1
  std::shared_ptr<const FileFrames> frames{};
};

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

/// How numbers are spread.
struct Spread {
  double least = 0, quantile_01 = 0, quantile_05 = 0, median = 0, quantile_95 = 0, quantile_99 = 0, most = 0;
  double mean = 0;
};

}  // namespace vdb_offset
