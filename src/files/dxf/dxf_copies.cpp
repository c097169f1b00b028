// SPDX-License-Identifier: Apache-2.0
// Writes lines and polylines in the place of a DXF file's entities, with what these have besides their form. An entity
// of its own keeps its layer, colour, line type, handle, extended data and lists byte for byte. One that an INSERT
// shows gets a handle of its own, and what it leaves to its block (the layer 0, BYBLOCK) is that of the INSERT, or of
// the one that shows this. A line of two points stays a LINE. Points at one height become a LWPOLYLINE where the file's
// version has these, and all others a POLYLINE with its vertices, plane or in space. Of widths only the constant one of
// a LWPOLYLINE stays. Handles go on from the highest one in the file. Where in the file an entity goes is decided in
// dxf_rewrite.cpp.
#include "dxf/dxf_copies.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace vdb_offset::io {
namespace {

constexpr int kR14 = 1014;
// Codes of what any entity may have: handle, line type, layer, visibility, colour, space, weight, owner, layout, ….
constexpr std::array kKeptCodes = {5, 6, 8, 48, 60, 62, 67, 284, 330, 347, 348, 360, 370, 390, 410, 420, 430, 440};
// Those that a copy has of its source, as what shows it has no say in them.
constexpr std::array kCopiedCodes = {48, 420, 430, 440};
constexpr int kInSpaceFlag = 8;

bool is_in(std::span<const int> codes, int code) { return std::find(codes.begin(), codes.end(), code) != codes.end(); }

bool is_level(std::span<const Vec3d> points) {
  return std::all_of(points.begin(), points.end(), [&](const Vec3d& p) { return p[2] == points.front()[2]; });
}

}  // namespace

void DxfCopies::append(std::string& made, const DxfDrawing::Shape& shape, std::span<const Vec3d> points, bool closed) {
  const DxfKind kind = drawing_.document.entities[shape.entity].kind;
  const Common common = common_of(shape);
  // Kinds that came with R13 or R14 stand beside polylines of that version, whatever the file says of itself.
  const bool has_light = drawing_.document.version >= kR14 || kind == DxfKind::LwPolyline || kind == DxfKind::Ellipse ||
                         kind == DxfKind::Spline;
  const bool is_line = kind == DxfKind::Line && points.size() == 2, is_light = has_light && is_level(points);
  DxfWriter writer(made, line_end_);
  writer.group(0, is_line ? "LINE" : is_light ? "LWPOLYLINE" : "POLYLINE");
  made += common.before;
  if (is_line) {
    if (common.is_modern) writer.group(100, "AcDbLine");
    writer.point(10, points[0]);
    writer.point(11, points[1]);
    made += common.extended;
  } else if (is_light) {
    if (common.is_modern) writer.group(100, "AcDbPolyline");
    append_light(writer, shape, common, points, closed);
    made += common.extended;
  } else {
    append_heavy(writer, shape, common, points, closed);
  }
}

void DxfCopies::append_light(DxfWriter& writer, const DxfDrawing::Shape& shape, const Common& common,
                             std::span<const Vec3d> points, bool closed) const {
  writer.group(90, fmt::format("{:9}", points.size()));
  writer.flags(70, (closed ? 1 : 0) | line_type_flag(shape));
  const bool is_own = shape.insert == DxfDrawing::kNone;
  if (const auto width = value_of(shape.entity, 43);
      is_own && !width.empty() && drawing_.document.entities[shape.entity].kind == DxfKind::LwPolyline)
    writer.group(43, width);
  if (points.front()[2] != 0) writer.group(38, points.front()[2]);
  writer.verbatim(common.height);
  for (const Vec3d& p : points) {
    writer.group(10, p[0]);
    writer.group(20, p[1]);
  }
}

void DxfCopies::append_heavy(DxfWriter& writer, const DxfDrawing::Shape& shape, const Common& common,
                             std::span<const Vec3d> points, bool closed) {
  const bool in_space = !is_level(points);
  if (common.is_modern) writer.group(100, in_space ? "AcDb3dPolyline" : "AcDb2dPolyline");
  else writer.group(66, "     1");
  writer.point(10, {0, 0, in_space ? 0 : points.front()[2]});
  writer.flags(70, (closed ? 1 : 0) | (in_space ? kInSpaceFlag : 0) | line_type_flag(shape));
  writer.verbatim(common.height);
  writer.verbatim(common.extended);
  for (const Vec3d& p : points) {
    append_part(writer, "VERTEX", common);
    if (common.is_modern) {
      writer.group(100, "AcDbVertex");
      writer.group(100, in_space ? "AcDb3dPolylineVertex" : "AcDb2dVertex");
    }
    writer.point(10, p);
    if (in_space) writer.flags(70, 32);
  }
  append_part(writer, "SEQEND", common);
}

