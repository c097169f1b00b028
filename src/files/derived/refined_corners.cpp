// SPDX-License-Identifier: Apache-2.0
#include "derived/refined_corners.h"

#include <fmt/format.h>

#include <algorithm>

#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

class CornerRefiner {
 public:
  CornerRefiner(const DerivedMesh& derived, std::span<const std::uint32_t> of_corner, std::size_t count)
      : derived_(derived), of_corner_(of_corner), count_(count), last_(derived.added_vertices(), kNone) {}

  RefinedCorners run() {
    if (of_corner_.empty()) return {};
    CornerFinder finder(derived_.source_mesh());
    refined_.of_corner.reserve(derived_.mesh().corners.size());
    for (std::uint32_t f = 0; f < derived_.face_count(); ++f)
      for (std::size_t k = 0; k < derived_.mesh().face(f).size(); ++k)
        refined_.of_corner.push_back(value_at(derived_.mesh().face(f)[k], derived_.corner(f, k, finder)));
    return std::move(refined_);
  }

 private:
  std::uint32_t value_at(std::uint32_t v, const CornerOrigin& corner) {
    RefinedCorners::Between value{v, {kNone, kNone, kNone}};
    std::uint32_t known = kNone;
    bool are_same = true;
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(corner.vertex.share[k] > 0)) continue;
      value.of[k] = of_corner_[corner.corner[k]];
      if (value.of[k] == kNone) return kNone;
      are_same = are_same && (known == kNone || known == value.of[k]);
      known = value.of[k];
    }
    return are_same ? known : number_of(value);
  }

  /// The number of an interpolated value, a new one unless there is one like it.
  std::uint32_t number_of(const RefinedCorners::Between& value) {
    std::uint32_t& last = last_[value.vertex - derived_.source_vertices()];
    for (std::uint32_t i = last; i != kNone; i = before_[i])
      if (refined_.added[i].of == value.of) return static_cast<std::uint32_t>(count_) + i;
    before_.push_back(last);
    last = static_cast<std::uint32_t>(refined_.added.size());
    refined_.added.push_back(value);
    return static_cast<std::uint32_t>(count_) + last;
  }

  const DerivedMesh& derived_;
  std::span<const std::uint32_t> of_corner_;
  std::size_t count_;
  RefinedCorners refined_;
  std::vector<std::uint32_t> last_, before_;  // the last value at each added vertex, and of each value the one before
};

}  // namespace

std::uint32_t CornerFinder::at(std::size_t face, std::uint32_t vertex) {
  if (face != face_) {
    face_ = face;
    corners_.clear();
    for (std::uint32_t c = mesh_.face_begin[face]; c < mesh_.face_begin[face + 1]; ++c)
      corners_.emplace_back(mesh_.corners[c], c);
    std::sort(corners_.begin(), corners_.end());
  }
  const auto found = std::lower_bound(corners_.begin(), corners_.end(), std::pair{vertex, std::uint32_t{0}});
  if (found == corners_.end() || found->first != vertex)
    throw InvalidInput(fmt::format(
        "refine_file: expected pieces of face {} between its own vertices, got one at vertex {}", face, vertex));
  return found->second;
}

RefinedCorners refine_corners(const DerivedMesh& derived, std::span<const std::uint32_t> of_corner, std::size_t count) {
  return CornerRefiner(derived, of_corner, count).run();
}

}  // namespace vdb_offset::io
