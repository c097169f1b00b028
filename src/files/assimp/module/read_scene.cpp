// SPDX-License-Identifier: Apache-2.0
// Meshes of the formats that Assimp reads.
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <assimp/DefaultLogger.hpp>
#include <assimp/Importer.hpp>
#include <cmath>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "assimp/assimp_meshes.h"
#include "document/document.h"
#include "document/format_readers.h"
#include "document/require_format.h"
#include "document/trial.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

/// What was read besides positions and faces. Such files are not written.
class AssimpDocument : public Document {
 public:
  AssimpDocument(Attributes attributes, FaceNames names)
      : attributes_(std::move(attributes)), names_(std::move(names)) {}

  WrittenDocument rewrite(const MovedMesh& moved) const override {
    throw InvalidInput(moved.path + ": expected a format that can be written, got one that is read only");
  }
  void read_attributes(const MeshFile&, Attributes& attributes) const override {
    std::vector<std::string> lost = std::move(attributes.lost);
    attributes = attributes_;
    attributes.lost = std::move(lost);
  }
  FaceNames face_names() const override { return names_; }

 private:
  Attributes attributes_;
  FaceNames names_;
};

/// The ending of a file's name, which says how it is read.
std::string hint_of(std::string path) {
  for (const char* const packed : {".gz", ".zst"})
    if (path.ends_with(packed)) path.resize(path.rfind('.'));
  std::string ending = path.substr(path.rfind('.') + 1);
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return ending;
}

/// The unit of a Collada file in metres, which Assimp makes of all coordinates: what the file says, or one metre. None
/// for other files.
std::optional<double> collada_unit(const MeshFile& file) {
  if (hint_of(file.path) != "dae") return std::nullopt;
  const std::string_view text = file.text();
  const std::size_t unit = text.find("<unit"), end = text.find('>', unit), at = text.find("meter", unit);
  if (unit == std::string_view::npos || at >= end) return 1.0;
  const std::size_t quote = text.find_first_of("\"'", at);
  if (quote >= end) return 1.0;
  const auto metres = decimal<double>(text.substr(quote + 1, text.find(text[quote], quote + 1) - quote - 1));
  return metres && *metres > 0 ? metres : 1.0;
}

/// The meshes of a scene, each where the nodes place it.
class SceneReader {
 public:
  SceneReader(const aiScene& scene, MeshFile& file) : scene_(scene), file_(file) {}

  void read() {
    // An attribute of some meshes alone has no place in the others.
    for (unsigned m = 0; m < scene_.mNumMeshes; ++m) {
      const aiMesh& mesh = *scene_.mMeshes[m];
      has_normals_ = has_normals_ && mesh.HasNormals();
      has_colours_ = has_colours_ && mesh.HasVertexColors(0);
      has_texture_ = has_texture_ && mesh.HasTextureCoords(0);
      has_bones_ = has_bones_ || mesh.HasBones();
      has_morphs_ = has_morphs_ || mesh.mNumAnimMeshes > 0;
    }
    aiMatrix4x4 own_unit;
    if (const std::optional<double> metres = collada_unit(file_)) {
      aiMatrix4x4::Scaling(aiVector3D(static_cast<float>(1 / *metres)), own_unit);
      file_.unit_micrometres = *metres * kMetre;
    } else {
      file_.unit_micrometres = unit();
    }
    add(*scene_.mRootNode, own_unit);
    if (file_.polygons.face_count() == 0)
      throw InvalidInput(file_.path + ": expected a mesh of at least one face, got none");
    if (others_ > 0) extra(fmt::format("{} points and lines", others_));
    if (has_bones_) extra("bones");
    if (has_morphs_) extra("morph targets");
    if (scene_.mNumAnimations > 0) extra("animations");
    if (scene_.mNumTextures > 0) extra("embedded textures");
    if (scene_.mNumMaterials > 0) extra("what materials are made of");
    if (scene_.mNumCameras + scene_.mNumLights > 0) extra("cameras and lights");
    file_.encoding = Encoding::LittleEndian;
    if (has_normals_) file_.normal_count = file_.polygons.positions.size();
    attributes_.has_alpha = has_colours_;
    file_.document = std::make_shared<AssimpDocument>(std::move(attributes_), std::move(names_));
  }

 private:
  void extra(std::string_view in_words) { file_.extras.emplace_back(in_words); }

  // Children are few levels deep in what Assimp lets through; it walks over them in this way itself.
  void add(const aiNode& node, const aiMatrix4x4& above) {
    const aiMatrix4x4 placed = above * node.mTransformation;
    for (unsigned i = 0; i < node.mNumMeshes; ++i) add(*scene_.mMeshes[node.mMeshes[i]], node, placed);
    for (unsigned i = 0; i < node.mNumChildren; ++i) add(*node.mChildren[i], placed);
  }

