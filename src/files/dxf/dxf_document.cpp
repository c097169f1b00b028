// SPDX-License-Identifier: Apache-2.0
// Reads the groups, sections, blocks and entities of a DXF file.
#include "dxf/dxf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "bytes/line_records.h"
#include "bytes/scanner.h"
#include "ground/system/memory.h"

namespace vdb_offset::io {
namespace {

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

constexpr std::pair<std::string_view, DxfKind> kDxfKinds[] = {
    {"INSERT", DxfKind::Insert},     {"LINE", DxfKind::Line},    {"LWPOLYLINE", DxfKind::LwPolyline},
    {"POLYLINE", DxfKind::Polyline}, {"ARC", DxfKind::Arc},      {"CIRCLE", DxfKind::Circle},
    {"ELLIPSE", DxfKind::Ellipse},   {"SPLINE", DxfKind::Spline}};

DxfKind kind_of(std::string_view name) {
  for (const auto& [known, kind] : kDxfKinds)
    if (name == known) return kind;
  return DxfKind::Other;
}

constexpr int kEntityType = 0, kName = 2, kHandle = 5, kStyleHandle = 105, kVariable = 9, kFlags = 70, kColour = 62;

/// Goes through the file once, from its beginning to its end.
class DxfDocumentReader {
 public:
  explicit DxfDocumentReader(const DxfText& text) : text_(text), at_(byte_order_mark(text.text())) {}

  std::optional<double> unit() {
    refuse_other_formats();
    while (step() && !group_.is(kEntityType, "EOF")) {
      if (!group_.is(kEntityType, "SECTION")) continue;
      need("the name of a section");
      if (!group_.is(kName, "HEADER")) break;  // it is the first one, if there is one
      header();
    }
    return dxf_unit_micrometres(document_.units);
  }

  DxfDocument run() {
    refuse_other_formats();
    while (step()) {
      if (group_.is(kEntityType, "EOF")) return finished();
      if (group_.code == kCommentCode) continue;
      if (!group_.is(kEntityType, "SECTION")) fail("'SECTION' or 'EOF'");
      section();
    }
    return finished();
  }

 private:
  static constexpr int kCommentCode = 999;

  void refuse_other_formats() const {
    const std::string_view text = text_.text();
    constexpr std::string_view kBinary = "AutoCAD Binary DXF";
    if (text.starts_with(kBinary)) text_.fail_at(0, "a DXF file in ASCII", "a binary one (save it as ASCII)");
    if (text.starts_with("AC10")) text_.fail_at(0, "a DXF file", "a DWG file (save it as DXF)");
  }

  DxfDocument finished() {
    if (!has_entities_) text_.fail_at(text_.text().size(), "a section ENTITIES", "none");
    return std::move(document_);
  }

  /// Takes the next group. Handles are looked at wherever they are.
  bool step() {
    if (!text_.next(at_, group_)) return false;
    if (group_.code == kHandle || group_.code == kStyleHandle) {
      std::uint64_t handle = 0;
      const char* const end = group_.value.data() + group_.value.size();
      if (std::from_chars(group_.value.data(), end, handle, 16).ptr == end && handle < kHandlesEnd)
        document_.highest_handle = std::max(document_.highest_handle, handle);
    }
    return true;
  }
  /// Takes the next group, which has to be there.
  void need(const char* expected) {
    if (!step()) text_.fail_at(text_.text().size(), expected, "the end of the file");
  }
  [[noreturn]] void fail(const char* expected) const {
    text_.fail_at(group_.value_begin, expected, fmt::format("'{}'", in_short(group_.value)));
  }

  void section() {
    need("the name of a section");
    if (group_.code != kName) fail("the name of a section");
    const std::string_view name = group_.value;
    if (name == "HEADER") return header();
    if (name == "TABLES") return tables();
    if (name == "BLOCKS") return blocks();
    if (name == "ENTITIES") return drawn();
    while (!group_.is(kEntityType, "ENDSEC")) need("'ENDSEC'");
  }

