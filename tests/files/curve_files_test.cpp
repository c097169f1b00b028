// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include "support/bytes.h"
#include "support/curve_oracles.h"
#include "support/curve_runs.h"
#include "support/folder.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

TEST_CASE("curve files: text keeps its bytes but for the numbers", "[curves][io]") {
  const std::string text = "My foil\r\n# first, closed\n 1.0 0.0 \n0,5 1\n";
  CHECK_THROWS_WITH(io::parse_curves("a.dat", io::CurveFormat::Text, text),
                    Catch::Contains("a.dat, line 4: expected a coordinate, got '0,5'"));
  const Folder folder;
  const std::string good = "My foil\r\n# first, closed\n 1.0 0.0 \n0.5\t1 # tip\n-.5 .0e0\n\n\n# second\n3 3\n4 4\n";
  const io::CurveFile read = io::read_curves(folder.write("a.dat", good));
  REQUIRE(read.file.polygons.face_count() == 2);
  CHECK(read.file.polygons.corners == std::vector<std::uint32_t>{0, 1, 2, 0, 3, 4});
  std::vector<Vec3d> moved = read.file.polygons.positions;
  io::write_curves(folder.file("same.dat"), read, moved);
  CHECK(slurp(folder.file("same.dat")) == good);
  moved[1] = Vec3d(0.25, -2, 0);
  io::write_curves(folder.file("b.dat"), read, moved);
  CHECK(slurp(folder.file("b.dat")) ==
        "My foil\r\n# first, closed\n 1.0 0.0 \n0.25\t-2 # tip\n-.5 .0e0\n\n\n# second\n3 3\n4 4\n");
  io::write_curves(folder.file("b.obj"), read, moved);
  CHECK(slurp(folder.file("b.obj")) == "v 1 0 0\nv 0.25 -2 0\nv -0.5 0 0\nv 3 3 0\nv 4 4 0\nl 1 2 3 1\nl 4 5\n");
  io::write_curves(folder.file("c.txt"), io::read_curves(folder.file("b.obj")), moved);
  CHECK(slurp(folder.file("c.txt")) == "1 0\n0.25 -2\n-0.5 0\n1 0\n\n3 3\n4 4\n");
}

TEST_CASE("curve files: airfoils in Lednicer's order are one curve from end to end", "[curves][io]") {
  const std::string text = "Foil\n 3. 3.\n\n0 0\n0.5 0.1\n1 0.01\n\n0 0\n0.5 -0.1\n1 -0.01\n";
  const io::CurveFile read = io::parse_curves("foil.dat", io::CurveFormat::Text, text);
  CHECK(read.file.polygons.positions.size() == 6);
  CHECK(read.file.polygons.corners == std::vector<std::uint32_t>{2, 1, 0, 3, 4, 5});
  CHECK(io::patched_bytes(read.file, read.file.polygons.positions) == text);
}

TEST_CASE("curve files: a drawing keeps its bytes but for the shapes that move", "[curves][io]") {
  const std::string head =
                        "<?xml version='1.0'?>\r\n<svg:svg xmlns:svg=\"http://www.w3.org/2000/svg\"><!-- d=\"M\" -->"
                        "<defs><path d=\"M0 0C1 1 2 2 3 3\"/><circle r='1'/></defs><text>a&amp;b</text>",
                    first = "<svg:path id='d' d = '", second = "'/>\n<polygon points=\"",
                    third = "\" fill='d=\"'/><polyline data-points='1' points='", tail = "'/></svg:svg>\n";
  const auto drawing = [&](const std::string& path, const std::string& polygon, const std::string& line) {
    return head + first + path + second + polygon + third + line + tail;
  };
  const std::string text = drawing("m1,2 3-.5h+1V1e1.5.25z l-1 0m5.5.5-1-1", "0 0 4 0 4,3", "7,7 8 8");
  const Folder folder;
  const io::CurveFile read = io::read_curves(folder.write("a.svg", text));
  CHECK(read.planar);
  const Curves& curves = read.file.polygons;
  CHECK(curves.positions == std::vector<Vec3d>{{1, 2, 0},
                                               {4, 1.5, 0},
                                               {5, 1.5, 0},
                                               {5, 10, 0},
                                               {5, 0.5, 0},
                                               {5, 0.25, 0},
                                               {1, 2, 0},
                                               {0, 2, 0},
                                               {5.5, 2.5, 0},
                                               {4.5, 1.5, 0},
                                               {0, 0, 0},
                                               {4, 0, 0},
                                               {4, 3, 0},
                                               {7, 7, 0},
                                               {8, 8, 0}});
  CHECK(curves.corners == std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 0, 6, 7, 8, 9, 10, 11, 12, 10, 13, 14});
  CHECK(curves.face_begin == std::vector<std::uint32_t>{0, 7, 9, 11, 15, 17});
  std::vector<Vec3d> moved = curves.positions;
  io::write_curves(folder.file("same.svg"), read, moved);
  CHECK(slurp(folder.file("same.svg")) == text);
  moved[9] = Vec3d(-1, 0.125, 0);
  io::write_curves(folder.file("b.svg"), read, moved);
  const std::string path = "M1,2 L4,1.5 L5,1.5 L5,10 L5,0.5 L5,0.25 Z M1,2 L0,2 M5.5,2.5 L-1,0.125";
  CHECK(slurp(folder.file("b.svg")) == drawing(path, "0 0 4 0 4,3", "7,7 8 8"));
  moved = curves.positions;
  moved[12] = Vec3d(4, 4, 0);
  moved[13] = Vec3d(6, 7, 0);
  io::write_curves(folder.file("c.svg"), read, moved);
  CHECK(slurp(folder.file("c.svg")) == drawing("m1,2 3-.5h+1V1e1.5.25z l-1 0m5.5.5-1-1", "0,0 4,0 4,4", "6,7 8,8"));
  // Curves that come from elsewhere, and back.
  io::write_curves(folder.file("d.txt"), io::read_curves(folder.file("c.svg")), moved);
  const io::CurveFile plain = io::read_curves(folder.file("d.txt"));
  io::write_curves(folder.file("e.svg"), plain, plain.file.polygons.positions);
  const io::CurveFile back = io::read_curves(folder.file("e.svg"));
  CHECK(back.file.polygons.face_count() == plain.file.polygons.face_count());
  CHECK(back.file.polygons.positions == moved);
  moved[0][2] = 1;
  CHECK_THROWS_WITH(io::write_curves(folder.file("f.svg"), Curves{moved, curves.corners, curves.face_begin}.view()),
                    Catch::Contains("z = 0"));
}

