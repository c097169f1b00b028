// SPDX-License-Identifier: Apache-2.0
// New 3MF packages: one object with one mesh, placed once.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "bytes/append_number.h"
#include "document/format_readers.h"
#include "ground/mesh/triangulate.h"
#include "ground/system/memory.h"
#include "threemf/model.h"
#include "threemf/zip_packing.h"

namespace vdb_offset::io {
namespace {

constexpr const char* kXmlHead = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
constexpr const char* kContentTypes =
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\n"
    " <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\n"
    " <Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>\n"
    "</Types>\n";
constexpr const char* kRelationships =
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\n"
    " <Relationship Id=\"rel0\" Target=\"/3D/3dmodel.model\""
    " Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/>\n"
    "</Relationships>\n";
constexpr int kGroupId = 1, kObjectId = 2;  // of what colours or materials triangles have; of the object

Pieces whole(std::string text) {
  return {1, [text = std::move(text)](std::size_t) { return text; }};
}

std::uint32_t packed_colour(const std::array<double, 4>& colour) {
  std::uint32_t bytes = 0;
  for (const double channel : colour) bytes = bytes << 8 | colour_byte(channel);
  return bytes;
}

/// A text in which the characters that XML reserves are written as it wants them.
/// How many bytes a character of UTF-8 has that begins so; 0: none does.
std::size_t utf8_length(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first < 0xe0) return 2;
  if (first >= 0xe0 && first < 0xf0) return 3;
  return first >= 0xf0 && first < 0xf5 ? 4 : 0;
}

/// Whether these bytes are one character of UTF-8 (RFC 3629, section 4).
bool is_utf8_character(std::string_view bytes) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(bytes[k]); };
  for (std::size_t k = 1; k < bytes.size(); ++k)
    if ((byte(k) & 0xc0) != 0x80) return false;
  if (bytes.size() < 3) return true;
  // Neither longer than need be, nor a half of a pair, nor beyond the last character.
  const unsigned first = byte(0), second = byte(1);
  const unsigned least = first == 0xe0   ? 0xa0
                         : first == 0xf0 ? 0x90
                                         : 0x80,
                 most = first == 0xed   ? 0x9f
                        : first == 0xf4 ? 0x8f
                                        : 0xbf;
  return second >= least && second <= most;
}

bool is_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(static_cast<unsigned char>(text[at]));
    if (length == 0 || length > text.size() - at || !is_utf8_character(text.substr(at, length))) return false;
    at += length;
  }
  return true;
}

/// A text in some other encoding, in which ASCII stays as it is.
std::string as_ascii(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) >= 0x80) c = '?';
  return text;
}

std::string in_xml(std::string_view text) {
  std::string made;
  for (const char c : text) {
    if (c == '&') made += "&amp;";
    else if (c == '<') made += "&lt;";
    else if (c == '"') made += "&quot;";
    else if (static_cast<unsigned char>(c) < ' ') made += ' ';
    else made += c;
  }
  return is_utf8(made) ? made : as_ascii(std::move(made));
}

/// The mesh, and what its triangles have: colours, or else the materials or the parts of its faces.
struct NewModel {
  SharedContent content;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> face_of;      // of each triangle, if there are materials
  std::vector<std::uint32_t> colours;      // that there are, in order
  std::vector<std::string> materials;      // their names; "" is none
  std::vector<std::uint32_t> material_of;  // of each face

  explicit NewModel(SharedContent shared) : content(std::move(shared)) {
    for (const auto& colour : content->with.colours) colours.push_back(packed_colour(colour));
    std::sort(colours.begin(), colours.end());
    colours.erase(std::unique(colours.begin(), colours.end()), colours.end());
    if (colours.empty()) take_materials();
    const PolygonView& mesh = content->mesh;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      append_triangles(mesh, f, triangles);
      if (!materials.empty()) face_of.resize(triangles.size(), static_cast<std::uint32_t>(f));
    }
  }

  bool has_properties() const { return !colours.empty() || !materials.empty(); }
  /// Of a material: red first.
  std::uint32_t display_colour(std::size_t material) const {
    constexpr std::uint32_t kUnknown = 0xcccccc;
    const auto& known = content->materials.colours;
    if (!content->parts.empty() || known.empty() || !known[material]) return kUnknown;
    std::uint32_t packed = 0;
    for (const double part : *known[material]) packed = packed << 8 | colour_byte(part);
    return packed;
  }
  std::uint32_t colour_index(std::uint32_t vertex) const {
    const auto found = std::lower_bound(colours.begin(), colours.end(), packed_colour(content->with.colours[vertex]));
    return static_cast<std::uint32_t>(found - colours.begin());
  }

 private:
  void take_materials() {
    if (content->parts.empty()) {
      materials = content->materials.names;
      material_of = content->materials.of_face;
      return;
    }
    for (const Part& part : content->parts) {
      material_of.resize(material_of.size() + part.faces, static_cast<std::uint32_t>(materials.size()));
      materials.push_back(part.name);
    }
    material_of.resize(content->mesh.face_count(), static_cast<std::uint32_t>(materials.size()));
    materials.emplace_back();
  }
};

