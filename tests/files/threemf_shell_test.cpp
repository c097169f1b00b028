// SPDX-License-Identifier: Apache-2.0
// Shells of 3MF packages, written into the package that they are of.
#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "space/surface/surface.h"
#include "support/edits.h"
#include "support/folder.h"
#include "support/oracles.h"
#include "support/threemf_packages.h"
#include "threemf/zip_archive.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/io/mesh_file.h"

using namespace vdb_offset;
using io::Format;

// Names of its own, as tests are compiled several files at once.
namespace threemf_shells {
namespace {

// A tetrahedron without the face over the axes x and y, so that a shell of it has a rim.
const std::string kOpenXml =
    "<mesh><vertices>\n <vertex x=\"0\" y=\"0\" z=\"0\"/>\n <vertex x=\"4\" y=\"0\" z=\"0\"/>\n <vertex x=\"0\" "
    "y=\"4\" "
    "z=\"0\"/>\n <vertex x=\"0\" y=\"0\" z=\"4\"/>\n</vertices><triangles>\n"
    " <triangle v1=\"0\" v2=\"1\" v3=\"3\" pid=\"8\" p1=\"1\" p2=\"0\" p3=\"2\"/>\n"
    " <triangle v1=\"1\" v2=\"2\" v3=\"3\" pid=\"7\" p1=\"1\" a=\"b\"/>\n <triangle v1=\"2\" v2=\"0\" v3=\"3\"/>\n"
    "</triangles></mesh>";

/// A package's shell, each vertex of its inner skin moved.
struct WrittenShell {
  std::string bytes, lost;
  io::MeshFile back;
};

WrittenShell shell_of(const std::string& package, const Vec3d& by, std::vector<std::uint8_t> only = {}) {
  const Folder folder;
  const io::MeshFile file = io::parse_mesh("a.3mf", Format::ThreeMf, package);
  const Shell shell =
      make_shell(file.polygons.view(), file.polygons.positions, shifted(file.polygons.positions, by), {}, {}, only);
  WrittenShell written;
  written.lost = io::write_shell(folder.file("s.3mf"), file, shell).lost;
  written.bytes = slurp(folder.file("s.3mf"));
  written.back = io::read_mesh(folder.file("s.3mf"));
  return written;
}

std::string entry(const std::string& archive, const std::string& name) {
  const std::string path = "a.3mf";
  const io::ZipArchive zip(path, archive);
  return zip.read(*zip.find(name));
}

/// Of each face its group and its material.
std::string names_of(const io::MeshFile& file) {
  const WallNames groups = io::wall_names(file);
  const io::Materials materials = io::read_materials(file);
  std::string names;
  for (std::size_t f = 0; f < file.polygons.face_count(); ++f)
    names += groups.names[groups.of_face[f]] +
             (materials.of_face.empty() ? "" : ":" + materials.names[materials.of_face[f]]) + " ";
  return names;
}

bool is_closed(const io::MeshFile& file) { return build_surface(file.polygons.view(), {}).facts.closed(); }

std::string times(int count, const std::string& words) {
  std::string all;
  for (; count > 0; --count) all += words;
  return all;
}

}  // namespace
}  // namespace threemf_shells
using namespace threemf_shells;

