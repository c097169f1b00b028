// SPDX-License-Identifier: Apache-2.0
// 3MF packages, as these files of other programs have them, none of which is here:
// - of the 3MF Consortium, lib3mf's example Helix.3mf (Debian's lib3mf-doc): namespaces that are not used, an entry for
//   each part without folders; and its samples "components" and "pyramid_vertexcolor" (github.com/3MFConsortium/
//   3mf-samples): components with transforms, a colour group;
// - PrusaSlicer 2.5 (prusa-slicer --export-3mf): metadata, items with a transform and an attribute `printable`,
//   Metadata/Slic3r_PE_model.config;
// - BambuStudio and OrcaSlicer: the production extension, meshes in parts of their own under 3D/Objects;
// - box.3mf of the Assimp project's test models: folders as entries, blanks before the end of tags.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "support/edits.h"
#include "support/folder.h"
#include "support/splitter.h"
#include "support/threemf_packages.h"
#include "threemf/zip_archive.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using io::Format;

// Names of its own, as tests are compiled several files at once.
namespace threemf {
namespace {

io::MeshFile parsed(const std::string& bytes) { return io::parse_mesh("a.3mf", Format::ThreeMf, bytes); }

std::string moved(const io::MeshFile& file, const Vec3d& by) {
  return io::patched_bytes(file, shifted(file.polygons.positions, by));
}

std::string entry_of(const std::string& archive, const std::string& name) {
  const std::string path = "a.3mf";
  const io::ZipArchive zip(path, archive);
  return zip.read(*zip.find(name));
}

/// The entries of `after` are those of `before`, in order, and the same but for the contents of some.
void check_kept(const std::string& before, const std::string& after, const std::vector<std::string>& changed) {
  const std::string path = "a.3mf";
  const io::ZipArchive old_zip(path, before), new_zip(path, after);
  REQUIRE(old_zip.entries().size() == new_zip.entries().size());
  for (std::size_t i = 0; i < old_zip.entries().size(); ++i) {
    const io::ZipEntry &was = old_zip.entries()[i], &is = new_zip.entries()[i];
    INFO(was.name);
    CHECK(is.name == was.name);
    CHECK(is.time == was.time);
    CHECK(is.method == was.method);
    if (std::count(changed.begin(), changed.end(), was.name) > 0) continue;
    CHECK(is.packed == was.packed);
    CHECK(new_zip.read(is) == old_zip.read(was));
  }
}

double volume(const Polygons& mesh) {
  double six = 0;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    six += mesh.positions[face[0]].dot(mesh.positions[face[1]].cross(mesh.positions[face[2]]));
  }
  return six / 6;
}

/// What PrusaSlicer writes: stored here, so that a part can be told byte by byte.
std::vector<ZipItem> slicer_package(const std::string& x) {
  const std::string model =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en-US\" " + kCoreSpace +
      " xmlns:slic3rpe=\"http://schemas.slic3r.org/3mf/2017/06\">\n"
      " <metadata name=\"slic3rpe:Version3mf\">1</metadata>\n <metadata name=\"Title\">a &amp; b</metadata>\n"
      " <resources>\n  <object id=\"1\" type=\"model\">\n   <mesh>\n    <vertices>\n"
      "     <vertex x=\"" +
      x +
      "\" y=\"0\" z=\"0\"/>\n     <vertex  z='0.50' y = \"4.0\" slic3rpe:a=\"x\" x=\"1e1\" />\n"
      "     <vertex x=\"3\" y=\"1\" z=\"0\"></vertex><!-- x=\"7\" -->\n"
      "    </vertices>\n    <triangles>\n"
      "     <triangle v1=\"0\" v2=\"1\" v3=\"2\" slic3rpe:custom_supports=\"4\"/>\n"
      "    </triangles>\n   </mesh>\n  </object>\n </resources>\n <build>\n"
      "  <item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 100 50 0.25\" printable=\"1\"/>\n </build>\n</model>\n";
  return {{"[Content_Types].xml", kContentTypes, false},
          {"Metadata/thumbnail.png", "\x89PNG of a kind", false},
          {"_rels/.rels", kRelationships, false},
          {"3D/3dmodel.model", model, false},
          {"Metadata/Slic3r_PE.config", "; layer_height = 0.2\n", false},
          {"Metadata/Slic3r_PE_model.config", "<config/>", false}};
}

}  // namespace
}  // namespace threemf
using namespace threemf;

