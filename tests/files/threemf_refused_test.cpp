// SPDX-License-Identifier: Apache-2.0
// 3MF packages that are damaged, or made to do harm.
#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "ground/system/memory.h"
#include "support/folder.h"
#include "support/threemf_packages.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using io::Format;

// Names of its own, as tests are compiled several files at once.
namespace threemf_refused {
namespace {

void check_refused(const std::string& bytes, const std::string& message) {
  CHECK_THROWS_MATCHES(io::parse_mesh("a.3mf", Format::ThreeMf, bytes), InvalidInput,
                       Catch::Matchers::Predicate<InvalidInput>(
                           [&](const InvalidInput& error) {
                             INFO(error.what());
                             CHECK_THAT(error.what(), Catch::Contains(message));
                             return std::string(error.what()).find('\n') == std::string::npos;
                           },
                           "has one line"));
}

void check_model_refused(const std::string& model, const std::string& message) {
  check_refused(package_of(model), message);
}

std::string in_object(const std::string& inside) {
  return model_of("<object id=\"1\">\n" + inside + "</object>", "<item objectid=\"1\"/>");
}

std::string with(const std::string& from, const std::string& to) {
  std::string mesh = kTetrahedronXml;
  REQUIRE(mesh.find(from) != std::string::npos);
  return in_object(mesh.replace(mesh.find(from), from.size(), to));
}

/// Neither a crash nor anything else than a mesh or a refusal.
void try_to_read(const std::string& bytes) {
  try {
    const io::MeshFile file = io::parse_mesh("a.3mf", Format::ThreeMf, bytes);
    CHECK(file.polygons.face_count() > 0);
  } catch (const InvalidInput&) {
    SUCCEED();
  }
}

}  // namespace
}  // namespace threemf_refused
using namespace threemf_refused;

TEST_CASE("3mf: models that are none are refused, with the line", "[3mf][io]") {
  check_model_refused("", "3D/3dmodel.model, line 1: expected XML");
  check_model_refused("<model/>", "line 1: expected an element 'model' of http://schemas");
  check_model_refused(
      "<a:model xmlns:a=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\"><a:build></a:model>",
      "mismatched tag");
  check_model_refused("\xff\xfe<\0m\0", "expected XML in UTF-8, got UTF-16");
  check_model_refused("<!DOCTYPE a [<!ENTITY b \"c\">]>\n" + in_object(kTetrahedronXml),
                      "expected XML without a document type, got 'a'");
  check_model_refused(model_of("", "", "unit=\"parsec\""),
                      "line 2: expected a unit micron, millimeter, centimeter, inch, foot or meter, got 'parsec'");
  check_model_refused(with("x=\"4\"", "x=\"four\""),
                      "line 4: expected a coordinate that is a finite number, got 'four'");
  check_model_refused(with("x=\"4\"", "x=\"nan\""), "got 'nan'");
  check_model_refused(with("x=\"4\"", "x=\"1e999\""), "got '1e999'");
  check_model_refused(with("x=\"4\" ", ""), "expected a coordinate 'x' of a vertex, got none");
  check_model_refused(with("v3=\"1\"", "v3=\"4\""), "expected the index of one of 4 vertices, got 4");
  check_model_refused(with("v3=\"1\"", "v3=\"-1\""), "expected the index of a vertex, from 0 to 2147483647, got '-1'");
  check_model_refused(with("v3=\"1\"", ""), "expected a corner 'v3' of a triangle, got none");
  check_model_refused(with("x=\"4\"", "x=\"4\" x=\"4\""), "duplicate attribute");
  check_model_refused(in_object(kTetrahedronXml + kTetrahedronXml), "expected one mesh in an object, got two");
  check_model_refused(in_object(""), "expected an item in 'build' that places a mesh of triangles, got none");
  check_model_refused(model_of("<object id=\"1\">" + kTetrahedronXml + "</object>", ""), "expected an item in 'build'");
  check_model_refused(model_of("<object id=\"1\">" + kTetrahedronXml + "</object>", "<item objectid=\"2\"/>"),
                      "line 4: expected an object 2 in this file, got none");
  check_model_refused(model_of("<object id=\"1\"/><object id=\"1\"/>", ""),
                      "expected an id that no object before has, got 1");
  check_model_refused(model_of("<object/>", ""), "expected an attribute 'id', got none");
  check_model_refused(in_object("<levelset xmlns=\"http://volumetric\"/>"),
                      "expected an object with a mesh or components, got one with 'levelset'");
  check_model_refused(
      model_of("<object id=\"1\" xmlns:s=\"http://schemas.microsoft.com/3dmanufacturing/slice/2015/07\" "
               "s:meshresolution=\"lowres\">" +
                   kTetrahedronXml + "</object>",
               "<item objectid=\"1\"/>"),
      "whose slices are");
  std::string deep;
  for (int i = 0; i < 100; ++i) deep += "<a>";
  check_model_refused(in_object(deep), "expected elements at most 64 deep");
}

