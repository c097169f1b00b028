// SPDX-License-Identifier: Apache-2.0
// Offsets of curved shapes of drawings, beside closed forms.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "support/bytes.h"
#include "support/dxf_text.h"
#include "support/folder.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/io/curve_file.h"

using namespace vdb_offset;

// Names of its own, as tests are compiled several files at once.
namespace drawings {
namespace {

constexpr double kPi = std::numbers::pi;

io::CurveFile drawn(const std::string& inside, double tolerance) {
  return io::parse_curves("t.svg", io::CurveFormat::Svg, "<svg>" + inside + "</svg>", {0, tolerance});
}

OffsetResult offset_of(const io::CurveFile& file, double distance, OffsetOptions options = {}) {
  const Distances distances(distance);
  return offset_curves(file.file.polygons.view(), {&distances, 1}, options).front();
}

/// The area that a closed curve encloses, below 0 if it runs the other way.
double area_of(const CurvesView& curves, std::size_t curve) {
  const auto points = curves.face(curve);
  double twice = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec3d &a = curves.positions[points[k]], &b = curves.positions[points[(k + 1) % points.size()]];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return twice / 2;
}

CurvesView moved(const io::CurveFile& file, const OffsetResult& result) {
  return {result.positions, file.file.polygons.corners, file.file.polygons.face_begin};
}

}  // namespace
}  // namespace drawings

TEST_CASE("drawings: the offset of a circle is the circle, and its area converges", "[curves]") {
  using namespace drawings;
  for (const double d : {0.5, -0.5}) {
    double before = 10;
    for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4}) {
      const io::CurveFile file = drawn("<circle cx='3' cy='4' r='2'/>", tolerance);
      const OffsetResult result = offset_of(file, d);
      // Outward points go along the radius. Inward they are where the parallels of both segments meet, which is no more
      // than d (1 / cos(h / 2) - 1) beyond: less than the tolerance, as d is less than the radius.
      for (const Vec3d& p : result.positions)
        CHECK(std::abs(std::hypot(p[0] - 3, p[1] - 4) - (2 + d)) <= tolerance + 1e-9);
      const double off = std::abs(area_of(moved(file, result), 0) - kPi * (2 + d) * (2 + d));
      CHECK(off <= 2 * kPi * (2 + d) * 2 * tolerance);
      CHECK(off < before / 3);
      before = off;
    }
  }
}

TEST_CASE("drawings: the kerf of a plate with rounded corners and a hole", "[curves]") {
  using namespace drawings;
  const double kerf = 0.1, tolerance = 1e-4;
  const io::CurveFile plate = drawn("<rect width='20' height='10' rx='3'/><circle cx='10' cy='5' r='2'/>", tolerance);
  OffsetOptions options;
  options.corners = Corners::Miter;
  const OffsetResult result = offset_of(plate, kerf, options);
  const CurvesView cut = moved(plate, result);
  const auto plate_area = [](double d) {
    const double r = 3 + d;
    return (20 + 2 * d) * (10 + 2 * d) - (4 - kPi) * r * r;
  };
  // Each point of the flattened outline is within the tolerance of the exact one: areas differ by less than the length
  // times the tolerance.
  CHECK(std::abs(area_of(cut, 0)) == Approx(plate_area(kerf)).margin(60 * tolerance));
  CHECK(std::abs(area_of(cut, 1)) == Approx(kPi * 1.9 * 1.9).margin(13 * tolerance));
  for (const auto p : cut.face(0)) {
    // Straight sides are where they have to be; corners are on their arcs.
    const double x = std::min(result.positions[p][0], 20 - result.positions[p][0]),
                 y = std::min(result.positions[p][1], 10 - result.positions[p][1]);
    if (x < 3 && y < 3) CHECK(std::abs(std::hypot(x - 3, y - 3) - 3.1) <= tolerance + 1e-9);
    else CHECK(std::abs(std::min(x, y) + 0.1) <= tolerance + 1e-9);
  }
}

