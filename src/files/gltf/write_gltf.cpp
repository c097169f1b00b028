// SPDX-License-Identifier: Apache-2.0
// Writes a mesh as a new glTF 2.0 file, .glb or .gltf. Vertices whose corners have several normals or texture
// coordinates are split first (split_vertices.h), the mesh's own before their copies. Each attribute is a view with an
// accessor, that of positions with bounds; indices have 16 bits if these are enough. Each part becomes a node, and each
// run of faces of one material a primitive, so that faces keep their order. Texture coordinates run down the picture,
// and colours of materials become linear light. The JSON is made at once and the binary data in pieces; a .gltf has the
// data inside, in base64. Coordinates beyond single precision's range are refused. Images are not written.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "bytes/append_number.h"
#include "document/format_readers.h"
#include "gltf/accessors.h"
#include "gltf/container.h"
#include "gltf/split_vertices.h"
#include "gltf/uri.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace gltf {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kVertexTarget = 34962, kIndexTarget = 34963;
// A vertex index of all ones is not allowed.
constexpr std::size_t kMostShort = 65535;

/// A part of a colour as glTF has it, from sRGB (IEC 61966-2-1), to four digits.
double linear(double part) {
  const double light = part <= 0.04045 ? part / 12.92 : std::pow((part + 0.055) / 1.055, 2.4);
  return std::round(light * 1e4) / 1e4;
}

/// A file's JSON, and the binary data that it is about.
class NewModel {
 public:
  explicit NewModel(const SharedContent& content)
      : content_(content),
        split_(std::make_shared<SplitVertices>(*content)),
        wide_(split_->origin.size() > kMostShort) {
    json_["asset"] = {{"version", "2.0"}, {"generator", "vdb_offset"}};
    json_["scene"] = 0;
    // (Not from lists within lists, which compilers take for different things.)
    json_["scenes"][0]["nodes"] = Json::array();
    for (const char* key : {"nodes", "meshes"}) json_[key] = Json::array();
    add_materials();
    for (const char* key : {"accessors", "bufferViews"}) json_[key] = Json::array();
    add_vertices();
    add_faces();
    padding_ = (4 - bytes_ % 4) % 4;
    bytes_ += padding_;
  }