  void add(const aiMesh& mesh, const aiNode& node, const aiMatrix4x4& placed) {
    Polygons& polygons = file_.polygons;
    const std::size_t first = polygons.positions.size();
    if (first + mesh.mNumVertices > kMostVertices)
      throw InvalidInput(fmt::format("{}: expected at most {} vertices, got more", file_.path, kMostVertices));
    aiMatrix3x3 turned(placed);
    const bool mirrors = turned.Determinant() < 0;
    turned.Inverse().Transpose();
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) add_vertex(mesh, v, placed, turned);
    const auto group = static_cast<std::uint32_t>(names_.groups.size());
    names_.groups.emplace_back(node.mName.length > 0 ? node.mName.C_Str() : mesh.mName.C_Str());
    const auto material = static_cast<std::uint32_t>(names_.materials.size());
    names_.materials.push_back(material_name(mesh.mMaterialIndex));
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices < 3) {
        ++others_;
        continue;
      }
      for (unsigned k = 0; k < face.mNumIndices; ++k) {
        const unsigned v = face.mIndices[mirrors ? face.mNumIndices - 1 - k : k];
        if (v >= mesh.mNumVertices)
          throw InvalidInput(fmt::format("{}: mesh '{}', face {}: expected vertices from 0 to {}, got {}", file_.path,
                                         mesh.mName.C_Str(), f, mesh.mNumVertices - 1, v));
        polygons.corners.push_back(static_cast<std::uint32_t>(first + v));
      }
      polygons.close_face();
      names_.group_of.push_back(group);
      names_.material_of.push_back(material);
    }
  }

  void add_vertex(const aiMesh& mesh, unsigned v, const aiMatrix4x4& placed, const aiMatrix3x3& turned) {
    const aiVector3D p = placed * mesh.mVertices[v];
    const Vec3d position(p.x, p.y, p.z);
    if (!position.isFinite())
      throw InvalidInput(fmt::format("{}: mesh '{}', vertex {}: expected finite numbers, got {}, {}, {}", file_.path,
                                     mesh.mName.C_Str(), v, p.x, p.y, p.z));
    file_.polygons.positions.push_back(position);
    if (has_normals_) {
      const aiVector3D n = turned * mesh.mNormals[v];
      Vec3d normal(n.x, n.y, n.z);
      if (const double length = normal.length(); length > 0) normal /= length;
      attributes_.normals.value.push_back(normal);
    }
    if (has_texture_) attributes_.texture.value.emplace_back(mesh.mTextureCoords[0][v].x, mesh.mTextureCoords[0][v].y);
    if (has_colours_) {
      const aiColor4D& c = mesh.mColors[0][v];
      const auto within = [](double colour) { return colour >= 0 ? std::min(colour, 1.0) : 0.0; };
      attributes_.colours.push_back({within(c.r), within(c.g), within(c.b), within(c.a)});
    }
  }

  std::string material_name(unsigned index) const {
    aiString name;
    if (index < scene_.mNumMaterials) scene_.mMaterials[index]->Get(AI_MATKEY_NAME, name);
    return name.C_Str();
  }

  /// FBX states its unit in centimetres.
  std::optional<double> unit() const {
    double centimetres = 0;
    float narrow = 0;
    if (!scene_.mMetaData) return std::nullopt;
    if (!scene_.mMetaData->Get("UnitScaleFactor", centimetres)) {
      if (!scene_.mMetaData->Get("UnitScaleFactor", narrow)) return std::nullopt;
      centimetres = narrow;
    }
    constexpr double kCentimetre = 1e4;  // micrometres
    return centimetres > 0 ? std::optional(centimetres * kCentimetre) : std::nullopt;
  }

  const aiScene& scene_;
  MeshFile& file_;
  Attributes attributes_;
  FaceNames names_;
  std::size_t others_ = 0;
  bool has_normals_ = true, has_colours_ = true, has_texture_ = true, has_bones_ = false, has_morphs_ = false;
};

const aiScene* import(Assimp::Importer& importer, const MeshFile& file) {
  // Corners that are the same in everything become one vertex; FBX's pivots become part of the nodes' placements.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_FBX_PRESERVE_PIVOTS, false);
  // Coordinates are the file's own; see collada_unit().
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const std::string_view bytes = file.text();
  return importer.ReadFileFromMemory(bytes.data(), bytes.size(), aiProcess_JoinIdenticalVertices,
                                     hint_of(file.path).c_str());
}

std::string in_one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  constexpr std::size_t kMost = 200;  // characters
  return text.substr(0, kMost);
}

}  // namespace

void parse_with_assimp(MeshFile& file) {
  // Most memory that reading may take: what a file of this size can hold, and enough for small ones.
  constexpr std::size_t kMostPerByte = 200, kAtLeast = std::size_t{1} << 30;
  try_in_child(file.path, kMostPerByte * file.text().size() + kAtLeast, [&] {
    Assimp::Importer importer;
    import(importer, file);
  });
  try {
    Assimp::Importer importer;
    const aiScene* const scene = import(importer, file);
    if (!scene || !scene->mRootNode)
      throw InvalidInput(fmt::format("{}: expected a file that Assimp reads, got: {}", file.path,
                                     in_one_line(importer.GetErrorString())));
    SceneReader(*scene, file).read();
  } catch (const std::bad_alloc&) {
    throw OutOfBudget(file.path + ": expected a file whose meshes fit into memory, got one that asks for more");
  }
}

}  // namespace vdb_offset::io
