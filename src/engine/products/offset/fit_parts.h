// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "space/surface/surface.h"

namespace vdb_offset {

/// What of a surface gives way together in a fit, as one part with one depth: a flat face between sharp edges as a
/// whole, so that it stays flat, and elsewhere each vertex by itself. At a sharp edge a vertex is in a part of either
/// side, so that one side can go and the other stay.
class FitParts {
 public:
  /// \param only of the input's faces, 1 of those that may give way; empty: all
  FitParts(const Surface& surface, std::span<const std::uint8_t> only);

  std::size_t count() const { return count_; }
  /// The part that each corner of a triangle is in; kNone of triangles that may not give way.
  const std::array<std::uint32_t, 3>& of(std::uint32_t triangle) const { return of_corner_[triangle]; }
  std::uint32_t at(std::uint32_t triangle, std::uint32_t vertex) const;
  /// Whether a part is a flat face, and not a vertex.
  bool is_flat(std::uint32_t part) const { return part < flat_count_; }

 private:
  class Finder;

  std::vector<std::array<std::uint32_t, 3>> of_corner_;
  const Surface& surface_;
  std::size_t count_ = 0, flat_count_ = 0;
};

}  // namespace vdb_offset
