// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "ground/numbers/rounding.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/polygons.h"

/// Splits edges at their midpoints, and triangles at a point inside. A face around a split edge becomes triangles
/// around the midpoint of its first one.
class Splitter {
 public:
  using Edge = std::pair<std::uint32_t, std::uint32_t>;

  explicit Splitter(const vdb_offset::io::MeshFile& file) : mesh_(file.polygons), precision_(file.precision) {
    refined_.polygons.positions = mesh_.positions;
  }

  Splitter& edge(std::uint32_t a, std::uint32_t b) {
    midpoint_[std::minmax(a, b)] = vdb_offset::kNone;
    return *this;
  }
  Splitter& inside(std::uint32_t face) {
    inside_.push_back(face);
    return *this;
  }

  vdb_offset::Refinement run() {
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) add_pieces(f);
    return std::move(refined_);
  }

 private:
  std::uint32_t add_vertex(const vdb_offset::VertexOrigin& origin) {
    vdb_offset::Vec3d position(0.0);
    for (std::size_t k = 0; k < 3; ++k) position += origin.share[k] * mesh_.positions[origin.vertex[k]];
    refined_.polygons.positions.push_back(precision_(position));
    refined_.added.push_back(origin);
    return static_cast<std::uint32_t>(refined_.polygons.positions.size() - 1);
  }
  void add_pieces(std::uint32_t f) {
    const auto face = mesh_.view().face(f);
    std::vector<std::uint32_t> around;
    std::size_t first = vdb_offset::kNone;
    for (std::size_t k = 0; k < face.size(); ++k) {
      const std::uint32_t a = face[k], b = face[(k + 1) % face.size()], other = face[(k + 2) % face.size()];
      around.push_back(a);
      const auto split = midpoint_.find(std::minmax(a, b));
      if (split == midpoint_.end()) continue;
      if (split->second == vdb_offset::kNone) split->second = add_vertex({f, {a, b, other}, {0.5, 0.5, 0}});
      if (first == vdb_offset::kNone) first = around.size();
      around.push_back(split->second);
    }
    if (std::find(inside_.begin(), inside_.end(), f) != inside_.end()) {
      const std::uint32_t centre = add_vertex({f, {face[0], face[1], face[2]}, {0.5, 0.25, 0.25}});
      for (std::size_t k = 0; k < around.size(); ++k)
        add_piece(f, {centre, around[k], around[(k + 1) % around.size()]});
    } else if (first != vdb_offset::kNone) {
      std::rotate(around.begin(), around.begin() + static_cast<std::ptrdiff_t>(first), around.end());
      for (std::size_t k = 2; k < around.size(); ++k) add_piece(f, {around[0], around[k - 1], around[k]});
    } else {
      add_piece(f, around);
    }
  }
  void add_piece(std::uint32_t f, const std::vector<std::uint32_t>& corners) {
    refined_.polygons.corners.insert(refined_.polygons.corners.end(), corners.begin(), corners.end());
    refined_.polygons.close_face();
    refined_.parent.push_back(f);
  }

  const vdb_offset::Polygons& mesh_;
  vdb_offset::Rounding precision_;
  std::map<Edge, std::uint32_t> midpoint_;
  std::vector<std::uint32_t> inside_;
  vdb_offset::Refinement refined_;
};
