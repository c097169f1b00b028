// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <unordered_map>
#include <vector>

#include "gltf/accessors.h"
#include "gltf/gltf_document.h"
#include "gltf/json.h"
#include "ground/numbers/rounding.h"

namespace vdb_offset::io::gltf {

/// Where a scene places a mesh first.
struct Placement {
  std::size_t nodes = 0;  ///< That place it.
  AffineFrame frame;
  std::string node_name;
  bool is_skinned = false;  ///< Then it has no frame of its own: its bones place it.
};

/// The placement of each mesh in the file's scene; without a scene, in the trees of all nodes.
/// \throw InvalidInput for nodes that are no trees, or a transform of a mesh that cannot be undone
std::vector<Placement> read_placements(const JsonValue& root);

/// Makes one mesh of the triangles of a file's placed meshes.
class MeshBuilder {
 public:
  /// All outlive the builder.
  MeshBuilder(MeshFile& file, const JsonValue& root, Contents& contents);
  MeshBuilder(const MeshBuilder&) = delete;
  MeshBuilder& operator=(const MeshBuilder&) = delete;
  ~MeshBuilder();

  /// Fills in the file's polygons and remarks and the contents' blocks and names.
  /// \throw InvalidInput for geometry that is not there, or cannot be rewritten in its place
  void build(const std::vector<Placement>& placements);

  /// Names of what vertices have, for MeshFile::extras.
  std::vector<std::string> attributes() const;
  bool has_targets() const { return has_targets_; }
  /// Primitives that are points or lines.
  std::size_t others() const { return others_; }

 private:
  struct Primitive;
  void add_mesh(std::size_t number, const Placement& placement);
  void add_primitive(const JsonValue& value, std::size_t mesh, std::size_t number, const Placement& placement,
                     const std::string& group);
  std::optional<std::size_t> block_of(const JsonValue& attributes, const Placement& placement);
  void add_attributes(const JsonValue& attributes, Block& block);
  std::optional<Accessor> find_floats(const JsonValue& attributes, const char* name, std::uint32_t width,
                                      const Block& block) const;
  std::optional<Accessor> find_numbers(const JsonValue& attributes, const char* name, std::uint32_t least,
                                       std::uint32_t most, const Block& block) const;
  void read_positions();
  void require_room(const JsonValue& primitive) const;
  void add_triangles(const Primitive& primitive);
  void name_faces(std::size_t count, const std::string& group, const JsonValue& primitive);
  void require_rewritable() const;
  void require_roles(const std::unordered_map<std::size_t, const char*>& role) const;
  void make_remarks();

  MeshFile& file_;
  const JsonValue& root_;
  Contents& contents_;
  Accessors accessors_;
  JsonList meshes_, materials_;
  std::unordered_map<std::size_t, std::size_t> block_by_accessor_;
  std::unordered_map<std::string, std::uint32_t> group_by_name_, material_by_name_;
  std::vector<Primitive> primitives_;
  std::uint64_t vertices_ = 0, corners_ = 0;
  std::size_t others_ = 0, unplaced_ = 0, repeated_ = 0, skinned_ = 0, shared_ = 0, other_normals_ = 0, without_ = 0;
  bool has_targets_ = false;
};

}  // namespace vdb_offset::io::gltf
