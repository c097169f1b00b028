// SPDX-License-Identifier: Apache-2.0
// Finds what of a drawing is drawn where: transforms, what is hidden, and what `use` shows.
#include "svg/svg_uses.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bytes/append_number.h"
#include "drawing/transform.h"
#include "ground/system/memory.h"
#include "svg/svg_outline.h"

namespace vdb_offset::io {
namespace {

constexpr std::string_view kMovingProperties = "transform translate rotate scale";

/// Goes through the elements in the order in which they are drawn.
class UseResolver {
 public:
  explicit UseResolver(const SvgDocument& document) : document_(document), elements_(document.elements()) {}

  SvgDrawing run() {
    visit(0, kSvgIdentity, SvgDrawing::kNoUse);
    return std::move(drawing_);
  }

 private:
  /// Draws an element and what is in it: as `use` shows it, or the whole drawing.
  void visit(std::uint32_t first, const SvgMatrix& to_drawing, std::uint32_t use) {
    active_.push_back(first);
    const std::uint32_t end = elements_[first].subtree_end;
    constexpr std::size_t kMany = 1 << 14;  // elements; fewer are not worth asking the system about
    if (end - first > kMany) require_memory((end - first) * sizeof(SvgMatrix), document_.path());
    std::vector<SvgMatrix> inside(end - first);  // of each element, what is in it
    for (std::uint32_t e = first; e < end;) {
      const SvgElement& element = elements_[e];
      const bool is_target = e == first && use != SvgDrawing::kNoUse;
      if (!is_shown(element, is_target)) {
        e = element.subtree_end;
        continue;
      }
      if (element.kind == SvgKind::Drawing && e > 0)
        document_.fail_at(element.begin, "one element 'svg'", "another one in it");
      SvgMatrix& matrix = inside[e - first];
      matrix = product(e == first ? to_drawing : inside[element.parent - first],
                       own_transform(element, is_target ? use : SvgDrawing::kNoUse));
      if (element.kind == SvgKind::Use) draw_use(e, matrix, use);
      else if (is_svg_shape(element.kind)) draw_shape(e, matrix, use);
      const bool is_whole = element.kind == SvgKind::Use || is_svg_shape(element.kind);  // nothing in it is drawn
      e = is_whole ? element.subtree_end : e + 1;
    }
    active_.pop_back();
  }

  /// Whether an element is drawn, as far as it says itself; a symbol is where a `use` refers to it.
  static bool is_shown(const SvgElement& element, bool is_target) {
    if (element.kind == SvgKind::Foreign || element.kind == SvgKind::Hidden || is_none(element, "display"))
      return false;
    if (element.kind == SvgKind::Symbol) return is_target;
    return !is_svg_shape(element.kind) || !is_none(element, "fill") || !is_none(element, "stroke");
  }

  /// Whether a property of the element's own is 'none'. A style goes before an attribute.
  static bool is_none(const SvgElement& element, std::string_view property) {
    if (const auto* const style = element.value("style"))
      if (const auto declared = declared_in(*style, property)) return declared->value == "none";
    return std::any_of(element.attributes.begin(), element.attributes.end(),
                       [&](const auto& each) { return each.name == property && each.value == "none"; });
  }

  /// The transform of an element's own attributes.
  SvgMatrix own_transform(const SvgElement& element, std::uint32_t shown_by) {
    if (const auto* const style = element.value("style"))
      if (declared_in(*style, kMovingProperties))
        document_.fail_at(element.begin, "transforms that are attributes", "one in a style");
    const std::string* const transform = element.value("transform");
    SvgMatrix own =
        transform ? parse_transform(scan_value(document_, element, *transform, "a transform")) : kSvgIdentity;
    if (element.kind == SvgKind::Use) own = product(own, shift_of(element));
    if (element.kind == SvgKind::Symbol && shown_by != SvgDrawing::kNoUse)
      own = product(own, fit_of(element, elements_[drawing_.uses[shown_by].element]));
    return own;
  }

  SvgMatrix shift_of(const SvgElement& use) const {
    const double x = length_of(document_, use, "x");
    return {1, 0, 0, 1, x, length_of(document_, use, "y")};
  }

  void draw_shape(std::uint32_t e, const SvgMatrix& to_drawing, std::uint32_t use) {
    const SvgElement& shape = elements_[e];
    const std::string_view geometry = svg_geometry(shape.kind);
    bool has_any = false;
    for (const SvgElement::Attribute& attribute : shape.attributes)
      has_any = has_any || (holds_name(geometry, attribute.name) && shape.value(attribute.name));
    if (!has_any) return;
    if (const auto* const style = shape.value("style"))
      if (const auto declared = declared_in(*style, geometry))
        document_.fail_at(shape.begin, "the geometry of shapes in attributes",
                          fmt::format("'{}' in a style", declared->name));
    if (!has_inverse(to_drawing)) document_.fail_at(shape.begin, "a transform that can be undone", "one that flattens");
    require_in_tag(shape, geometry);
    held_.add();
    drawing_.shapes.push_back({e, use, to_drawing, 0, 0});
  }

  /// Attributes that are written anew have to be in the tag itself.
  void require_in_tag(const SvgElement& element, std::string_view names) const {
    const std::vector<SvgTagAttribute> tag = svg_tag_attributes(document_.text(), element);
    for (const SvgElement::Attribute& attribute : element.attributes) {
      if (!holds_name(names, attribute.name)) continue;
      const bool is_there = std::any_of(tag.begin(), tag.end(), [&](const SvgTagAttribute& each) {
        return each.name == attribute.name || (attribute.name == "href" && each.name.ends_with(":href"));
      });
      if (!is_there)
        document_.fail_at(element.begin, fmt::format("an attribute '{}' in the element itself", attribute.name),
                          "one that a DTD declares");
    }
  }

