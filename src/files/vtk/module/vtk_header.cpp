// SPDX-License-Identifier: Apache-2.0
// Reads how a file of VTK's is made, and refuses counts that its bytes cannot back, before VTK's own readers see the
// file: these make room for whatever a file promises. Of XML it takes the attributes of the first tag and how arrays
// are stored, and bounds all numbers of things by the size of the file, by more if the file is compressed. Of a legacy
// file it takes the lines that say ASCII or BINARY and the kind of the data set, and bounds the numbers in lines that
// begin with a keyword or describe an array. The text is searched as it stands, without a parser. Only surfaces and
// unstructured grids are let through. Everything else about the file is left to VTK's readers and to vtk_cells.cpp.
#include "vtk/module/vtk_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string_view>

#include "vdb_offset/numbers.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

// What a compressed byte can become at most: zlib's 1032, and more than LZ4's 255. LZMA can do more, for what nobody
// writes.
constexpr std::uint64_t kMostThings = 1100;

[[noreturn]] void fail(const MeshFile& file, std::size_t byte, const std::string& expected, std::string_view found) {
  throw InvalidInput(fmt::format("{}, byte {}: expected {}, got '{}'", file.path, byte, expected,
                                 found.substr(0, std::min<std::size_t>(found.size(), 60))));
}

/// The value in quotes, of either kind, behind the first `=` from `at` on; nothing if there is none.
std::string_view quoted(std::string_view text, std::size_t at) {
  const std::size_t quote = text.find_first_of("\"'", text.find('=', at));
  if (quote == std::string_view::npos) return {};
  const std::size_t end = text.find(text[quote], quote + 1);
  return end == std::string_view::npos ? std::string_view() : text.substr(quote + 1, end - quote - 1);
}

/// The value of an attribute of an element, or nothing.
std::string_view attribute(std::string_view element, const std::string& name) {
  for (std::size_t at = element.find(name + "="); at != std::string_view::npos; at = element.find(name + "=", at + 1))
    if (at > 0 && static_cast<unsigned char>(element[at - 1]) <= ' ') return quoted(element, at);
  return {};
}

/// Whether an array of the text is stored so.
bool has_arrays(std::string_view text, const std::string& format) {
  return text.find(" format=\"" + format + "\"") != std::string_view::npos ||
         text.find(" format='" + format + "'") != std::string_view::npos;
}

std::string_view line_at(std::string_view text, std::size_t at) {
  return text.substr(at, std::min(text.find('\n', at), text.size()) - at);
}

/// Refuses attributes whose names begin so, and that are no numbers up to `most`.
void require_counts(const MeshFile& file, std::string_view text, std::string_view start, std::uint64_t most) {
  for (std::size_t at = text.find(start); at != std::string_view::npos; at = text.find(start, at + 1)) {
    const std::string_view name = text.substr(at + 1, text.find('=', at) - at - 1), value = quoted(text, at);
    const auto count = decimal<std::uint64_t>(value);
    if (!count || *count > most)
      fail(file, at, fmt::format("a {} that the file has bytes for", name.substr(0, name.find_last_not_of(' ') + 1)),
           value);
  }
}

/// Refuses numbers of things that the file has no bytes for.
void require_counts_of_xml(const MeshFile& file, std::string_view text, const VtkHeader& header) {
  const std::uint64_t most = file.text().size() * (header.compressor.empty() ? 1 : kMostThings);
  require_counts(file, text, " NumberOf", most);
  constexpr std::uint64_t kMostOfKey = 1000;  // values of an information key, which have two or three
  require_counts(file, text, " index=", kMostOfKey);
  require_counts(file, text, " length=", kMostOfKey);
}

VtkHeader read_xml_header(const MeshFile& file, std::size_t start) {
  const std::string_view all = file.text();
  const std::string_view text = all.substr(0, all.find("<AppendedData"));
  // The element's first tag: attributes of others do not count.
  const std::string_view element = text.substr(start, std::min(text.find('>', start), text.size()) - start);
  VtkHeader header;
  const std::string_view type = attribute(element, "type");
  if (type != "PolyData" && type != "UnstructuredGrid")
    fail(file, start, "a VTKFile of type PolyData or UnstructuredGrid", type.empty() ? element : type);
  header.grid = type == "UnstructuredGrid";
  header.compressor = attribute(element, "compressor");
  header.wide_counts = attribute(element, "header_type") == "UInt64";
  header.big_endian = attribute(element, "byte_order") == "BigEndian";
  header.appended = has_arrays(text, "appended");
  header.ascii = !header.appended && !has_arrays(text, "binary");
  header.base64 = header.appended && attribute(line_at(all, text.size()), "encoding") == "base64";
  require_counts_of_xml(file, text, header);
  return header;
}

