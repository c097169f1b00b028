// SPDX-License-Identifier: Apache-2.0
// Makes one mesh of the triangles of a glTF file's meshes, each where the scene places it first. Each accessor of
// positions becomes a block of vertices, in the order in which primitives name them; a primitive that names it again
// shares the block, unless it is placed elsewhere. Strips and fans become triangles, which are turned round where a
// transform mirrors. Faces are named by their node or mesh, and by their material. How many corners there may be is
// bounded by the bytes of the file. What is to be rewritten has to have bytes and a role of its own, so that nothing
// else of the file changes with it; a file in which it has not is refused. Points, lines and what the scene does not
// show are left out, and remarks say how many. Morph targets and weights of bones stay as they are.
#include "gltf/mesh_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "vdb_offset/run.h"

namespace vdb_offset::io::gltf {
namespace {

enum Mode : std::uint64_t { kTriangles = 4, kStrip = 5, kFan = 6 };

// Corners that there may be for a byte of the file and its buffers. A strip has three for each index, which may be a
// byte; more come about only where primitives name the same data again and again.
constexpr std::uint64_t kCornersPerByte = 8;

/// A name as formats of lines can hold it: without line ends, and without a backslash at its end, which would continue
/// the line.
std::string on_one_line(std::string name) {
  for (char& c : name)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
  while (name.ends_with('\\') || name.ends_with(' ')) name.pop_back();
  name.erase(0, std::min(name.find_first_not_of(' '), name.size()));
  return name;
}

std::uint32_t number_of(const std::string& name, std::vector<std::string>& names,
                        std::unordered_map<std::string, std::uint32_t>& known) {
  const auto [found, is_new] = known.try_emplace(name, static_cast<std::uint32_t>(names.size()));
  if (is_new) names.push_back(name);
  return found->second;
}

std::uint64_t triangle_count(std::uint64_t mode, std::uint64_t corners) {
  return mode == kTriangles ? corners / 3 : corners < 3 ? 0 : corners - 2;
}

/// The corners of a triangle, as indices within the list of those of the primitive.
std::array<std::uint64_t, 3> corners_of(std::uint64_t mode, std::uint64_t triangle) {
  if (mode == kTriangles) return {3 * triangle, 3 * triangle + 1, 3 * triangle + 2};
  if (mode == kFan) return {triangle + 1, triangle + 2, 0};
  const std::uint64_t odd = triangle % 2;
  return {triangle, triangle + 1 + odd, triangle + 2 - odd};
}

}  // namespace

/// A primitive of triangles.
struct MeshBuilder::Primitive {
  JsonValue value;
  std::size_t mesh, number, block;
  std::optional<Accessor> indices;
  std::uint64_t mode, corners;
  bool mirrored;
  std::string group;
};

MeshBuilder::MeshBuilder(MeshFile& file, const JsonValue& root, Contents& contents)
    : file_(file),
      root_(root),
      contents_(contents),
      accessors_(root, contents.buffers),
      meshes_(root, "meshes"),
      materials_(root, "materials") {}

MeshBuilder::~MeshBuilder() = default;

void MeshBuilder::build(const std::vector<Placement>& placements) {
  for (std::size_t m = 0; m < meshes_.size(); ++m) add_mesh(m, placements[m]);
  if (primitives_.empty()) root_.fail("meshes of triangles that a scene shows", "none");
  require_rewritable();
  read_positions();
  for (const Primitive& primitive : primitives_) add_triangles(primitive);
  if (file_.polygons.face_count() == 0) root_.fail("meshes of triangles that a scene shows", "none");
  FaceNames& names = contents_.names;
  const auto is_empty = [](const std::string& name) { return name.empty(); };
  if (std::all_of(names.groups.begin(), names.groups.end(), is_empty)) names.groups = {}, names.group_of = {};
  if (std::all_of(names.materials.begin(), names.materials.end(), is_empty))
    names.materials = {}, names.material_of = {};
  make_remarks();
}

void MeshBuilder::add_mesh(std::size_t number, const Placement& placement) {
  const JsonValue mesh = meshes_[number], primitives = mesh.at("primitives");
  if (placement.nodes == 0) {
    ++unplaced_;
    return;
  }
  repeated_ += placement.nodes > 1;
  skinned_ += placement.is_skinned;
  const std::string group = on_one_line(placement.node_name.empty() ? mesh.text_of("name") : placement.node_name);
  for (std::size_t p = 0; p < primitives.size(); ++p) add_primitive(primitives[p], number, p, placement, group);
}

void MeshBuilder::add_primitive(const JsonValue& value, std::size_t mesh, std::size_t number,
                                const Placement& placement, const std::string& group) {
  if (const auto extensions = value.find("extensions"))
    if (const auto draco = extensions->find("KHR_draco_mesh_compression"))
      draco->fail("geometry as plain floats", "compressed by Draco, which is not supported");
  const auto mode_value = value.find("mode");
  const std::uint64_t mode = mode_value ? mode_value->whole(kFan) : std::uint64_t{kTriangles};
  if (mode < kTriangles) {
    ++others_;
    return;
  }
  has_targets_ |= value.find("targets").has_value();
  const std::optional<std::size_t> block = block_of(value.at("attributes"), placement);
  if (!block) return;
  Primitive primitive{
      value, mesh, number, *block, {}, mode, contents_.blocks[*block].position.count, placement.frame.mirrors(), group};
  if (const auto indices = value.find("indices")) {
    primitive.indices = accessors_.read(accessors_.index_of(*indices));
    const Component type = primitive.indices->component;
    if (primitive.indices->width != 1 || (type != Component::U8 && type != Component::U16 && type != Component::U32))
      indices->fail("an accessor of whole numbers from 0 on", "others");
    primitive.corners = primitive.indices->count;
  }
  if (mode == kTriangles && primitive.corners % 3 != 0)
    value.fail("triangles of three corners each", fmt::format("{} corners", primitive.corners));
  corners_ += 3 * triangle_count(mode, primitive.corners);
  require_room(value);
  primitives_.push_back(std::move(primitive));
}

void MeshBuilder::require_room(const JsonValue& primitive) const {
  std::uint64_t bytes = file_.text().size();
  for (const Buffer& buffer : contents_.buffers)
    if (buffer.in == Buffer::In::File) bytes += buffer.bytes.size();
  const std::uint64_t most = std::min<std::uint64_t>(kCornersPerByte * bytes, kNone - 2);
  if (corners_ > most)
    primitive.fail(fmt::format("at most {} corners in a file of its size", most), std::to_string(corners_));
}

/// The block of a primitive's positions. None if the primitive has none, or they are placed in another frame before.
std::optional<std::size_t> MeshBuilder::block_of(const JsonValue& attributes, const Placement& placement) {
  const auto position = attributes.find("POSITION");
  if (!position) {
    ++without_;
    return std::nullopt;
  }
  const std::size_t accessor = accessors_.index_of(*position);
  if (const auto known = block_by_accessor_.find(accessor); known != block_by_accessor_.end()) {
    const Block& block = contents_.blocks[known->second];
    const auto normal = attributes.find("NORMAL");
    other_normals_ += normal && !(block.normal && accessors_.index_of(*normal) == block.normal->index);
    if (block.frame == placement.frame) return known->second;
    ++shared_;
    return std::nullopt;
  }
  Block block;
  block.position = accessors_.read_floats(accessor, "POSITION", 3);
  block.frame = placement.frame;
  add_attributes(attributes, block);
  block.first = static_cast<std::uint32_t>(vertices_);
  vertices_ += block.position.count;
  if (vertices_ > kNone - 2)
    position->fail(fmt::format("at most {} vertices in all", kNone - 2), std::to_string(vertices_));
  block_by_accessor_.emplace(accessor, contents_.blocks.size());
  contents_.blocks.push_back(block);
  return contents_.blocks.size() - 1;
}

void MeshBuilder::add_attributes(const JsonValue& attributes, Block& block) {
  block.normal = find_floats(attributes, "NORMAL", 3, block);
  block.tangent = find_floats(attributes, "TANGENT", 4, block);
  block.texture = find_numbers(attributes, "TEXCOORD_0", 2, 2, block);
  block.colour = find_numbers(attributes, "COLOR_0", 3, 4, block);
}

/// An attribute that is rewritten with its vertices, which it has to fit.
std::optional<Accessor> MeshBuilder::find_floats(const JsonValue& attributes, const char* name, std::uint32_t width,
                                                 const Block& block) const {
  const auto index = attributes.find(name);
  if (!index) return std::nullopt;
  const Accessor accessor = accessors_.read_floats(accessors_.index_of(*index), name, width);
  if (accessor.count != block.position.count)
    index->fail(fmt::format("an accessor of {} elements, as many as positions", block.position.count),
                std::to_string(accessor.count));
  return accessor;
}

/// An attribute that is read for other formats, and stays as it is. None if it is not what it should be.
std::optional<Accessor> MeshBuilder::find_numbers(const JsonValue& attributes, const char* name, std::uint32_t least,
                                                  std::uint32_t most, const Block& block) const {
  const auto index = attributes.find(name);
  if (!index || accessors_.is_sparse(accessors_.index_of(*index))) return std::nullopt;
  const std::optional<Accessor> accessor = accessors_.read_if_can(accessors_.index_of(*index));
  if (!accessor || accessor->count != block.position.count || accessor->width < least || accessor->width > most)
    return std::nullopt;
  const bool is_share =
      accessor->normalized && (accessor->component == Component::U8 || accessor->component == Component::U16);
  return accessor->component == Component::Float || is_share ? accessor : std::nullopt;
}

void MeshBuilder::read_positions() {
  file_.polygons.positions.reserve(vertices_);
  for (const Block& block : contents_.blocks)
    for (std::uint64_t i = 0; i < block.position.count; ++i) {
      const Vec3d q = block.position.vector(i), p = block.frame.to_mesh(q);
      if (!p.isFinite())
        accessors_.value(block.position.index)
            .fail(q.isFinite() ? "positions that can be placed" : "finite numbers",
                  fmt::format("others in element {}", i));
      file_.polygons.positions.push_back(p);
    }
}

void MeshBuilder::add_triangles(const Primitive& primitive) {
  const Block& block = contents_.blocks[primitive.block];
  contents_.primitives.push_back({primitive.mesh, primitive.number, primitive.block,
                                  static_cast<std::uint32_t>(file_.polygons.face_count()), primitive.mirrored});
  const std::uint64_t count = triangle_count(primitive.mode, primitive.corners);
  std::size_t made = 0;
  for (std::uint64_t t = 0; t < count; ++t) {
    std::array<std::uint32_t, 3> corner{};
    const auto within = corners_of(primitive.mode, t);
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = primitive.indices ? primitive.indices->whole(within[k], 0) : static_cast<std::uint32_t>(within[k]);
      if (corner[k] >= block.position.count)
        primitive.value.at("indices").fail(fmt::format("indices below {}", block.position.count),
                                           fmt::format("{} in element {}", corner[k], within[k]));
    }
    // Strips are joined to one by triangles that are lines.
    const bool is_join = corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0];
    if (primitive.mode != kTriangles && is_join) continue;
    if (primitive.mirrored) std::swap(corner[1], corner[2]);
    for (const std::uint32_t v : corner) file_.polygons.corners.push_back(block.first + v);
    file_.polygons.close_face();
    ++made;
  }
  name_faces(made, primitive.group, primitive.value);
}