  void draw_use(std::uint32_t e, const SvgMatrix& to_drawing, std::uint32_t outer) {
    const SvgElement& use = elements_[e];
    const std::string* const reference = use.value("href");
    if (!reference) return;
    const std::uint32_t target = target_of(use, *reference);
    require_in_tag(use, "href transform");
    require_within_limits(use, target);
    const auto number = static_cast<std::uint32_t>(drawing_.uses.size());
    held_.add();
    drawing_.uses.push_back({e, target, outer, 0, drawing_.shapes.size(), 0, as_text(shift_of(use)), {}});
    if (elements_[target].kind == SvgKind::Symbol) {
      require_in_tag(elements_[target], "transform");
      drawing_.uses[number].fit = as_text(fit_of(elements_[target], use));
    }
    visit(target, to_drawing, number);
    drawing_.uses[number].end_shape = drawing_.shapes.size();
    drawing_.uses[number].end_use = static_cast<std::uint32_t>(drawing_.uses.size());
    if (drawing_.uses[number].first_shape == drawing_.shapes.size()) drawing_.uses.resize(number);  // it shows no shape
  }

  std::uint32_t target_of(const SvgElement& use, const std::string& reference) const {
    if (!reference.starts_with('#'))
      document_.fail_at(use.begin, "a reference to an element of this file, as '#id'",
                        fmt::format("'{}' in a 'use'", reference.substr(0, kShownReference)));
    const SvgElement* const target = document_.with_id(reference.substr(1));
    if (!target)
      document_.fail_at(
          use.begin,
          fmt::format("an element with the id '{}', which a 'use' refers to", reference.substr(1, kShownReference)),
          "none");
    return static_cast<std::uint32_t>(target - elements_.data());
  }

  void require_within_limits(const SvgElement& use, std::uint32_t target) {
    constexpr std::size_t kMostElements = 1'000'000;  // shown by all 'use' together; drawings have thousands
    constexpr std::size_t kDeepest = 100;             // each is a call of visit(), and one more of the writer
    if (std::find(active_.begin(), active_.end(), target) != active_.end())
      document_.fail_at(use.begin, "a 'use' of something else than what it is part of", "a circle of references");
    shown_elements_ += elements_[target].subtree_end - target;
    if (active_.size() > kDeepest || shown_elements_ > kMostElements)
      document_.fail_at(use.begin, fmt::format("'use' of {} elements at most, {} deep", kMostElements, kDeepest),
                        "more");
  }

  /// What the viewBox of a symbol makes of it within the width and height of the `use` that shows it.
  SvgMatrix fit_of(const SvgElement& symbol, const SvgElement& use) const {
    const std::string* const view = symbol.value("viewBox");
    if (!view) return kSvgIdentity;
    SvgValueScanner box = scan_value(document_, symbol, *view, "a viewBox");
    double from[4] = {};
    for (double& number : from) number = box.number("four numbers");
    const double size[] = {length_of(document_, use, "width"), length_of(document_, use, "height")};
    if (!(from[2] > 0 && from[3] > 0 && size[0] > 0 && size[1] > 0))
      document_.fail_at(use.begin, "a width and a height above 0 where a 'use' shows a symbol with a viewBox",
                        "others, or none");
    const std::string* const given = symbol.value("preserveAspectRatio");
    const std::string_view how = given ? std::string_view(*given) : "xMidYMid meet";
    double scale[] = {size[0] / from[2], size[1] / from[3]};
    // value() gives no 'none', so it is looked for among the attributes.
    const bool stretched = std::any_of(symbol.attributes.begin(), symbol.attributes.end(), [](const auto& each) {
      return each.name == "preserveAspectRatio" && each.value.starts_with("none");
    });
    if (!stretched) {
      const bool slices = how.find("slice") != std::string_view::npos;
      scale[0] = scale[1] = slices ? std::max(scale[0], scale[1]) : std::min(scale[0], scale[1]);
    }
    const auto share = [&](std::string_view least, std::string_view most) {
      return how.find(least) != std::string_view::npos ? 0 : how.find(most) != std::string_view::npos ? 1 : 0.5;
    };
    const double shares[] = {share("xMin", "xMax"), share("YMin", "YMax")};
    const auto shift = [&](int k) { return shares[k] * (size[k] - from[2 + k] * scale[k]) - from[k] * scale[k]; };
    return {scale[0], 0, 0, scale[1], shift(0), shift(1)};
  }

  /// A transform as the attribute has it; empty if it does nothing.
  static std::string as_text(const SvgMatrix& m) {
    if (m == kSvgIdentity) return {};
    const bool shifts = m[0] == 1 && m[1] == 0 && m[2] == 0 && m[3] == 1;
    std::string text = shifts ? "translate(" : "matrix(";
    for (std::size_t k = shifts ? 4 : 0; k < m.size(); ++k) {
      if (text.back() != '(') text += ',';
      append_number(text, m[k]);
    }
    return text += ')';
  }

  static constexpr std::size_t kShownReference = 40;  // characters of a reference that a message shows

  const SvgDocument& document_;
  const std::vector<SvgElement>& elements_;
  SvgDrawing drawing_;
  std::vector<std::uint32_t> active_;  // elements that are being drawn: the drawing, and what `use` shows
  std::size_t shown_elements_ = 0;
  MemoryWatch held_{document_.path(), sizeof(SvgDrawing::Use)};
};

}  // namespace

SvgDrawing resolve_uses(const SvgDocument& document) { return UseResolver(document).run(); }

}  // namespace vdb_offset::io
