// SPDX-License-Identifier: Apache-2.0
// Writes a DXF file again with points at other positions.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "bytes/append_number.h"
#include "bytes/line_records.h"
#include "bytes/scanner.h"
#include "dxf/dxf.h"
#include "dxf/dxf_copies.h"
#include "ground/system/assert.h"

namespace vdb_offset::io {
namespace {

/// Bytes of the file that others take the place of.
struct DxfEdit {
  std::uint64_t begin, end;
  std::string text;
};

/// Where the coordinates of a point stand: the groups of x, y and z, as far as there are any.
struct PointGroups {
  std::array<DxfGroup, 3> at;
  std::array<bool, 3> has = {false, false, false};

  void take(int axis, const DxfGroup& group) {
    at[static_cast<std::size_t>(axis)] = group;
    has[static_cast<std::size_t>(axis)] = true;
  }
};

class DxfRewriter {
 public:
  DxfRewriter(const CurveFile& file, std::span<const Vec3d> positions, const Rounding& precision)
      : text_(file.file.path, file.file.text()),
        drawing_(*file.dxf),
        source_(file.file.polygons.view()),
        positions_(positions),
        precision_(precision),
        line_end_(line_end_of(file.file.text())),
        copies_(text_, drawing_, line_end_) {}

  std::string run() {
    const auto& shapes = drawing_.shapes;
    for (std::size_t s = 0; s < shapes.size();) {
      std::size_t end = s + 1;
      const std::uint32_t entity = outermost(shapes[s]);
      while (end < shapes.size() && outermost(shapes[end]) == entity) ++end;
      if (std::any_of(shapes.begin() + static_cast<std::ptrdiff_t>(s),
                      shapes.begin() + static_cast<std::ptrdiff_t>(end),
                      [&](const auto& shape) { return has_moved(shape); }))
        edit(entity, s, end);
      s = end;
    }
    if (copies_.last_handle() > drawing_.document.highest_handle && drawing_.document.seed_end > 0)
      edits_.push_back(
          {drawing_.document.seed_begin, drawing_.document.seed_end, fmt::format("{:X}", copies_.last_handle() + 1)});
    return edited();
  }

 private:
  using Shape = DxfDrawing::Shape;

  /// The INSERT of the section ENTITIES that shows a shape; kNone if none does.
  std::uint32_t outermost_insert(const Shape& shape) const {
    std::uint32_t insert = shape.insert;
    while (insert != DxfDrawing::kNone && drawing_.inserts[insert].shown_by != DxfDrawing::kNone)
      insert = drawing_.inserts[insert].shown_by;
    return insert;
  }
  /// The entity of the section ENTITIES that a shape is, or that shows it.
  std::uint32_t outermost(const Shape& shape) const {
    const std::uint32_t insert = outermost_insert(shape);
    return insert == DxfDrawing::kNone ? shape.entity : drawing_.inserts[insert].entity;
  }

  bool has_moved(std::uint32_t p) const { return positions_[p] != source_.positions[p]; }
  bool has_moved(const Shape& shape) const {
    if (shape.curve == DxfDrawing::kNone) return false;
    const auto points = source_.face(shape.curve);
    return std::any_of(points.begin(), points.end(), [&](std::uint32_t p) { return has_moved(p); });
  }

  /// A point as it is written: without those digits that are not asked for, if it has moved.
  Vec3d written(std::uint32_t p) const { return has_moved(p) ? precision_(positions_[p]) : positions_[p]; }

  /// The points of a shape, each once.
  std::vector<std::uint32_t> points_of(const Shape& shape) const {
    const auto face = source_.face(shape.curve);
    const bool repeats = face.size() > 1 && face.back() == face.front();
    return {face.begin(), face.end() - repeats};
  }

  void edit(std::uint32_t entity, std::size_t first, std::size_t end) {
    const Shape& shape = drawing_.shapes[first];
    if (shape.insert == DxfDrawing::kNone && shape.keeps_form && edit_in_place(shape)) return;
    const DxfEntity& replaced = drawing_.document.entities[entity];
    DxfEdit made{replaced.begin, replaced.end, {}};
    for (std::size_t s = first; s < end; ++s) {
      const Shape& each = drawing_.shapes[s];
      require_curves_alone(each);
      if (each.curve == DxfDrawing::kNone) continue;
      std::vector<Vec3d> points;
      for (const auto p : points_of(each)) points.push_back(written(p));
      copies_.append(made.text, each, points, drawing_.closed[each.curve] != 0);
    }
    edits_.push_back(std::move(made));
  }

