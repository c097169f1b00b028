// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "gltf/buffers.h"
#include "gltf/json.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset::io::gltf {

enum class Component : std::uint16_t { I8 = 5120, U8 = 5121, I16 = 5122, U16 = 5123, U32 = 5125, Float = 5126 };

/// Elements of a buffer, all of which are within it.
struct Accessor {
  std::size_t index = 0, buffer = 0;
  std::uint64_t begin = 0;  ///< The first element's byte in the buffer.
  std::uint64_t stride = 0, count = 0;
  Component component = Component::Float;
  std::uint32_t width = 1;  ///< Components of an element.
  bool normalized = false;
  std::string_view bytes;  ///< The buffer's.

  std::uint64_t element_bytes() const;
  std::uint64_t at(std::uint64_t i) const { return begin + i * stride; }
  float single(std::uint64_t i, std::uint32_t k) const {
    float value = 0;
    std::memcpy(&value, bytes.data() + at(i) + k * sizeof value, sizeof value);
    return value;
  }
  Vec3d vector(std::uint64_t i) const { return {single(i, 0), single(i, 1), single(i, 2)}; }
  std::uint32_t whole(std::uint64_t i, std::uint32_t k) const;
  /// A component as a number: normalized ones from 0 to 1, or from -1.
  double number(std::uint64_t i, std::uint32_t k) const;
};

/// The accessors of a file.
class Accessors {
 public:
  /// The buffers outlive this, and the accessors.
  Accessors(const JsonValue& root, std::span<const Buffer> buffers);

  std::size_t size() const { return list_.size(); }
  std::size_t index_of(const JsonValue& index) const { return list_.index_of(index); }
  JsonValue value(std::size_t index) const { return list_[index]; }

  /// \throw InvalidInput for an accessor whose elements are not all there, are sparse or are none
  Accessor read(std::size_t index) const;
  /// As read(), for one of floats: VEC3, VEC4.
  Accessor read_floats(std::size_t index, const char* what, std::uint32_t width) const;
  /// None for what read() would refuse.
  std::optional<Accessor> read_if_can(std::size_t index) const;
  bool is_sparse(std::size_t index) const { return list_[index].find("sparse").has_value(); }

  /// \throw InvalidInput if an element of a rewritten accessor shares bytes with one of another accessor, or with a
  /// view of something else
  void require_apart(const std::vector<Accessor>& rewritten) const;

 private:
  struct Range;
  std::vector<Range> all_ranges(const std::vector<Accessor>& rewritten) const;
  void add_sparse_views(std::size_t index, std::vector<Range>& ranges) const;
  [[noreturn]] void fail_together(const Range& a, const Range& b) const;

  JsonList list_, views_;
  JsonValue root_;
  std::span<const Buffer> buffers_;
};

}  // namespace vdb_offset::io::gltf
