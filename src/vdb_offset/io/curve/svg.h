#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/base/precision.h"
#include "vdb_offset/curve/ribbon.h"

namespace vdb_offset::io {

/// What an SVG drawing's lines are, and where they stand in the file.
struct SvgLines {
  /// An element `path`, `polyline` or `polygon`. Its curves lie one behind the other.
  struct Shape {
    std::uint64_t begin, end;          ///< Bytes of its attribute `d` or `points`, without the quotes.
    bool is_path;                      ///< Else a list of points.
    std::array<double, 6> to_drawing;  ///< Of its points: x' = a x + c y + e, y' = b x + d y + f.
    std::size_t curves;
  };

  Curves curves;  ///< In the drawing's coordinates, y down as they are.
  std::vector<Shape> shapes;
  std::vector<Vec2d> own;            ///< Of each point: its coordinates in the shape's own system.
  std::vector<std::uint8_t> closed;  ///< Of each curve: 1 if a `Z` or a polygon closes it.
};

/// Reads the straight lines of a drawing: `path` (M L H V Z and m l h v z), `polyline` and `polygon`, with the
/// transforms of all that they are in. What is only referred to (`defs`, `clipPath`, `mask`, `marker`, `pattern`,
/// `symbol`) is left alone, as is what has no lines, such as text and images, and what is not SVG's.
/// \throw InvalidInput (file, line, what was expected, what was found) for what is no XML, or UTF-16, for curved
/// segments, other shapes and `use`, which would not be offset along with these, and for transforms in a style
SvgLines parse_svg(const std::string& path, std::string_view text);

/// The same drawing with points at other positions: attributes of shapes of which a point has moved are written anew,
/// in absolute coordinates; all other bytes stay. `source` are the curves of `lines`, where they may not be any more.
std::string patch_svg(std::string_view text, const SvgLines& lines, CurvesView source, std::span<const Vec3d> positions,
                      const Precision& precision);

/// A drawing of curves that come from elsewhere, one path each.
/// \throw InvalidInput if z is not 0 all over
std::string as_svg(CurvesView curves, const Precision& precision);

}  // namespace vdb_offset::io
