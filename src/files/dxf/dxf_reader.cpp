// SPDX-License-Identifier: Apache-2.0
// Reads the curves of a DXF file from its entities.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "dxf/dxf.h"
#include "dxf/dxf_ends.h"
#include "ground/system/memory.h"

namespace vdb_offset::io {
namespace {

/// The smallest box around curves.
class DxfBox {
 public:
  void add(const Vec3d& p) {
    lower_ = openvdb::math::minComponent(lower_, p);
    upper_ = openvdb::math::maxComponent(upper_, p);
  }
  void add(const SvgCurve& arc, double z) {
    SvgBox box;
    box.add(arc);
    add({box.lower()[0], box.lower()[1], z});
    add({box.upper()[0], box.upper()[1], z});
  }
  /// Points of a spline: close enough for a share of the diagonal, and always the same ones.
  void add(const DxfBezier& piece) {
    for (const DxfBezier& half : halves_of(piece))
      for (const DxfBezier& quarter : halves_of(half)) add(point_of(quarter.back()));
  }
  double diagonal() const {
    const Vec3d size = upper_ - lower_;
    return upper_[0] >= lower_[0] ? std::hypot(size[0], size[1], size[2]) : 0;
  }

 private:
  static constexpr double kFar = std::numeric_limits<double>::infinity();
  Vec3d lower_{kFar}, upper_{-kFar};
};

void require_finite(const DxfText& text, const DxfEntity& entity, const Vec3d& p) {
  if (!p.isFinite()) text.fail_at(entity.begin, "coordinates that are numbers", "larger ones");
}

/// Finds the box around all curves, where each of them begins and ends, and whether one is curved.
class DxfMeasure : public DxfPen {
 public:
  explicit DxfMeasure(const DxfText& text) : text_(text) {}

  void begin(const DxfEntity& entity) {
    entity_ = &entity;
    ends_ = {};
    own_ = {};
    has_point_ = false;
  }
  void point(const Vec3d& p) override {
    take(p);
    all_.add(p), own_.add(p);
  }
  void arc(const SvgCurve& arc, double z, Ends ends) override {
    is_curved_ = true;
    all_.add(arc, z), own_.add(arc, z);
    if (ends == Ends::AtFirstPoint) return;
    const Vec2d last = point_at(arc, 1, 1);
    take({last[0], last[1], z});
  }
  void spline(const DxfBezier& piece) override {
    is_curved_ = true;
    all_.add(piece), own_.add(piece);
    take(point_of(piece.back()));
  }
  void end(bool closed) override {
    ends_.is_open = !closed;
    ends_.extent = own_.diagonal();
  }

  /// Those of the curve that was drawn last; closed if it has none.
  const DxfEnds& ends() const { return ends_; }
  bool is_curved() const { return is_curved_; }
  double diagonal() const { return all_.diagonal(); }

 private:
  void take(const Vec3d& p) {
    require_finite(text_, *entity_, p);
    if (!has_point_) ends_.first = p;
    has_point_ = true;
    ends_.last = p;
  }

  const DxfText& text_;
  const DxfEntity* entity_ = nullptr;
  DxfBox all_, own_;
  DxfEnds ends_;
  bool has_point_ = false, is_curved_ = false;
};

/// Makes points of curves.
class DxfFlattener : public DxfPen {
 public:
  DxfFlattener(const DxfText& text, Curves& curves, std::vector<std::uint8_t>& closed, double tolerance)
      : text_(text), curves_(curves), closed_(closed), tolerance_(tolerance) {}

  /// Points beside ends that have been moved are so much nearer to their curve, as far as that goes.
  void begin(const DxfEntity& entity, const DxfEnds& ends) {
    entity_ = &entity;
    ends_ = ends;
    within_ = std::max(tolerance_ - ends.shift, tolerance_ / 2);
    is_curved_ = false;
  }

  void point(const Vec3d& p) override { add_point(p); }

  void arc(const SvgCurve& arc, double z, Ends ends) override {
    is_curved_ = true;
    const std::size_t count = count_of(arc);
    constexpr std::size_t kMany = 1 << 16;  // points of one curve; fewer are not worth asking the system about
    if (count > kMany) require_memory(count * kBytesOfPoint, text_.path());
    for (std::size_t k = 1; k < count + (ends == Ends::There); ++k) {
      const Vec2d p = point_at(arc, k, count);
      add_point({p[0], p[1], z});
    }
  }

  void spline(const DxfBezier& piece) override {
    is_curved_ = true;
    if (!flatten_dxf(piece, within_, [&](const Vec3d& p) { add_point(p); })) fail_to_follow();
  }

