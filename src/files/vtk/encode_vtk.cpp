// SPDX-License-Identifier: Apache-2.0
// New files of VTK's formats (VTK File Formats).
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "bytes/append_number.h"
#include "bytes/vtk_xml.h"
#include "document/format_readers.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

template <class Number>
void append_big_endian(std::string& bytes, Number number) {
  append_binary(bytes, number);
  std::reverse(bytes.end() - sizeof number, bytes.end());
}

/// How the numbers of a file are stored.
struct NumberOrder {
  bool big_endian;

  template <class Number>
  void append(std::string& bytes, Number number) const {
    if (big_endian) append_big_endian(bytes, number);
    else append_binary(bytes, number);
  }
  template <class Point>
  void append_point(std::string& bytes, const Point& point, bool single) const {
    for (int k = 0; k < Point::size; ++k)
      if (single) append(bytes, static_cast<float>(point[k]));
      else append(bytes, static_cast<double>(point[k]));
  }
};

const char* floating(bool single, bool legacy) {
  if (legacy) return single ? "float" : "double";
  return single ? "Float32" : "Float64";
}

VtkArray points_of(const SharedContent& content, NumberOrder order) {
  const std::size_t count = content->mesh.positions.size();
  return {"Points", "Float64", 3, 3 * sizeof(double), {count, [=](std::string& bytes, std::size_t v) {
                                                         order.append_point(
                                                             bytes, content->precision(content->mesh.positions[v]),
                                                             false);
                                                       }}};
}

VtkArray normals_of(const SharedContent& content, NumberOrder order) {
  const auto& normals = content->with.normals;
  const std::size_t width = normals.single ? sizeof(float) : sizeof(double), count = normals.value.size();
  return {"Normals",
          floating(normals.single, order.big_endian),
          3,
          3 * width,
          {count, [=](std::string& bytes, std::size_t v) {
             order.append_point(bytes, content->with.normals.value[v], content->with.normals.single);
           }}};
}

VtkArray texture_of(const SharedContent& content, NumberOrder order) {
  const auto& texture = content->with.texture;
  const std::size_t width = texture.single ? sizeof(float) : sizeof(double), count = texture.value.size();
  return {"TextureCoordinates",
          floating(texture.single, order.big_endian),
          2,
          2 * width,
          {count, [=](std::string& bytes, std::size_t v) {
             order.append_point(bytes, content->with.texture.value[v], content->with.texture.single);
           }}};
}

VtkArray colours_of(const SharedContent& content) {
  const int components = content->with.has_alpha ? 4 : 3;
  const std::size_t count = content->with.colours.size();
  return {"Colors",
          "UInt8",
          components,
          static_cast<std::size_t>(components),
          {count, [=](std::string& bytes, std::size_t v) {
             for (std::size_t k = 0; k < static_cast<std::size_t>(components); ++k)
               append_binary(bytes, colour_byte(content->with.colours[v][k]));
           }}};
}

/// Which part each face is of, 0 for the first; \pre there are fewer than 256.
VtkArray parts_of(const SharedContent& content) {
  const std::size_t count = content->mesh.face_count();
  return {"part", "UInt8", 1, 1, {count, [=](std::string& bytes, std::size_t f) {
                                    std::uint8_t part = 0;
                                    for (std::size_t end = content->parts[0].faces; f >= end;
                                         end += content->parts[part].faces)
                                      ++part;
                                    append_binary(bytes, part);
                                  }}};
}

/// VTK's number of a cell of so many corners: VTK_TRIANGLE, VTK_QUAD or VTK_POLYGON.
std::uint8_t cell_type(std::size_t corners) {
  return corners == 3 ? std::uint8_t{5} : corners == 4 ? std::uint8_t{9} : std::uint8_t{7};
}

class XmlFile {
 public:
  XmlFile(Format format, SharedContent content)
      : content_(std::move(content)),
        is_grid_(format == Format::Vtu),
        xml_(is_grid_ ? "UnstructuredGrid" : "PolyData") {}

  Pieces pieces() {
    const PolygonView& mesh = content_->mesh;
    add_part_names();
    xml_.add_text(fmt::format("<Piece NumberOfPoints=\"{}\" {}=\"{}\">\n", mesh.positions.size(),
                              is_grid_ ? "NumberOfCells" : "NumberOfPolys", mesh.face_count()));
    add_point_data();
    if (!content_->parts.empty()) {
      xml_.add_text("<CellData>\n");
      xml_.add(parts_of(content_));
      xml_.add_text("</CellData>\n");
    }
    xml_.add_text("<Points>\n");
    xml_.add(points_of(content_, order_));
    xml_.add_text("</Points>\n");
    add_cells();
    xml_.add_text("</Piece>\n");
    return std::move(xml_).raw();
  }

 private:
  void add_point_data() {
    const Attributes& with = content_->with;
    if (with.normals.empty() && with.texture.empty() && with.colours.empty()) return;
    xml_.add_text(fmt::format("<PointData{}{}{}>\n", with.colours.empty() ? "" : " Scalars=\"Colors\"",
                              with.normals.empty() ? "" : " Normals=\"Normals\"",
                              with.texture.empty() ? "" : " TCoords=\"TextureCoordinates\""));
    if (!with.normals.empty()) xml_.add(normals_of(content_, order_));
    if (!with.texture.empty()) xml_.add(texture_of(content_, order_));
    if (!with.colours.empty()) xml_.add(colours_of(content_));
    xml_.add_text("</PointData>\n");
  }