  std::size_t bytes() const { return bytes_; }
  /// Bytes that fill the binary data up to a multiple of four.
  std::size_t padding() const { return padding_; }
  /// With the buffer's URI, if it has one.
  std::string json(const std::string& uri = {}) {
    Json buffer = {{"byteLength", bytes_}};
    if (!uri.empty()) buffer["uri"] = uri;
    json_["buffers"] = Json::array();
    json_["buffers"].push_back(std::move(buffer));
    return json_.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  Pieces binary(const std::string& head) { return in_sections(head, sections_); }

 private:
  void add_materials() {
    const Materials& materials = content_->materials;
    if (materials.of_face.empty()) return;
    Json list = Json::array();
    for (std::size_t m = 0; m < materials.names.size(); ++m) {
      material_.push_back(list.size());
      if (materials.names[m].empty()) continue;
      Json look = {{"metallicFactor", 0}};
      if (!materials.colours.empty() && materials.colours[m]) {
        for (const double part : *materials.colours[m]) look["baseColorFactor"].push_back(linear(part));
        look["baseColorFactor"].push_back(1);
      }
      list.push_back({{"name", materials.names[m]}, {"pbrMetallicRoughness", std::move(look)}});
    }
    if (!list.empty()) json_["materials"] = std::move(list);
  }

  /// Adds a view of records and, if it is given what they are, an accessor of all of them.
  std::size_t add_view(std::size_t count, std::size_t stride, int target, Section section) {
    Json view = {{"buffer", 0}, {"byteOffset", bytes_}, {"byteLength", count * stride}};
    if (target == kVertexTarget) view["byteStride"] = stride;
    view["target"] = target;
    json_["bufferViews"].push_back(std::move(view));
    bytes_ += count * stride;
    sections_.push_back(std::move(section));
    return json_["bufferViews"].size() - 1;
  }

  void add_attribute(const char* name, const char* type, Component component, std::size_t stride,
                     std::function<void(std::string&, std::size_t)> append) {
    const std::size_t count = split_->origin.size();
    const std::size_t view = add_view(count, stride, kVertexTarget, {count, std::move(append)});
    attributes_[name] = json_["accessors"].size();
    Json accessor = {{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}};
    if (component == Component::U8) accessor["normalized"] = true;
    json_["accessors"].push_back(std::move(accessor));
  }

  void add_vertices() {
    const auto split = split_;
    const auto content = content_;
    add_attribute("POSITION", "VEC3", Component::Float, 12, [=](std::string& bytes, std::size_t i) {
      for (int k = 0; k < 3; ++k)
        append_binary(bytes, static_cast<float>(content->mesh.positions[split->origin[i]][k]));
    });
    add_bounds();
    if (!split->normals.empty())
      add_attribute("NORMAL", "VEC3", Component::Float, 12, [=](std::string& bytes, std::size_t i) {
        for (int k = 0; k < 3; ++k) append_binary(bytes, static_cast<float>(split->normals[i][k]));
      });
    if (!split->texture.empty())
      add_attribute("TEXCOORD_0", "VEC2", Component::Float, 8, [=](std::string& bytes, std::size_t i) {
        append_binary(bytes, static_cast<float>(split->texture[i][0]));
        append_binary(bytes, static_cast<float>(1 - split->texture[i][1]));  // down the picture
      });
    add_colours();
  }

  void add_bounds() {
    Vec3d least(INFINITY), most(-INFINITY);
    for (const Vec3d& p : content_->mesh.positions)
      for (int k = 0; k < 3; ++k) {
        const double number = static_cast<float>(p[k]);
        if (!std::isfinite(number))
          throw InvalidInput(fmt::format("gltf: expected coordinates that single precision can hold, got {}", p[k]));
        least[k] = std::min(least[k], number);
        most[k] = std::max(most[k], number);
      }
    json_["accessors"].back()["min"] = {least[0], least[1], least[2]};
    json_["accessors"].back()["max"] = {most[0], most[1], most[2]};
  }

  void add_colours() {
    const Attributes& with = content_->with;
    if (with.colours.empty()) return;
    const std::size_t width = with.has_alpha ? 4 : 3;
    const bool bytes_do = are_bytes(with.colours);
    const auto append = [=, split = split_, content = content_](std::string& bytes, std::size_t i) {
      const auto& colour = content->with.colours[split->origin[i]];
      for (std::size_t k = 0; k < (bytes_do ? 4 : width); ++k)  // four bytes, as records begin at a multiple of four
        if (bytes_do) append_binary(bytes, k < width ? colour_byte(colour[k]) : std::uint8_t{0});
        else append_binary(bytes, static_cast<float>(colour[k]));
    };
    add_attribute("COLOR_0", width == 4 ? "VEC4" : "VEC3", bytes_do ? Component::U8 : Component::Float,
                  bytes_do ? 4 : 4 * width, append);
  }

  void add_faces() {
    const std::size_t of_index = wide_ ? 4 : 2, count = split_->triangles.size();
    const std::size_t view = add_view(3 * count, of_index, kIndexTarget,
                                      {count, [split = split_, wide = wide_](std::string& bytes, std::size_t t) {
                                         for (const std::uint32_t v : split->triangles[t])
                                           if (wide) append_binary(bytes, v);
                                           else append_binary(bytes, static_cast<std::uint16_t>(v));
                                       }});
    std::size_t first = 0;
    for (const Part& part : content_->parts) {
      add_node(part.name, first, first + part.faces, view);
      first += part.faces;
    }
    if (const std::size_t faces = content_->mesh.face_count(); first < faces) add_node("", first, faces, view);
  }

  /// Adds a node and its mesh of faces that follow each other; those of one material are a primitive, so that all keep
  /// their order.
  void add_node(const std::string& name, std::size_t first, std::size_t last, std::size_t view) {
    Json primitives = Json::array();
    const auto& of_face = content_->materials.of_face;
    for (std::size_t f = first, end = first; f < last; f = end) {
      for (++end; end < last && (of_face.empty() || of_face[end] == of_face[f]);) ++end;
      const std::size_t begin = split_->triangle_begin[f], count = split_->triangle_begin[end] - begin;
      if (count == 0) continue;
      Json primitive = {{"attributes", attributes_}, {"indices", json_["accessors"].size()}};
      if (!of_face.empty() && !content_->materials.names[of_face[f]].empty())
        primitive["material"] = material_[of_face[f]];
      primitives.push_back(std::move(primitive));
      json_["accessors"].push_back({{"bufferView", view},
                                    {"byteOffset", 3 * begin * (wide_ ? 4 : 2)},
                                    {"componentType", wide_ ? Component::U32 : Component::U16},
                                    {"count", 3 * count},
                                    {"type", "SCALAR"}});
    }
    if (primitives.empty()) return;
    Json node = {{"mesh", json_["meshes"].size()}}, mesh = {{"primitives", std::move(primitives)}};
    if (!name.empty()) node["name"] = mesh["name"] = name;
    json_["scenes"][0]["nodes"].push_back(json_["nodes"].size());
    json_["nodes"].push_back(std::move(node));
    json_["meshes"].push_back(std::move(mesh));
  }

  SharedContent content_;
  std::shared_ptr<const SplitVertices> split_;
  bool wide_;  ///< Indices are of 32 bits.
  Json json_ = Json::object(), attributes_ = Json::object();
  std::vector<std::size_t> material_;  ///< In the file, by number in the content.
  std::size_t bytes_ = 0, padding_ = 0;
  std::vector<Section> sections_;
};

Pieces filled_up(Pieces pieces, std::size_t zeros) {
  if (zeros == 0) return pieces;
  return in_a_row({std::move(pieces), {1, [zeros](std::size_t) { return std::string(zeros, '\0'); }}});
}

}  // namespace
}  // namespace gltf

Pieces to_glb(const SharedContent& content) {
  gltf::NewModel model(content);
  return gltf::filled_up(model.binary(gltf::glb_head(model.json(), model.bytes())), model.padding());
}

Pieces to_gltf(const SharedContent& content) {
  gltf::NewModel model(content);
  const std::string bytes = join(gltf::filled_up(model.binary(""), model.padding()));
  auto text = model.json("data:application/octet-stream;base64," + gltf::base64(bytes));
  return {1, [text = std::move(text)](std::size_t) { return text; }};
}

}  // namespace vdb_offset::io
