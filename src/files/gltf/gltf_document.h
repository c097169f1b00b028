// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "document/document.h"
#include "gltf/accessors.h"
#include "gltf/buffers.h"
#include "gltf/container.h"
#include "ground/numbers/rounding.h"

namespace vdb_offset::io::gltf {

/// The vertices of an accessor of positions, and what goes with them.
struct Block {
  std::uint32_t first = 0;  ///< Its first vertex in the mesh.
  Accessor position;
  std::optional<Accessor> normal, tangent;  ///< As many as there are vertices, as are all of these.
  std::optional<Accessor> texture, colour;
  AffineFrame frame;
};

/// A primitive of which the mesh has faces: number `number` of mesh `mesh`.
struct PlacedPrimitive {
  std::size_t mesh, number, block;
  std::uint32_t first_face;
  bool mirrored;  ///< Its triangles are turned round.
};

/// A glTF file, whose own bytes are kept but for those that move.
struct Contents {
  Container container;
  std::vector<Buffer> buffers;
  std::vector<std::string> image_uris;  ///< Of images that are files.
  std::vector<Block> blocks;
  std::vector<PlacedPrimitive> primitives;  ///< In the order of their faces.
  FaceNames names;
};

class GltfDocument : public Document {
 public:
  explicit GltfDocument(Contents contents) : contents_(std::move(contents)) {}

  WrittenDocument rewrite(const MovedMesh& moved) const override;
  bool takes_faces() const override { return true; }
  WrittenDocument derive(const std::shared_ptr<const DerivedMesh>& derived, const std::string& path) const override;
  void read_attributes(const MeshFile& source, Attributes& attributes) const override;
  FaceNames face_names() const override { return contents_.names; }

 private:
  Contents contents_;
};

// What a file holds, in words: what another format has a place for is taken off the list of what it loses.
inline constexpr const char *kNormals = "normals", *kTexture = "texture coordinates", *kColours = "vertex colours";

}  // namespace vdb_offset::io::gltf