  void header() {
    std::string_view variable;
    for (need("'ENDSEC'"); !group_.is(kEntityType, "ENDSEC"); need("'ENDSEC'")) {
      if (group_.code == kVariable) variable = group_.value;
      else if (variable == "$ACADVER" && group_.value.starts_with("AC"))
        std::from_chars(group_.value.data() + 2, group_.value.data() + group_.value.size(), document_.version);
      else if (variable == "$INSUNITS" && group_.code == kFlags)
        document_.units = static_cast<int>(std::clamp<std::int64_t>(text_.integer(group_), 0, 1000));
      else if (variable == "$HANDSEED" && group_.code == kHandle)
        document_.seed_begin = group_.value_begin, document_.seed_end = group_.value_begin + group_.value.size();
    }
  }

  void tables() {
    std::string name;
    DxfLayer layer;
    bool is_layer = false;
    for (need("'ENDSEC'");; need("'ENDSEC'")) {
      if (group_.code == kEntityType) {
        if (is_layer) document_.layers.insert_or_assign(std::move(name), layer);
        if (group_.value == "ENDSEC") return;
        is_layer = group_.value == "LAYER";
        name.clear(), layer = {};
      } else if (is_layer && group_.code == kName) {
        name = dxf_key(group_.value);
      } else if (is_layer && group_.code == kColour) {
        layer.is_off = text_.integer(group_) < 0;
      } else if (is_layer && group_.code == kFlags) {
        layer.is_frozen = text_.integer(group_) % 2 != 0;
      }
    }
  }

  void blocks() {
    for (need("'BLOCK' or 'ENDSEC'"); !group_.is(kEntityType, "ENDSEC");) {
      if (group_.is(kEntityType, "BLOCK")) block();
      else need("'BLOCK' or 'ENDSEC'");
    }
  }

  void block() {
    DxfBlock block;
    block.begin = group_.begin;
    std::string name;
    for (need("'ENDBLK'"); group_.code != kEntityType; need("'ENDBLK'")) {
      if (group_.code == kName) name = dxf_key(group_.value);
      else if (group_.code == 10 || group_.code == 20 || group_.code == 30)
        block.base[group_.code / 10 - 1] = text_.number(group_);
    }
    block.first_entity = static_cast<std::uint32_t>(document_.entities.size());
    while (!group_.is(kEntityType, "ENDBLK")) {
      if (group_.value == "ENDSEC" || group_.value == "BLOCK") fail("'ENDBLK'");
      entity();
    }
    block.end_entity = static_cast<std::uint32_t>(document_.entities.size());
    document_.block_by_name.emplace(std::move(name), static_cast<std::uint32_t>(document_.blocks.size()));
    append_within_limit(document_.blocks, block, text_.path().c_str());
  }

  void drawn() {
    if (has_entities_) text_.fail_at(group_.value_begin, "one section ENTITIES", "another one");
    has_entities_ = true;
    document_.first_drawn = static_cast<std::uint32_t>(document_.entities.size());
    for (need("'ENDSEC'"); group_.code != kEntityType; need("'ENDSEC'"))
      if (group_.code != kCommentCode) fail("an entity");
    while (!group_.is(kEntityType, "ENDSEC")) {
      if (group_.value == "SECTION" || group_.value == "EOF") fail("'ENDSEC'");
      entity();
    }
    document_.end_drawn = static_cast<std::uint32_t>(document_.entities.size());
  }

  /// Takes an entity, with the vertices and attributes behind it, and goes to the group behind that.
  void entity() {
    DxfEntity entity;
    entity.begin = group_.begin;
    entity.kind = kind_of(group_.value);
    bool has_more = entity.kind == DxfKind::Polyline, is_mesh = false;
    for (need("'ENDSEC'"); group_.code != kEntityType; need("'ENDSEC'"))
      if (entity.kind == DxfKind::Insert && group_.code == 66) has_more = text_.integer(group_) == 1;
      else if (entity.kind == DxfKind::Polyline && group_.code == kFlags)
        is_mesh = (text_.integer(group_) & kMesh) != 0;
    entity.body_end = group_.begin;
    if (has_more) {
      const std::string_view more = entity.kind == DxfKind::Polyline ? "VERTEX" : "ATTRIB";
      const std::string expected = fmt::format("'{}' or 'SEQEND'", more);
      for (; !group_.is(kEntityType, "SEQEND"); need(expected.c_str()))
        if (group_.code == kEntityType && group_.value != more) fail(expected.c_str());
      for (need("'ENDSEC'"); group_.code != kEntityType;) need("'ENDSEC'");
    }
    entity.end = group_.begin;
    if (is_mesh) entity.kind = DxfKind::Other;
    append_within_limit(document_.entities, entity, text_.path().c_str());
  }