  /// What else an INSERT shows would be lost with it.
  void require_curves_alone(const Shape& shape) const {
    const std::uint32_t insert = outermost_insert(shape);
    if (insert == DxfDrawing::kNone || drawing_.inserts[insert].other == 0) return;
    std::uint64_t at = drawing_.inserts[insert].other;
    DxfGroup group;
    text_.next(at, group);
    text_.fail_at(drawing_.inserts[insert].other,
                  "curves that are shown, and nothing else, in a block whose INSERT becomes these as they move",
                  fmt::format("'{}'", in_short(group.value)));
  }

  /// Gives an entity's points other coordinates. False if it has no room for them.
  bool edit_in_place(const Shape& shape) {
    const DxfEntity& entity = drawing_.document.entities[shape.entity];
    const std::vector<std::uint32_t> points = points_of(shape);
    const std::vector<PointGroups> groups = groups_of(entity);
    if (groups.size() != points.size()) return false;
    const bool is_line = entity.kind == DxfKind::Line;
    const bool in_space =
        is_line || (entity.kind == DxfKind::Polyline && (DxfValues(text_, entity, {70}).flags(70) & 8) != 0);
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (!groups[k].has[0] || !groups[k].has[1]) return false;
      if (!in_space && written(points[k])[2] != source_.positions[points[k]][2]) return false;
    }
    const double mirrored = !in_space && is_mirrored(text_, entity) ? -1 : 1;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (!has_moved(points[k])) continue;
      const Vec3d to = written(points[k]);
      for (int axis = 0; axis < (in_space ? 3 : 2); ++axis)
        edit_number(groups[k], axis, axis == 0 ? mirrored * to[0] : to[axis]);
    }
    return true;
  }

  /// What the file has is compared, as ends that have been joined may be elsewhere.
  void edit_number(const PointGroups& groups, int axis, double value) {
    const auto k = static_cast<std::size_t>(axis);
    if (value == (groups.has[k] ? text_.number(groups.at[k]) : 0)) return;
    std::string number;
    append_number(number, value);
    if (groups.has[k]) {
      const std::uint64_t begin = groups.at[k].value_begin;
      edits_.push_back({begin, begin + groups.at[k].value.size(), std::move(number)});
      return;
    }
    // Of x and y there is always a group. That of z has the code ten above that of y.
    std::string added;
    DxfWriter(added, line_end_).group(groups.at[1].code + 10, number);
    edits_.push_back({groups.at[1].end, groups.at[1].end, std::move(added)});
  }

  /// Where the points of an entity stand, in order.
  std::vector<PointGroups> groups_of(const DxfEntity& entity) const {
    if (entity.kind == DxfKind::Polyline) return groups_of_vertices(entity);
    const bool is_line = entity.kind == DxfKind::Line;
    std::vector<PointGroups> groups(is_line ? 2 : 0);
    text_.for_each_own(entity.begin, entity.body_end, [&](const DxfGroup& group) {
      const int axis = group.code / 10 - 1, point = group.code % 10;
      if (!is_line && group.code == 10) groups.emplace_back();
      if (axis < 0 || axis > (is_line ? 2 : 1) || point > (is_line ? 1 : 0) || groups.empty()) return;
      (is_line ? groups[static_cast<std::size_t>(point)] : groups.back()).take(axis, group);
    });
    return groups;
  }

  std::vector<PointGroups> groups_of_vertices(const DxfEntity& polyline) const {
    std::vector<PointGroups> groups;
    bool in_vertex = false;  // else at its end, SEQEND, which may have anything
    text_.for_each_own(polyline.body_end, polyline.end, [&](const DxfGroup& group) {
      if (group.code == 0) in_vertex = group.value == "VERTEX";
      if (group.code == 0 && in_vertex) groups.emplace_back();
      const bool is_coordinate = group.code == 10 || group.code == 20 || group.code == 30;
      if (in_vertex && is_coordinate) groups.back().take(group.code / 10 - 1, group);
    });
    return groups;
  }

  std::string edited() {
    std::sort(edits_.begin(), edits_.end(), [](const DxfEdit& a, const DxfEdit& b) { return a.begin < b.begin; });
    std::string made;
    std::uint64_t begin = 0;
    for (const DxfEdit& edit : edits_) {
      made.append(text_.text(), begin, edit.begin - begin);
      made += edit.text;
      begin = edit.end;
    }
    return made.append(text_.text(), begin);
  }

  DxfText text_;
  const DxfDrawing& drawing_;
  CurvesView source_;
  std::span<const Vec3d> positions_;
  const Rounding& precision_;
  std::string_view line_end_;
  DxfCopies copies_;
  std::vector<DxfEdit> edits_;
};

}  // namespace

std::string rewrite_dxf(const CurveFile& file, std::span<const Vec3d> positions, const Rounding& precision) {
  VDB_OFFSET_ASSERT(positions.size() == file.file.polygons.positions.size());
  return DxfRewriter(file, positions, precision).run();
}

}  // namespace vdb_offset::io