TEST_CASE("3mf: a slicer's package keeps every byte of its parts but the coordinates of what moved", "[3mf][io]") {
  for (const bool wide : {false, true}) {
    std::vector<ZipItem> items = slicer_package("2.5"), after = slicer_package("2.75");
    for (std::vector<ZipItem>* const list : {&items, &after})
      for (ZipItem& item : *list) item.wide = wide, item.comment = "about " + item.name;
    const std::string bytes = zip_file(items, "a comment");
    const io::MeshFile file = parsed(bytes);
    CHECK(file.polygons.positions == std::vector<Vec3d>{{102.5, 50, 0.25}, {110, 54, 0.75}, {103, 51, 0.25}});
    CHECK(file.unit_micrometres == 1000.0);
    CHECK(io::patched_bytes(file, file.polygons.positions) == bytes);
    std::vector<Vec3d> positions = file.polygons.positions;
    positions[0][0] += 0.25;
    const std::string made = io::patched_bytes(file, positions);
    check_kept(bytes, made, {"3D/3dmodel.model"});
    for (const ZipItem& item : after) {
      CHECK(entry_of(made, item.name) == item.bytes);
      CHECK_THAT(made, Catch::Contains(item.comment));
    }
    CHECK_THAT(made, Catch::EndsWith("a comment"));
  }
  // All forms of tags; other attributes stay.
  const io::MeshFile file = parsed(zip_file(slicer_package("2.5")));
  const std::string model = entry_of(moved(file, {0.125, 1, -2}), "3D/3dmodel.model");
  CHECK(model.find("<vertex x=\"2.625\" y=\"1\" z=\"-2\"/>\n     <vertex  z='-1.5' y = \"5\" slic3rpe:a=\"x\" "
                   "x=\"10.125\" />\n     <vertex x=\"3.125\" y=\"2\" z=\"-2\"></vertex><!-- x=\"7\" -->\n") !=
        std::string::npos);
}

TEST_CASE("3mf: a long model part is written in pieces that are cut nowhere inside of a tag", "[3mf][io]") {
  // Tags of several lengths around each MiB, and much between meshes.
  std::string mesh = "<mesh><vertices>", after = mesh;
  for (int v = 0; v < 30000; ++v) {
    const std::string plain =
        fmt::format("\" y='{}' z=\"0\" a=\">\" {}/>", v % 7, std::string(static_cast<std::size_t>(v % 13), ' '));
    mesh += fmt::format("<vertex x=\"{}", v) + plain;
    after += fmt::format("<vertex x=\"{}", v + 1) + plain;
  }
  const std::string rest = "</vertices><!--" + std::string(std::size_t{3} << 19, '+') +
                           "--><triangles><triangle v1=\"0\" v2=\"1\" v3=\"9\"/></triangles></mesh>";
  const auto model = [&](const std::string& vertices) {
    return model_of(
        "<object id=\"1\">" + vertices + rest + "</object><object id=\"2\">" + vertices + rest + "</object>",
        "<item objectid=\"2\"/><item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 9 0\"/>");
  };
  CHECK(entry_of(moved(parsed(package_of(model(mesh))), {1, 0, 0}), "3D/3dmodel.model") == model(after));
}