/// The words of a line, as many as there is room for.
std::array<std::string_view, 5> words_of(std::string_view line, std::size_t& count) {
  std::array<std::string_view, 5> words;
  count = 0;
  for (std::size_t at = line.find_first_not_of(" \t\r"); at != std::string_view::npos && count < words.size();
       at = line.find_first_not_of(" \t\r", at)) {
    const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
    words[count++] = line.substr(at, end - at);
    at = end;
  }
  return words;
}

bool is_type(std::string_view word) {
  constexpr std::string_view kTypes[] = {
      "bit",  "unsigned_char", "char",   "unsigned_short", "short",  "unsigned_int", "int",           "unsigned_long",
      "long", "float",         "double", "vtkIdType",      "string", "vtktypeint64", "vtktypeuint64", "variant"};
  return std::find(std::begin(kTypes), std::end(kTypes), word) != std::end(kTypes);
}

/// Refuses numbers of things that the file has no bytes for: in the lines that begin with a keyword, and in those of
/// arrays, "name components tuples type". Numbers between them, in binary files, may look like such a line only by a
/// chance that does not happen.
void require_counts_of_legacy(const MeshFile& file) {
  constexpr std::string_view kKeywords[] = {"POINTS",          "VERTICES", "LINES",        "POLYGONS",
                                            "TRIANGLE_STRIPS", "CELLS",    "CELL_TYPES",   "POINT_DATA",
                                            "CELL_DATA",       "FIELD",    "LOOKUP_TABLE", "OFFSETS"};
  const std::string_view text = file.text();
  const std::uint64_t most = 8 * std::uint64_t{text.size()};  // bits are the smallest things
  for (std::size_t at = 0; at < text.size(); at += line_at(text, at).size() + 1) {
    const std::string_view line = line_at(text, at);
    if (line.size() > 400) continue;
    std::size_t count = 0;
    const auto words = words_of(line, count);
    const bool is_keyword = std::find(std::begin(kKeywords), std::end(kKeywords), words[0]) != std::end(kKeywords);
    const bool is_array = count == 4 && is_type(words[3]);
    if (!is_keyword && !is_array) continue;
    std::uint64_t product = 1;
    for (std::size_t k = 1; k < std::min<std::size_t>(count, 3); ++k) {
      const auto number = decimal<std::uint64_t>(words[k]);
      if (!number) continue;  // a name or a type; VTK's reader refuses what it is not
      product =
          *number > most || product > most ? most + 1 : product * std::max<std::uint64_t>(1, is_array ? *number : 1);
      if (product > most) fail(file, at, "no more than the file has bytes for", line);
    }
  }
}

VtkHeader read_legacy_header(const MeshFile& file) {
  const std::string_view text = file.text();
  VtkHeader header;
  header.legacy = true;
  std::size_t at = 0;
  for (int line = 0; line < 2 && at < text.size(); ++line) at += line_at(text, at).size() + 1;
  std::string_view encoding, dataset;
  for (std::size_t count = 0; at < text.size() && dataset.empty(); at += line_at(text, at).size() + 1) {
    const auto words = words_of(line_at(text, at), count);
    if (words[0] == "ASCII" || words[0] == "BINARY") encoding = words[0];
    else if (words[0] == "DATASET") dataset = words[1];
    else if (count > 0) fail(file, at, encoding.empty() ? "ASCII or BINARY" : "DATASET", words[0]);
  }
  if (encoding.empty()) fail(file, std::min(at, text.size()), "ASCII or BINARY", "the end of the file");
  if (dataset != "POLYDATA" && dataset != "UNSTRUCTURED_GRID")
    fail(file, std::min(at, text.size()), "a DATASET of POLYDATA or UNSTRUCTURED_GRID", dataset);
  header.ascii = encoding == "ASCII";
  header.grid = dataset == "UNSTRUCTURED_GRID";
  require_counts_of_legacy(file);
  return header;
}

}  // namespace

VtkHeader read_vtk_header(const MeshFile& file) {
  const std::string_view text = file.text();
  if (text.starts_with("# vtk DataFile Version")) return read_legacy_header(file);
  const std::size_t element = text.substr(0, 4096).find("<VTKFile");
  if (element == std::string_view::npos)
    fail(file, 0, "'# vtk DataFile Version' or '<VTKFile'", line_at(text, 0).substr(0, 24));
  return read_xml_header(file, element);
}

}  // namespace vdb_offset::io
