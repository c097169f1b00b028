// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "vdb_offset/numbers.h"

namespace vdb_offset {

/// A frame in which a file has coordinates, and how it is placed.
class AffineFrame {
 public:
  AffineFrame() = default;
  /// Three columns and an origin. None if they cannot be inverted.
  static std::optional<AffineFrame> of(const std::array<Vec3d, 3>& axes, const Vec3d& origin);

  bool is_identity() const { return identity_; }
  /// Whether it swaps left and right.
  bool mirrors() const { return mirrors_; }

  /// The same arithmetic whenever a position is read, so that what is judged is what will be read.
  Vec3d to_mesh(const Vec3d& q) const {
    return identity_ ? q : axes_[0] * q[0] + axes_[1] * q[1] + axes_[2] * q[2] + origin_;
  }
  Vec3d to_file(const Vec3d& p) const {
    if (identity_) return p;
    const Vec3d q = p - origin_;
    return inverse_[0] * q[0] + inverse_[1] * q[1] + inverse_[2] * q[2];
  }
  // Normals are turned by the inverse, transposed. Of any length; the results have length 1, or 0 if they had.
  Vec3d normal_to_mesh(const Vec3d& n) const;
  Vec3d normal_to_file(const Vec3d& n) const;
  /// The largest coordinate that the axes give to a point, each part of the sums counted for itself.
  double reach(const Vec3d& q) const;

  bool operator==(const AffineFrame& other) const { return axes_ == other.axes_ && origin_ == other.origin_; }

 private:
  std::array<Vec3d, 3> axes_{Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)}, inverse_ = axes_;
  Vec3d origin_{0.0};
  bool identity_ = true, mirrors_ = false;
};

/// Which frame each vertex of a file is in, by its position in the mesh.
class FileFrames {
 public:
  /// Vertices from first[i] to first[i + 1] are in frame i; `first` has one entry more than there are frames.
  FileFrames(std::span<const AffineFrame> frames, std::span<const std::uint32_t> first,
             std::span<const Vec3d> positions);

  /// The frames of the vertices at a position. None if there is no such vertex.
  std::span<const AffineFrame> find(const Vec3d& position) const;
  /// Where a vertex that was at `source` is as it is read again, if `kept` is what its frame keeps of a position. Where
  /// vertices in several frames are at one position, one that all of them keep, if there is any near.
  Vec3d as_kept(const Vec3d& source, Vec3d position, const std::function<Vec3d(const Vec3d&)>& kept) const;
  /// The largest number that goes into a coordinate on the way from the file.
  double extent() const { return extent_; }

 private:
  struct Hash {
    std::size_t operator()(const Vec3d& p) const;
  };
  // Frames that vertices at one position are in; more are not looked at.
  static constexpr std::size_t kMostTogether = 8;
  std::uint32_t joined(std::uint32_t set, std::uint32_t other);

  std::vector<std::vector<AffineFrame>> sets_;  ///< Frames that a position has, in the order of its vertices.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> joined_;
  std::unordered_map<Vec3d, std::uint32_t, Hash> at_;  ///< Its set. Empty if all vertices are in one frame.
  double extent_ = 0;
};

/// Rounds coordinates to what a file keeps of them.
struct Rounding : Precision {
  Rounding() = default;
  Rounding(const Precision& precision)
      : Precision(precision) {}  // NOLINT(google-explicit-constructor): no information is lost or added
  Rounding(Kind of, int significant_digits = 17) {  // NOLINT(google-explicit-constructor): a kind is a precision
    kind = of;
    digits = significant_digits;
  }

  double operator()(double value) const {
    return kind == Kind::Double   ? value
           : kind == Kind::Single ? static_cast<double>(static_cast<float>(value))
                                  : rounded_to_digits(value);
  }
  Vec3d operator()(const Vec3d& p) const {
    if (scale == Vec3d(1.0)) return {(*this)(p[0]), (*this)(p[1]), (*this)(p[2])};
    return in_file(p) * scale;
  }

  /// The position as the file has it, without the scale.
  Vec3d in_file(const Vec3d& p) const {
    const Vec3d q = p / scale;
    return {(*this)(q[0]), (*this)(q[1]), (*this)(q[2])};
  }

  /// What is kept of the position of a vertex that was at `source` before.
  Vec3d operator()(const Vec3d& source, const Vec3d& position) const {
    if (position == source && !rounds_all) return position;
    return frames ? in_frame(source, position) : (*this)(position);
  }

  /// Whether `stored` is what is written for a vertex that has not moved from `position`.
  bool stays(const Vec3d& position, const Vec3d& stored) const {
    if (!rounds_all) return position == stored;
    if (frames) return in_frame(position, position) == stored;
    if (scale != Vec3d(1.0)) return (*this)(position) == stored;
    return (*this)(position[0]) == stored[0] && (*this)(position[1]) == stored[1] && (*this)(position[2]) == stored[2];
  }

  /// Most that a number may change by as it is kept, relative to itself.
  double half_unit() const {
    return kind == Kind::Double ? 0x1p-53 : kind == Kind::Single ? 0x1p-24 : 5 * std::pow(10.0, -digits);
  }

  /// Most that a number may change by, relative to itself, arithmetic on the way included.
  double epsilon() const {
    return kind == Kind::Double ? 0x1p-51 : kind == Kind::Single ? 0x1p-23 : 0x1p-51 + 5 * std::pow(10.0, -digits);
  }

  /// Most that a coordinate of a position may be off, arithmetic on the way included.
  double most_off(const Vec3d& position) const {
    double size = std::max({std::abs(position[0]), std::abs(position[1]), std::abs(position[2])});
    if (frames) size = std::max(size, frames->extent());
    return size * epsilon();
  }
  /// Most that a vertex may be off, all coordinates together: the square root of 3 times that, and a little.
  double most_off_together(const Vec3d& position) const { return 2 * most_off(position); }

 private:
  /// The position as it is read again, after its vertex was written in the frame that it has in the file.
  Vec3d in_frame(const Vec3d& source, const Vec3d& position) const {
    return frames->as_kept(source, position,
                           [this](const Vec3d& q) { return Vec3d((*this)(q[0]), (*this)(q[1]), (*this)(q[2])); });
  }

  double rounded_to_digits(double value) const;
};

}  // namespace vdb_offset
