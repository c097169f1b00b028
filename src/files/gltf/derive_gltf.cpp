// SPDX-License-Identifier: Apache-2.0
// Writes a glTF file over a shell of its own faces. Each primitive keeps its place, its material and all else that its
// JSON has; its triangles are the shell's, and each of its accessors gets an element for every vertex that was added: a
// copy of that of the vertex which it comes from, weights of bones, texture coordinates and morph targets included.
// Positions are those of the shell; inner normals have the other sign, or new values where faces moved, and tangents
// are turned with them. New elements go behind the binary data that are there, or into a buffer of their own inside the
// JSON text, so that no file beside changes. A mesh of which the shell has no faces stays; of others, primitives
// without any go. Accessors that cannot be read (sparse ones) are no longer named by primitives, which is reported as a
// loss.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "bytes/append_number.h"
#include "derived/derived_mesh.h"
#include "derived/refined_corners.h"
#include "document/convert.h"
#include "gltf/gltf_document.h"
#include "gltf/json.h"
#include "gltf/rewriting.h"
#include "gltf/uri.h"
#include "ground/mesh/triangulate.h"
#include "ground/system/memory.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io::gltf {
namespace {

using OrderedJson = nlohmann::ordered_json;
constexpr int kOfVertices = 34962, kOfIndices = 34963;  // targets of views
constexpr std::size_t kMostOfShort = 65535;             // vertices; an index of all ones is not allowed

/// The vertices that follow a block's own.
struct AddedVertices {
  struct Vertex {
    std::uint32_t vertex, like;  ///< Of the shell; the one of the block of which it has all but the position.
    bool operator<(const Vertex& other) const { return vertex < other.vertex; }
  };
  std::vector<Vertex> list;
};

class GltfDeriver {
 public:
  GltfDeriver(const Contents& contents, const DerivedMesh& derived, const std::string& path)
      : contents_(contents),
        derived_(derived),
        text_(derived.source().text()),
        parsed_(nlohmann::json::parse(contents.container.json_of(text_))),
        root_(derived.source().path, parsed_),
        accessors_(root_, contents.buffers),
        json_(OrderedJson::parse(contents.container.json_of(text_))),
        beside_(contents, derived.source().path, path),
        triangles_(contents.primitives.size()),
        added_(contents.blocks.size()) {}