TEST_CASE("3mf: entries that are deflated, or described behind their bytes, are copied as they are", "[3mf][io]") {
  std::vector<ZipItem> items = slicer_package("2.5");
  for (ZipItem& item : items) item.deflated = item.described_behind = true;
  // Deflated as no program would: one block that is as it was.
  ZipItem& last = items.back();
  const auto length = static_cast<std::uint16_t>(last.bytes.size());
  last.packed = "\1" + raw(length) + raw(static_cast<std::uint16_t>(~length)) + last.bytes;
  const std::string bytes = zip_file(items), after = moved(parsed(bytes), {1, 0, 0});
  check_kept(bytes, after, {"3D/3dmodel.model"});
  CHECK_THAT(after, Catch::Contains(last.packed));
  const io::MeshFile back = parsed(after);
  CHECK(back.polygons.positions == shifted(parsed(bytes).polygons.positions, {1, 0, 0}));
  CHECK(io::patched_bytes(back, back.polygons.positions) == after);
}

TEST_CASE("3mf: the production extension's parts are read, and only those that moved are written", "[3mf][io]") {
  const std::string production =
      "unit=\"millimeter\" xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\" "
      "requiredextensions=\"p\"";
  const auto part = [&](int id) {
    return model_of(
        fmt::format("<object id=\"{}\" p:UUID=\"0001000{}-81cb\" type=\"model\">{}</object>", id, id, kTetrahedronXml),
        "", production);
  };
  const std::string root = model_of(
      "<object id=\"8\" p:UUID=\"00000001-61cb\" type=\"model\"><components>"
      "<component p:path=\"/3D/Objects/object_1.model\" objectid=\"1\" p:UUID=\"b\" transform=\"1 0 0 0 1 0 0 0 1 10 0 "
      "0\"/>"
      "<component p:path=\"/3D/Objects/object%202.model\" objectid=\"1\" p:UUID=\"c\"/></components></object>",
      "<item objectid=\"8\" p:UUID=\"d\" transform=\"1 0 0 0 1 0 0 0 1 0 0 5\"/>", production);
  std::vector<ZipItem> items{{"[Content_Types].xml", kContentTypes, false},
                             {"_rels/.rels", kRelationships, false},
                             {"3D/3dmodel.model", root, false},
                             {"3D/Objects/object_1.model", part(1), false},
                             {"3D/Objects/object 2.model", part(1), false},
                             {"Metadata/model_settings.config", "<config></config>", false}};
  const io::MeshFile file = parsed(zip_file(items));
  REQUIRE(file.polygons.positions.size() == 8);
  CHECK(file.polygons.positions[1] == Vec3d(14, 0, 5));
  CHECK(file.polygons.positions[7] == Vec3d(0, 0, 9));
  std::vector<Vec3d> positions = file.polygons.positions;
  positions[6] += Vec3d(0, 0.5, 0);
  items[4].bytes = replaced(items[4].bytes, "y=\"4\"", "y=\"4.5\"");
  const std::string made = io::patched_bytes(file, positions);
  check_kept(zip_file(items), made, {});
  for (const ZipItem& item : items) CHECK(entry_of(made, item.name) == item.bytes);
  CHECK(io::wall_names(file).names ==
        std::vector<std::string>{"object 1 of 3D/Objects/object_1.model", "object 1 of 3D/Objects/object 2.model"});
}