void MeshBuilder::name_faces(std::size_t count, const std::string& group, const JsonValue& primitive) {
  const auto index = primitive.find("material");
  const std::string material = index ? on_one_line(materials_.at(*index).text_of("name")) : std::string();
  FaceNames& names = contents_.names;
  names.group_of.insert(names.group_of.end(), count, number_of(group, names.groups, group_by_name_));
  names.material_of.insert(names.material_of.end(), count, number_of(material, names.materials, material_by_name_));
}

/// What a file holds besides must not change with the positions, normals and tangents that are rewritten.
void MeshBuilder::require_rewritable() const {
  std::vector<Accessor> rewritten;
  std::unordered_map<std::size_t, const char*> role;
  const auto add = [&](const std::optional<Accessor>& accessor, const char* name) {
    if (!accessor) return;
    rewritten.push_back(*accessor);
    role.emplace(accessor->index, name);
  };
  for (const Block& block : contents_.blocks) {
    add(block.position, "POSITION");
    add(block.normal, "NORMAL");
    add(block.tangent, "TANGENT");
  }
  accessors_.require_apart(rewritten);
  require_roles(role);
}

/// No accessor that is rewritten may be something else in another place.
void MeshBuilder::require_roles(const std::unordered_map<std::size_t, const char*>& role) const {
  const auto require = [&](const JsonValue& index, const std::string& name) {
    const auto known = role.find(accessors_.index_of(index));
    if (known != role.end() && known->second != name)
      index.fail(fmt::format("an accessor of its own, as one of {} is to be rewritten", known->second), "the same");
  };
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    const JsonValue primitives = meshes_[m].at("primitives");
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      primitives[p].at("attributes").for_each([&](const std::string& name, const JsonValue& index) {
        require(index, name);
      });
      if (const auto indices = primitives[p].find("indices")) require(*indices, "");
      const auto targets = primitives[p].find("targets");
      for (std::size_t t = 0; targets && t < targets->size(); ++t)
        (*targets)[t].for_each([&](const std::string&, const JsonValue& index) { require(index, ""); });
    }
  }
}