  WrittenDocument run() {
    written_.lost.emplace_back(kShellParts);
    collect_triangles();
    for (std::size_t b = 0; b < added_.size(); ++b) {
      auto& list = added_[b].list;
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end(), [](auto& x, auto& y) { return x.vertex == y.vertex; }),
                 list.end());
      block_of_[contents_.blocks[b].position.index] = b;
    }
    for (OrderedJson& mesh : json_["meshes"])
      for (OrderedJson& primitive : mesh["primitives"]) put_attributes(primitive);
    put_triangles();
    if (!beside_.in_same_folder()) add_copies();
    put_data();
    return std::move(written_);
  }

 private:
  using Triangle = std::array<std::uint32_t, 3>;

  /// The primitive that a face is of.
  std::size_t primitive_of(std::uint32_t f) const {
    const auto behind =
        std::upper_bound(contents_.primitives.begin(), contents_.primitives.end(), derived_.parent(f),
                         [](std::uint32_t face, const PlacedPrimitive& p) { return face < p.first_face; });
    return static_cast<std::size_t>(behind - contents_.primitives.begin()) - 1;
  }
  bool is_own(const Block& block, std::uint32_t v) const {
    return v >= block.first && v < block.first + block.position.count;
  }

  void collect_triangles() {
    CornerFinder finder(derived_.source_mesh());
    std::vector<Triangle> triangles;
    for (std::uint32_t f = 0; f < derived_.face_count(); ++f) {
      const std::size_t p = primitive_of(f), b = contents_.primitives[p].block;
      const Block& block = contents_.blocks[b];
      const auto face = derived_.mesh().face(f);
      for (std::size_t k = 0; k < face.size(); ++k) {
        if (is_own(block, face[k])) continue;
        const std::uint32_t own = derived_.origin(face[k]).vertex[0];
        // A face where parts of several blocks meet may have vertices of the others.
        const std::uint32_t like =
            is_own(block, own) ? own : derived_.source_mesh().corners[derived_.corner(f, k, finder).corner[0]];
        added_[b].list.push_back({face[k], like});
      }
      triangles.clear();
      append_triangles(derived_.mesh(), f, triangles);
      for (Triangle& triangle : triangles) {
        const auto& [x, y, z] = triangle;
        if (contents_.primitives[p].mirrored) std::swap(triangle[1], triangle[2]);
        if (x != y && y != z && z != x) triangles_[p].push_back(triangle);
      }
    }
  }

  /// Has a primitive's attributes name accessors with the elements of all vertices.
  void put_attributes(OrderedJson& primitive) {
    const auto position = primitive["attributes"].find("POSITION");
    const auto known =
        position == primitive["attributes"].end() ? block_of_.end() : block_of_.find(position->get<std::size_t>());
    if (known == block_of_.end()) return;
    const auto put = [&](OrderedJson& attributes, bool of_target) {
      std::vector<std::string> unread;
      for (auto& [name, index] : attributes.items()) {
        const auto made = accessor_of(index.get<std::size_t>(), known->second, name, of_target);
        if (made) index = *made;
        else unread.push_back(name);
      }
      for (const std::string& name : unread) {
        attributes.erase(name);
        written_.lost.push_back(fmt::format("{} {} of vertices", of_target ? "morph targets'" : "numbers", name));
      }
    };
    put(primitive["attributes"], false);
    if (const auto targets = primitive.find("targets"); targets != primitive.end())
      for (OrderedJson& target : *targets) put(target, true);
  }

  /// The accessor of a block's vertices that one becomes. None if that cannot be read, or has others.
  std::optional<std::size_t> accessor_of(std::size_t index, std::size_t b, const std::string& name, bool of_target) {
    const auto [known, is_new] = made_.try_emplace({index, b}, index);
    if (!is_new) return known->second;
    const std::optional<Accessor> from = accessors_.read_if_can(index);
    if (!from || from->count != contents_.blocks[b].position.count) {
      known->second = std::nullopt;
      return std::nullopt;
    }
    OrderedJson entry = json_["accessors"][index];
    entry.erase("byteOffset");
    for (const char* const bound : {"min", "max"})  // those of copies are what they were
      if (name == "NORMAL" || name == "TANGENT") entry.erase(bound);
    const std::uint64_t count = from->count + added_[b].list.size(), size = from->element_bytes(),
                        stride = (size + 3) / 4 * 4;  // as the format asks for
    entry["bufferView"] = add_view(count * stride, kOfVertices, stride == size ? 0 : stride);
    entry["count"] = count;
    const std::size_t begin = data_.size();
    for (std::uint64_t i = 0; i < count; ++i) {
      append_element(*from, b, i, name, of_target);
      data_.resize(begin + (i + 1) * stride, '\0');
    }
    if (name == "POSITION" && !of_target) add_bounds(entry, begin, count);
    // The first block takes the accessor's place, so that few numbers change.
    if (taken_.insert(index).second) json_["accessors"][index] = std::move(entry);
    else {
      known->second = json_["accessors"].size();
      json_["accessors"].push_back(std::move(entry));
    }
    return known->second;
  }

  /// Appends what vertex i of a block has.
  void append_element(const Accessor& from, std::size_t b, std::uint64_t i, const std::string& name, bool of_target) {
    const Block& block = contents_.blocks[b];
    const bool is_added = i >= from.count;
    const auto v = is_added ? added_[b].list[i - from.count].vertex : static_cast<std::uint32_t>(block.first + i);
    const std::uint64_t like = is_added ? added_[b].list[i - from.count].like - block.first : i;
    const std::size_t at = data_.size();
    data_ += from.bytes.substr(from.at(like), from.element_bytes());
    if (from.component != Component::Float || from.width < 3) return;
    const auto put = [&](const Vec3d& value) {
      for (int k = 0; k < 3; ++k) {
        const auto number = static_cast<float>(value[k]);
        std::memcpy(data_.data() + at + static_cast<std::size_t>(k) * sizeof number, &number, sizeof number);
      }
    };
    const bool inner = derived_.is_inner(v);
    if (of_target) {
      if (inner && name == "NORMAL") put(Vec3d(0.0) - from.vector(like));
      return;
    }
    // A vertex that is a copy of another block's is placed there as well.
    const auto position = derived_.new_position(v);
    if (name == "POSITION" && (position || derived_.origin(v).vertex[0] != block.first + like))
      put(block.frame.to_file(derived_.position(v)));
    const auto turned = block.normal ? derived_.new_vertex_normal(v) : std::nullopt;
    if (name == "NORMAL" && turned) put(block.frame.normal_to_file(*turned));
    else if (name == "NORMAL" && inner) put(Vec3d(0.0) - from.vector(like));
    if (name == "TANGENT")
      append_turned(from, like, inner, turned ? block.frame.normal_to_file(*turned) : Vec3d(0.0), at);
  }

  /// Turns the tangent that was appended at a byte so that it is at a right angle to a normal, if there is a new one.
  /// On an inner skin the fourth number, which says on what side the third axis is, has the other sign.
  void append_turned(const Accessor& from, std::uint64_t like, bool inner, const Vec3d& normal, std::size_t at) {
    constexpr double kLeast = 1e-3;  // of a tangent: one that points along the normal says nothing
    const Vec3d tangent = from.vector(like), across = tangent - normal * normal.dot(tangent);
    const double length = across.length();
    const bool turns = normal.lengthSqr() > 0 && length > kLeast * tangent.length() && std::isfinite(length);
    for (std::uint32_t k = 0; k < from.width; ++k) {
      float number = from.single(like, k);
      if (k < 3 && turns) number = static_cast<float>(across[static_cast<int>(k)] / length);
      if (k == 3 && inner) number = -number;
      std::memcpy(data_.data() + at + k * sizeof number, &number, sizeof number);
    }
  }

  void add_bounds(OrderedJson& entry, std::size_t begin, std::uint64_t count) const {
    for (const bool most : {false, true}) {
      std::array<float, 3> bound;
      for (std::size_t k = 0; k < 3; ++k)
        for (std::uint64_t i = 0; i < count; ++i) {
          float number = 0;
          std::memcpy(&number, data_.data() + begin + (3 * i + k) * sizeof number, sizeof number);
          bound[k] = i == 0 ? number : most ? std::max(bound[k], number) : std::min(bound[k], number);
        }
      entry[most ? "max" : "min"] = bound;
    }
  }

  /// Has primitives name the triangles of the shell. Those without any go, unless their mesh has none at all.
  void put_triangles() {
    std::map<std::size_t, std::vector<std::size_t>> of_mesh;
    for (std::size_t p = 0; p < triangles_.size(); ++p) of_mesh[contents_.primitives[p].mesh].push_back(p);
    for (const auto& [mesh, primitives] : of_mesh) {
      const auto is_empty = [&](std::size_t p) { return triangles_[p].empty(); };
      if (std::all_of(primitives.begin(), primitives.end(), is_empty)) continue;
      OrderedJson& list = json_["meshes"][mesh]["primitives"];
      for (auto p = primitives.rbegin(); p != primitives.rend(); ++p) {
        const std::size_t number = contents_.primitives[*p].number;
        if (is_empty(*p)) list.erase(number);
        else put_indices(*p, list[number]);
      }
    }
  }
  void put_indices(std::size_t p, OrderedJson& primitive) {
    const std::size_t b = contents_.primitives[p].block;
    const Block& block = contents_.blocks[b];
    const bool wide = block.position.count + added_[b].list.size() > kMostOfShort;
    const std::size_t count = 3 * triangles_[p].size();
    const std::size_t view = add_view(count * (wide ? 4 : 2), kOfIndices, 0);
    for (const Triangle& triangle : triangles_[p])
      for (const std::uint32_t v : triangle) {
        const auto& list = added_[b].list;
        const std::size_t number =
            is_own(block, v)
                ? v - block.first
                : block.position.count +
                      static_cast<std::size_t>(std::lower_bound(list.begin(), list.end(), AddedVertices::Vertex{v, 0}) -
                                               list.begin());
        if (wide) append_binary(data_, static_cast<std::uint32_t>(number));
        else append_binary(data_, static_cast<std::uint16_t>(number));
      }
    primitive["indices"] = json_["accessors"].size();
    primitive.erase("mode");  // triangles
    json_["accessors"].push_back({{"bufferView", view},
                                  {"componentType", wide ? Component::U32 : Component::U16},
                                  {"count", count},
                                  {"type", "SCALAR"}});
  }

  bool has_chunk() const {
    return !contents_.buffers.empty() && contents_.buffers[0].in == Buffer::In::Chunk && contents_.container.bin;
  }
  /// Adds a view of bytes that are to follow. Returns its number.
  std::size_t add_view(std::uint64_t bytes, int target, std::uint64_t stride) {
    require_memory(data_.size() + bytes, derived_.source().path);
    data_.resize((data_.size() + 3) / 4 * 4, '\0');
    const std::size_t before = has_chunk() ? contents_.container.bin->size : 0;
    OrderedJson view = {{"buffer", has_chunk() ? 0 : contents_.buffers.size()},
                        {"byteOffset", (before + 3) / 4 * 4 + data_.size()},
                        {"byteLength", bytes},
                        {"target", target}};
    if (stride > 0) view["byteStride"] = stride;
    json_["bufferViews"].push_back(std::move(view));
    return json_["bufferViews"].size() - 1;
  }

  void add_copies() {
    for (const Buffer& buffer : contents_.buffers)
      if (buffer.in == Buffer::In::File) beside_.add_copy(buffer.uri, written_);
    for (const std::string& uri : contents_.image_uris)
      if (!is_data_uri(uri)) beside_.add_copy(uri, written_);
  }

  /// Puts the file together.
  void put_data() {
    data_.resize((data_.size() + 3) / 4 * 4, '\0');
    const Container& container = contents_.container;
    const int indent = container.json_of(text_).find('\n') == std::string_view::npos ? -1 : 2;
    if (has_chunk()) {
      const Container::Span chunk = *container.bin;
      const std::size_t filled = (chunk.size + 3) / 4 * 4;
      json_["buffers"][0]["byteLength"] = filled + data_.size();
      written_.file = in_a_row({in_slices(glb_head(json_.dump(indent), filled + data_.size())),
                                in_slices(text_.substr(chunk.begin, chunk.size)),
                                in_slices(std::string(filled - chunk.size, '\0')), in_slices(std::move(data_))});
      if (chunk.begin + chunk.size < text_.size()) written_.lost.emplace_back("chunks of other data");
      return;
    }
    json_["buffers"].push_back(
        {{"byteLength", data_.size()}, {"uri", "data:application/octet-stream;base64," + base64(data_)}});
    const std::string json = json_.dump(indent);
    written_.file = container.is_binary
                        ? in_a_row({in_slices(glb_head(derived_.source().path, container, text_, json)),
                                    in_slices(text_.substr(container.json_chunk.begin + container.json_chunk.size))})
                        : in_slices(std::string(text_.substr(0, container.json.begin)) + json);
  }

  const Contents& contents_;
  const DerivedMesh& derived_;
  std::string_view text_;
  nlohmann::json parsed_;
  JsonValue root_;
  Accessors accessors_;
  OrderedJson json_;
  FilesBeside beside_;
  std::vector<std::vector<Triangle>> triangles_;  // of each primitive, by the shell's vertices
  std::vector<AddedVertices> added_;              // of each block
  std::map<std::size_t, std::size_t> block_of_;   // by the accessor of positions
  std::map<std::pair<std::size_t, std::size_t>, std::optional<std::size_t>> made_;  // by accessor and block
  std::set<std::size_t> taken_;
  std::string data_;
  WrittenDocument written_;
};

}  // namespace

WrittenDocument GltfDocument::derive(const SharedDerived& derived, const std::string& path) const {
  return GltfDeriver(contents_, *derived, path).run();
}

}  // namespace vdb_offset::io::gltf