void DxfCopies::append_part(DxfWriter& writer, std::string_view type, const Common& common) {
  writer.group(0, type);
  if (common.is_modern && drawing_.document.highest_handle > 0) writer.group(5, next_handle());
  if (common.is_modern) writer.group(100, "AcDbEntity");
  writer.group(8, common.layer);
}

DxfCopies::Common DxfCopies::common_of(const DxfDrawing::Shape& shape) {
  Common common;
  common.layer = inherited(shape, 8, "0");
  const DxfEntity& entity = drawing_.document.entities[shape.entity];
  common.is_modern = !value_of(shape.entity, 100).empty();
  if (shape.insert == DxfDrawing::kNone) add_own(common, entity);
  else add_copied(common, shape);
  return common;
}

/// Adds all that an entity has beside its form, byte for byte.
void DxfCopies::add_own(Common& common, const DxfEntity& entity) const {
  bool in_braces = false;  // lists of what refers to it, or of an application's own
  double thickness = 0;
  text_.for_each(entity.begin, entity.body_end, [&](const DxfGroup& group) {
    const std::string_view bytes = text_.text().substr(group.begin, group.end - group.begin);
    const bool opens = group.code == 102 && group.value.starts_with('{');
    if (group.code >= 1000) common.extended += bytes;
    else if (in_braces || opens || is_in(kKeptCodes, group.code) || group.is(100, "AcDbEntity")) common.before += bytes;
    else if (group.code == 39) thickness = text_.number(group);
    if (group.code == 102) in_braces = opens;
  });
  // A list that the file leaves open would take in what follows here.
  if (in_braces) DxfWriter(common.before, line_end_).group(102, "}");
  if (thickness == 0) return;
  const bool points_down =
      entity.kind != DxfKind::Ellipse && entity.kind != DxfKind::Spline && is_mirrored(text_, entity);
  DxfWriter(common.height, line_end_).group(39, points_down ? -thickness : thickness);
}

/// Adds what an entity of a block has where an INSERT shows it: what it leaves to the block is that of the INSERT.
void DxfCopies::add_copied(Common& common, const DxfDrawing::Shape& shape) {
  DxfWriter writer(common.before, line_end_);
  std::uint32_t outermost = shape.insert;
  while (drawing_.inserts[outermost].shown_by != DxfDrawing::kNone) outermost = drawing_.inserts[outermost].shown_by;
  const std::uint32_t insert = drawing_.inserts[outermost].entity;
  const auto add = [&](int code, std::string_view value) {
    if (!value.empty()) writer.group(code, value);
  };
  if (!value_of(shape.entity, 5).empty()) add(5, next_handle());
  add(330, value_of(insert, 330));
  if (common.is_modern) add(100, "AcDbEntity");
  for (const int code : {67, 410}) add(code, value_of(insert, code));
  add(8, common.layer);
  add(6, inherited(shape, 6, "BYBLOCK"));
  add(62, inherited(shape, 62, "0"));
  add(370, inherited(shape, 370, "-2"));
  for (const int code : kCopiedCodes) add(code, value_of(shape.entity, code));
}

/// The value of a group of a shape's entity or, as long as that leaves it to the block, of what shows it.
std::string_view DxfCopies::inherited(const DxfDrawing::Shape& shape, int code, std::string_view by_block) const {
  std::string_view value = value_of(shape.entity, code);
  for (std::uint32_t insert = shape.insert; insert != DxfDrawing::kNone && dxf_key(value) == dxf_key(by_block);
       insert = drawing_.inserts[insert].shown_by)
    value = value_of(drawing_.inserts[insert].entity, code);
  return value;
}

/// The first value behind a code of an entity; empty if it has none.
std::string_view DxfCopies::value_of(std::uint32_t entity, int code) const {
  std::string_view value;
  bool is_found = false;
  const DxfEntity& of = drawing_.document.entities[entity];
  text_.for_each_own(of.begin, of.body_end, [&](const DxfGroup& group) {
    if (is_found || group.code != code) return;
    value = group.value;
    is_found = true;
  });
  return value;
}

/// The flag that has a line type run on through the vertices.
int DxfCopies::line_type_flag(const DxfDrawing::Shape& shape) const {
  constexpr int kRunsOn = 128;
  const DxfEntity& entity = drawing_.document.entities[shape.entity];
  if (entity.kind != DxfKind::LwPolyline && entity.kind != DxfKind::Polyline) return 0;
  return (DxfValues(text_, entity, {70}).flags(70) & kRunsOn) != 0 ? kRunsOn : 0;
}

std::string DxfCopies::next_handle() { return fmt::format("{:X}", ++last_handle_); }

}  // namespace vdb_offset::io
