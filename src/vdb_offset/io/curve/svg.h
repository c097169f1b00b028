// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/base/rounding.h"
#include "vdb_offset/curve/ribbon.h"
#include "vdb_offset/io/curve_file.h"

namespace vdb_offset::io {

/// Reads the straight lines of a drawing: `path` (M L H V Z and m l h v z), `polyline` and `polygon`, with the
/// transforms of all that they are in. What is only referred to (`defs`, `clipPath`, `mask`, `marker`, `pattern`,
/// `symbol`) is left alone, as is what has no lines, such as text and images, and what is not SVG's.
/// \throw InvalidInput (file, line, what was expected, what was found) for what is no XML, or UTF-16, for curved
/// segments, other shapes and `use`, which would not be offset along with these, and for transforms in a style
SvgLines parse_svg(const std::string& path, std::string_view text);

/// Rewrites a drawing with points at other positions: attributes of shapes of which a point has moved are written anew,
/// in absolute coordinates; all other bytes stay. `source` are the curves of `lines`, which may have been moved out of
/// there.
std::string rewrite_svg(std::string_view text, const SvgLines& lines, CurvesView source,
                        std::span<const Vec3d> positions, const Rounding& precision);

/// A drawing of curves that come from elsewhere, one path each.
/// \throw InvalidInput if z is not 0 all over
std::string as_svg(CurvesView curves, const Rounding& precision);

}  // namespace vdb_offset::io
