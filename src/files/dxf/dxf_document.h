// SPDX-License-Identifier: Apache-2.0
#pragma once

// What a DXF file consists of, and where it stands there. The reader is our own: libraries that read and write DXF are
// under licences that would bind this one (libdxfrw and dxflib: GPL), and GDAL's OGR replaces arcs and splines by
// segments of a fixed angle, which holds no tolerance, and loses all that is no curve.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "vdb_offset/numbers.h"

namespace vdb_offset::io {

/// A code on a line of its own, and a value on the next one.
struct DxfGroup {
  int code = 0;
  std::string_view value;                             ///< Without blanks around it.
  std::uint64_t begin = 0, value_begin = 0, end = 0;  ///< Bytes: of the code's line, the value, and behind its line.

  bool is(int its_code, std::string_view its_value) const { return code == its_code && value == its_value; }
};

/// The text of a file, group by group. Keeps references to the path, which is for messages, and the text.
class DxfText {
 public:
  DxfText(const std::string& path, std::string_view text) : path_(path), text_(text) {}

  const std::string& path() const { return path_; }
  std::string_view text() const { return text_; }

  /// The group at a byte, which moves on behind it; false at the end of the text. \throw InvalidInput if a code is
  /// none, or has no value
  bool next(std::uint64_t& at, DxfGroup& group) const;
  /// Calls visit(group) for the groups between two bytes.
  template <class Visit>
  void for_each(std::uint64_t at, std::uint64_t end, Visit&& visit) const {
    for (DxfGroup group; at < end && next(at, group);) visit(group);
  }

  /// The same but for what applications keep there: groups between a code 102 with an opening brace and the next one.
  template <class Visit>
  void for_each_own(std::uint64_t at, std::uint64_t end, Visit&& visit) const {
    bool in_braces = false;
    for_each(at, end, [&](const DxfGroup& group) {
      if (group.code == 102) in_braces = group.value.starts_with('{');
      else if (group.code == 0) in_braces = false;
      if (!in_braces) visit(group);
    });
  }

  /// The value as a finite number, or as a whole one. \throw InvalidInput
  double number(const DxfGroup& group) const;
  std::int64_t integer(const DxfGroup& group) const;

  /// \throw InvalidInput with the line of a byte
  [[noreturn]] void fail_at(std::uint64_t at, const std::string& expected, const std::string& found) const;

 private:
  const std::string& path_;
  std::string_view text_;
};

enum class DxfKind : std::uint8_t { Other, Insert, Line, LwPolyline, Polyline, Arc, Circle, Ellipse, Spline };
inline bool is_dxf_curve(DxfKind kind) { return kind >= DxfKind::Line; }

struct DxfEntity {
  std::uint64_t begin = 0;     ///< Byte where its first group begins.
  std::uint64_t body_end = 0;  ///< Where its own groups end, and those of its vertices or attributes begin.
  std::uint64_t end = 0;       ///< Behind these.
  DxfKind kind = DxfKind::Other;
};

/// A definition of what INSERT shows.
struct DxfBlock {
  std::uint64_t begin = 0;
  std::uint32_t first_entity = 0, end_entity = 0;
  Vec3d base{0.0};  ///< The point that comes to stand where an INSERT is.
};

struct DxfLayer {
  bool is_off = false, is_frozen = false;
};

struct DxfDocument {
  std::vector<DxfEntity> entities;               ///< Of blocks, and of the section ENTITIES.
  std::uint32_t first_drawn = 0, end_drawn = 0;  ///< Those of ENTITIES.
  std::vector<DxfBlock> blocks;
  std::unordered_map<std::string, std::uint32_t> block_by_name;  ///< In lower case, as names are alike in any.
  std::unordered_map<std::string, DxfLayer> layers;
  int version = 0;                   ///< The number behind AC in $ACADVER: 1009 is R12, 1015 is R2000; 0: not stated.
  int units = 0;                     ///< $INSUNITS; 0: not stated.
  std::uint64_t highest_handle = 0;  ///< Of all entities and objects.
  std::uint64_t seed_begin = 0, seed_end = 0;  ///< Bytes of the next handle to give, in $HANDSEED; both 0 if missing.
};

/// A name in the form in which names are compared.
std::string dxf_key(std::string_view name);

/// Reads sections, blocks and entities. \throw InvalidInput for what is no ASCII DXF file, and for one that is cut.
/// OutOfBudget
DxfDocument read_dxf_document(const DxfText& text);

/// The unit that a number of $INSUNITS stands for, micrometres; none for 0 and for lengths of the sky.
std::optional<double> dxf_unit_micrometres(int units);

/// The unit that the header states; the sections behind it are not read. \throw InvalidInput as read_dxf_document()
std::optional<double> unit_of_dxf(const DxfText& text);

}  // namespace vdb_offset::io
