// SPDX-License-Identifier: Apache-2.0
// What DXF files are after their curves have moved, by a reader of the test's own, and those of curves from elsewhere.
//
// Tried as well, by hand, beside GDAL's OGR: files of LibreCAD 1 (dxflib 2.2, R2000: an elliptical arc and a line) and
// 2 (dxfrw 0.6.3, R2007: a spline that says it is closed and is not, seen from (0, 0, 0)), of OpenSCAD (lines with six
// digits, no header), of a program on ODA's library (R2004: a POLYLINE with handles for its vertices), and one of R2.6
// (all x of a line before all y, arcs up to an angle of 0). The inputs below are as these programs write them.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>

#include "support/bytes.h"
#include "support/dxf_text.h"
#include "support/folder.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;

// Names of its own, and tests among them, as tests are compiled several files at once.
namespace dxf_rewrite {
namespace {

constexpr double kCoarse = 10;

std::string written(const io::CurveFile& file, std::span<const Vec3d> positions, const io::WriteOptions& options = {}) {
  const Folder folder;
  io::write_curves(folder.file("o.dxf"), file, positions, options);
  return slurp(folder.file("o.dxf"));
}

io::CurveFile parsed(const std::string& text, double tolerance = kCoarse) {
  return io::parse_curves("t.dxf", io::CurveFormat::Dxf, text, {0, tolerance});
}

/// A file after all points have moved by a vector, or those of one curve alone.
std::string moved(const std::string& text, const Vec3d& by, std::size_t only = ~std::size_t{0}) {
  const io::CurveFile file = parsed(text);
  std::vector<Vec3d> positions = file.file.polygons.positions;
  const CurvesView curves = file.file.polygons.view();
  for (std::size_t c = 0; c < curves.face_count(); ++c)
    if (only == ~std::size_t{0} || only == c)
      for (const auto p : curves.face(c)) positions[p] = curves.positions[p] + by;
  const std::string made = written(file, positions);
  // Whatever is written is read with the same points.
  const io::CurveFile back = parsed(made);
  CHECK(back.file.polygons.positions == positions);
  CHECK(back.file.polygons.corners == file.file.polygons.corners);
  return made;
}

std::string moved_entities(const std::string& brief, const std::string& header = "9|$ACADVER 1|AC1015") {
  const std::string made = moved(dxf_text::file(brief, header), Vec3d(1, 0, 0));
  const std::size_t begin = made.find("ENTITIES\n") + 9;
  return made.substr(begin, made.rfind("0\nENDSEC") - begin);
}

const std::string kR12 = "9|$ACADVER 1|AC1009";

}  // namespace

TEST_CASE("dxf: entities with straight segments keep all but their coordinates", "[curves][io][dxf]") {
  CHECK(moved_entities("0|LINE 5|A 8|cut 62|1 10|1.50 20|2.00 30|0.0 11|4 21|5.0 31|0.0 1001|X 1040|7") ==
        dxf_text::groups("0|LINE 5|A 8|cut 62|1 10|2.5 20|2.00 30|0.0 11|5 21|5.0 31|0.0 1001|X 1040|7"));
  CHECK(
      moved_entities("0|LINE 8|1 6|CONTINUOUS 10|1.5000 11|2.0000 20|-0.0000 21|-0.0000 62|5", "9|$ACADVER 1|AC1003") ==
      dxf_text::groups("0|LINE 8|1 6|CONTINUOUS 10|2.5 11|3 20|-0.0000 21|-0.0000 62|5"));
  CHECK(moved_entities("0|LWPOLYLINE 8|cut 90|2 70|1 43|0.2 10|0.0 20|0 10|4 20|0.00 40|1 41|2 210|0 220|0 230|1") ==
        dxf_text::groups("0|LWPOLYLINE 8|cut 90|2 70|1 43|0.2 10|1 20|0 10|5 20|0.00 40|1 41|2 210|0 220|0 230|1"));
  CHECK(
      moved_entities("0|POLYLINE 5|71 8|L 100|AcDb2dPolyline 66|1 10|0.0 20|0.0 30|0.0 70|1 0|VERTEX 5|72 330|71 8|L "
                     "10|0.0 20|0.0 30|0.0 0|VERTEX 5|73 330|71 8|L 10|10.0 20|0.0 30|0.0 0|SEQEND 5|76") ==
      dxf_text::groups("0|POLYLINE 5|71 8|L 100|AcDb2dPolyline 66|1 10|0.0 20|0.0 30|0.0 70|1 0|VERTEX 5|72 330|71 8|L "
                       "10|1 20|0.0 30|0.0 0|VERTEX 5|73 330|71 8|L 10|11 20|0.0 30|0.0 0|SEQEND 5|76"));
  // Seen from below, x runs to the left.
  CHECK(moved_entities("0|LWPOLYLINE 8|cut 90|2 70|0 10|3 20|0 10|4 20|0 230|-1") ==
        dxf_text::groups("0|LWPOLYLINE 8|cut 90|2 70|0 10|2 20|0 10|3 20|0 230|-1"));
  // Of ends that were one but for rounding, those that move are so afterwards; those that stay keep their digits.
  const std::string joined = "0|LINE 10|0 20|0 11|100 21|0 0|LINE 10|100.000001 20|0.000001 11|100 21|50";
  CHECK(moved_entities(joined) == dxf_text::groups("0|LINE 10|1 20|0 11|101 21|0 0|LINE 10|101 20|0 11|101 21|50"));
  CHECK_THAT(moved(dxf_text::file("0|LINE 11|9 21|9 " + joined), Vec3d(0, 0, 1), 0),
             Catch::Contains("10\n100.000001\n"));
  // What applications keep in an entity, and what stands behind the last vertex, are no coordinates.
  CHECK(moved_entities("0|LINE 102|{X 10|7 102|} 10|1 20|2 11|4 21|5") ==
        dxf_text::groups("0|LINE 102|{X 10|7 102|} 10|2 20|2 11|5 21|5"));
  CHECK(moved_entities("0|POLYLINE 66|1 0|VERTEX 10|1 20|2 0|VERTEX 10|4 20|5 0|SEQEND 10|7") ==
        dxf_text::groups("0|POLYLINE 66|1 0|VERTEX 10|2 20|2 0|VERTEX 10|5 20|5 0|SEQEND 10|7"));
  // A line that leaves z = 0, of which it has no groups, gets some; a flat polyline that does becomes one in space.
  CHECK_THAT(moved(dxf_text::file("0|LINE 10|1 20|2 11|4 21|5"), Vec3d(0, 0, 3)),
             Catch::Contains("20\n2\n 30\n3\n11\n4\n21\n5\n 31\n3\n"));
  const io::CurveFile flat =
      parsed(dxf_text::file("0|LWPOLYLINE 8|a 90|2 70|0 10|0 20|0 10|1 20|0", "9|$ACADVER 1|AC1015"));
  const std::vector<dxf_text::Entity> risen =
      dxf_text::entities(written(flat, std::vector<Vec3d>{{0, 0, 0}, {1, 0, 2}}));
  REQUIRE(risen.size() == 4);
  CHECK((risen[0].type == "POLYLINE" && risen[0].number(70) == 8 && risen[2].number(30) == 2));
}

TEST_CASE("dxf written: a list that an entity leaves open takes in nothing of its new form", "[dxf]") {
  for (const char* const header : {"9|$ACADVER 1|AC1015", "9|$ACADVER 1|AC1009"})
    CHECK_THAT(moved_entities("0|CIRCLE 5|2F 10|0 20|0 40|1 102|{X 1|a", header),
               Catch::Contains("102\n{X\n1\na\n102\n}\n"));
}

TEST_CASE("dxf: curved entities become polylines and keep what they have beside their form", "[curves][io][dxf]") {
  const std::string made = moved(
      dxf_text::file("0|CIRCLE 5|2F 102|{ACAD_REACTORS 330|1C 102|} 330|1F 100|AcDbEntity 8|holes 6|DASHED 62|3 370|25 "
                     "100|AcDbCircle 39|0.5 10|2 20|3 30|1.5 40|1 1001|ACAD 1070|7",
                     "9|$ACADVER 1|AC1015"),
      Vec3d(1, 0, 0));
  const dxf_text::Entity polyline = dxf_text::entities(made).front();
  std::string brief;
  for (const auto& [code, value] : polyline.groups)
    brief += fmt::format(" {}|{}", code, value.substr(value.find_first_not_of(' ')));
  CHECK(
      brief ==
      " 5|2F 102|{ACAD_REACTORS 330|1C 102|} 330|1F 100|AcDbEntity 8|holes 6|DASHED 62|3 370|25 100|AcDbPolyline 90|4 "
      "70|1 38|1.5 39|0.5 10|4 20|3 10|3 20|4 10|2 20|3 10|3 20|2 1001|ACAD 1070|7");
}

TEST_CASE("dxf: kinds of curves become the polyline that the version has", "[curves][io][dxf]") {
  const std::string ellipse = "0|ELLIPSE 8|a 10|0 20|0 11|2 21|0 40|0.5 41|0 42|6.283185307179586",
                    bulged = "0|LWPOLYLINE 8|a 90|2 70|129 43|0.5 10|0 20|0 42|1 10|2 20|0 42|1",
                    arc = "0|ARC 8|a 62|4 39|2 10|0 20|0 40|1 50|0 51|90",
                    old =
                        "0|POLYLINE 8|a 66|1 70|1 0|VERTEX 8|a 10|0 20|0 42|1 0|VERTEX 8|a 10|2 20|0 42|1 0|SEQEND 8|a";
  const auto type = [](const std::string& entity, const std::string& header) {
    return dxf_text::entities(moved(dxf_text::file(entity, header), Vec3d(0, 1, 0))).front();
  };
  for (const std::string& each : {ellipse, bulged, arc, old})
    CHECK(type(each, "9|$ACADVER 1|AC1027").type == "LWPOLYLINE");
  CHECK(type(bulged, "9|$ACADVER 1|AC1027").number(70) == 129);
  CHECK(type(bulged, "9|$ACADVER 1|AC1027").number(43) == 0.5);
  const dxf_text::Entity r12 = type(arc, kR12);
  CHECK((r12.type == "POLYLINE" && r12.number(62) == 4 && r12.number(66) == 1 && r12.number(39) == 2));
  const std::string of_classes = "0|ARC 5|9 100|AcDbEntity 8|a 100|AcDbCircle 10|0 20|0 40|1 100|AcDbArc 50|0 51|90";
  const dxf_text::Entity r13 = type(of_classes, "9|$ACADVER 1|AC1012");
  CHECK((r13.type == "POLYLINE" && r13.groups[3] == std::pair{100, std::string("AcDb2dPolyline")}));
  CHECK(type(old, kR12).type == "POLYLINE");
  // What stands in a file of no version came with R13 itself.
  CHECK(type(ellipse, "").type == "LWPOLYLINE");
}

TEST_CASE("dxf: every other byte stays, and all of them at distance 0", "[curves][io][dxf]") {
  std::string text = "999\nmade by hand\n" +
                     dxf_text::file(
                         "0|CIRCLE 8|a 10|0 20|0 40|1 0|TEXT 1|caf\xe9 0|SPLINE 8|b 71|1 40|0 40|0 40|1 40|1 10|0 20|0 "
                         "10|3 20|0 0|INSERT 2|b 10|9 20|9",
                         "9|$ACADVER 1|AC1015 9|$HANDSEED 5|FF", "0|BLOCK 2|b 0|LINE 8|0 11|1 0|ENDBLK",
                         "0|TABLE 2|LAYER 0|LAYER 2|a 70|0 62|7 0|ENDTAB");
  for (const char* const line_end : {"\n", "\r\n", "\r"}) {
    std::string of_lines;
    for (const char c : text) c == '\n' ? of_lines += line_end : of_lines += c;
    const io::CurveFile file = parsed(of_lines);
    CHECK(written(file, file.file.polygons.positions) == of_lines);
    std::vector<Vec3d> positions = file.file.polygons.positions;
    for (const auto p : file.file.polygons.view().face(0)) positions[p] += Vec3d(0, 1, 0);
    const std::string made = written(file, positions);
    const std::size_t begin = of_lines.find("CIRCLE"), end = of_lines.find("TEXT");
    CHECK(made.substr(0, begin - 3) == of_lines.substr(0, begin - 3));
    CHECK(made.substr(made.find("TEXT")) == of_lines.substr(end));
    CHECK(made.find(line_end) != std::string::npos);
    if (line_end != std::string("\n")) CHECK(std::count(made.begin(), made.end(), '\r') > 20);
  }
}

TEST_CASE("dxf: an INSERT becomes what it shows, if that moves", "[curves][io][dxf]") {
  const std::string
      header = "9|$ACADVER 1|AC1015 9|$HANDSEED 5|2B",
      blocks =
          "0|BLOCK 2|b 0|LINE 5|20 100|AcDbEntity 8|0 62|0 6|ByBlock 10|0 20|0 11|1 21|0 0|CIRCLE 5|21 8|holes "
          "62|3 10|0 20|0 40|1 0|ENDBLK 0|BLOCK 2|both 0|INSERT 2|b 8|0 62|0 6|BYBLOCK 10|5 20|0 0|ENDBLK";
  const std::string text = dxf_text::file(
      "0|LINE 5|28 8|a 10|50 11|60 0|INSERT 5|2A 330|1F 8|cut 62|5 6|DOT 2|both 10|10 20|0 41|2 42|2 0|INSERT "
      "5|29 8|cut 2|b 10|0 20|9",
      header, blocks);
  std::vector<dxf_text::Entity> made = dxf_text::entities(moved(text, Vec3d(0, 1, 0), 1));
  REQUIRE(made.size() == 4);
  CHECK((made[0].type == "LINE" && made[3].type == "INSERT"));
  const dxf_text::Entity &line = made[1], &circle = made[2];
  // What it leaves to the block is what the INSERT has.
  CHECK((line.type == "LINE" && line.value(8) == "cut" && line.value(62) == "5" && line.value(6) == "DOT"));
  CHECK((line.number(10) == 20 && line.number(20) == 1 && line.number(11) == 22));
  CHECK((circle.type == "LWPOLYLINE" && circle.value(8) == "holes" && circle.value(62) == "3"));
  CHECK(circle.numbers(10) == std::vector<double>{22, 20, 18, 20});
  // Handles are new, above all that the file has, and the next one is told.
  CHECK((line.value(5) == "2C" && circle.value(5) == "2D" && line.value(330) == "1F"));
  CHECK_THAT(moved(text, Vec3d(0, 1, 0), 1), Catch::Contains("$HANDSEED\n5\n2E\n"));
  CHECK_THAT(moved(text, Vec3d(0, 1, 0), 0), Catch::Contains("$HANDSEED\n5\n2B\n"));
  // An array becomes a copy at each of its places.
  const std::string array = dxf_text::file("0|INSERT 8|cut 2|b 70|3 71|2 44|5 45|7", kR12, blocks);
  made = dxf_text::entities(moved(array, Vec3d(1, 0, 0)));
  CHECK(std::count_if(made.begin(), made.end(), [](const auto& each) { return each.type == "LINE"; }) == 6);
  CHECK(std::count_if(made.begin(), made.end(), [](const auto& each) { return each.type == "SEQEND"; }) == 6);
}

TEST_CASE("dxf: an INSERT that shows something else is not taken apart", "[curves][io][dxf]") {
  const auto refused = [](const std::string& insert, const std::string& more) {
    const io::CurveFile file = parsed(dxf_text::file(insert, "",
                                                     "0|BLOCK 2|b 0|LINE 8|0 11|1 " + more +
                                                         "0|ENDBLK "
                                                         "0|BLOCK 2|c 0|INSERT 2|b 0|ENDBLK"));
    CHECK(written(file, file.file.polygons.positions).size() > 20);  // as long as nothing moves
    std::vector<Vec3d> positions = file.file.polygons.positions;
    positions[0] += Vec3d(1, 0, 0);
    try {
      written(file, positions);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK(refused("0|INSERT 2|b", "") == "");
  CHECK_THAT(refused("0|INSERT 2|b", "0|TEXT 1|7 "), Catch::Contains("got 'TEXT'"));
  CHECK_THAT(refused("0|INSERT 2|c", "0|TEXT 1|7 "), Catch::Contains("line 15: expected curves that are shown"));
  CHECK_THAT(refused("0|INSERT 2|b", "0|LINE 60|1 11|1 "), Catch::Contains("got 'LINE'"));
  CHECK_THAT(refused("0|INSERT 66|1 2|b 0|ATTRIB 1|7 0|SEQEND", ""), Catch::Contains("got 'ATTRIB'"));
}

TEST_CASE("dxf: coordinates that move have the digits that are asked for", "[curves][io][dxf]") {
  const io::CurveFile file = parsed(dxf_text::file("0|LINE 10|1.23456789 20|0 11|4 21|0 0|CIRCLE 10|0 20|0 40|1"));
  std::vector<Vec3d> positions = file.file.polygons.positions;
  for (Vec3d& p : positions) p += Vec3d(1. / 3, 0, 0);
  io::WriteOptions options;
  options.digits = 4;
  const std::vector<dxf_text::Entity> made = dxf_text::entities(written(file, positions, options));
  CHECK(made[0].value(10) == "1.568");
  CHECK(made[0].value(11) == "4.333");
  CHECK(made[2].value(10) == "1.333");
}

TEST_CASE("dxf: curves of other files become the least that readers take", "[curves][io][dxf]") {
  const io::CurveFile lines =
      io::parse_curves("t.txt", io::CurveFormat::Text, "# closed\n0 0\n4 0\n4 3\n\n1 1\n2 2.5\n\n7 7\n", {});
  const Folder folder;
  io::write_curves(folder.file("o.dxf"), lines, lines.file.polygons.positions);
  const std::string text = slurp(folder.file("o.dxf"));
  CHECK_THAT(text, Catch::StartsWith("  0\nSECTION\n  2\nHEADER\n  9\n$ACADVER\n  1\nAC1009\n") &&
                       Catch::EndsWith("  0\nENDSEC\n  0\nEOF\n"));
  const std::vector<dxf_text::Entity> made = dxf_text::entities(text);
  REQUIRE(made.size() == 9);  // of a point alone nothing is left
  CHECK((made[0].type == "POLYLINE" && made[0].number(70) == 1 && made[3].number(20) == 3 && made[4].type == "SEQEND"));
  CHECK((made[5].type == "POLYLINE" && made[5].number(70) == 0 && made[7].number(20) == 2.5));
  // There and back, in space as well.
  const io::CurveFile space =
      io::parse_curves("t.obj", io::CurveFormat::Obj, "v 0 0 1\nv 1 0 2\nv 0 1 2\nl 1 2 3\nl 2 3\n");
  io::write_curves(folder.file("s.dxf"), space, space.file.polygons.positions);
  const io::CurveFile back = io::read_curves(folder.file("s.dxf"));
  CHECK(back.file.polygons.positions == std::vector<Vec3d>{{0, 0, 1}, {1, 0, 2}, {0, 1, 2}, {1, 0, 2}, {0, 1, 2}});
  io::write_curves(folder.file("s.obj"), back, back.file.polygons.positions);
  CHECK(io::read_curves(folder.file("s.obj")).file.polygons.positions == back.file.polygons.positions);
  const io::CurveFile circle = parsed(dxf_text::file("0|CIRCLE 10|0 20|0 40|1"), 0.01);
  io::write_curves(folder.file("c.svg"), circle, circle.file.polygons.positions);
  CHECK(io::read_curves(folder.file("c.svg")).file.polygons.positions == circle.file.polygons.positions);
}

}  // namespace dxf_rewrite
