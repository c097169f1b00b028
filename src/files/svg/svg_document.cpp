// SPDX-License-Identifier: Apache-2.0
// Reads the elements of a drawing by expat.
#include "svg/svg_document.h"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <exception>
#include <memory>
#include <new>
#include <utility>

#include "bytes/scanner.h"
#include "drawing/transform.h"
#include "ground/system/memory.h"

namespace vdb_offset::io {
namespace {

struct KnownElement {
  std::string_view name;
  SvgKind kind;
  std::string_view geometry;
};
constexpr KnownElement kKnownElements[] = {{"svg", SvgKind::Drawing, "width height viewBox preserveAspectRatio"},
                                           {"defs", SvgKind::Hidden, ""},
                                           {"clipPath", SvgKind::Hidden, ""},
                                           {"mask", SvgKind::Hidden, ""},
                                           {"marker", SvgKind::Hidden, ""},
                                           {"pattern", SvgKind::Hidden, ""},
                                           {"symbol", SvgKind::Symbol, "viewBox preserveAspectRatio"},
                                           {"use", SvgKind::Use, "href x y width height"},
                                           {"path", SvgKind::Path, "d"},
                                           {"polyline", SvgKind::Polyline, "points"},
                                           {"polygon", SvgKind::Polygon, "points"},
                                           {"line", SvgKind::Line, "x1 y1 x2 y2"},
                                           {"rect", SvgKind::Rect, "x y width height rx ry"},
                                           {"circle", SvgKind::Circle, "cx cy r"},
                                           {"ellipse", SvgKind::Ellipse, "cx cy rx ry"}};
constexpr std::string_view kCommonAttributes = "id transform style display fill stroke";
// What expat puts between the namespace of an element and its name.
constexpr char kNamespaceEnd = '|';

/// Reads elements, called by expat for the beginning and the end of each.
class ElementReader {
 public:
  ElementReader(const SvgDocument& document, std::vector<SvgElement>& elements)
      : document_(document),
        text_(document.text()),
        elements_(elements),
        parser_(XML_ParserCreateNS(nullptr, kNamespaceEnd), XML_ParserFree) {
    if (!parser_) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* self, const char* name, const char** attributes) {
          static_cast<ElementReader*>(self)->guarded([&](ElementReader& reader) { reader.begin(name, attributes); });
        },
        [](void* self, const char*) { static_cast<ElementReader*>(self)->end(); });
  }

  void run() {
    for (const char* const mark : {"\xff\xfe", "\xfe\xff"})
      if (text_.starts_with(mark)) document_.fail_at(0, "a drawing in UTF-8", "UTF-16");
    constexpr std::size_t kChunk = 1 << 26;  // bytes that expat gets at a time: it counts them in an int
    for (std::size_t at = 0; at < text_.size() || at == 0; at += kChunk) {
      const std::string_view chunk = text_.substr(at, kChunk);
      const bool last = at + kChunk >= text_.size();
      if (XML_Parse(parser_.get(), chunk.data(), static_cast<int>(chunk.size()), last) == XML_STATUS_OK) continue;
      if (thrown_) std::rethrow_exception(thrown_);
      document_.fail_at(here(), "XML", fmt::format("'{}'", XML_ErrorString(XML_GetErrorCode(parser_.get()))));
    }
  }

 private:
  /// Calls act() and keeps what it throws: no exception may pass through expat, which is C.
  template <class Do>
  void guarded(Do&& act) {
    try {
      act(*this);
    } catch (...) {
      thrown_ = std::current_exception();
      XML_StopParser(parser_.get(), XML_FALSE);
    }
  }

  std::size_t here() const { return static_cast<std::size_t>(XML_GetCurrentByteIndex(parser_.get())); }
  std::size_t behind() const {
    return std::min(text_.size(), here() + static_cast<std::size_t>(XML_GetCurrentByteCount(parser_.get())));
  }

