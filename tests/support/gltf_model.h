// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gltf/uri.h"
#include "support/bytes.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset::test {

/// A glTF file under construction: its JSON and its one buffer.
struct GltfModel {
  using Json = nlohmann::ordered_json;

  Json json = {{"asset", {{"version", "2.0"}}}};
  std::string buffer;

  /// Adds elements with a view of their own. Returns the accessor's number.
  std::size_t add(const std::string& bytes, int component, std::size_t count, const char* type) {
    buffer.resize((buffer.size() + 3) / 4 * 4);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}});
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"componentType", component},
                                 {"count", count},
                                 {"type", type}});
    buffer += bytes;
    return json["accessors"].size() - 1;
  }
  std::size_t add_points(const std::vector<Vec3d>& points, bool bounded = false) {
    std::string bytes;
    for (const Vec3d& p : points)
      for (int k = 0; k < 3; ++k) bytes += raw(static_cast<float>(p[k]));
    const std::size_t accessor = add(bytes, 5126, points.size(), "VEC3");
    if (!bounded) return accessor;
    Vec3d least = points[0], most = points[0];
    for (const Vec3d& p : points)
      for (int k = 0; k < 3; ++k) {
        least[k] = std::min(least[k], p[k]);
        most[k] = std::max(most[k], p[k]);
      }
    json["accessors"].back()["min"] = {least[0], least[1], least[2]};
    json["accessors"].back()["max"] = {most[0], most[1], most[2]};
    return accessor;
  }
  std::size_t add_indices(const std::vector<std::uint16_t>& indices) {
    std::string bytes;
    for (const std::uint16_t index : indices) bytes += raw(index);
    return add(bytes, 5123, indices.size(), "SCALAR");
  }

  /// A node that places a mesh of one primitive; `node` says more of it. Returns the node.
  Json& add_mesh(Json primitive, Json node = Json::object()) {
    json["meshes"].push_back({{"primitives", {std::move(primitive)}}});
    return add_node(std::move(node), json["meshes"].size() - 1);
  }
  Json& add_node(Json node, std::size_t mesh) {
    node["mesh"] = mesh;
    json["nodes"].push_back(std::move(node));
    return json["nodes"].back();
  }

  std::string glb(int indent = -1) const {
    Json whole = json;
    whole["buffers"] = {{{"byteLength", buffer.size()}}};
    std::string text = whole.dump(indent), binary = buffer;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4);
    return "glTF" + word(2) + word(12 + 8 + text.size() + 8 + binary.size()) + word(text.size()) + "JSON" + text +
           word(binary.size()) + std::string("BIN\0", 4) + binary;
  }
  std::string gltf(int indent = 2) const {
    Json whole = json;
    whole["buffers"] = {
        {{"byteLength", buffer.size()}, {"uri", "data:application/octet-stream;base64," + io::gltf::base64(buffer)}}};
    return whole.dump(indent);
  }
  /// With the buffer in another file.
  std::string gltf_beside(const std::string& uri) const {
    Json whole = json;
    whole["buffers"] = {{{"uri", uri}, {"byteLength", buffer.size()}}};
    return whole.dump(1, '\t');
  }

 private:
  static std::string word(std::size_t value) { return raw(static_cast<std::uint32_t>(value)); }
};

/// The 24 vertices of a cube from -1 to 1, four for each side, and the normals of the sides.
struct HardCube {
  std::vector<Vec3d> points, normals;
  std::vector<std::uint16_t> indices;

  HardCube() {
    for (int axis = 0; axis < 3; ++axis)
      for (const int sign : {-1, 1}) {
        const auto first = static_cast<std::uint16_t>(points.size());
        for (int corner = 0; corner < 4; ++corner) {
          Vec3d p(0.0), n(0.0);
          p[axis] = n[axis] = sign;
          p[(axis + 1) % 3] = corner % 2 == 0 ? -sign : sign;
          p[(axis + 2) % 3] = corner / 2 == 0 ? -1 : 1;
          points.push_back(p);
          normals.push_back(n);
        }
        for (const int corner : {0, 1, 2, 2, 1, 3}) indices.push_back(static_cast<std::uint16_t>(first + corner));
      }
  }
};

}  // namespace vdb_offset::test
