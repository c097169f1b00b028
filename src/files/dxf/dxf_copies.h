// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "dxf/dxf.h"
#include "dxf/dxf_writer.h"

namespace vdb_offset::io {

/// Writes entities in the place of those that a file has, with what they have beside their form: layer, colour, line
/// type, handle, owner, extended data.
class DxfCopies {
 public:
  DxfCopies(const DxfText& text, const DxfDrawing& drawing, std::string_view line_end)
      : text_(text), drawing_(drawing), line_end_(line_end), last_handle_(drawing.document.highest_handle) {}

  /// Appends a polyline in the place of a shape: a LWPOLYLINE if the file's version has these and all points are in a
  /// plane z = constant, else a POLYLINE. A LINE that an INSERT shows becomes a LINE.
  void append(std::string& made, const DxfDrawing::Shape& shape, std::span<const Vec3d> points, bool closed);

  /// The last handle that has been given.
  std::uint64_t last_handle() const { return last_handle_; }

 private:
  /// What an entity has beside its form, as groups.
  struct Common {
    std::string before, extended;  ///< In front of what its form is told by, and behind it.
    std::string height;            ///< Its thickness, if it has one.
    std::string layer;
    bool is_modern = false;  ///< Says what classes it is made of, as entities do from R13 on.
  };

  Common common_of(const DxfDrawing::Shape& shape);
  void add_own(Common& common, const DxfEntity& entity) const;
  void add_copied(Common& common, const DxfDrawing::Shape& shape);
  void append_light(DxfWriter& writer, const DxfDrawing::Shape& shape, const Common& common,
                    std::span<const Vec3d> points, bool closed) const;
  void append_heavy(DxfWriter& writer, const DxfDrawing::Shape& shape, const Common& common,
                    std::span<const Vec3d> points, bool closed);
  void append_part(DxfWriter& writer, std::string_view type, const Common& common);
  std::string_view inherited(const DxfDrawing::Shape& shape, int code, std::string_view by_block) const;
  std::string_view value_of(std::uint32_t entity, int code) const;
  int line_type_flag(const DxfDrawing::Shape& shape) const;
  std::string next_handle();

  const DxfText& text_;
  const DxfDrawing& drawing_;
  std::string_view line_end_;
  std::uint64_t last_handle_;
};

}  // namespace vdb_offset::io