  void begin(std::string_view name, const char** attributes) {
    held_.add();
    SvgElement element;
    element.parent = open_.empty() ? 0 : open_.back();
    element.begin = here();
    element.tag_end = behind();
    bool foreign = false;
    if (const std::size_t end = name.rfind(kNamespaceEnd); end != std::string_view::npos) {
      foreign = name.substr(0, end) != "http://www.w3.org/2000/svg";
      name.remove_prefix(end + 1);
    }
    for (const KnownElement& known : kKnownElements)
      if (name == known.name) element.kind = known.kind;
    if (open_.empty() && (element.kind != SvgKind::Drawing || foreign))
      document_.fail_at(here(), "an element 'svg'", fmt::format("'{}'", name));
    if (foreign) element.kind = SvgKind::Foreign;
    else take_attributes(element, attributes);
    open_.push_back(static_cast<std::uint32_t>(elements_.size()));
    elements_.push_back(std::move(element));
  }

  void take_attributes(SvgElement& element, const char** attributes) const {
    const std::string_view wanted = svg_geometry(element.kind);
    for (const char** a = attributes; *a; a += 2) {
      std::string_view name = a[0];
      if (name == "http://www.w3.org/1999/xlink|href") name = "href";
      if (!holds_name(wanted, name) && !holds_name(kCommonAttributes, name)) continue;
      constexpr std::size_t kLarge = 1 << 20;  // bytes; smaller values are not worth asking the system about
      const std::size_t size = std::string_view(a[1]).size();
      if (size > kLarge) require_memory(size, document_.path());
      // Of both kinds of reference the one without a namespace counts, whichever comes first.
      const bool comes_first = name == "href" && name == a[0];
      element.attributes.insert(comes_first ? element.attributes.begin() : element.attributes.end(),
                                {std::string(name), std::string(a[1], size)});
    }
  }

  /// Ends an element. expat also calls it for an empty element for which begin() has failed.
  void end() {
    if (thrown_) return;
    SvgElement& element = elements_[open_.back()];
    open_.pop_back();
    element.subtree_end = static_cast<std::uint32_t>(elements_.size());
    const bool has_tag = text_.substr(here(), 2) == "</";
    element.end_tag = has_tag ? here() : element.tag_end;
    element.end = has_tag ? behind() : element.tag_end;
  }

  const SvgDocument& document_;
  std::string_view text_;
  std::vector<SvgElement>& elements_;
  std::unique_ptr<XML_ParserStruct, decltype(&XML_ParserFree)> parser_;
  std::exception_ptr thrown_;
  std::vector<std::uint32_t> open_;
  MemoryWatch held_{document_.path(), sizeof(SvgElement)};
};

}  // namespace

std::string_view svg_geometry(SvgKind kind) {
  for (const KnownElement& known : kKnownElements)
    if (kind == known.kind) return known.geometry;
  return {};
}

const std::string* SvgElement::value(std::string_view name) const {
  for (const Attribute& attribute : attributes)
    if (attribute.name == name) return attribute.value == "none" ? nullptr : &attribute.value;
  return nullptr;
}

std::vector<SvgTagAttribute> svg_tag_attributes(std::string_view text, const SvgElement& element) {
  std::vector<SvgTagAttribute> found;
  if (text.substr(element.begin, 1) != "<") return found;
  std::size_t at = element.begin + 1;
  const std::size_t end = element.tag_end;
  const auto skip = [&](auto&& while_so) {
    while (at < end && while_so(text[at])) ++at;
  };
  // expat has checked the tag's form.
  skip([](char c) { return !is_svg_space(c); });
  while (at < end) {
    const std::size_t blank = at;
    skip(is_svg_space);
    const std::size_t name = at;
    skip([](char c) { return c != '=' && !is_svg_space(c); });
    const std::string_view word = text.substr(name, at - name);
    skip([](char c) { return c != '"' && c != '\''; });
    if (at >= end) break;
    const char quote = text[at++];
    const std::size_t value = at;
    skip([&](char c) { return c != quote; });
    found.push_back({word, blank, name, ++at, value});
  }
  return found;
}