TEST_CASE("drawings: a drawing with curves, offset and written, is as it was but for what moved", "[curves][io]") {
  using namespace drawings;
  const std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"no\"?>\n<!-- Created by hand -->\n"
      "<svg width=\"210mm\" height=\"297mm\" viewBox=\"0 0 210 297\" version=\"1.1\" id=\"svg5\"\n"
      "   xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\"\n"
      "   xmlns=\"http://www.w3.org/2000/svg\">\n"
      "  <inkscape:view id=\"namedview7\" inkscape:zoom=\"0.74\"/>\n"
      "  <defs id=\"defs2\"/>\n"
      "  <g inkscape:label=\"Layer 1\" id=\"layer1\" transform=\"translate(1.5e1,-2)\">\n"
      "    <path style=\"fill:none;stroke:#ff0000;stroke-width:0.1\"\n"
      "       d=\"m 40,60 c 11.04569,0 20,8.954305 20,20 0,11.045695 -8.954305,20 -20,20 -11.04569,0 -20,-8.954305 "
      "-20,-20 0,-11.045695 8.954305,-20 20,-20 z\"\n       id=\"path1\" />\n"
      "    <ellipse style=\"fill:none\" id=\"path2\" cx=\"120\" cy=\"80\" rx=\"20\" ry=\"10\" />\n"
      "  </g>\n</svg>\n";
  const io::CurveFile file = io::parse_curves("t.svg", io::CurveFormat::Svg, text);
  const OffsetResult result = offset_of(file, 0.5);
  const Folder folder;
  io::write_curves(folder.file("o.svg"), file, result.positions);
  const std::string written = slurp(folder.file("o.svg"));
  for (const char* const kept : {"<!-- Created by hand -->", "inkscape:zoom=\"0.74\"/>", "id=\"path1\" />",
                                 "<path style=\"fill:none\" id=\"path2\" d=\"M", "translate(1.5e1,-2)"})
    CHECK(written.find(kept) != std::string::npos);
  CHECK(written.find("ellipse") == std::string::npos);
  const io::CurveFile back = io::read_curves(folder.file("o.svg"));
  REQUIRE(back.file.polygons.positions.size() == result.positions.size());
  for (std::size_t p = 0; p < result.positions.size(); ++p)
    CHECK((back.file.polygons.positions[p] - result.positions[p]).length() < 1e-12);
  // The path is a circle of radius 20 to 3 in 10,000, as four such curves are.
  for (const auto p : moved(file, result).face(0))
    CHECK(std::hypot(result.positions[p][0] - 55, result.positions[p][1] - 78) == Approx(20.5).epsilon(3e-4));
}