TEST_CASE("3mf: a shell stays the objects, the colours and the package that its source is", "[3mf][io][shell]") {
  const std::string model = model_of(
      "<basematerials id=\"7\"><base name=\"red\" displaycolor=\"#FF0000\"/><base name=\"blue\" "
      "displaycolor=\"#0000FF\"/></basematerials><m:colorgroup id=\"8\"><m:color color=\"#FF0000\"/><m:color "
      "color=\"#00FF00\"/><m:color color=\"#0000FF\"/></m:colorgroup>"
      "<object id=\"1\" name=\"one\" pid=\"7\" pindex=\"0\">" +
          kTetrahedronXml + "</object><object id=\"2\" name=\"two\" pid=\"7\" pindex=\"1\">" + kOpenXml +
          "</object><object id=\"3\" name=\"three\" type=\"support\">" + kTetrahedronXml + "</object>",
      "<item objectid=\"2\" transform=\"-1 0 0 0 1 0 0 0 1 20 0 0\"/><item objectid=\"1\"/><item objectid=\"3\"/>",
      "unit=\"inch\" xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\"");
  const std::vector<ZipItem> items{{"[Content_Types].xml", kContentTypes},
                                   {"Metadata/thumbnail.png", "a picture"},
                                   {"_rels/.rels", kRelationships},
                                   {"3D/3dmodel.model", model}};
  const WrittenShell shell = shell_of(zip_file(items), {0.5, 0.25, 1});
  CHECK(shell.lost.empty());
  for (const ZipItem& item : items)
    if (item.name != "3D/3dmodel.model") CHECK(entry(shell.bytes, item.name) == item.bytes);
  CHECK(shell.back.unit_micrometres == 25400.0);
  CHECK(is_closed(shell.back));
  // Of the second object three triangles on each side, of which two have a material, and six of the rim.
  CHECK(shell.back.polygons.positions.size() == 16);
  CHECK(names_of(shell.back) ==
        "two: two:blue two:blue two: two:blue two:blue two: two: two:blue two:blue two:blue two:blue " +
            times(8, "one:red "));
  CHECK(shell.back.polygons.positions[4] == Vec3d(20.5, 0.25, 1));
  const std::string after = entry(shell.bytes, "3D/3dmodel.model");
  // The source's own lines stay; the inner triangle's corners have the colours that theirs have, in its order, and in
  // the object's frame, which mirrors, the inner skin is moved the other way along x.
  CHECK_THAT(after, Catch::Contains("a=\"b\"/>\n <triangle v1=\"2\" v2=\"0\" v3=\"3\"/>\n <triangle v1=\""));
  CHECK_THAT(after, Catch::Contains("<vertex x=\"-0.5\" y=\"0.25\" z=\"1\"/>"));
  CHECK_THAT(after, Catch::Contains("<triangle v1=\"5\" v2=\"4\" v3=\"7\" pid=\"8\" p1=\"0\" p2=\"1\" p3=\"2\"/>"));
  const std::string support = model.substr(model.find("<object id=\"3\""));
  CHECK(after.ends_with(support));
}

TEST_CASE("3mf: objects of which a shell has no faces stay, and others lose faces that are not of it",
          "[3mf][io][shell]") {
  const std::string model =
      model_of("<object id=\"1\" name=\"one\">" + kTetrahedronXml + "</object><object id=\"2\" name=\"two\">" +
                   kTetrahedronXml + "</object>",
               "<item objectid=\"1\"/><item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 9 0 0\"/>");
  const WrittenShell shell = shell_of(package_of(model), {0.5, 0.25, 1}, {1, 1, 0, 0, 0, 0, 0, 0});
  // Two triangles on each side, and a quad over each of four edges at their border.
  CHECK(names_of(shell.back) ==
        times(2, "one:outer ") + times(2, "one:inner ") + times(8, "one:rim ") + times(4, "two: "));
  CHECK(is_closed(shell.back));
  const std::string after = entry(shell.bytes, "3D/3dmodel.model");
  CHECK(after.ends_with(model.substr(model.find("<object id=\"2\""))));
}

TEST_CASE("3mf: what comes of a slicer's volume stays in it", "[3mf][io][shell]") {
  const std::string model = model_of("<object id=\"3\">" + kTetrahedronXml + "</object>", "<item objectid=\"3\"/>"),
                    settings = "Metadata/Slic3r_PE_model.config";
  const auto config = [](int last_of_a, int first_of_b, int last_of_b) {
    return fmt::format(
        "<config>\n <object id=\"3\">\n  <volume firstid=\"0\" lastid=\"{}\"><metadata key=\"name\" "
        "value=\"a\"/></volume>\n"
        "  <volume firstid='{}' lastid=\"{}\"><metadata key=\"name\" value=\"b\"/></volume>\n </object>\n</config>\n",
        last_of_a, first_of_b, last_of_b);
  };
  const auto package = [&](const std::string& text) {
    return zip_file({{"_rels/.rels", kRelationships}, {settings, text}, {"3D/3dmodel.model", model}});
  };
  const WrittenShell whole = shell_of(package(config(2, 3, 3)), {0.5, 0.25, 1});
  CHECK(entry(whole.bytes, settings) == config(5, 6, 7));
  CHECK(names_of(whole.back) == times(3, "a:outer ") + times(3, "a:inner ") + "b:outer b:inner ");
  // A volume that loses its triangles goes.
  const WrittenShell part = shell_of(package(config(2, 3, 3)), {0.5, 0.25, 1}, {1, 1, 1, 0});
  CHECK(entry(part.bytes, settings) ==
        "<config>\n <object id=\"3\">\n  <volume firstid=\"0\" lastid=\"11\"><metadata key=\"name\" "
        "value=\"a\"/></volume>\n"
        "  \n </object>\n</config>\n");
}
