// SPDX-License-Identifier: Apache-2.0
// VTK's XML of polygons (VTK File Formats, "PolyData"). What is not compressed is simple enough that it needs no VTK.
#include "states/vtp.h"

#include <fmt/format.h>

#include <bit>
#include <cstddef>
#include <functional>
#include <iterator>

#include "vdb_offset/output_files.h"

namespace vdb_offset::io {
namespace {

// Bytes that are handed on at once. Not measured beside other sizes.
constexpr std::size_t kBlock = std::size_t{1} << 16;

const char* type_of(std::span<const float>) { return "Float32"; }
const char* type_of(std::span<const std::uint8_t>) { return "UInt8"; }
const char* type_of(std::span<const std::uint32_t>) { return "UInt32"; }

std::string_view bytes_of(const void* begin, std::size_t size) { return {static_cast<const char*>(begin), size}; }

/// The parts of a file: the arrays' bytes stand behind the text, each with their number before them.
class VtpFile {
 public:
  explicit VtpFile(const VtpData& data) : data_(data) {
    text_ = fmt::format(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"{}\" "
        "header_type=\"UInt64\">\n"
        "<PolyData>\n",
        std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian");
    add_words();
    const PolygonView& cells = data.cells;
    const char* const kind = data.are_lines ? "Line" : "Poly";
    text_ += fmt::format("<Piece NumberOfPoints=\"{}\" NumberOf{}s=\"{}\">\n", cells.positions.size(), kind,
                         cells.face_count());
    add_fields("PointData", data.of_points);
    add_fields("CellData", data.of_cells);
    text_ += "<Points>\n";
    add_array("Points", "Float64", 3, bytes_of(cells.positions.data(), cells.positions.size_bytes()));
    text_ += fmt::format("</Points>\n<{}s>\n", kind);
    add_array("connectivity", "UInt32", 1, bytes_of(cells.corners.data(), cells.corners.size_bytes()));
    const auto ends = cells.face_begin.subspan(cells.face_begin.empty() ? 0 : 1);
    add_array("offsets", "UInt32", 1, bytes_of(ends.data(), ends.size_bytes()));
    text_ += fmt::format("</{}s>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_", kind);
  }

  void write(const Sink& sink) const {
    sink(text_);
    for (const std::string_view array : arrays_) {
      const std::uint64_t size = array.size();
      sink(bytes_of(&size, sizeof size));
      for (std::size_t at = 0; at < array.size(); at += kBlock) sink(array.substr(at, kBlock));
    }
    sink("\n</AppendedData>\n</VTKFile>\n");
  }

 private:
  void add_array(const std::string& name, const char* type, int components, std::string_view bytes) {
    text_ += fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n", type,
        name, components, offset_);
    offset_ += sizeof(std::uint64_t) + bytes.size();
    arrays_.push_back(bytes);
  }

  void add_fields(const char* where, const std::vector<VtpArray>& fields) {
    if (fields.empty()) return;
    text_ += fmt::format("<{} Scalars=\"{}\">\n", where, fields.front().name);
    for (const VtpArray& field : fields)
      std::visit(
          [&](const auto& numbers) {
            add_array(field.name, type_of(numbers), 1, bytes_of(numbers.data(), numbers.size_bytes()));
          },
          field.numbers);
    text_ += fmt::format("</{}>\n", where);
  }

  /// Words as VTK has them: the codes of their bytes, with a 0 behind each.
  void add_words() {
    if (data_.words.empty()) return;
    text_ += "<FieldData>\n";
    for (const VtpWords& each : data_.words) {
      text_ += fmt::format("<Array type=\"String\" Name=\"{}\" NumberOfTuples=\"{}\" format=\"ascii\">\n", each.name,
                           each.words.size());
      for (const std::string& word : each.words) {
        for (const char c : word) text_ += fmt::format("{} ", static_cast<unsigned>(static_cast<unsigned char>(c)));
        text_ += "0\n";
      }
      text_ += "</Array>\n";
    }
    text_ += "</FieldData>\n";
  }

  const VtpData& data_;
  std::string text_;
  std::uint64_t offset_ = 0;
  std::vector<std::string_view> arrays_;
};

}  // namespace

void write_vtp(const std::string& path, const VtpData& data) {
  const VtpFile file(data);
  write_file(path, [&](const Sink& sink) { file.write(sink); });
}

}  // namespace vdb_offset::io