TEST_CASE("drawings: the ways in which programs write them", "[curves][io]") {
  using namespace drawings;
  const auto read = [](const std::string& text) {
    return io::parse_curves("t.svg", io::CurveFormat::Svg, text, {0, 1e-3});
  };
  // Entities for namespaces, a style sheet as character data, foreign elements in a switch, curves without separators.
  const io::CurveFile entities = read(
      "<?xml version=\"1.0\" encoding=\"iso-8859-1\"?>\n<!DOCTYPE svg PUBLIC \"-//W3C//DTD SVG 1.1//EN\" \"svg11.dtd\" "
      "[\n"
      "  <!ENTITY ns_svg \"http://www.w3.org/2000/svg\">\n  <!ENTITY ns_ai \"http://ns.example.com/ai/\">\n]>\n"
      "<svg version=\"1.1\" xmlns=\"&ns_svg;\" xmlns:i=\"&ns_ai;\" x=\"0px\" y=\"0px\" xml:space=\"preserve\">\n"
      "<style type=\"text/css\"><![CDATA[ .st0{fill:none;stroke:#FF0000;} ]]></style><switch>\n"
      "<foreignObject requiredExtensions=\"&ns_ai;\" width=\"1\" height=\"1\"><i:pgf id=\"p\"/></foreignObject>\n"
      "<g i:extraneous=\"self\"><path class=\"st0\" "
      "d=\"M20.5,10.5c0,5.523-4.477,10-10,10s-10-4.477-10-10s4.477-10,10-10"
      "S20.5,4.977,20.5,10.5z\"/><line class=\"st0\" x1=\"1e1\" y1=\"-.5\" x2=\"10\" y2=\"21\"/></g></switch></svg>");
  REQUIRE(entities.file.polygons.face_count() == 2);
  for (const auto p : entities.file.polygons.view().face(0)) {
    const Vec3d& at = entities.file.polygons.positions[p];
    CHECK(std::hypot(at[0] - 10.5, at[1] - 10.5) == Approx(10).epsilon(3e-4));
  }
  // Hundredths of a millimetre, a box around each shape that is not drawn, the same place written twice before the end.
  const io::CurveFile boxes = read(
      "<svg width='210mm' height='297mm' viewBox='0 0 21000 29700' xmlns='http://www.w3.org/2000/svg'>"
      "<g class='com.sun.star.drawing.CustomShape'><g id='id3'><rect class='BoundingBox' stroke='none' fill='none' "
      "x='2999' "
      "y='3999' width='5003' height='3003'/><path fill='rgb(114,159,207)' stroke='none' d='M 5500,7000 L 3000,7000 "
      "3000,4000 "
      "8000,4000 8000,7000 5500,7000 Z'/><path fill='none' stroke='rgb(52,101,164)' d='M 5500,7000 L 3000,7000 "
      "3000,4000 "
      "8000,4000 8000,7000 5500,7000 Z'/></g></g></svg>");
  CHECK(boxes.file.polygons.face_count() == 2);
  CHECK(boxes.flattened_shapes == 0);
  // One command for many coordinates, numbers with exponents, arcs with their flags glued to what follows.
  const io::CurveFile glued = read(
      "<svg xmlns='http://www.w3.org/2000/svg'><path d='m1e1 10a5 5 0 1110 0 5 5 0 01-1.0E+1 0zm30,0 "
      "5e-1.5.5-.5'/></svg>");
  REQUIRE(glued.file.polygons.face_count() == 2);
  CHECK(std::abs(area_of(glued.file.polygons.view(), 0)) == Approx(kPi * 25).epsilon(1e-3));
  CHECK(glued.file.polygons.positions.back() == Vec3d(41, 10, 0));
}

TEST_CASE("drawings: the kerf of a plate of separate lines and arcs, some of them the other way round",
          "[curves][dxf]") {
  using namespace drawings;
  // The four corners are a millionth off their sides. All pieces are one curve, which has an inner and an outer side.
  const double kerf = 0.1, tolerance = 1e-4;
  const io::CurveFile plate = io::parse_curves(
      "t.dxf", io::CurveFormat::Dxf,
      dxf_text::file(
          "0|LINE 10|3 20|0 11|17 21|0 0|ARC 10|17.000001 20|3 40|3 50|270 51|360 0|LINE 10|20 20|7 11|20 21|3 "
          "0|ARC 10|17 20|7 40|3.000001 50|0 51|90 0|LINE 10|3 20|10 11|17 21|10 0|ARC 10|3 20|7 40|3 "
          "50|90.000002 51|180 0|LINE 10|0 20|7 11|0 21|3 0|ARC 10|3 20|3 40|3 50|180 51|270 "
          "0|CIRCLE 10|10 20|5 40|2"),
      {0, tolerance});
  CHECK(open_curves(plate.file.polygons.view()).empty());
  OffsetOptions options;
  options.corners = Corners::Miter;
  const OffsetResult result = offset_of(plate, kerf, options);
  for (std::size_t c = 0; c < 9; ++c)
    for (const auto p : moved(plate, result).face(c)) {
      const double x = std::min(result.positions[p][0], 20 - result.positions[p][0]),
                   y = std::min(result.positions[p][1], 10 - result.positions[p][1]);
      if (c == 8) CHECK(std::hypot(x - 10, y - 5) == Approx(1.9).margin(tolerance));
      else if (x < 3 && y < 3) CHECK(std::hypot(x - 3, y - 3) == Approx(3.1).margin(tolerance + 2e-6));
      else CHECK(std::min(x, y) == Approx(-0.1).margin(tolerance + 2e-6));
    }
}
