// SPDX-License-Identifier: Apache-2.0
// Writes a drawing again with points at other positions.
#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bytes/append_number.h"
#include "ground/system/assert.h"
#include "svg/svg.h"

namespace vdb_offset::io {
namespace {

/// Bytes of the file that others take the place of.
struct Edit {
  std::uint64_t begin, end;
  std::string text;
};

/// The points of a drawing, of which some have moved.
struct MovedPoints {
  const SvgDrawing& drawing;
  const CurvesView& source;
  std::span<const Vec3d> positions;
  const Rounding& precision;

  bool has_moved(std::uint32_t p) const { return positions[p] != source.positions[p]; }
  /// Whether a point of a shape has moved.
  bool has_moved(const SvgDrawing::Shape& shape) const {
    const std::size_t first = source.face_begin[shape.first_curve], end = source.face_begin[shape.end_curve];
    const auto corners = source.corners.subspan(first, end - first);
    return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t p) { return has_moved(p); });
  }

  /// Appends a point in the coordinates of its shape. Without a transform, it has the digits of the precision, as
  /// results are judged on these. With one, it has all digits, so that the point of the drawing is as exact.
  void append_own(std::string& text, const SvgDrawing::Shape& shape, std::uint32_t p) const {
    const Vec3d& at = positions[p];
    if (!has_moved(p)) append_svg_point(text, drawing.own[p]);
    else if (shape.to_drawing == kSvgIdentity) append_svg_point(text, {at[0], at[1]}, precision);
    else append_svg_point(text, transformed_back(shape.to_drawing, precision(at)));
  }

  /// The points of a shape, as the data of a path or as a list.
  std::string data_of(const SvgDrawing::Shape& shape, bool is_list) const {
    std::string text;
    for (std::size_t c = shape.first_curve; c < shape.end_curve; ++c) {
      if (c > shape.first_curve) text += ' ';
      const auto points = source.face(c);
      const bool repeats = points.size() > 1 && points.back() == points.front();
      for (std::size_t k = 0; k < points.size() - repeats; ++k) {
        if (k > 0) text += ' ';
        if (!is_list) text += k == 0 ? 'M' : 'L';
        append_own(text, shape, points[k]);
      }
      if (!is_list && drawing.closed[c]) text += " Z";
    }
    return text;
  }
};

class SvgRewriter {
 public:
  SvgRewriter(std::string_view text, const MovedPoints& moved) : text_(text), drawing_(moved.drawing), moved_(moved) {}

  std::string run() const {
    const auto& shapes = drawing_.shapes;
    if (std::none_of(shapes.begin(), shapes.end(), [&](const auto& shape) { return moved_.has_moved(shape); }))
      return std::string(text_);
    std::vector<Edit> edits;
    add_edits(edits, SvgDrawing::kNoUse, {0, shapes.size()}, {0, drawing_.uses.size()});
    return edited(0, text_.size(), std::move(edits));
  }

 private:
  using Range = std::pair<std::size_t, std::size_t>;

  /// Adds the edits of the shapes and uses that one `use` shows, or that stand in their places.
  void add_edits(std::vector<Edit>& edits, std::uint32_t use, Range shapes, Range uses) const {
    for (std::size_t s = shapes.first; s < shapes.second; ++s)
      if (drawing_.shapes[s].use == use && moved_.has_moved(drawing_.shapes[s])) edit_shape(edits, drawing_.shapes[s]);
    for (std::size_t u = uses.first; u < uses.second; u = drawing_.uses[u].end_use)
      edit_use(edits, drawing_.uses[u], u);
  }

  /// The bytes of the file from `begin` to `end` with edits.
  std::string edited(std::uint64_t begin, std::uint64_t end, std::vector<Edit> edits) const {
    // What is put in before a byte comes before what takes the place of bytes from there on.
    std::sort(edits.begin(), edits.end(),
              [](const Edit& a, const Edit& b) { return std::pair(a.begin, a.end) < std::pair(b.begin, b.end); });
    std::string made;
    for (const Edit& edit : edits) {
      made.append(text_, begin, edit.begin - begin);
      made += edit.text;
      begin = edit.end;
    }
    return made.append(text_, begin, end - begin);
  }

