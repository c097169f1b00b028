// SPDX-License-Identifier: Apache-2.0
// Writes curves as a drawing of their own.
#include "svg/svg.h"

#include <fmt/format.h>

#include <algorithm>

#include "bytes/append_number.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {

void append_svg_point(std::string& text, const Vec2d& p, const Rounding& precision) {
  append_number(text, precision(p[0]), precision);
  append_number(text += ',', precision(p[1]), precision);
}

std::string as_svg(CurvesView curves, const Rounding& precision) {
  Vec2d lower(0.0, 0.0), upper(0.0, 0.0);
  for (std::size_t i = 0; i < curves.corners.size(); ++i) {
    const Vec3d& p = curves.positions[curves.corners[i]];
    if (p[2] != 0)
      throw InvalidInput(
          fmt::format("SVG: expected curves in the plane z = 0, got z = {} at point {}", p[2], curves.corners[i]));
    for (int k = 0; k < 2; ++k) {
      lower[k] = i == 0 ? p[k] : std::min(lower[k], p[k]);
      upper[k] = i == 0 ? p[k] : std::max(upper[k], p[k]);
    }
  }
  std::string text = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"";
  for (const double n : {lower[0], lower[1], upper[0] - lower[0]}) append_number(text, n), text += ' ';
  append_number(text, upper[1] - lower[1]);
  text += "\" fill=\"none\" stroke=\"black\" stroke-width=\"";
  append_number(text, std::max(upper[0] - lower[0], upper[1] - lower[1]) / 500);
  text += "\">\n";
  for (std::size_t c = 0; c < curves.face_count(); ++c) {
    const auto points = curves.face(c);
    const bool closed = points.size() > 3 && curves.positions[points.back()] == curves.positions[points.front()];
    text += "<path d=\"";
    for (std::size_t k = 0; k < points.size() - closed; ++k) {
      text += k == 0 ? "M" : " L";
      const Vec3d& p = curves.positions[points[k]];
      append_svg_point(text, {p[0], p[1]}, precision);
    }
    text += closed ? " Z\"/>\n" : "\"/>\n";
  }
  return text += "</svg>\n";
}

}  // namespace vdb_offset::io