TEST_CASE("3mf: placements that lead nowhere are refused", "[3mf][io]") {
  const auto placed = [](const std::string& transform) {
    return model_of("<object id=\"1\">" + kTetrahedronXml + "</object>",
                    "<item objectid=\"1\" transform=\"" + transform + "\"/>");
  };
  check_model_refused(placed("1 0 0 0 1 0 0 0 1 0 0"), "expected a transform of 12 numbers, got 11");
  check_model_refused(placed("1 0 0 0 1 0 0 0 1 0 0 0 0"), "expected a transform of 12 numbers, got more");
  check_model_refused(placed("1 0 0 0 1 0 0 0 0 0 0 0"), "expected a transform that keeps space as it is");
  check_model_refused(placed("1 0 0 0 1 0 0 0 1 0 0 nan"), "finite number, got 'nan");
  const auto component = [](int of, int in, const std::string& more = {}) {
    return fmt::format("<object id=\"{}\"><components><component objectid=\"{}\" {}/></components></object>", of, in,
                       more);
  };
  check_model_refused(model_of(component(1, 2) + component(2, 3) + component(3, 1), "<item objectid=\"1\"/>"),
                      "got object 1 inside itself");
  check_model_refused(
      model_of(
          component(
              1, 1,
              "xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\" p:path=\"/3D/o.model\""),
          "<item objectid=\"1\"/>"),
      "expected a part '/3D/o.model', got none");
  std::string chain = "<object id=\"1\">" + kTetrahedronXml + "</object>";
  for (int i = 2; i < 100; ++i) chain += component(i, i - 1);
  check_model_refused(model_of(chain, "<item objectid=\"99\"/>"),
                      "expected components at most 64 deep, got deeper ones");
  // Each object twice inside the next: 2^60 places, of which the first counts.
  std::string doubled = "<object id=\"1\">" + kTetrahedronXml + "</object>";
  for (int i = 2; i < 60; ++i)
    doubled += fmt::format(
        "<object id=\"{}\"><components><component objectid=\"{}\"/><component objectid=\"{}\"/></components></object>",
        i, i - 1, i - 1);
  const io::MeshFile file =
      io::parse_mesh("a.3mf", Format::ThreeMf, package_of(model_of(doubled, "<item objectid=\"59\"/>")));
  CHECK(file.polygons.positions.size() == 4);
}

