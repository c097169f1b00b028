// SPDX-License-Identifier: Apache-2.0
#pragma once

// Outlines of the shapes of an SVG drawing.

#include <string>

#include "drawing/smooth_curve.h"
#include "drawing/transform.h"
#include "svg/svg_document.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset::io {

/// What draws the outline of a shape, in the shape's own coordinates.
class SvgPen {
 public:
  enum class Ends { There, AtFirstPoint };

  SvgPen() = default;
  SvgPen(const SvgPen&) = delete;
  SvgPen& operator=(const SvgPen&) = delete;
  virtual ~SvgPen() = default;
  /// Begins an outline at a point, or goes on straight to it.
  virtual void point(const Vec2d& p) = 0;
  /// Goes on along a curve from the last point. One that ends at the outline's first point closes it without another
  /// point there.
  virtual void curve(const SvgCurve& curve, Ends ends = Ends::There) = 0;
  /// Ends the outline, if one has been begun.
  virtual void end(bool closed) = 0;
};

/// Walks over the value of one of the element's attributes; mistakes are reported by the element's line.
SvgValueScanner scan_value(const SvgDocument& document, const SvgElement& element, const std::string& value,
                           std::string what);

/// A length of an element, in the units of the drawing; 0 if it has none. \throw InvalidInput
double length_of(const SvgDocument& document, const SvgElement& element, const char* name);

/// Draws the outline of a shape. Those without an extent have none. \throw InvalidInput (line, what was expected)
void draw_outline(const SvgDocument& document, const SvgElement& shape, SvgPen& pen);

}  // namespace vdb_offset::io