  void end(bool closed) override {
    const std::size_t first = curves_.face_begin.back();
    if (ends_.is_open) {
      curves_.positions[curves_.corners[first]] = ends_.first;
      curves_.positions.back() = ends_.last;
    }
    const bool is_same = curves_.positions[curves_.corners[first]] == curves_.positions.back();
    const bool is_long = curves_.corners.size() > first + 3;
    // What will be written as a polyline needs no point twice. One that has points of its own keeps all of them.
    if (is_same && is_curved_ && is_long) {
      curves_.corners.back() = curves_.corners[first];
      curves_.positions.pop_back();
      closed = true;
    } else if (closed && !is_same) {
      curves_.corners.push_back(curves_.corners[first]);
    }
    curves_.close_face();
    closed_.push_back(closed);
  }

  /// Whether the curve that was drawn last has a curved segment.
  bool is_curved() const { return is_curved_; }

 private:
  static constexpr std::size_t kBytesOfPoint = sizeof(Vec3d) + sizeof(std::uint32_t);
  static constexpr double kMost = 1e9;  // segments of one curve: what fits any memory

  std::size_t count_of(const SvgCurve& arc) const {
    const double count = segments_within(within_, arc);
    if (!(count <= kMost)) fail_to_follow();
    return static_cast<std::size_t>(count);
  }
  [[noreturn]] void fail_to_follow() const {
    text_.fail_at(entity_->begin,
                  fmt::format("a curve that {:g} segments can follow to within {:g} (--flatten)", kMost, within_),
                  "one that needs more");
  }

  void add_point(const Vec3d& p) {
    require_finite(text_, *entity_, p);
    held_.add();
    curves_.corners.push_back(static_cast<std::uint32_t>(curves_.positions.size()));
    curves_.positions.push_back(p);
  }

  const DxfText& text_;
  Curves& curves_;
  std::vector<std::uint8_t>& closed_;
  double tolerance_, within_ = 0;
  const DxfEntity* entity_ = nullptr;
  DxfEnds ends_;
  bool is_curved_ = false;
  MemoryWatch held_{text_.path(), kBytesOfPoint};
};

/// Draws one of a drawing's curves. Returns whether its entity keeps its form with other points.
bool draw_shape(const DxfText& text, const DxfDrawing& drawing, const DxfDrawing::Shape& shape, DxfPen& pen) {
  static const DxfPlacement kInPlace;
  const bool is_shown = shape.insert != DxfDrawing::kNone;
  return draw_dxf(text, drawing.document.entities[shape.entity],
                  is_shown ? drawing.inserts[shape.insert].placement : kInPlace, pen);
}

/// A millionth of the diagonal: a thousandth of a millimetre on a sheet of a metre. Programs write coordinates and
/// angles with six decimals or more, or compute them to about 1e-8.
constexpr double kSameDxfEnd = 1e-6;

}  // namespace

void parse_dxf(CurveFile& file, const CurveReading& how) {
  const DxfText text(file.file.path, file.file.text());
  auto drawing = std::make_shared<DxfDrawing>(resolve_dxf(text, read_dxf_document(text), file.file.remarks));
  DxfMeasure measure(text);
  std::vector<DxfEnds> ends;
  for (const DxfDrawing::Shape& shape : drawing->shapes) {
    measure.begin(drawing->document.entities[shape.entity]);
    draw_shape(text, *drawing, shape, measure);
    append_within_limit(ends, measure.ends(), text.path().c_str());
  }
  join_near_ends(ends, kSameDxfEnd * measure.diagonal());
  const double tolerance = !measure.is_curved()     ? 0
                           : how.flatten_share == 0 ? how.flatten_length
                                                    : how.flatten_share * measure.diagonal();
  Curves& curves = file.file.polygons;
  DxfFlattener flattener(text, curves, drawing->closed, tolerance);
  for (std::size_t s = 0; s < drawing->shapes.size(); ++s) {
    DxfDrawing::Shape& shape = drawing->shapes[s];
    const std::size_t before = curves.face_count();
    flattener.begin(drawing->document.entities[shape.entity], ends[s]);
    shape.keeps_form = draw_shape(text, *drawing, shape, flattener);
    if (curves.face_count() > before) shape.curve = static_cast<std::uint32_t>(before);
    file.flattened_shapes += flattener.is_curved();
  }
  if (curves.face_count() == 0)
    text.fail_at(text.text().size(), "a curve (LINE, LWPOLYLINE, POLYLINE, ARC, CIRCLE, ELLIPSE, SPLINE)",
                 "none in the drawing");
  file.flattened_to = file.flattened_shapes > 0 ? tolerance : 0;
  file.planar = std::all_of(curves.positions.begin(), curves.positions.end(), [](const Vec3d& p) { return p[2] == 0; });
  file.file.unit_micrometres = dxf_unit_micrometres(drawing->document.units);
  file.dxf = std::move(drawing);
}

}  // namespace vdb_offset::io
