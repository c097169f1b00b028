#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "vdb_offset/parallel.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Where vertices stand in each layer: from the wall outward, one vertex after the other.
class Stacks {
 public:
  Stacks() = default;
  /// Places are not set: who does that, in parallel, is the first to touch the memory.
  Stacks(std::size_t vertices, std::size_t layers)
      : vertices_(vertices),
        layers_(layers),
        places_(std::make_unique_for_overwrite<Vec3d[]>(vertices * (layers + 1))) {}

  std::size_t vertices() const { return vertices_; }
  std::size_t layers() const { return layers_; }
  /// World coordinates: layers() + 1 places, the first of them on the wall.
  std::span<Vec3d> of(std::size_t vertex) { return {places_.get() + vertex * (layers_ + 1), layers_ + 1}; }
  std::span<const Vec3d> of(std::size_t vertex) const { return {places_.get() + vertex * (layers_ + 1), layers_ + 1}; }
  /// Whether all of a vertex's layers are at one place.
  bool is_flat(std::size_t vertex) const { return of(vertex).front() == of(vertex).back(); }

  /// Of all vertices in one layer, 0 for the wall.
  std::vector<Vec3d> surface(std::size_t layer) const {
    std::vector<Vec3d> places(vertices_);
    for_each_index(vertices_, [&](std::size_t v) { places[v] = of(v)[layer]; });
    return places;
  }

 private:
  std::size_t vertices_ = 0, layers_ = 0;
  std::unique_ptr<Vec3d[]> places_;
};

}  // namespace vdb_offset
