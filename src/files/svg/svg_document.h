// SPDX-License-Identifier: Apache-2.0
#pragma once

// The elements of an SVG drawing, in the order of the file, and where they stand there.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace vdb_offset::io {

/// What an element is for whoever looks for curves.
enum class SvgKind : std::uint8_t {
  Foreign,  ///< Of another namespace: it and all in it is passed over.
  Group,    ///< Whatever may have shapes in it, and what has none, such as text.
  Hidden,   ///< Holds what is drawn elsewhere, if at all.
  Symbol,
  Drawing,
  Use,
  Path,  // from here on: shapes
  Polyline,
  Polygon,
  Line,
  Rect,
  Circle,
  Ellipse,
};
inline bool is_svg_shape(SvgKind kind) { return kind >= SvgKind::Path; }

/// Attributes that say where an element of this kind is, beside its transform: names with blanks between them.
std::string_view svg_geometry(SvgKind kind);

struct SvgElement {
  /// The value of an attribute, with entities replaced.
  struct Attribute {
    std::string name, value;
  };

  SvgKind kind = SvgKind::Group;
  std::uint32_t parent = 0, subtree_end = 0;  ///< Elements; those in it are the ones from its own number up to the end.
  std::uint64_t begin = 0, tag_end = 0;       ///< Bytes of its start tag.
  std::uint64_t end_tag = 0, end = 0;         ///< Bytes of its end tag; of an empty element both are tag_end.
  /// Those that svg_geometry() names (of the outermost element its size and viewBox), and `id`, `transform`, `style`,
  /// `display`, `fill` and `stroke`; both kinds of `href` under this name.
  std::vector<Attribute> attributes;

  /// The value of an attribute; none if it is missing or "none".
  const std::string* value(std::string_view name) const;
};

/// Where an attribute stands in a tag.
struct SvgTagAttribute {
  std::string_view name;
  std::uint64_t blank;       ///< First byte of the white space before it.
  std::uint64_t begin, end;  ///< Bytes of its name up to the closing quote, this included.
  std::uint64_t value;       ///< First byte of its value, which ends one before `end`.
};

/// The attributes of the start tag of an element, which has to stand in the text itself; none if an entity has it.
std::vector<SvgTagAttribute> svg_tag_attributes(std::string_view text, const SvgElement& element);

class SvgDocument;

/// The length of a drawing's unit in micrometres, as the `width`, `height`, `viewBox` and `preserveAspectRatio` of its
/// outermost element give it: that of a pixel of CSS, 1/96 in, without a viewBox. None where it depends on what the
/// drawing is shown in (percent, units of a font, no size at all), and where x and y have different ones.
std::optional<double> svg_unit_micrometres(const SvgDocument& document);

/// The elements of a drawing. Keeps references to the path, which is for messages, and the text.
class SvgDocument {
 public:
  /// \throw InvalidInput for what is no XML, for UTF-16, and if the outermost element is no `svg`. OutOfBudget
  SvgDocument(const std::string& path, std::string_view text);

  const std::string& path() const { return path_; }
  std::string_view text() const { return text_; }
  const std::vector<SvgElement>& elements() const { return elements_; }
  /// The first element with this id; null if none has it.
  const SvgElement* with_id(const std::string& id) const;

  /// \throw InvalidInput with the line of a byte
  [[noreturn]] void fail_at(std::uint64_t at, const std::string& expected, const std::string& found) const;

  /// Gives the elements away, without the values of their attributes.
  std::vector<SvgElement> take_elements() &&;

 private:
  const std::string& path_;
  std::string_view text_;
  std::vector<SvgElement> elements_;
  std::unordered_map<std::string, std::uint32_t> by_id_;
};

}  // namespace vdb_offset::io