TEST_CASE("curve files: a drawing's transforms are undone where points are written", "[curves][io]") {
  const std::string text =
      "<svg><g transform='translate(10 -5)scale(2)'><path transform='rotate(90),skewX(45)' d='M1 0 L1 1'/>"
      "<path transform=' rotate ( 180 , 1 0.5 ) ' d='M0 0 L1 1'/></g>"
      "<polyline transform='matrix(0 1 -1 0 3 4) scale(1 3)skewY(45)' points='1 2 3 4'/></svg>";
  const io::CurveFile read = io::parse_curves("t.svg", io::CurveFormat::Svg, text);
  const Vec3d expected[] = {{10, -3, 0}, {8, -1, 0}, {14, -3, 0}, {12, -5, 0}, {-6, 5, 0}, {-18, 7, 0}};
  const auto& positions = read.file.polygons.positions;
  REQUIRE(positions.size() == 6);
  for (std::size_t p = 0; p < 6; ++p) CHECK((positions[p] - expected[p]).length() < 1e-14);
  std::vector<Vec3d> moved = positions;
  for (Vec3d& p : moved) p += Vec3d(0.5, -0.25, 0);
  const Folder folder;
  io::write_curves(folder.file("t.svg"), read, moved);
  const io::CurveFile back = io::read_curves(folder.file("t.svg"));
  for (std::size_t p = 0; p < 6; ++p) CHECK((back.file.polygons.positions[p] - moved[p]).length() < 1e-14);
  CHECK(slurp(folder.file("t.svg")).find("rotate ( 180 , 1 0.5 ) ' d='M-0.2") != std::string::npos);
}

TEST_CASE("curve files: drawings as programs write them", "[curves][io]") {
  const auto parse = [](const std::string& text) { return io::parse_curves("t.svg", io::CurveFormat::Svg, text); };
  // What is not SVG's, in hidden parts and empty is passed over; styles may speak of other transforms.
  const io::CurveFile odd = parse(
      "<svg xmlns='http://www.w3.org/2000/svg' xmlns:o='x'><metadata><o:path d='C 1'/></metadata><o:rect/>"
      "<path d='none'/><path d=''/><path/><text style='text-transform:none'/>"
      "<path transform='none' d='m 0.1,0.1 l 0,0.2 0.2,0 0,-0.2 -0.2,0'/></svg>");
  const Curves& square = odd.file.polygons;
  REQUIRE(square.positions.size() == 5);
  CHECK(square.positions.front() == square.positions.back());  // but for rounding it ends where it began
  // Digits are those of the drawing's coordinates, whatever the shape's own are; a point that stays keeps all of its.
  const std::string text =
      "<svg><g transform='translate(-1000,-1000)'><path d='M1000,1000 L1000.3,1000 1000.3,1000.3 Z'/></g>"
      "<path d='M30.123456 1L2 3'/></svg>";
  const io::CurveFile shifted = parse(text);
  std::vector<Vec3d> moved = shifted.file.polygons.positions;
  moved[0] = Vec3d(-0.123456, 0.25, 0);
  moved[4] = Vec3d(2.123456, 3, 0);
  const Folder folder;
  io::WriteOptions three;
  three.digits = 3;
  io::write_curves(folder.file("t.svg"), shifted, moved, three);
  CHECK(slurp(folder.file("t.svg")) ==
        "<svg><g transform='translate(-1000,-1000)'><path d='M999.877,1000.25 L1000.3,1000 L1000.3,1000.3 Z'/></g>"
        "<path d='M30.123456,1 L2.12,3'/></svg>");
}

