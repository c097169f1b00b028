// SPDX-License-Identifier: Apache-2.0
#include "derived/interpolate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bytes/append_number.h"
#include "document/encode.h"

namespace vdb_offset::io {
namespace {

std::array<double, 3> numbers_of(const std::array<std::string_view, 3>& words) {
  return {number_or_nan(words[0]), number_or_nan(words[1]), number_or_nan(words[2])};
}

/// Whether all that count are the same.
template <class Value>
bool are_same(const VertexOrigin& origin, const std::array<Value, 3>& of) {
  const Value& known = of[nearest(origin)];
  for (std::size_t k = 0; k < 3; ++k)
    if (origin.share[k] > 0 && of[k] != known) return false;
  return true;
}

/// Whether single precision is enough for all that count.
bool are_single(const VertexOrigin& origin, const std::array<double, 3>& of) {
  for (std::size_t k = 0; k < 3; ++k)
    if (origin.share[k] > 0 && !fits_float(of[k])) return false;
  return true;
}

}  // namespace

std::size_t nearest(const VertexOrigin& origin) {
  return static_cast<std::size_t>(std::max_element(origin.share.begin(), origin.share.end()) - origin.share.begin());
}

double interpolated(const VertexOrigin& origin, const std::array<double, 3>& of) {
  double sum = 0, least = of[nearest(origin)], most = least;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(origin.share[k] > 0)) continue;
    if (!std::isfinite(of[k])) return std::numeric_limits<double>::quiet_NaN();
    sum += origin.share[k] * of[k];
    least = std::min(least, of[k]);
    most = std::max(most, of[k]);
  }
  return std::clamp(sum, least, most);
}

Vec3d interpolated_normal(const VertexOrigin& origin, const std::array<Vec3d, 3>& of) {
  Vec3d sum(0.0);
  for (std::size_t k = 0; k < 3; ++k)
    if (origin.share[k] > 0) sum += origin.share[k] * of[k];
  return sum / sum.length();
}

void append_interpolated(std::string& text, const VertexOrigin& origin, const std::array<std::string_view, 3>& of,
                         Digits digits) {
  const std::string_view closest = of[nearest(origin)];
  const std::array<double, 3> numbers = numbers_of(of);
  const double value = interpolated(origin, numbers);
  if (are_same(origin, of) || !std::isfinite(value)) {
    text += closest;
    return;
  }
  if (digits == Digits::Whole) return append_number(text, std::round(value));
  const bool single = digits == Digits::Single || (digits == Digits::Shortest && are_single(origin, numbers));
  append_number(text, value, {single ? Rounding::Kind::Single : Rounding::Kind::Double});
}

void append_interpolated_words(std::string& text, const VertexOrigin& origin, const std::array<Scanner, 3>& of,
                               std::size_t whole) {
  std::array<Scanner, 3> at = of;
  Scanner& closest = at[nearest(origin)];
  for (std::size_t i = 0; !closest.at_line_end(); ++i) {
    std::array<std::string_view, 3> words;
    for (std::size_t k = 0; k < 3; ++k)
      if (origin.share[k] > 0) words[k] = at[k].token();
    append_interpolated(text += ' ', origin, words, i < whole ? Digits::Whole : Digits::Shortest);
  }
}

void ByteColours::look_at(Scanner words, std::size_t most) {
  for (; whole_ && most > 0 && !words.at_line_end(); --most) {
    std::int64_t number = 0;
    whole_ = parse_integer(words.token(), number);
    above_one_ = above_one_ || number > 1;
  }
}

std::array<std::string, 3> interpolated_normal_words(const VertexOrigin& origin,
                                                     const std::array<std::array<std::string_view, 3>, 3>& of) {
  std::array<Vec3d, 3> normals;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::array<double, 3> numbers = numbers_of(of[k]);
    normals[k] = Vec3d(numbers[0], numbers[1], numbers[2]);
  }
  const Vec3d normal = interpolated_normal(origin, normals);
  const bool keeps_words = are_same(origin, of) || !normal.isFinite();
  std::array<std::string, 3> words;
  for (std::size_t i = 0; i < 3; ++i) {
    if (keeps_words) words[i] = of[nearest(origin)][i];
    // Single precision is enough for a normal.
    else append_number(words[i], normal[static_cast<int>(i)], {Rounding::Kind::Single});
  }
  return words;
}

}  // namespace vdb_offset::io
