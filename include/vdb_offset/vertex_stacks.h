// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// The positions of vertices in each layer, from the wall outward: one stack for each vertex.
class VDB_OFFSET_API VertexStacks {
 public:
  VertexStacks() = default;
  /// Positions are not set: memory is first touched by the threads that set them, in parallel.
  VertexStacks(std::size_t vertices, std::size_t layers)
      : vertices_(vertices),
        layers_(layers),
        positions_(std::make_unique_for_overwrite<Vec3d[]>(vertices * (layers + 1))) {}

  VertexStacks(const VertexStacks& other) : VertexStacks(other.vertices_, other.layers_) {
    std::copy_n(other.positions_.get(), vertices_ * (layers_ + 1), positions_.get());
  }
  VertexStacks(VertexStacks&&) = default;
  VertexStacks& operator=(const VertexStacks& other) { return *this = VertexStacks(other); }
  VertexStacks& operator=(VertexStacks&&) = default;
  ~VertexStacks() = default;

  std::size_t vertices() const { return vertices_; }
  std::size_t layers() const { return layers_; }
  /// The stack of a vertex, world coordinates: layers() + 1 positions, the first of them on the wall.
  std::span<Vec3d> of(std::size_t vertex) { return {positions_.get() + vertex * (layers_ + 1), layers_ + 1}; }
  std::span<const Vec3d> of(std::size_t vertex) const {
    return {positions_.get() + vertex * (layers_ + 1), layers_ + 1};
  }
  /// Whether all layers of a vertex are at one position.
  bool is_flat(std::size_t vertex) const { return of(vertex).front() == of(vertex).back(); }

 private:
  std::size_t vertices_ = 0, layers_ = 0;
  std::unique_ptr<Vec3d[]> positions_;
};

/// The stacks of a mesh's vertices, of which several may share one.
class VDB_OFFSET_API SharedStacks {
 public:
  SharedStacks() = default;
  /// \param stack of each vertex: the index of its stack
  SharedStacks(VertexStacks stacks, std::vector<std::uint32_t> stack)
      : stacks_(std::move(stacks)), stack_(std::move(stack)) {}

  std::size_t vertices() const { return stack_.size(); }
  std::size_t layers() const { return stacks_.layers(); }
  std::span<const Vec3d> of(std::size_t vertex) const { return stacks_.of(stack_[vertex]); }
  bool is_flat(std::size_t vertex) const { return stacks_.is_flat(stack_[vertex]); }

  /// The positions of all vertices in one layer, 0 for the wall.
  std::vector<Vec3d> surface(std::size_t layer) const;

 private:
  VertexStacks stacks_;
  std::vector<std::uint32_t> stack_;
};

}  // namespace vdb_offset