std::string model_head(const NewModel& model) {
  const double unit = model.content->unit_micrometres.value_or(0);
  const std::string_view name = name_of_unit(unit);
  std::string head = kXmlHead;
  head += fmt::format("<model unit=\"{}\" xml:lang=\"en-US\" xmlns=\"{}\"", name.empty() ? "millimeter" : name,
                      kThreeMfCore);
  if (!model.colours.empty()) head += fmt::format(" xmlns:m=\"{}\"", kThreeMfMaterial);
  head += ">\n <resources>\n";
  if (!model.colours.empty()) {
    head += fmt::format("  <m:colorgroup id=\"{}\">\n", kGroupId);
    for (const std::uint32_t colour : model.colours) head += fmt::format("   <m:color color=\"#{:08X}\"/>\n", colour);
    head += "  </m:colorgroup>\n";
  } else if (!model.materials.empty()) {
    head += fmt::format("  <basematerials id=\"{}\">\n", kGroupId);
    for (std::size_t m = 0; m < model.materials.size(); ++m)
      head += fmt::format("   <base name=\"{}\" displaycolor=\"#{:06X}\"/>\n", in_xml(model.materials[m]),
                          model.display_colour(m));
    head += "  </basematerials>\n";
  }
  head += fmt::format("  <object id=\"{}\" type=\"model\"", kObjectId);
  if (model.has_properties()) head += fmt::format(" pid=\"{}\" pindex=\"0\"", kGroupId);
  return head + ">\n   <mesh>\n    <vertices>\n";
}

void append_attribute(std::string& text, std::string_view name, std::uint64_t value) {
  text += name;
  append_integer(text, value);
  text += '"';
}

void append_triangle(std::string& text, const NewModel& model, std::size_t t) {
  const auto& [a, b, c] = model.triangles[t];
  // A polygon that passes through a vertex twice comes to such; the format forbids them.
  if (a == b || b == c || c == a) return;
  append_attribute(text, "     <triangle v1=\"", a);
  append_attribute(text, " v2=\"", b);
  append_attribute(text, " v3=\"", c);
  if (!model.colours.empty()) {
    append_attribute(text, " pid=\"", kGroupId);
    append_attribute(text, " p1=\"", model.colour_index(a));
    append_attribute(text, " p2=\"", model.colour_index(b));
    append_attribute(text, " p3=\"", model.colour_index(c));
  } else if (!model.materials.empty()) {
    append_attribute(text, " pid=\"", kGroupId);
    append_attribute(text, " p1=\"", model.material_of[model.face_of[t]]);
  }
  text += "/>\n";
}

Pieces model_text(const SharedContent& content) {
  const auto model = std::make_shared<const NewModel>(content);
  const auto append_vertex = [content](std::string& text, std::size_t v) {
    constexpr std::string_view kBefore[] = {"     <vertex x=\"", "\" y=\"", "\" z=\""};
    for (int k = 0; k < 3; ++k) {
      text += kBefore[k];
      append_number(text, content->mesh.positions[v][k], content->precision);
    }
    text += "\"/>\n";
  };
  const auto line = [](std::string between) {
    return Section{1, [between = std::move(between)](std::string& text, std::size_t) { text += between; }};
  };
  return in_sections(
      model_head(*model),
      {{content->mesh.positions.size(), append_vertex},
       line("    </vertices>\n    <triangles>\n"),
       {model->triangles.size(), [model](std::string& text, std::size_t t) { append_triangle(text, *model, t); }},
       line(fmt::format("    </triangles>\n   </mesh>\n  </object>\n </resources>\n <build>\n"
                        "  <item objectid=\"{}\"/>\n </build>\n</model>\n",
                        kObjectId))});
}

}  // namespace

Pieces to_3mf(const SharedContent& content) {
  // Deflated: a vertex of three long numbers, and a triangle, by what was measured.
  constexpr std::size_t kVertex = 32, kTriangle = 16;
  const std::string where = "new 3MF file";
  require_memory(content->mesh.positions.size() * kVertex +
                     content->mesh.corners.size() * (kTriangle + sizeof(std::array<std::uint32_t, 3>)),
                 where);
  return new_archive(where, {{"[Content_Types].xml", whole(std::string(kXmlHead) + kContentTypes)},
                             {"_rels/.rels", whole(std::string(kXmlHead) + kRelationships)},
                             {"3D/3dmodel.model", model_text(content)}});
}

}  // namespace vdb_offset::io