TEST_CASE("3mf: components are placed by all their transforms, mirrored ones turned round", "[3mf][io]") {
  // A quarter turn, then a mirror, then twice the size.
  const std::string bytes = package_of(model_of("<object id=\"1\" name=\"tet\">" + kTetrahedronXml +
                                                    "</object>"
                                                    "<object id=\"2\"><components><component objectid=\"1\" "
                                                    "transform=\"0 1 0 -1 0 0 0 0 1 1 0 0\"/></components></object>"
                                                    "<object id=\"3\"><components><component objectid=\"2\" "
                                                    "transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/></components></object>",
                                                "<item objectid=\"3\" transform=\"2 0 0 0 2 0 0 0 2 0 0 10\"/>"));
  const io::MeshFile file = parsed(bytes);
  CHECK(file.polygons.positions == std::vector<Vec3d>{{-2, 0, 10}, {-2, 8, 10}, {6, 0, 10}, {-2, 0, 18}});
  CHECK(volume(file.polygons) == Approx(8 * 64 / 6.0));
  CHECK(file.remarks.empty());
  const std::string after = moved(file, {2, -4, 6});
  CHECK(entry_of(after, "3D/3dmodel.model").find("<vertex x=\"-2\" y=\"1\" z=\"3\"/>") != std::string::npos);
  CHECK(parsed(after).polygons.positions == shifted(file.polygons.positions, {2, -4, 6}));
}

TEST_CASE("3mf: turned objects come back to their places but for rounding", "[3mf][io]") {
  const double c = std::cos(0.7), s = std::sin(0.7);
  const io::MeshFile file = parsed(package_of(
      model_of("<object id=\"1\">" + kTetrahedronXml + "</object>",
               fmt::format("<item objectid=\"1\" transform=\"{} {} 0 {} {} 0 0 0 1.1 125 105.3 10\"/>", c, s, -s, c))));
  const std::vector<Vec3d> wanted = shifted(file.polygons.positions, {0.1, 0.2, 1.0 / 3});
  const io::MeshFile back = parsed(io::patched_bytes(file, wanted));
  for (std::size_t v = 0; v < wanted.size(); ++v)
    // Coordinates up to 128: four units of their last place.
    CHECK((back.polygons.positions[v] - wanted[v]).length() <= 4 * 0x1p-46);
  // Those of objects that are only moved come back to the bit.
  const io::MeshFile plain =
      parsed(package_of(model_of("<object id=\"1\">" + kTetrahedronXml + "</object>",
                                 "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 125 105.3 10\"/>")));
  const std::vector<Vec3d> there = shifted(plain.polygons.positions, {0.1, 0.2, 1.0 / 3});
  CHECK(parsed(io::patched_bytes(plain, there)).polygons.positions == there);
}

TEST_CASE("3mf: what is printed moves, all else stays and is told", "[3mf][io]") {
  const auto object = [](int id, const std::string& more) {
    return fmt::format("<object id=\"{}\" {}>{}</object>", id, more, kTetrahedronXml);
  };
  const io::MeshFile file = parsed(package_of(model_of(
      object(1, "name=\"twice\"") + object(2, "type=\"support\"") + object(3, "") + object(4, "type=\"surface\""),
      "<item objectid=\"1\"/><item objectid=\"2\"/><item objectid=\"4\"/>"
      "<item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 20 0 0\"/>")));
  CHECK(file.polygons.positions.size() == 8);
  CHECK(file.has_touching_objects);
  REQUIRE(file.remarks.size() == 3);
  CHECK_THAT(file.remarks[0], Catch::Contains("twice"));
  CHECK_THAT(file.remarks[1], Catch::Contains("placed nowhere"));
  CHECK_THAT(file.remarks[2], Catch::Contains("support"));
  const std::string model = entry_of(moved(file, {1, 1, 1}), "3D/3dmodel.model");
  const auto stays = [&](int id) {
    return model.find(object(id, id == 2 ? "type=\"support\"" : "")) != std::string::npos;
  };
  CHECK(stays(2));
  CHECK(stays(3));
}

