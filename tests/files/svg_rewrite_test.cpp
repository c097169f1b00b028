// SPDX-License-Identifier: Apache-2.0
// What drawings are after their shapes have moved, what `use` shows, and what is refused.
#include <catch2/catch.hpp>

#include "support/bytes.h"
#include "support/folder.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;

// Names of its own, and tests among them, as tests are compiled several files at once.
namespace svg_rewrite {
namespace {

const std::string kHead = "<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink'>";

io::CurveFile parsed(const std::string& inside, double tolerance = 10) {
  return io::parse_curves("t.svg", io::CurveFormat::Svg, kHead + inside + "</svg>", {0, tolerance});
}

/// The inside of a drawing after all points have moved by a vector, or those of one curve alone.
std::string moved(const std::string& inside, const Vec3d& by, std::size_t only = ~std::size_t{0}) {
  const io::CurveFile file = parsed(inside);
  std::vector<Vec3d> positions = file.file.polygons.positions;
  const CurvesView curves = file.file.polygons.view();
  for (std::size_t c = 0; c < curves.face_count(); ++c)
    if (only == ~std::size_t{0} || only == c)
      for (const auto p : curves.face(c)) positions[p] = curves.positions[p] + by;
  const Folder folder;
  io::write_curves(folder.file("o.svg"), file, positions);
  const std::string text = slurp(folder.file("o.svg"));
  return text.substr(kHead.size(), text.size() - kHead.size() - 6);
}

}  // namespace

TEST_CASE("drawings: shapes become paths in their places and keep all other attributes", "[curves][io]") {
  const Vec3d by(1, 0, 0);
  CHECK(moved("<circle id='a' cx='2'\n cy=\"3\" r='1' class='cut'/>", by) ==
        "<path id='a' d=\"M4,3 L3,4 L2,3 L3,2 Z\" class='cut'/>");
  CHECK(moved("<ellipse rx='2' ry='1' style='fill:none'></ellipse>", by) ==
        "<path d=\"M3,0 L1,1 L-1,0 L1,-1 Z\" style='fill:none'></path>");
  CHECK(moved("<rect fill='red' width='2' height='1' d='x' ><title>r</title></rect >", by) ==
        "<path fill='red' d=\"M1,0 L3,0 L3,1 L1,1 Z\" ><title>r</title></path >");
  CHECK(moved("<line x1='0' y1='0' x2='5' y2='0' stroke='blue'/>", by) == "<path d=\"M1,0 L6,0\" stroke='blue'/>");
  CHECK(moved("<path fill='none' d='M0 0A1 1 0 0 1 2 0z' id='p'/>", by) ==
        "<path fill='none' d='M1,0 L2,-1 L3,0 Z' id='p'/>");
  CHECK(moved("<g transform='scale(2)'><circle r='1' transform='translate(1 1)'/></g>", by) ==
        "<g transform='scale(2)'><path d=\"M1.5,0 L0.5,1 L-0.5,0 L0.5,-1 Z\" transform='translate(1 1)'/></g>");
  // A prefix stays.
  const io::CurveFile file =
      io::parse_curves("t.svg", io::CurveFormat::Svg,
                       "<s:svg xmlns:s='http://www.w3.org/2000/svg'><s:circle r='1'></s:circle></s:svg>", {0, 10});
  std::vector<Vec3d> positions = file.file.polygons.positions;
  for (Vec3d& p : positions) p += by;
  const Folder folder;
  io::write_curves(folder.file("o.svg"), file, positions);
  CHECK(slurp(folder.file("o.svg")) ==
        "<s:svg xmlns:s='http://www.w3.org/2000/svg'><s:path d=\"M2,0 L1,1 L0,0 L1,-1 Z\"></s:path></s:svg>");
}

TEST_CASE("drawings: what does not move keeps every byte, curved or not", "[curves][io]") {
  const std::string inside =
      "<defs><circle id='c' r='1'/></defs><use href='#c' x='9'/><circle cx='1e1' r='.5'/>"
      "<path d='m0 0c1 1 2 1 3 0'/><rect width='2' height='2' rx='1'/>";
  CHECK(moved(inside, {0, 0, 0}) == inside);
  // One shape moves: the others stay as they were, but for what a 'use' shows.
  CHECK(moved("<circle cx='1e1' r='.5'/><line x2='1'/>", {0, 1, 0}, 1) ==
        "<circle cx='1e1' r='.5'/><path d=\"M0,1 L1,1\"/>");
}

TEST_CASE("drawings: a use becomes a group of what it shows", "[curves][io]") {
  const Vec3d by(1, 0, 0);
  CHECK(moved("<defs><line id='l' x2='1' class='a'/></defs><use id='u' xlink:href='#l' x='5' y='2' fill='red'/>", by) ==
        "<defs><line id='l' x2='1' class='a'/></defs>"
        "<g transform=\"translate(5,2)\" id='u' fill='red'><path d=\"M1,0 L2,0\" class='a'/></g>");
  // Its own transform comes first; what it has in it stays.
  CHECK(moved("<defs><line id='l' x2='1'/></defs><use href='#l' transform='scale(2)' x='5' width='3'><title/></use>",
              by) ==
        "<defs><line id='l' x2='1'/></defs>"
        "<g transform='scale(2) translate(5,0)'><path d=\"M0.5,0 L1.5,0\"/><title/></g>");
  CHECK(moved("<defs><line id='l' x2='1'/></defs><use href='#l'/>", by) ==
        "<defs><line id='l' x2='1'/></defs><g><path d=\"M1,0 L2,0\"/></g>");
  // Of a group with another one in it, what has no lines, ids and all; only ids are dropped in copies.
  CHECK(
      moved(
          "<defs><g id='g'><line id='l' x2='1'/><text id='t'>x</text><use href='#l' y='3'/></g></defs><use href='#g'/>",
          by) ==
      "<defs><g id='g'><line id='l' x2='1'/><text id='t'>x</text><use href='#l' y='3'/></g></defs>"
      "<g><g><path d=\"M1,0 L2,0\"/><text>x</text><g transform=\"translate(0,3)\"><path d=\"M1,0 L2,0\"/></g></g></g>");
  // A shape that is drawn itself as well: it moves, and what shows it no longer refers to it, whether that moves or
  // not.
  CHECK(moved("<line id='l' x2='1'/><use href='#l' y='3'/>", by, 0) ==
        "<path id='l' d=\"M1,0 L2,0\"/><g transform=\"translate(0,3)\"><line x2='1'/></g>");
  CHECK(moved("<use href='#t'/><text id='t'/><line x2='1'/>", by) ==
        "<use href='#t'/><text id='t'/><path d=\"M1,0 L2,0\"/>");
}

TEST_CASE("drawings: a symbol is fitted into the use that shows it", "[curves][io]") {
  const std::string symbol =
      "<symbol id='s' viewBox='0 0 10 20'{}><rect width='10' height='20'/></symbol><use href='#s' x='100' width='20' "
      "height='20'/>";
  const auto corner = [&](const std::string& aspect, std::size_t index) {
    std::string text = symbol;
    text.replace(text.find("{}"), 2, aspect);
    const Vec3d p = parsed(text).file.polygons.positions[index];
    return Vec2d(p[0], p[1]);
  };
  CHECK(corner("", 0) == Vec2d(105, 0));
  CHECK(corner("", 2) == Vec2d(115, 20));
  CHECK(corner(" preserveAspectRatio='none'", 2) == Vec2d(120, 20));
  CHECK(corner(" preserveAspectRatio='xMaxYMin'", 0) == Vec2d(110, 0));
  CHECK(corner(" preserveAspectRatio='xMinYMid slice'", 0) == Vec2d(100, -10));
  std::string text = symbol;
  text.replace(text.find("{}"), 2, "");
  CHECK(moved(text, {2, 0, 0})
            .ends_with("</symbol><g transform=\"translate(100,0)\"><g "
                       "transform=\"matrix(1,0,0,1,5,0)\"><path d=\"M2,0 L12,0 L12,20 L2,20 Z\"/></g></g>") == false);
  CHECK(moved(text, {2, 0, 0})
            .ends_with("<g transform=\"translate(100,0)\"><g transform=\"translate(5,0)\"><path d=\"M2,0 "
                       "L12,0 L12,20 L2,20 Z\"/></g></g>"));
}

TEST_CASE("drawings: what was written is read back with the same points", "[curves][io]") {
  const std::string inside =
      "<defs><symbol id='s' viewBox='0 0 9 7'><ellipse cx='3' cy='3' rx='2' ry='1'/></symbol>"
      "<g id='g'><circle r='3'/><use xlink:href='#s' width='4' height='5' x='.1' y='.7'/></g></defs>"
      "<use href='#g' transform='rotate(33) skewX(7)' x='12.3'/><path transform='scale(.3)' d='M0 0q9 9 9 0t9 0z'/>";
  const io::CurveFile file = parsed(inside, 1e-3);
  std::vector<Vec3d> positions = file.file.polygons.positions;
  for (Vec3d& p : positions) p = p * 1.01 + Vec3d(0.1, 0.2, 0);
  const Folder folder;
  io::write_curves(folder.file("o.svg"), file, positions);
  const io::CurveFile back = io::read_curves(folder.file("o.svg"));
  CHECK(back.flattened_shapes == 0);
  CHECK(back.file.polygons.corners == file.file.polygons.corners);
  REQUIRE(back.file.polygons.positions.size() == positions.size());
  for (std::size_t p = 0; p < positions.size(); ++p)
    CHECK((back.file.polygons.positions[p] - positions[p]).length() < 1e-13 * 30);
}

TEST_CASE("drawings: references and lengths that cannot be followed are told by their line", "[curves][io]") {
  const auto fails = [](const std::string& inside, const std::string& message) {
    CHECK_THROWS_WITH(parsed("\n" + inside), Catch::Contains("t.svg, line 2: " + message));
  };
  fails("<use href='#a'/>", "expected an element with the id 'a', which a 'use' refers to, got none");
  fails("<use href='b.svg#a'/>", "expected a reference to an element of this file, as '#id', got 'b.svg#a' in a 'use'");
  fails("<g id='a'><use href='#a'/></g>", "expected a 'use' of something else than what it is part of");
  fails("<g id='a'><use href='#b'/></g><g id='b'><use href='#a'/></g>", "expected a 'use' of something else");
  fails("<use id='a' href='#a'/>", "expected a 'use' of something else");
  std::string bomb = "<defs><g id='g0'><path d='M0 0L1 1'/></g>";
  for (int k = 1; k < 12; ++k) {
    bomb += "<g id='g" + std::to_string(k) + "'>";
    for (int i = 0; i < 10; ++i) bomb += "<use href='#g" + std::to_string(k - 1) + "'/>";
    bomb += "</g>";
  }
  fails(bomb + "</defs><use href='#g11'/>", "expected 'use' of 1000000 elements at most, 100 deep, got more");
  std::string chain = "<defs><path id='g0' d='M0 0L1 1'/>";
  for (int k = 1; k < 200; ++k)
    chain += "<use id='g" + std::to_string(k) + "' href='#g" + std::to_string(k - 1) + "'/>";
  fails(chain + "</defs><use href='#g199'/>", "expected 'use' of 1000000 elements at most, 100 deep, got more");
  fails("<symbol id='s' viewBox='0 0 1 1'><rect width='1' height='1'/></symbol><use href='#s'/>",
        "expected a width and a height above 0 where a 'use' shows a symbol with a viewBox");
  fails("<circle r='50%'/>",
        "expected a number, alone or with px, mm, cm, in, pt, pc or Q behind it, got '50%' in 'r'");
  fails("<circle r='1' cx='2em'/>", "expected a number, alone or with px");
  fails("<circle r='-1'/>", "expected 'r' of 0 or more, got '-1'");
  fails("<rect width='1' height='x'/>", "expected a length, got 'x' in 'height'");
  fails("<circle style='r:3; fill: none' cx='1'/>",
        "expected the geometry of shapes in attributes, got 'r' in a style");
  fails("<path d='M0 0A1 1 0 2 0 1 1'/>", "expected a flag of an arc, 0 or 1, got '2 0 1 1' in a path's 'd'");
  fails("<path d='M0 0C1 1 2 2'/>", "expected a number for x, got its end in a path's 'd'");
  CHECK_THROWS_WITH(parsed("<circle r='1e300'/>", 1e-300),
                    Catch::Contains("segments can follow to within 1e-300 (--flatten)"));
}

TEST_CASE("drawings: the unit is what size, viewBox and preserveAspectRatio make of it", "[curves][io]") {
  const auto unit = [](const std::string& attributes) {
    const std::string text = "<svg xmlns='http://www.w3.org/2000/svg' " + attributes + "><path d='M0 0L1 1'/></svg>";
    return io::parse_curves("t.svg", io::CurveFormat::Svg, text).file.unit_micrometres;
  };
  const double pixel = 25400. / 96;
  // Without a viewBox, a pixel of CSS, whatever the size.
  for (const char* size : {"", "width='10cm' height='2in'", "width='100%'"}) CHECK(unit(size) == pixel);
  const std::string view = "viewBox='0 0 1000 500' ";
  for (const auto& [size, micrometres] : {std::pair<const char*, double>{"100mm", 100},
                                          {"10cm", 100},
                                          {" 10in\n", 254},
                                          {"720pt", 254},
                                          {"60pc", 254},
                                          {"400Q", 100},
                                          {"960px", 254},
                                          {"960", 254},
                                          {"1e2mm", 100}}) {
    INFO(size);
    // The height follows from the width where it is missing.
    REQUIRE(unit(view + "width='" + size + "'"));
    CHECK(*unit(view + "width='" + size + "'") == Approx(micrometres).epsilon(1e-15));
    CHECK(*unit(view + "height='" + size + "'") == Approx(2 * micrometres).epsilon(1e-15));
    CHECK(*unit(view + "style='width: 1in; width: " + size + "' width='7mm' height='auto'") ==
          Approx(micrometres).epsilon(1e-15));
  }
  CHECK(unit("viewBox='-3,4 210, 297' width='210mm' height='297mm'") == 1000.0);  // exactly
  // What does not fit is made smaller, cut off, or stretched: then x and y have units of their own.
  const std::string square = view + "width='100mm' height='100mm' ";
  CHECK(unit(square) == 100.0);
  CHECK(unit(square + "preserveAspectRatio='xMinYMax meet'") == 100.0);
  CHECK(unit(square + "preserveAspectRatio='xMidYMid slice'") == 200.0);
  CHECK(unit(square + "preserveAspectRatio='none'") == std::nullopt);
  CHECK(unit(view + "width='100mm' height='50.01mm' preserveAspectRatio='none'") == 100.0);
  // Sizes that depend on where the drawing is shown, and what is no size.
  for (const char* size : {"", "width='100%' height='100%'", "width='100mm' height='50%'", "width='10em'", "width='0'",
                           "width='-3mm'", "width='calc(1mm + 1mm)'", "width='mm'"}) {
    INFO(size);
    CHECK(unit(view + size) == std::nullopt);
  }
  for (const char* box : {"", "0 0 10", "0 0 0 10", "0 0 10 -1", "a b c d"})
    CHECK(unit(std::string("width='1mm' viewBox='") + box + "'") == std::nullopt);
}

TEST_CASE("drawings: what says that it is not shown is not drawn", "[curves][io]") {
  const auto curves_of = [](const std::string& hidden) {
    return parsed(hidden + "<line x2='1'/>").file.polygons.face_count();
  };
  CHECK(curves_of("<rect class='BoundingBox' stroke='none' fill='none' width='9' height='9'/>") == 1);
  CHECK(curves_of("<rect style='fill:none; stroke : none' width='9' height='9'/>") == 1);
  CHECK(curves_of("<rect style='stroke:red' fill='none' stroke='none' width='9' height='9'/>") == 2);
  CHECK(curves_of("<rect fill='none' width='9' height='9'/>") == 2);
  CHECK(curves_of("<rect fill='none' style='stroke:none;stroke:red' width='9' height='9'/>") == 2);
  CHECK(curves_of("<g style='display:none'><g><rect width='9' height='9'/></g></g>") == 1);
  CHECK(curves_of("<g display='none' style='display:inline'><rect width='9' height='9'/></g>") == 2);
  CHECK(curves_of("<use href='#a'><circle r='1'/></use><g id='a'/><circle r='1'><circle r='2'/></circle>") == 2);
}

TEST_CASE("drawings: what is only referred to is not drawn", "[curves][io]") {
  const io::CurveFile file = parsed(
      "<symbol id='s'><circle r='1'/></symbol><clipPath><use href='#nothing'/><rect width='50%'/></clipPath>"
      "<marker><path d='M0 0C'/></marker><pattern><circle r='1'/></pattern><mask><circle r='1'/></mask>"
      "<g display='inline'><line x2='1'/></g><use/><use href='#s'/>");
  CHECK(file.file.polygons.face_count() == 2);
  CHECK(file.flattened_shapes == 1);
}

}  // namespace svg_rewrite