  void edit_shape(std::vector<Edit>& edits, const SvgDrawing::Shape& shape) const {
    const SvgElement& element = drawing_.elements[shape.element];
    const bool is_list = element.kind == SvgKind::Polyline || element.kind == SvgKind::Polygon;
    const std::string data = moved_.data_of(shape, is_list);
    const std::string_view geometry = svg_geometry(element.kind);
    if (is_list || element.kind == SvgKind::Path) {
      for (const SvgTagAttribute& each : svg_tag_attributes(text_, element))
        if (each.name == geometry) edits.push_back({each.value, each.end - 1, data});
      return;
    }
    rename(edits, element, "path");
    bool is_written = false;  // in the place of the first attribute that it replaces
    for (const SvgTagAttribute& each : svg_tag_attributes(text_, element)) {
      if (!is_written && holds_name(geometry, each.name)) {
        edits.push_back({each.begin, each.end, "d=\"" + data + '"'});
        is_written = true;
      } else if (holds_name(geometry, each.name) || each.name == "d") {
        edits.push_back({each.blank, each.end, {}});
      }
    }
  }

  /// Gives an element another name, with the prefix of its namespace.
  void rename(std::vector<Edit>& edits, const SvgElement& element, const char* name) const {
    const std::uint64_t begin = element.begin + 1 + prefix_of(element).size();
    edits.push_back({begin, end_of_name(begin), name});
    if (element.end_tag == element.end) return;
    const std::uint64_t closing = element.end_tag + 2 + prefix_of(element).size();
    edits.push_back({closing, end_of_name(closing), name});
  }

  std::uint64_t end_of_name(std::uint64_t at) const { return text_.find_first_of(" \t\r\n/>", at); }

  std::string_view prefix_of(const SvgElement& element) const {
    const std::string_view name = text_.substr(element.begin + 1, end_of_name(element.begin) - element.begin - 1);
    const std::size_t colon = name.find(':');
    return name.substr(0, colon == std::string_view::npos ? 0 : colon + 1);
  }

  /// Makes a group of a `use`, with what it shows before what it has in it.
  void edit_use(std::vector<Edit>& edits, const SvgDrawing::Use& use, std::size_t number) const {
    const SvgElement& element = drawing_.elements[use.element];
    const SvgElement& target = drawing_.elements[use.target];
    make_group(edits, element, use.shift, "x y width height href");
    std::vector<Edit> copied;
    add_edits(copied, static_cast<std::uint32_t>(number), {use.first_shape, use.end_shape}, {number + 1, use.end_use});
    if (target.kind == SvgKind::Symbol)
      make_group(copied, target, use.fit, "viewBox preserveAspectRatio x y width height refX refY");
    drop_ids(copied, use.target);
    std::string copy = edited(target.begin, target.end, std::move(copied));
    if (element.end_tag != element.end) {
      edits.push_back({element.tag_end, element.tag_end, std::move(copy)});
      return;
    }
    const std::uint64_t slash = element.tag_end - 2;
    edits.push_back({slash, element.tag_end, '>' + std::move(copy) + "</" + std::string(prefix_of(element)) + "g>"});
  }

  /// Turns an element into a group without some of its attributes, and with one more transform.
  void make_group(std::vector<Edit>& edits, const SvgElement& element, const std::string& transform,
                  std::string_view dropped) const {
    rename(edits, element, "g");
    bool is_written = transform.empty();
    for (const SvgTagAttribute& each : svg_tag_attributes(text_, element)) {
      if (each.name == "transform" && !is_written) {
        const bool is_none = text_.substr(each.value, each.end - 1 - each.value) == "none";
        edits.push_back({is_none ? each.value : each.end - 1, each.end - 1, is_none ? transform : ' ' + transform});
        is_written = true;
      } else if (holds_name(dropped, each.name) || (each.name.ends_with(":href") && holds_name(dropped, "href"))) {
        edits.push_back({each.blank, each.end, {}});
      }
    }
    if (is_written) return;
    const std::uint64_t behind_name = end_of_name(element.begin);
    edits.push_back({behind_name, behind_name, " transform=\"" + transform + '"'});
  }

  /// Drops the ids of an element and all in it, of which the copy would be a second one.
  void drop_ids(std::vector<Edit>& edits, std::uint32_t target) const {
    for (std::uint32_t e = target; e < drawing_.elements[target].subtree_end; ++e)
      for (const SvgTagAttribute& each : svg_tag_attributes(text_, drawing_.elements[e]))
        if (each.name == "id") edits.push_back({each.blank, each.end, {}});
  }

  std::string_view text_;
  const SvgDrawing& drawing_;
  const MovedPoints& moved_;
};

}  // namespace

std::string rewrite_svg(std::string_view text, const SvgDrawing& drawing, CurvesView source,
                        std::span<const Vec3d> positions, const Rounding& precision) {
  VDB_OFFSET_ASSERT(positions.size() == source.positions.size());
  const MovedPoints moved{drawing, source, positions, precision};
  return SvgRewriter(text, moved).run();
}

}  // namespace vdb_offset::io
