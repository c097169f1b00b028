// SPDX-License-Identifier: Apache-2.0
#include "states/vtp.h"

#include <fmt/format.h>

#include <utility>

#include "bytes/vtk_xml.h"

namespace vdb_offset::io {
namespace {

void add_fields(VtkXml& xml, const char* where, const std::vector<VtpArray>& fields) {
  if (fields.empty()) return;
  xml.add_text(fmt::format("<{} Scalars=\"{}\">\n", where, fields.front().name));
  for (const VtpArray& field : fields)
    std::visit([&](const auto& numbers) { xml.add(array_of(field.name, 1, numbers)); }, field.numbers);
  xml.add_text(fmt::format("</{}>\n", where));
}

}  // namespace

void write_vtp(const std::string& path, const VtpData& data) {
  VtkXml xml("PolyData");
  if (!data.words.empty()) {
    xml.add_text("<FieldData>\n");
    for (const VtpWords& each : data.words) xml.add_words(each.name, each.words);
    xml.add_text("</FieldData>\n");
  }
  const PolygonView& cells = data.cells;
  const char* const kind = data.are_lines ? "Line" : "Poly";
  xml.add_text(fmt::format("<Piece NumberOfPoints=\"{}\" NumberOf{}s=\"{}\">\n", cells.positions.size(), kind,
                           cells.face_count()));
  add_fields(xml, "PointData", data.of_points);
  add_fields(xml, "CellData", data.of_cells);
  const std::span<const double> numbers(cells.positions.empty() ? nullptr : cells.positions.front().asPointer(),
                                        3 * cells.positions.size());
  xml.add_text("<Points>\n");
  xml.add(array_of("Points", 3, numbers));
  xml.add_text(fmt::format("</Points>\n<{}s>\n", kind));
  xml.add(array_of("connectivity", 1, cells.corners));
  xml.add(array_of("offsets", 1, cells.face_begin.subspan(cells.face_begin.empty() ? 0 : 1)));
  xml.add_text(fmt::format("</{}s>\n</Piece>\n", kind));
  write_pieces(path, std::move(xml).raw());
}

}  // namespace vdb_offset::io