  static constexpr int kMesh = 16 | 64;  // flags of a POLYLINE: a mesh of polygons, or of any faces
  // Handles have up to 16 hexadecimal digits; higher ones leave none to give.
  static constexpr std::uint64_t kHandlesEnd = std::uint64_t{1} << 62;

  const DxfText& text_;
  std::uint64_t at_;
  DxfGroup group_;
  DxfDocument document_;
  bool has_entities_ = false;
};

}  // namespace

bool DxfText::next(std::uint64_t& at, DxfGroup& group) const {
  // What ends a text may stand alone: some writers put an empty line there, and some a byte 26.
  if (at >= text_.size() || text_.find_first_not_of(" \t\r\n\x1a", at) == std::string_view::npos) return false;
  const auto line_end = [&](std::uint64_t from) {
    return std::min<std::uint64_t>(text_.find('\n', from), text_.size());
  };
  const std::uint64_t code_end = line_end(at);
  const std::string_view code = without_blanks(text_.substr(at, code_end - at));
  std::int64_t number = 0;
  constexpr std::int64_t kLeast = -1000, kMost = 10000;
  if (!parse_integer(code, number) || number < kLeast || number >= kMost)
    fail_at(at, "a group code", fmt::format("'{}'", in_short(code)));
  if (code_end + 1 > text_.size()) fail_at(text_.size(), "a value behind a group code", "the end of the file");
  const std::uint64_t value_end = line_end(code_end + 1);
  const std::string_view line = text_.substr(code_end + 1, value_end - code_end - 1);
  group.code = static_cast<int>(number);
  group.value = without_blanks(line);
  group.begin = at;
  group.value_begin =
      group.value.empty() ? code_end + 1 : static_cast<std::uint64_t>(group.value.data() - text_.data());
  at = group.end = std::min<std::uint64_t>(value_end + 1, text_.size());
  return true;
}

double DxfText::number(const DxfGroup& group) const {
  double value = 0;
  if (!parse_double(group.value, value) || !std::isfinite(value))
    fail_at(group.value_begin, fmt::format("a number behind the group code {}", group.code),
            fmt::format("'{}'", in_short(group.value)));
  return value;
}

std::int64_t DxfText::integer(const DxfGroup& group) const {
  const double value = number(group);
  constexpr double kExact = 1e15;
  if (value != std::floor(value) || std::abs(value) > kExact)
    fail_at(group.value_begin, fmt::format("a whole number behind the group code {}", group.code),
            fmt::format("'{}'", in_short(group.value)));
  return static_cast<std::int64_t>(value);
}

void DxfText::fail_at(std::uint64_t at, const std::string& expected, const std::string& found) const {
  Scanner(path_, text_).fail_with(expected, found, std::min<std::size_t>(at, text_.size()));
}

std::string dxf_key(std::string_view name) {
  std::string key(name);
  for (char& c : key)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return key;
}

DxfDocument read_dxf_document(const DxfText& text) { return DxfDocumentReader(text).run(); }

std::optional<double> dxf_unit_micrometres(int units) {
  // By their numbers, from inches, 1, on.
  constexpr double kInch = 25400;
  constexpr double kSizes[] = {0,    kInch, 12 * kInch,  63360 * kInch, 1000,       1e4,
                               1e6,  1e9,   kInch / 1e6, kInch / 1000,  36 * kInch, 1e-4,
                               1e-3, 1,     1e5,         1e7,           1e8,        1e15};
  if (units <= 0 || units >= static_cast<int>(std::size(kSizes))) return std::nullopt;
  return kSizes[units];
}

std::optional<double> unit_of_dxf(const DxfText& text) { return DxfDocumentReader(text).unit(); }

}  // namespace vdb_offset::io
