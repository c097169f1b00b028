// SPDX-License-Identifier: Apache-2.0
// Reads the curves of a drawing from its elements.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "drawing/smooth_curve.h"
#include "ground/system/memory.h"
#include "svg/svg.h"
#include "svg/svg_outline.h"
#include "svg/svg_uses.h"

namespace vdb_offset::io {
namespace {

/// Finds the box around all shapes, and whether one of them is curved.
class Measure : public SvgPen {
 public:
  void begin(const SvgMatrix& to_drawing) { to_drawing_ = to_drawing; }
  void point(const Vec2d& p) override {
    const Vec3d drawn = transformed(to_drawing_, p);
    box_.add(Vec2d(drawn[0], drawn[1]));
  }
  void curve(const SvgCurve& curve, Ends /*ends*/) override {
    is_curved_ = true;
    box_.add(transformed(to_drawing_, curve));
  }
  void end(bool /*closed*/) override {}

  bool is_curved() const { return is_curved_; }
  double diagonal() const { return box_.diagonal(); }

 private:
  SvgMatrix to_drawing_ = kSvgIdentity;
  SvgBox box_;
  bool is_curved_ = false;
};

/// Makes points of the outlines of shapes.
class Flattener : public SvgPen {
 public:
  Flattener(const SvgDocument& document, SvgDrawing& drawing, Curves& curves, double tolerance)
      : document_(document), drawing_(drawing), curves_(curves), tolerance_(tolerance) {}

  void begin(const SvgElement& shape, const SvgMatrix& to_drawing) {
    shape_ = &shape;
    to_drawing_ = to_drawing;
    is_curved_ = false;
  }

  void point(const Vec2d& p) override { add_point(p); }

  void curve(const SvgCurve& curve, Ends ends) override {
    is_curved_ = true;
    const std::size_t count = count_of(transformed(to_drawing_, curve));
    constexpr std::size_t kMany = 1 << 16;  // points of one curve; fewer are not worth asking the system about
    if (count > kMany) require_memory(count * kBytesOfPoint, document_.path());
    for (std::size_t k = 1; k < count; ++k) add_point(point_at(curve, k, count));
    if (ends == Ends::There) add_point(point_at(curve, count, count));
  }

  /// A curve that ends where it begins is closed anyway.
  void end(bool closed) override {
    const std::size_t first = curves_.face_begin.back();
    if (curves_.corners.size() == first) return;
    if (curves_.corners.size() > first + 2) join_ends(curves_.corners[first]);
    if (closed && drawing_.own[curves_.corners[first]] != drawing_.own.back() && curves_.corners.size() > first + 1)
      curves_.corners.push_back(curves_.corners[first]);
    curves_.close_face();
    drawing_.closed.push_back(closed);
  }

  /// Whether the shape that was drawn last has a curved segment.
  bool is_curved() const { return is_curved_; }

 private:
  static constexpr std::size_t kBytesOfPoint = sizeof(Vec3d) + sizeof(Vec2d) + sizeof(std::uint32_t);

  std::size_t count_of(const SvgCurve& drawn) const {
    constexpr double kMost = 1e9;  // segments of one curve: what fits any memory
    const double count = segments_within(tolerance_, drawn);
    if (!(count <= kMost))
      document_.fail_at(
          shape_->begin,
          fmt::format("a curve that {:g} segments can follow to within {:g} (--flatten)", kMost, tolerance_),
          "one that needs more");
    return static_cast<std::size_t>(count);
  }

  void add_point(const Vec2d& p) {
    const Vec3d position = transformed(to_drawing_, p);
    if (!std::isfinite(position[0]) || !std::isfinite(position[1]))
      document_.fail_at(shape_->begin, "coordinates that are numbers", "larger ones");
    held_.add();
    curves_.corners.push_back(static_cast<std::uint32_t>(curves_.positions.size()));
    curves_.positions.push_back(position);
    drawing_.own.push_back(p);
  }

  /// Joins the last point of a curve to its first one if only rounding keeps them apart, as the sum of relative
  /// coordinates does.
  void join_ends(std::uint32_t first) {
    constexpr double kRounding = 1e-13;  // share of the largest coordinate: the rounding of a thousand sums
    std::vector<Vec2d>& own = drawing_.own;
    double largest = 0;
    for (std::size_t p = first; p < own.size(); ++p)
      for (int k = 0; k < 2; ++k) largest = std::max(largest, std::abs(own[p][k]));
    if (!((own.back() - own[first]).length() <= kRounding * largest)) return;
    own.back() = own[first];
    curves_.positions.back() = curves_.positions[first];
  }

  const SvgDocument& document_;
  SvgDrawing& drawing_;
  Curves& curves_;
  double tolerance_;
  const SvgElement* shape_ = nullptr;
  SvgMatrix to_drawing_ = kSvgIdentity;
  bool is_curved_ = false;
  MemoryWatch held_{document_.path(), kBytesOfPoint};
};

/// The tolerance within which curves are flattened, world units. A share is of the drawing's diagonal; without curves
/// any number does.
double tolerance_of(const SvgDocument& document, const SvgDrawing& drawing, const CurveReading& how) {
  if (how.flatten_share == 0) return how.flatten_length;
  Measure measure;
  for (const SvgDrawing::Shape& shape : drawing.shapes) {
    measure.begin(shape.to_drawing);
    draw_outline(document, document.elements()[shape.element], measure);
  }
  return measure.is_curved() ? how.flatten_share * measure.diagonal() : 0;
}

}  // namespace

void parse_svg(CurveFile& file, const CurveReading& how) {
  SvgDocument document(file.file.path, file.file.text());
  auto drawing = std::make_shared<SvgDrawing>(resolve_uses(document));
  const double tolerance = tolerance_of(document, *drawing, how);
  Curves& curves = file.file.polygons;
  Flattener flattener(document, *drawing, curves, tolerance);
  for (SvgDrawing::Shape& shape : drawing->shapes) {
    const SvgElement& element = document.elements()[shape.element];
    shape.first_curve = curves.face_count();
    flattener.begin(element, shape.to_drawing);
    draw_outline(document, element, flattener);
    shape.end_curve = curves.face_count();
    file.flattened_shapes += flattener.is_curved();
  }
  if (curves.face_count() == 0)
    document.fail_at(document.text().size(), "a path or another shape with two points", "none in the drawing");
  file.flattened_to = file.flattened_shapes > 0 ? tolerance : 0;
  file.planar = true;
  file.file.unit_micrometres = svg_unit_micrometres(document);
  drawing->elements = std::move(document).take_elements();
  file.svg = std::move(drawing);
}

}  // namespace vdb_offset::io