TEST_CASE("3mf: archives that are damaged are refused", "[3mf][io]") {
  const std::string model = in_object(kTetrahedronXml);
  const std::vector<ZipItem> good{
      {"[Content_Types].xml", kContentTypes}, {"_rels/.rels", kRelationships}, {"3D/3dmodel.model", model}};
  const auto changed = [&](std::size_t item, auto&& change) {
    std::vector<ZipItem> items = good;
    change(items[item]);
    return zip_file(items);
  };
  check_refused("PK", "a.3mf: expected a ZIP archive, got 'Not a zip archive'");
  check_refused(std::string(100, 'x'), "a.3mf: expected a ZIP archive, got 'Not a zip archive'");
  check_refused(zip_file({}), "expected a part _rels/.rels (a 3MF package), got none");
  check_refused(changed(1, [](ZipItem& item) { item.bytes = "<Relationships/>"; }),
                "_rels/.rels: expected a relation to a 3D model, got none");
  check_refused(changed(2, [](ZipItem& item) { item.name = "3D/other.model"; }),
                "expected a part '/3D/3dmodel.model' in the package, got none");
  check_refused(zip_file({good[0], good[1], good[2], good[2]}), "expected one part '3D/3dmodel.model', got two");
  check_refused(changed(2, [](ZipItem& item) { item.told_crc = 0x1234; }),
                "3D/3dmodel.model: expected bytes that can be unpacked, got 'CRC error'");
  check_refused(changed(2, [](ZipItem& item) { item.packed = "\xff garbage"; }),
                "expected bytes that can be unpacked, got 'Zlib error: data error'");
  check_refused(changed(2, [](ZipItem& item) { item.packed = deflated(item.bytes).substr(0, 60); }),
                "expected bytes that can be unpacked, got 'CRC error'");
  check_refused(changed(2, [](ZipItem& item) { item.told_size = 10; }), "expected 10 bytes when unpacked, got more");
  check_refused(changed(2, [&](ZipItem& item) { item.told_size = static_cast<std::uint32_t>(model.size() + 1); }),
                "bytes when unpacked, got");
  check_refused(changed(2, [](ZipItem& item) { item.told_size = 0xfffffff0; }),
                "expected a size that deflated bytes can have, got 4294967280 bytes");
  check_refused(changed(2, [](ZipItem& item) { item.deflated = false, item.told_size = 3; }),
                "expected 3 bytes when unpacked, got more");
  std::string overlapping = zip_file(good);
  const std::size_t directory = overlapping.find("PK\1\2"), second = overlapping.find("PK\1\2", directory + 1);
  overlapping.replace(second + 42, 4, overlapping.substr(directory + 42, 4));
  check_refused(overlapping, "_rels/.rels: expected bytes that can be unpacked");
}

TEST_CASE("3mf: directories that ask for more than there is are refused", "[3mf][io]") {
  const std::string file = zip_file({{"a", std::string(1000, 'a'), false, false, true}});
  const std::size_t directory = file.find("PK\1\2"), end = file.find("PK\6\6");
  // Room for a million million entries.
  std::string many = file;
  many.replace(end + 24, 16, raw(std::uint64_t{1} << 40) + raw(std::uint64_t{1} << 40));
  check_refused(many, "expected the end of a directory of at most 1048576 bytes, got 1099511627776 entries in");
  std::string large = file;
  large.replace(end + 40, 8, raw(std::uint64_t{1} << 30));
  check_refused(large, "expected the end of a directory of at most 1048576 bytes, got 1 entries in 1073741824");
  // An end in each comment, for which the directory would be read anew.
  const std::string plain = zip_file({{"a", "a"}}), last = plain.substr(plain.find("PK\5\6"));
  std::string ends = plain;
  for (int i = 0; i < 20; ++i) ends += last;
  check_refused(ends, "expected the end of a directory of at most");
  // Entries that are the same bytes, of which each would be a copy.
  const std::string entry = file.substr(directory, end - directory);
  std::string same = file.substr(0, directory) + entry + entry + entry;
  same += "PK\5\6" + std::string(4, '\0') + raw(std::uint16_t{3}) + raw(std::uint16_t{3}) +
          raw(static_cast<std::uint32_t>(3 * entry.size())) + raw(static_cast<std::uint32_t>(directory)) +
          std::string(2, '\0');
  check_refused(same, "a.3mf: a: expected entries apart from each other");
}

TEST_CASE("3mf: a bomb takes no memory before it is refused", "[3mf][io]") {
  // A thousand times its size, all blanks: as much as deflated bytes can come to.
  std::string blanks(std::size_t{1} << 24, ' ');
  const std::string package = package_of(blanks);
  blanks = {};
  set_memory_limit(held_memory() + (std::size_t{8} << 20));
  CHECK_THROWS_AS(io::parse_mesh("a.3mf", Format::ThreeMf, package), OutOfBudget);
  set_memory_limit(0);
  check_refused(package, "expected XML, got 'no element found'");
}

TEST_CASE("3mf: whatever is cut off or changed, nothing but a refusal comes of it", "[3mf][io]") {
  const std::string bytes = zip_file({{"[Content_Types].xml", "<Types/>"},
                                      {"_rels/.rels", kRelationships, true, true},
                                      {"3D/3dmodel.model", in_object(kTetrahedronXml), true, false, true}});
  for (std::size_t size = 0; size < bytes.size(); ++size) try_to_read(bytes.substr(0, size));
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(changed[at] ^ (at % 3 == 0 ? 0xff : 1 << at % 8));
    try_to_read(changed);
  }
}