  void add_part_names() {
    if (content_->parts.empty()) return;
    std::vector<std::string> names;
    for (const Part& part : content_->parts) names.push_back(part.name);
    xml_.add_text("<FieldData>\n");
    xml_.add_words("part names", names);
    xml_.add_text("</FieldData>\n");
  }

  void add_cells() {
    const SharedContent content = content_;
    const std::size_t corners = content->mesh.corners.size(), faces = content->mesh.face_count();
    const bool narrow = corners <= std::numeric_limits<std::int32_t>::max() &&
                        content->mesh.positions.size() <= std::numeric_limits<std::int32_t>::max();
    const std::size_t width = narrow ? sizeof(std::int32_t) : sizeof(std::int64_t);
    const auto append = [narrow](std::string& bytes, std::uint32_t index) {
      if (narrow) append_binary(bytes, static_cast<std::int32_t>(index));
      else append_binary(bytes, static_cast<std::int64_t>(index));
    };
    const char* const type = narrow ? "Int32" : "Int64";
    xml_.add_text(is_grid_ ? "<Cells>\n" : "<Polys>\n");
    xml_.add({"connectivity", type, 1, width, {corners, [=](std::string& bytes, std::size_t c) {
                                                 append(bytes, content->mesh.corners[c]);
                                               }}});
    xml_.add({"offsets", type, 1, width, {faces, [=](std::string& bytes, std::size_t f) {
                                            append(bytes, content->mesh.face_begin[f + 1]);
                                          }}});
    if (is_grid_)
      xml_.add({"types", "UInt8", 1, 1, {faces, [=](std::string& bytes, std::size_t f) {
                                           append_binary(bytes, cell_type(content->mesh.face(f).size()));
                                         }}});
    xml_.add_text(is_grid_ ? "</Cells>\n" : "</Polys>\n");
  }

  SharedContent content_;
  bool is_grid_;
  NumberOrder order_{false};
  VtkXml xml_;
};

/// A legacy file, binary: lines of text with the arrays between them, most significant byte first.
class LegacyFile {
 public:
  explicit LegacyFile(SharedContent content) : content_(std::move(content)) {}

  Pieces pieces() {
    const PolygonView& mesh = content_->mesh;
    const std::size_t numbers = mesh.corners.size() + mesh.face_count();
    if (numbers > std::numeric_limits<std::int32_t>::max())
      throw InvalidInput(fmt::format(".vtk: expected at most {} numbers for faces, got {} (.vtp has a place for more)",
                                     std::numeric_limits<std::int32_t>::max(), numbers));
    add("", points_of(content_, kOrder));
    const SharedContent content = content_;
    line(fmt::format("POLYGONS {} {}", mesh.face_count(), numbers));
    sections_.push_back({mesh.face_count(), [=](std::string& bytes, std::size_t f) {
                           const auto face = content->mesh.face(f);
                           append_big_endian(bytes, static_cast<std::int32_t>(face.size()));
                           for (const auto v : face) append_big_endian(bytes, static_cast<std::int32_t>(v));
                         }});
    end_array();
    add_data();
    const std::string header = fmt::format(
        "# vtk DataFile Version 3.0\nvdb_offset\nBINARY\nDATASET POLYDATA\nPOINTS {} double\n", mesh.positions.size());
    return in_sections(header, std::move(sections_));
  }

 private:
  static constexpr NumberOrder kOrder{true};

  void line(std::string text) {
    text += '\n';
    sections_.push_back({1, [text = std::move(text)](std::string& bytes, std::size_t) { bytes += text; }});
  }
  void end_array() { line(""); }
  void add(const std::string& header, const VtkArray& array) {
    if (!header.empty()) line(header);
    sections_.push_back(array.section);
    end_array();
  }

  void add_data() {
    const Attributes& with = content_->with;
    if (!content_->parts.empty()) {
      line(fmt::format("CELL_DATA {}", content_->mesh.face_count()));
      add("SCALARS part unsigned_char 1\nLOOKUP_TABLE default", parts_of(content_));
    }
    if (with.normals.empty() && with.texture.empty() && with.colours.empty()) return;
    line(fmt::format("POINT_DATA {}", content_->mesh.positions.size()));
    if (!with.normals.empty()) {
      const VtkArray normals = normals_of(content_, kOrder);
      add(fmt::format("NORMALS {} {}", normals.name, normals.type), normals);
    }
    if (!with.texture.empty()) {
      const VtkArray texture = texture_of(content_, kOrder);
      add(fmt::format("TEXTURE_COORDINATES {} 2 {}", texture.name, texture.type), texture);
    }
    if (with.colours.empty()) return;
    const VtkArray colours = colours_of(content_);
    add(fmt::format("COLOR_SCALARS {} {}", colours.name, colours.components), colours);
  }

  SharedContent content_;
  std::vector<Section> sections_;
};

}  // namespace

Pieces to_vtk(Format format, const SharedContent& content) {
  return format == Format::Vtk ? LegacyFile(content).pieces() : XmlFile(format, content).pieces();
}

}  // namespace vdb_offset::io
