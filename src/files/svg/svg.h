// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drawing/transform.h"
#include "ground/numbers/rounding.h"
#include "svg/svg_document.h"
#include "vdb_offset/io/curve_file.h"

namespace vdb_offset::io {

/// What the curves of a drawing are, and where they stand in the file.
struct SvgDrawing {
  static constexpr std::uint32_t kNoUse = ~std::uint32_t{0};

  /// A shape as it is drawn: once in its place, and once for each `use` that shows it. Its curves lie one behind the
  /// other.
  struct Shape {
    std::uint32_t element;
    std::uint32_t use;     ///< What shows it; kNoUse if it is drawn in its place.
    SvgMatrix to_drawing;  ///< Of its points.
    std::size_t first_curve, end_curve;
  };
  /// An element `use` that shows shapes, once for each time that it is drawn itself.
  struct Use {
    std::uint32_t element, target;  ///< Elements: its own and that which it refers to.
    std::uint32_t use;              ///< What shows it; kNoUse if it stands in its place.
    std::uint32_t end_use;          ///< Those within it are the ones from its own number up to here.
    std::size_t first_shape, end_shape;
    std::string shift, fit;  ///< Transforms that it adds to its own one, and to that of a symbol; empty: none.
  };

  std::vector<SvgElement> elements;
  std::vector<Shape> shapes;
  std::vector<Use> uses;
  std::vector<Vec2d> own;            ///< Of each point: its coordinates in the shape's own system.
  std::vector<std::uint8_t> closed;  ///< Of each curve: 1 if a `Z` or its shape closes it.
};

/// Reads the curves of a drawing: `path`, `polyline`, `polygon`, `line`, `rect`, `circle` and `ellipse`, as they are
/// drawn, with the transforms of all that they are in, and as `use` shows them. Curved segments are flattened. What is
/// only referred to (`defs`, `clipPath`, `mask`, `marker`, `pattern`, `symbol`) is left alone, as is what has no
/// lines, such as text and images, what is not SVG's, and what says itself that it is not shown: `display` is `none`,
/// or of a shape both `fill` and `stroke` are, as for the boxes that LibreOffice writes around shapes. Sets all of
/// `file` that is a drawing's, from its text. \throw InvalidInput (file, line, what was expected, what was found) for
/// what is no XML, or UTF-16, for another `svg` in the drawing, for transforms and geometry in a style, for lengths in
/// percent or in units of a font, and for references out of the file, to nothing, in a circle, or to more than a
/// million elements. OutOfBudget
void parse_svg(CurveFile& file, const CurveReading& how);

/// Rewrites a drawing with points at other positions: shapes of which a point has moved are written anew, in absolute
/// coordinates, curved ones and rectangles as paths. If any has moved, each `use` becomes a group of what it shows. All
/// other bytes stay. `source` are the curves of the drawing.
std::string rewrite_svg(std::string_view text, const SvgDrawing& drawing, CurvesView source,
                        std::span<const Vec3d> positions, const Rounding& precision);

/// A drawing of curves that come from elsewhere, one path each.
/// \throw InvalidInput if z is not 0 all over
std::string as_svg(CurvesView curves, const Rounding& precision);

/// Appends "x,y".
void append_svg_point(std::string& text, const Vec2d& p, const Rounding& precision = {});

}  // namespace vdb_offset::io
