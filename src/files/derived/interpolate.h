// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "bytes/scanner.h"
#include "vdb_offset/polygons.h"

// Values at added vertices, of those at the vertices of their origin: `of[k]` belongs to origin.vertex[k], and does not
// count where the share is 0.
namespace vdb_offset::io {

/// Which of its vertices an added vertex is nearest to: the one with the largest share, the first of several.
std::size_t nearest(const VertexOrigin& origin);

/// The sum of the numbers by their shares, which is not outside of their range. NaN if one of them is not finite.
double interpolated(const VertexOrigin& origin, const std::array<double, 3>& of);

/// The normal of length 1. Not finite if one of the normals is not, or if they cancel out.
Vec3d interpolated_normal(const VertexOrigin& origin, const std::array<Vec3d, 3>& of);

/// What text a number gets.
enum class Digits { Shortest, Single, Double, Whole };

/// Appends the number between those that words stand for: one word where all are the same, and the nearest one where
/// one of them is no finite number. The shortest text has the digits of single precision where these are enough for
/// all of the words.
void append_interpolated(std::string& text, const VertexOrigin& origin, const std::array<std::string_view, 3>& of,
                         Digits digits = Digits::Shortest);

/// Appends the words between those of three lines, each behind a blank; as many as the nearest line has. The first
/// `whole` of them are whole numbers.
void append_interpolated_words(std::string& text, const VertexOrigin& origin, const std::array<Scanner, 3>& of,
                               std::size_t whole = 0);

/// Finds out whether numbers are colours of bytes: whole ones, and some above 1.
class ByteColours {
 public:
  /// Looks at the first `most` words of a line.
  void look_at(Scanner words, std::size_t most);
  bool are_bytes() const { return whole_ && above_one_; }

 private:
  bool whole_ = true, above_one_ = false;
};

/// The normal between those that words stand for; the nearest one if it has no direction.
std::array<std::string, 3> interpolated_normal_words(const VertexOrigin& origin,
                                                     const std::array<std::array<std::string_view, 3>, 3>& of);

}  // namespace vdb_offset::io