TEST_CASE("curve files: mistakes in a drawing are told by their line", "[curves][io]") {
  const auto fails = [](const std::string& text, const std::string& message) {
    CHECK_THROWS_WITH(io::parse_curves("f.svg", io::CurveFormat::Svg, text), Catch::Contains(message));
  };
  const auto path = [](const std::string& data) { return "<svg>\n<path\nd='" + data + "'/></svg>"; };
  fails("", "byte 0");
  fails("<svg>\n<path", "f.svg, line 2: expected XML, got 'unclosed token'");
  fails("solid\n", "f.svg, line 1: expected XML");
  fails("<html/>", "f.svg, line 1: expected an element 'svg', got 'html'");
  fails(std::string("\xff\xfe<\0s\0", 6), "expected a drawing in UTF-8, got UTF-16");
  fails("<svg><defs><path d='M0 0L1 1'/></defs></svg>", "expected a path or another shape with two points");
  fails(path("M0 0 B 1 1"),
        "f.svg, line 2: expected one of the commands M, L, H, V, C, S, Q, T, A and Z, got 'B 1 1' in a path's 'd'");
  fails(path("M0 0 1"), "expected a number for y, got its end in a path's 'd'");
  fails(path("L0 0"), "expected a path that begins with M, got 'L0 0'");
  fails(path("1 2"), "expected one of the commands M, L, H, V, C, S, Q, T, A and Z, got '1 2'");
  fails(path("M0 0Z 1 2"), "expected one of the commands");
  fails(path("M0 0L1e999 2"), "expected a number for x, got '1e999 2'");
  fails(path("M0 0Linf 2"), "expected a number for x, got 'inf 2'");
  fails("<svg><svg><path d='M0 0L1 1'/></svg></svg>", "expected one element 'svg', got another one in it");
  fails("<svg><polygon points='0 0 1'/></svg>", "expected a number for y, got its end in a list of points");
  fails("<svg transform='turn(3)'/>", "expected a transform that SVG knows, not 'turn' of 1 numbers, before here");
  fails("<svg transform='scale(1 2 3)'/>", "not 'scale' of 3 numbers");
  fails("<svg transform='scale 2'/>", "expected a transform such as 'translate(1 2)'");
  fails("<!DOCTYPE svg [<!ENTITY e \"<path d='M0 0L1 1'/>\">]>\n<svg>&e;<path d='M0 0L1 1'/></svg>",
        "f.svg, line 2: expected an attribute 'd' in the element itself, got one that a DTD declares");
  fails("<!DOCTYPE svg [<!ATTLIST path d CDATA 'M0 0L1 1'>]>\n<svg><path id='a'/><path d='M0 0L1 1'/></svg>",
        "f.svg, line 2: expected an attribute 'd' in the element itself");
  fails("<svg><g style='fill:none; transform : scale(2)'/></svg>", "expected transforms that are attributes");
  fails(path("M0 +-1L1 1"), "expected a number for y, got '+-1L1 1'");
  fails("<svg transform='scale(0)'><path d='M0 0L1 1'/></svg>", "expected a transform that can be undone");
}

TEST_CASE("curve files: mistakes are told by their line", "[curves][io]") {
  const auto fails = [](io::CurveFormat format, const std::string& text, const std::string& message) {
    CHECK_THROWS_WITH(io::parse_curves("f", format, text), Catch::Contains(message));
  };
  using enum io::CurveFormat;
  fails(Text, "", "byte 0");
  fails(Text, "only a title\n", "at least one line 'x y'");
  fails(Text, "1 2\n1 2 3\n", "f, line 2: expected 2 coordinates");
  fails(Text, "1 2\n1\n", "f, line 2: expected a coordinate, got the end of the line");
  fails(Text, "1 2\nnan 2\n", "finite");
  fails(Text, "1 2\n\n3 4\n", "f: expected a curve of 2 points or more, got single points alone (2)");
  fails(Obj, "v 0 0 0\nl 1\n", "f, line 2: expected at least 2 points");
  fails(Obj, "v 0 0 0\nl 1 2\n", "f, line 2: expected a vertex index up to 1");
  fails(Obj, "v 0 0 0\nl 1 -2\n", "f, line 2: expected a vertex index within the 1 read so far");
}

/// Run by the acceptance tests where there is a folder of real curves.
TEST_CASE("curve files: real curves at four distances", "[.curve_files]") {
  const char* const folder = std::getenv("VDB_OFFSET_CURVES");
  REQUIRE(folder);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    ++files;
    const io::CurveFile read = io::read_curves(entry.path().string());
    const Curves& curves = read.file.polygons;
    const double diagonal = used_diagonal(curves.view());
    for (const double percent : {0.5, -0.5, 2.0, -2.0}) {
      CAPTURE(entry.path().filename().string(), percent);
      require_honest(curves, offset_of(curves, percent / 100 * diagonal));
    }
  }
  CHECK(files >= 9);
}
