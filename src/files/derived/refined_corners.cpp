// SPDX-License-Identifier: Apache-2.0
#include "derived/refined_corners.h"

#include <fmt/format.h>

#include <algorithm>

#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

class CornerRefiner {
 public:
  CornerRefiner(PolygonView mesh, const Refinement& refinement, std::span<const std::uint32_t> of_corner,
                std::size_t count)
      : mesh_(mesh), refinement_(refinement), of_corner_(of_corner), count_(count), finder_(mesh) {}

  RefinedCorners run() {
    if (of_corner_.empty()) return {};
    const std::vector<std::uint32_t> first = first_pieces(mesh_, refinement_);
    last_.assign(refinement_.added.size(), kNone);
    refined_.of_corner.reserve(refinement_.polygons.corners.size());
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
      if (is_split(mesh_, refinement_, first, f)) {
        for (std::uint32_t piece = first[f]; piece < first[f + 1]; ++piece)
          for (const std::uint32_t v : refinement_.polygons.view().face(piece))
            refined_.of_corner.push_back(value_at(f, v));
      } else {
        const auto own = of_corner_.subspan(mesh_.face_begin[f], mesh_.face(f).size());
        refined_.of_corner.insert(refined_.of_corner.end(), own.begin(), own.end());
      }
    }
    return std::move(refined_);
  }

 private:
  std::uint32_t value_at(std::size_t face, std::uint32_t v) {
    const std::size_t source_vertices = refinement_.source_vertices();
    if (v < source_vertices) return value_of_source(face, v);
    const auto added = static_cast<std::uint32_t>(v - source_vertices);
    const VertexOrigin& origin = refinement_.added[added];
    RefinedCorners::Between value{added, {kNone, kNone, kNone}};
    std::uint32_t known = kNone;
    bool are_same = true;
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(origin.share[k] > 0)) continue;
      value.of[k] = value_of_source(face, origin.vertex[k]);
      if (value.of[k] == kNone) return kNone;
      are_same = are_same && (known == kNone || known == value.of[k]);
      known = value.of[k];
    }
    return are_same ? known : number_of(value);
  }

  std::uint32_t value_of_source(std::size_t face, std::uint32_t v) { return of_corner_[finder_.at(face, v)]; }

  /// The number of an interpolated value, a new one unless there is one like it.
  std::uint32_t number_of(const RefinedCorners::Between& value) {
    std::uint32_t& last = last_[value.added];
    for (std::uint32_t i = last; i != kNone; i = before_[i])
      if (refined_.added[i].of == value.of) return static_cast<std::uint32_t>(count_) + i;
    before_.push_back(last);
    last = static_cast<std::uint32_t>(refined_.added.size());
    refined_.added.push_back(value);
    return static_cast<std::uint32_t>(count_) + last;
  }

  PolygonView mesh_;
  const Refinement& refinement_;
  std::span<const std::uint32_t> of_corner_;
  std::size_t count_;
  CornerFinder finder_;
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

RefinedCorners refine_corners(PolygonView mesh, const Refinement& refinement, std::span<const std::uint32_t> of_corner,
                              std::size_t count) {
  return CornerRefiner(mesh, refinement, of_corner, count).run();
}

std::vector<std::uint32_t> first_pieces(PolygonView mesh, const Refinement& refinement) {
  std::vector<std::uint32_t> first(mesh.face_count() + 1, 0);
  for (const std::uint32_t face : refinement.parent) ++first[face + 1];
  for (std::size_t f = 0; f < mesh.face_count(); ++f) first[f + 1] += first[f];
  return first;
}

bool is_split(PolygonView mesh, const Refinement& refinement, std::span<const std::uint32_t> first_piece,
              std::size_t face) {
  return first_piece[face + 1] - first_piece[face] != 1 ||
         !std::ranges::equal(refinement.polygons.view().face(first_piece[face]), mesh.face(face));
}

}  // namespace vdb_offset::io