std::vector<std::string> MeshBuilder::attributes() const {
  std::vector<std::string> names;
  const auto add = [&](std::optional<Accessor> Block::*attribute, const char* name) {
    if (std::any_of(contents_.blocks.begin(), contents_.blocks.end(),
                    [&](const Block& b) { return (b.*attribute).has_value(); }))
      names.emplace_back(name);
  };
  add(&Block::normal, kNormals);
  add(&Block::tangent, "tangents");
  add(&Block::texture, kTexture);
  add(&Block::colour, kColours);
  return names;
}

void MeshBuilder::make_remarks() {
  const auto remark = [&](std::size_t count, const char* one, const char* several, const char* what) {
    if (count > 0) file_.remarks.push_back(fmt::format("{} {} {}", count, count == 1 ? one : several, what));
  };
  remark(unplaced_, "mesh", "meshes", "that the scene does not show: left as they are");
  remark(repeated_, "mesh", "meshes",
         "that several nodes place: offset where the first of them is, and moved so in all");
  remark(skinned_, "mesh", "meshes",
         "with bones: offset in the pose that the file has vertices in; bones and weights stay");
  remark(shared_, "part", "parts",
         "with the vertices of another that is placed elsewhere: moved with those, and not looked at");
  remark(others_ + without_, "part", "parts", "of points or lines, or without positions: not looked at");
  remark(other_normals_, "part", "parts", "with other normals at the vertices of another: these normals stay");
  if (has_targets_)
    file_.remarks.emplace_back("morph targets stay as they are: differences from the vertices that move");
}

}  // namespace vdb_offset::io::gltf