SvgDocument::SvgDocument(const std::string& path, std::string_view text) : path_(path), text_(text) {
  ElementReader(*this, elements_).run();
  for (std::uint32_t e = 0; e < elements_.size(); ++e)
    if (const std::string* const id = elements_[e].value("id")) by_id_.emplace(*id, e);
}

const SvgElement* SvgDocument::with_id(const std::string& id) const {
  const auto found = by_id_.find(id);
  return found == by_id_.end() ? nullptr : &elements_[found->second];
}

void SvgDocument::fail_at(std::uint64_t at, const std::string& expected, const std::string& found) const {
  Scanner(path_, text_).fail_with(expected, found, std::min<std::size_t>(at, text_.size()));
}

namespace {

/// A property of the outermost element. What a style declares goes before an attribute.
std::string_view property_of(const SvgElement& svg, std::string_view name) {
  if (const auto* const style = svg.value("style"))
    if (const auto declared = declared_in(*style, name)) return declared->value;
  const std::string* const value = svg.value(name);
  return value ? std::string_view(*value) : std::string_view();
}

/// A width or height in micrometres: 0 for one that follows from the other one, none for one that cannot be known.
std::optional<double> size_in_micrometres(std::string_view text) {
  while (!text.empty() && is_svg_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_svg_space(text.back())) text.remove_suffix(1);
  if (text.empty() || text == "auto") return 0;
  std::size_t digits = text.size();
  while (digits > 0 && (std::isalpha(static_cast<unsigned char>(text[digits - 1])) != 0 || text[digits - 1] == '%'))
    --digits;
  const std::string_view name = digits == text.size() ? std::string_view("px") : text.substr(digits);
  double number = 0;
  if (!parse_double(text.substr(0, digits), number) || !(number > 0)) return std::nullopt;
  for (const SvgUnit& unit : kSvgUnits)
    if (name == unit.name) return number * unit.micrometres;
  return std::nullopt;
}

/// The width and height of a viewBox; none for what is no four numbers, or has no extent.
std::optional<Vec2d> extent_of_view(std::string_view text) {
  double numbers[4] = {};
  for (double& number : numbers) {
    while (!text.empty() && (is_svg_space(text.front()) || text.front() == ',')) text.remove_prefix(1);
    std::size_t end = 0;
    while (end < text.size() && !is_svg_space(text[end]) && text[end] != ',') ++end;
    if (!parse_double(text.substr(0, end), number)) return std::nullopt;
    text.remove_prefix(end);
  }
  if (!(numbers[2] > 0 && numbers[3] > 0)) return std::nullopt;
  return Vec2d(numbers[2], numbers[3]);
}

}  // namespace

std::optional<double> svg_unit_micrometres(const SvgDocument& document) {
  const SvgElement& svg = document.elements().front();
  if (!svg.value("viewBox")) return kSvgUnits[0].micrometres;
  const std::optional<Vec2d> extent = extent_of_view(*svg.value("viewBox"));
  const std::optional<double> width = size_in_micrometres(property_of(svg, "width")),
                              height = size_in_micrometres(property_of(svg, "height"));
  if (!extent || !width || !height || *width + *height == 0) return std::nullopt;
  const double x = *width / (*extent)[0], y = *height / (*extent)[1], smaller = std::min(x, y), larger = std::max(x, y);
  if (smaller == 0) return larger;
  const bool is_stretched = std::any_of(svg.attributes.begin(), svg.attributes.end(), [](const auto& each) {
    return each.name == "preserveAspectRatio" && each.value.starts_with("none");
  });
  constexpr double kAlike = 1e-3;  // sizes are often written with three or four digits
  if (is_stretched) return larger - smaller <= kAlike * larger ? std::optional(x) : std::nullopt;
  const std::string* const fit = svg.value("preserveAspectRatio");
  return fit && fit->find("slice") != std::string::npos ? larger : smaller;
}

std::vector<SvgElement> SvgDocument::take_elements() && {
  for (SvgElement& element : elements_) element.attributes = {};
  return std::move(elements_);
}

}  // namespace vdb_offset::io
