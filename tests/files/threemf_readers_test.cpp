// SPDX-License-Identifier: Apache-2.0
// What lib3mf, the 3MF Consortium's own reader, makes of packages that were written here: the same objects, names,
// placements and numbers, as far as its single precision goes.
#include <catch2/catch.hpp>

#include <lib3mf/Model/COM/NMR_DLLInterfaces.h>

#include <array>
#include <memory>

#include "support/folder.h"
#include "support/threemf_packages.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/io/mesh_file.h"

using namespace vdb_offset;
using io::Format;

// Names of its own, as tests are compiled several files at once.
namespace threemf_readers {
namespace {

using Object = NMR::PLib3MFBase*;
using Handle = std::unique_ptr<NMR::PLib3MFBase, decltype(&NMR::lib3mf_release)>;
Handle handle(Object object) { return {object, &NMR::lib3mf_release}; }

struct ReadObject {
  std::string name;
  std::vector<std::array<float, 3>> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

struct ReadModel {
  std::uint32_t unit = 0;
  std::size_t warnings = 0, items = 0;
  std::vector<ReadObject> objects;
};

ReadObject read_object(Object object) {
  ReadObject read;
  DWORD vertices = 0, triangles = 0;
  REQUIRE(NMR::lib3mf_meshobject_getvertexcount(object, &vertices) == 0);
  REQUIRE(NMR::lib3mf_meshobject_gettrianglecount(object, &triangles) == 0);
  for (DWORD v = 0; v < vertices; ++v) {
    NMR::MODELMESHVERTEX vertex;
    REQUIRE(NMR::lib3mf_meshobject_getvertex(object, v, &vertex) == 0);
    read.positions.push_back({vertex.m_fPosition[0], vertex.m_fPosition[1], vertex.m_fPosition[2]});
  }
  for (DWORD t = 0; t < triangles; ++t) {
    NMR::MODELMESHTRIANGLE triangle;
    REQUIRE(NMR::lib3mf_meshobject_gettriangle(object, t, &triangle) == 0);
    read.triangles.push_back({triangle.m_nIndices[0], triangle.m_nIndices[1], triangle.m_nIndices[2]});
  }
  char name[64] = {};
  ULONG length = 0;
  REQUIRE(NMR::lib3mf_object_getnameutf8(object, name, sizeof name, &length) == 0);
  read.name = name;
  return read;
}

ReadModel read_by_lib3mf(const std::string& path) {
  Object model = nullptr, reader = nullptr, objects = nullptr, items = nullptr;
  REQUIRE(NMR::lib3mf_createmodel(&model) == 0);
  const Handle model_end = handle(model);
  REQUIRE(NMR::lib3mf_model_queryreader(model, "3mf", &reader) == 0);
  const Handle reader_end = handle(reader);
  REQUIRE(NMR::lib3mf_reader_readfromfileutf8(reader, path.c_str()) == 0);
  ReadModel read;
  DWORD count = 0;
  REQUIRE(NMR::lib3mf_reader_getwarningcount(reader, &count) == 0);
  read.warnings = count;
  REQUIRE(NMR::lib3mf_model_getunit(model, &count) == 0);
  read.unit = count;
  REQUIRE(NMR::lib3mf_model_getmeshobjects(model, &objects) == 0);
  const Handle objects_end = handle(objects);
  BOOL goes_on = 0;
  while (NMR::lib3mf_resourceiterator_movenext(objects, &goes_on) == 0 && goes_on) {
    Object object = nullptr;
    REQUIRE(NMR::lib3mf_resourceiterator_getcurrent(objects, &object) == 0);
    const Handle object_end = handle(object);
    read.objects.push_back(read_object(object));
  }
  REQUIRE(NMR::lib3mf_model_getbuilditems(model, &items) == 0);
  const Handle items_end = handle(items);
  while (NMR::lib3mf_builditemiterator_movenext(items, &goes_on) == 0 && goes_on) ++read.items;
  return read;
}

void check_same(const ReadObject& read, const std::vector<Vec3d>& positions, std::span<const std::uint32_t> corners) {
  REQUIRE(read.positions.size() == positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v)
    for (int k = 0; k < 3; ++k)
      CHECK(read.positions[v][static_cast<std::size_t>(k)] == static_cast<float>(positions[v][k]));
  REQUIRE(3 * read.triangles.size() == corners.size());
  for (std::size_t t = 0; t < read.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) CHECK(read.triangles[t][k] == corners[3 * t + k]);
}

}  // namespace
}  // namespace threemf_readers
using namespace threemf_readers;

TEST_CASE("3mf: lib3mf reads a new package as it was meant", "[3mf][io]") {
  const Folder folder;
  for (const char* const colours : {"", " 1 0 0"}) {
    io::MeshFile obj = io::parse_mesh("a.obj", Format::Obj,
                                      "v 0.1 0 0" + std::string(colours) +
                                          "\nv 1.5 0 0\nv 0 1e-3 0\nv 0 0 0.3333333333333\n"
                                          "usemtl red & blue\nf 1 3 2\nf 1 2 4\nf 2 3 4\nusemtl b\nf 3 1 4\n");
    obj.unit_micrometres = 25400;
    io::write_mesh(folder.file("n.3mf"), obj, obj.polygons.positions);
    const ReadModel read = read_by_lib3mf(folder.file("n.3mf"));
    CHECK(read.warnings == 0);
    CHECK(read.unit == NMR::MODELUNIT_INCH);
    CHECK(read.items == 1);
    REQUIRE(read.objects.size() == 1);
    check_same(read.objects[0], obj.polygons.positions, obj.polygons.corners);
  }
}

TEST_CASE("3mf: lib3mf reads a package of which a part was written anew", "[3mf][io]") {
  const Folder folder;
  const std::string model = model_of(
      "<object id=\"1\" name=\"one\">" + kTetrahedronXml + "</object><object id=\"2\" name=\"two\">" + kTetrahedronXml +
          "</object>",
      "<item objectid=\"1\"/><item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 20 0 0\"/>", "unit=\"centimeter\"");
  std::vector<ZipItem> items{{"[Content_Types].xml", kContentTypes},
                             {"Metadata/thumbnail.png", "not a picture"},
                             {"_rels/.rels", kRelationships},
                             {"3D/3dmodel.model", model}};
  for (const bool described : {false, true}) {
    items[3].described_behind = described;
    const io::MeshFile file = io::parse_mesh("a.3mf", Format::ThreeMf, zip_file(items));
    std::vector<Vec3d> positions = file.polygons.positions;
    for (Vec3d& p : positions) p += Vec3d(0.1, 1.0 / 3, -2);
    io::write_mesh(folder.file("m.3mf"), file, positions);
    const ReadModel read = read_by_lib3mf(folder.file("m.3mf"));
    CHECK(read.warnings == 0);
    CHECK(read.unit == NMR::MODELUNIT_CENTIMETER);
    CHECK(read.items == 2);
    REQUIRE(read.objects.size() == 2);
    CHECK(read.objects[1].name == "two");
    // In their own frames both are the same, but for the rounding of 20 and 0.1.
    const std::span corners(file.polygons.corners);
    check_same(read.objects[0], {positions.begin(), positions.begin() + 4}, corners.subspan(0, 12));
    check_same(read.objects[1], {positions.begin(), positions.begin() + 4}, corners.subspan(0, 12));
  }
}

TEST_CASE("3mf: lib3mf reads a shell as the objects that its source has", "[3mf][io][shell]") {
  const Folder folder;
  const std::string model =
      model_of("<object id=\"1\" name=\"one\">" + kTetrahedronXml +
                   "</object><basematerials id=\"7\"><base name=\"red\" displaycolor=\"#FF0000\"/></basematerials>"
                   "<object id=\"2\" name=\"two\" pid=\"7\" pindex=\"0\">" +
                   kTetrahedronXml + "</object>",
               "<item objectid=\"1\"/><item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 20 0 0\"/>");
  const io::MeshFile file = io::parse_mesh("a.3mf", Format::ThreeMf,
                                           zip_file({{"[Content_Types].xml", kContentTypes},
                                                     {"Metadata/thumbnail.png", "not a picture"},
                                                     {"_rels/.rels", kRelationships},
                                                     {"3D/3dmodel.model", model}}));
  std::vector<Vec3d> inner = file.polygons.positions;
  for (Vec3d& p : inner) p += Vec3d(0.5, 0.25, 1);
  io::write_shell(folder.file("s.3mf"), file, make_shell(file.polygons.view(), file.polygons.positions, inner, {}));
  const ReadModel read = read_by_lib3mf(folder.file("s.3mf"));
  CHECK(read.warnings == 0);
  CHECK(read.items == 2);
  REQUIRE(read.objects.size() == 2);
  CHECK(read.objects[0].name == "one");
  std::vector<Vec3d> both(file.polygons.positions.begin(), file.polygons.positions.begin() + 4);
  both.insert(both.end(), inner.begin(), inner.begin() + 4);
  std::vector<std::uint32_t> corners(file.polygons.corners.begin(), file.polygons.corners.begin() + 12);
  for (std::size_t c = 0; c < 12; ++c) corners.push_back(4 + corners[c - c % 3 + (3 - c % 3) % 3]);
  for (const ReadObject& object : read.objects) check_same(object, both, corners);
}
