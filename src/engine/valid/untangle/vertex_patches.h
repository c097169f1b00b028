// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "ground/numbers/index_set.h"
#include "ground/system/assert.h"
#include "space/surface/surface.h"

namespace vdb_offset {

/// Some of a surface's vertices, in patches that share no face.
class Patches {
 public:
  /// Keeps a reference.
  explicit Patches(const Surface& surface) : surface_(surface), number_(surface.vertices.size(), kNone) {}

  /// Makes patches of these vertices, in place of those before. \pre sorted, each once
  void split(const Indices& vertices) {
    VDB_OFFSET_ASSERT(is_index_set(vertices, number_.size()));
    clear();
    vertices_ = vertices;
    constexpr std::uint32_t kOpen = kNone - 1;
    for (const auto v : vertices_) number_[v] = kOpen;
    for (const auto seed : vertices_) {
      if (number_[seed] != kOpen) continue;
      const auto number = static_cast<std::uint32_t>(patches_.size());
      Indices& patch = patches_.emplace_back(1, seed);
      number_[seed] = number;
      for (std::size_t i = 0; i < patch.size(); ++i)
        for (const auto t : surface_.triangles_around(patch[i]))
          for (const auto w : surface_.triangles[t])
            if (number_[w] == kOpen) {
              number_[w] = number;
              patch.push_back(w);
            }
      std::sort(patch.begin(), patch.end());
    }
  }

  /// Drops the patches for which is_dropped(patch, number) is true. Numbers are those before any is dropped.
  template <class Predicate>
  void drop_if(Predicate&& is_dropped) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < patches_.size(); ++i) {
      const bool dropped = is_dropped(patches_[i], i);
      for (const auto v : patches_[i]) number_[v] = dropped ? kNone : kept;
      if (dropped) continue;
      if (kept != i) patches_[kept] = std::move(patches_[i]);
      ++kept;
    }
    patches_.resize(kept);
    std::erase_if(vertices_, [&](std::uint32_t v) { return number_[v] == kNone; });
  }

  void clear() {
    for (const auto v : vertices_) number_[v] = kNone;
    vertices_.clear();
    patches_.clear();
  }

  std::size_t count() const { return patches_.size(); }
  /// The vertices of a patch, sorted.
  const Indices& operator[](std::size_t patch) const { return patches_[patch]; }
  /// The number of the patch that a vertex is in; kNone if it is in none.
  std::uint32_t of(std::uint32_t vertex) const { return number_[vertex]; }
  /// The vertices of all patches, sorted.
  const Indices& vertices() const { return vertices_; }

 private:
  const Surface& surface_;
  std::vector<std::uint32_t> number_;
  std::vector<Indices> patches_;
  Indices vertices_;
};

}  // namespace vdb_offset
