// SPDX-License-Identifier: Apache-2.0
#include "bytes/vtk_xml.h"

#include <zlib.h>

#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <string>
#include <vector>

#include "support/folder.h"

using namespace vdb_offset;

namespace {

std::uint64_t word_at(const std::string& bytes, std::size_t at) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

/// Where an array begins, behind the mark of the appended data.
std::size_t begin_of(const std::string& file, const std::string& name) {
  const std::size_t tag = file.find("Name=\"" + name + "\""), offset = file.find("offset=\"", tag) + 8;
  return file.find("\n_") + 2 + std::stoul(file.substr(offset));
}

/// An array as VTK's documentation says that it is packed: the number of blocks, the bytes of a whole one and of a last
/// one that is not whole, the packed bytes of each, then these.
std::string unpacked(const std::string& file, const std::string& name) {
  std::size_t at = begin_of(file, name);
  const std::uint64_t blocks = word_at(file, at), whole = word_at(file, at + 8), rest = word_at(file, at + 16);
  std::size_t data = at + 8 * (3 + blocks);
  std::string bytes;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    uLongf size = b + 1 == blocks && rest > 0 ? rest : whole;
    std::string block(size, '\0');
    const std::uint64_t packed = word_at(file, at + 8 * (3 + b));
    REQUIRE(uncompress(reinterpret_cast<Bytef*>(block.data()), &size,
                       reinterpret_cast<const Bytef*>(file.data() + data), packed) == Z_OK);
    CHECK(size == block.size());
    bytes += block;
    data += packed;
  }
  return bytes;
}

template <class Number>
std::string bytes_of(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

}  // namespace

TEST_CASE("vtk xml: packed arrays are those that were given, of any number of blocks", "[io][vtk_xml]") {
  const Folder folder;
  std::vector<double> points(3 * 123457);  // more than two blocks, the last of which is not whole
  std::iota(points.begin(), points.end(), -1e5);
  std::vector<float> whole(std::size_t{1} << 18, 0.25f), none;  // one block; no block
  io::VtkXml xml("StructuredGrid", " WholeExtent=\"0 1 0 1 0 1\"");
  xml.add(io::array_of("points", 3, std::span<const double>(points)));
  xml.add(io::array_of("whole", 1, std::span<const float>(whole)));
  xml.add(io::array_of("none", 1, std::span<const float>(none)));
  std::move(xml).write_packed(folder.file("a.vts"), "a.vts");
  const std::string file = slurp(folder.file("a.vts"));
  CHECK(file.find("compressor=\"vtkZLibDataCompressor\"") != std::string::npos);
  CHECK(unpacked(file, "points") == bytes_of(points));
  CHECK(unpacked(file, "whole") == bytes_of(whole));
  CHECK(unpacked(file, "none").empty());
  CHECK(word_at(file, begin_of(file, "points")) == 3);
  CHECK(word_at(file, begin_of(file, "whole") + 16) == 0);
  CHECK(file.ends_with("\n</AppendedData>\n</VTKFile>\n"));
  CHECK(file.size() < bytes_of(points).size());
}

TEST_CASE("vtk xml: raw arrays have their bytes counted before them", "[io][vtk_xml]") {
  const std::vector<std::uint8_t> states = {3, 1, 2};
  const std::vector<std::string> words = {"ab", ""};
  io::VtkXml xml("PolyData");
  xml.add_words("names", words);
  xml.add(io::array_of("states", 1, std::span<const std::uint8_t>(states)));
  const std::string file = io::join(std::move(xml).raw());
  CHECK(file.find("97 98 0\n0\n") != std::string::npos);
  const std::size_t begin = begin_of(file, "states");
  CHECK(word_at(file, begin) == 3);
  CHECK(file.substr(begin + 8, 3) == bytes_of(states));
}