TEST_CASE("3mf: objects that touch are kept apart, unless they need to be welded themselves", "[3mf][io]") {
  const auto two = [](const std::string& mesh, const char* x) {
    return parsed(package_of(model_of(
        "<object id=\"1\">" + mesh + "</object><object id=\"2\">" + kTetrahedronXml + "</object>",
        fmt::format("<item objectid=\"1\"/><item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 {} 0 0\"/>", x))));
  };
  CHECK(two(kTetrahedronXml, "4").has_touching_objects);
  CHECK_FALSE(two(kTetrahedronXml, "5").has_touching_objects);
  const std::string torn = replaced(
      replaced(kTetrahedronXml, "</vertices>", "<vertex x=\"4\" y=\"0\" z=\"0\"/></vertices>"), "v1=\"1\"", "v1=\"4\"");
  CHECK_FALSE(two(torn, "4").has_touching_objects);
  CHECK_THAT(two(torn, "4").remarks.at(0), Catch::Contains("--weld none"));
}

TEST_CASE("3mf: units are told, also without reading the whole file", "[3mf][io][units]") {
  const Folder folder;
  const std::vector<std::pair<std::string, double>> units{{"unit=\"micron\"", 1},       {"", 1000},
                                                          {"unit=\"centimeter\"", 1e4}, {"unit=\"inch\"", 25400},
                                                          {"unit=\"foot\"", 304800},    {"unit=\"meter\"", 1e6}};
  for (const auto& [attribute, micrometres] : units) {
    const std::string bytes =
        package_of(model_of("<object id=\"1\">" + kTetrahedronXml + "</object>", "<item objectid=\"1\"/>", attribute));
    CHECK(parsed(bytes).unit_micrometres == micrometres);
    CHECK(io::unit_micrometres(folder.write("u.3mf", bytes)) == micrometres);
    // A new file of the mesh has them, too.
    const io::MeshFile obj = io::parse_mesh("a.obj", Format::Obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    io::MeshFile known = obj;
    known.unit_micrometres = micrometres;
    io::write_mesh(folder.file("n.3mf"), known, known.polygons.positions);
    CHECK(io::read_mesh(folder.file("n.3mf")).unit_micrometres == micrometres);
  }
}

TEST_CASE("3mf: names of objects and materials choose faces, colours of vertices go into other formats", "[3mf][io]") {
  const std::string triangles =
      replaced(replaced(replaced(kTetrahedronXml, "v3=\"1\"/>", "v3=\"1\" pid=\"5\" p1=\"1\"/>"), "v3=\"3\"/>",
                        "v3=\"3\" p1=\"0\"/>"),
               "v3=\"3\"/>", "v3=\"3\" pid=\"9\" p1=\"0\"/>");
  const io::MeshFile named = parsed(package_of(
      model_of("<basematerials id=\"5\"><base name=\"red\" displaycolor=\"#f00\"/><base name=\"blue &quot;2&quot;\" "
               "displaycolor=\"#00f\"/></basematerials><object id=\"1\" name=\"&lt;part&gt;\" pid=\"5\" pindex=\"0\">" +
                   triangles + "</object>",
               "<item objectid=\"1\"/>")));
  const io::Materials materials = io::read_materials(named);
  CHECK(materials.names == std::vector<std::string>{"", "blue \"2\"", "red"});
  CHECK(materials.of_face == std::vector<std::uint32_t>{1, 2, 0, 2});
  CHECK(io::select_faces(named, std::vector{io::parse_selector("group=<part>")}) == std::vector<std::uint8_t>(4, 1));
  CHECK(io::select_faces(named, std::vector{io::parse_selector("material=red")}) ==
        std::vector<std::uint8_t>{0, 1, 0, 1});

  const std::string mirrored = "<item objectid=\"1\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/>";
  const auto coloured = [&](const std::string& last) {
    std::string mesh = replaced(kTetrahedronXml, "v1=\"0\" v2=\"2\" v3=\"1\"",
                                "v1=\"0\" v2=\"2\" v3=\"1\" pid=\"7\" p1=\"0\" p2=\"2\" p3=\"1\"");
    mesh =
        replaced(mesh, "v1=\"0\" v2=\"1\" v3=\"3\"", "v1=\"0\" v2=\"1\" v3=\"3\" pid=\"7\" p1=\"0\" p2=\"1\" p3=\"2\"");
    mesh =
        replaced(mesh, "v1=\"1\" v2=\"2\" v3=\"3\"", "v1=\"1\" v2=\"2\" v3=\"3\" pid=\"7\" p1=\"1\" p2=\"2\" p3=\"2\"");
    mesh = replaced(mesh, "v1=\"2\" v2=\"0\" v3=\"3\"", "v1=\"2\" v2=\"0\" v3=\"3\" pid=\"7\" " + last);
    return parsed(package_of(model_of(
        "<m:colorgroup id=\"7\"><m:color color=\"#ff0000\"/><m:color color=\"#00FF00\"/><m:color color=\"#0000ff80\"/>"
        "</m:colorgroup><object id=\"1\">" +
            mesh + "</object>",
        mirrored, "xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\"")));
  };
  const io::Attributes attributes = io::read_attributes(coloured("p1=\"2\" p2=\"0\" p3=\"2\""));
  using Colour = std::array<double, 4>;
  CHECK(attributes.colours ==
        std::vector<Colour>{{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 128 / 255.0}, {0, 0, 1, 128 / 255.0}});
  CHECK(attributes.has_alpha);
  CHECK(std::find(attributes.lost.begin(), attributes.lost.end(), "colours of triangles") == attributes.lost.end());
  // Where triangles disagree, no vertex has a colour.
  const io::Attributes others = io::read_attributes(coloured("p1=\"1\""));
  CHECK(others.colours.empty());
  CHECK(std::find(others.lost.begin(), others.lost.end(), "colours of triangles") != others.lost.end());
}

TEST_CASE("3mf: shells, iso-surfaces and refined meshes keep the unit", "[3mf][io][units]") {
  const Folder folder;
  const std::string path =
      folder.write("i.3mf", package_of(model_of("<object id=\"1\">" + kTetrahedronXml + "</object>",
                                                "<item objectid=\"1\"/>", "unit=\"inch\"")));
  const io::MeshFile file = io::read_mesh(path);
  const Shell shell =
      make_shell(file.polygons.view(), shifted(file.polygons.positions, {0, 0, 1}), file.polygons.positions, {}, {});
  io::write_shell(folder.file("s.3mf"), file, shell);
  const io::MeshFile back = io::read_mesh(folder.file("s.3mf"));
  CHECK(back.unit_micrometres == 25400.0);
  CHECK(io::read_materials(back).names == std::vector<std::string>{"", "outer", "inner"});
  const Refinement refinement = Splitter(file).edge(0, 1).run();
  const io::RefinedFile refined = io::refine_file(file, refinement);
  io::write_mesh(folder.file("r.3mf"), refined.file, refined.file.polygons.positions);
  CHECK(io::read_mesh(folder.file("r.3mf")).unit_micrometres == 25400.0);
}

TEST_CASE("3mf: slicers' own names choose faces", "[3mf][io]") {
  const auto groups = [](const std::string& model, const std::string& settings, const std::string& text) {
    const io::MeshFile file =
        parsed(zip_file({{"_rels/.rels", kRelationships}, {"3D/3dmodel.model", model}, {settings, text}}));
    std::string named;
    const WallNames names = io::wall_names(file);
    for (std::size_t f = 0; f < names.of_face.size(); ++f) named += names.names[names.of_face[f]] + " ";
    return file.remarks.empty() ? named : file.remarks[0];
  };
  const std::string one = model_of("<object id=\"3\">" + kTetrahedronXml + "</object>", "<item objectid=\"3\"/>"),
                    prusa = "Metadata/Slic3r_PE_model.config", bambu = "Metadata/model_settings.config";
  const auto volume = [](int first, int last, const std::string& name) {
    return fmt::format(
        "<volume firstid=\"{}\" lastid=\"{}\"><metadata type=\"volume\" key=\"name\" value=\"{}\"/>"
        "<metadata type=\"volume\" key=\"matrix\" value=\"1\"/></volume>",
        first, last, name);
  };
  const std::string
      head =
          "<config><object id=\"3\" instances_count=\"1\"><metadata type=\"object\" key=\"name\" value=\"gear.stl\"/>",
      tail = "</object></config>";
  CHECK(groups(one, prusa, head + volume(0, 3, "v") + tail) == "gear.stl gear.stl gear.stl gear.stl ");
  CHECK(groups(one, prusa, head + volume(0, 1, "a") + volume(2, 2, "b") + tail) == "a a b gear.stl ");
  CHECK(groups(one, prusa, head + volume(0, 1, "a") + volume(2, 9, "b") + tail) == "a a gear.stl gear.stl ");
  CHECK_THAT(groups(one, prusa, head + volume(2, 1, "a") + tail),
             Catch::Contains("names of objects are not known: a.3mf: " + prusa));
  const std::string two =
      model_of("<object id=\"1\">" + kTetrahedronXml + "</object><object id=\"2\">" + kTetrahedronXml +
                   "</object><object id=\"8\"><components><component objectid=\"1\"/>"
                   "<component objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 9 0 0\"/></components></object>",
               "<item objectid=\"8\"/>");
  CHECK(groups(two, bambu,
               "<config><object id=\"8\"><metadata key=\"name\" value=\"all\"/><part id=\"1\" "
               "subtype=\"normal_part\"><metadata key=\"name\" value=\"lid\"/></part></object></config>") ==
        "lid lid lid lid all all all all ");
}

TEST_CASE("3mf: a new package holds the mesh, its colours or materials, and is the same each time", "[3mf][io]") {
  const Folder folder;
  const io::MeshFile obj =
      io::parse_mesh("a.obj", Format::Obj,
                     "mtllib a.mtl\nv 0.1 0 0 1 0 0\nv 1 0 1e-7 0 1 0\nv 1 1 0 0 0 1\nv 0 1.25 0 1 1 1\n"
                     "usemtl a&b\nf 1 2 3 4\nusemtl c\nf 3 2 1\nf 4 4 3\n");
  const io::WriteResult result = io::write_mesh(folder.file("n.3mf"), obj, obj.polygons.positions);
  CHECK_THAT(result.lost, Catch::Contains("triangles that have a vertex twice"));
  const std::string bytes = slurp(folder.file("n.3mf"));
  io::write_mesh(folder.file("m.3mf"), obj, obj.polygons.positions);
  CHECK(slurp(folder.file("m.3mf")) == bytes);
  const io::MeshFile back = io::read_mesh(folder.file("n.3mf"));
  CHECK(back.polygons.positions == obj.polygons.positions);
  CHECK(back.polygons.corners == std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3, 2, 1, 0});
  CHECK(io::read_attributes(back).colours == io::read_attributes(obj).colours);
  CHECK(io::patched_bytes(back, back.polygons.positions) == bytes);

  io::WriteOptions options;
  options.digits = 3;
  const std::vector<Vec3d> positions = shifted(obj.polygons.positions, {1.0 / 3, 0, 0});
  io::write_mesh(folder.file("d.3mf"), obj, positions, options);
  CHECK(entry_of(slurp(folder.file("d.3mf")), "3D/3dmodel.model").find("x=\"0.433\"") != std::string::npos);

  const io::MeshFile plain = io::parse_mesh(
      "a.obj", Format::Obj, "mtllib a.mtl\nv 0.1 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nusemtl a&\"b\"\nf 3 2 1\n");
  CHECK(io::write_mesh(folder.file("p.3mf"), plain, plain.polygons.positions).lost == "colours of materials");
  const io::Materials materials = io::read_materials(io::read_mesh(folder.file("p.3mf")));
  CHECK(materials.names == std::vector<std::string>{"", "a&\"b\""});
  CHECK(materials.of_face == std::vector<std::uint32_t>{0, 1});
}
