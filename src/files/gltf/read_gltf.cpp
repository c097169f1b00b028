// SPDX-License-Identifier: Apache-2.0
// glTF 2.0, as https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html has it. The file is not written anew of a
// model in memory, as libraries do: that would lose what they do not know, and change the bytes of all the rest.

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <utility>

#include "document/format_readers.h"
#include "gltf/gltf_document.h"
#include "gltf/json.h"
#include "gltf/mesh_builder.h"
#include "gltf/uri.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace gltf {
namespace {

nlohmann::json parse_json(const MeshFile& file, const Container& container) {
  const std::string_view text = container.json_of(file.text());
  if (const std::size_t depth = JsonText(text).depth(); depth > JsonText::kDeepest)
    throw InvalidInput(
        fmt::format("{}: expected JSON nested at most {} deep, got {}", file.path, JsonText::kDeepest, depth));
  try {
    return nlohmann::json::parse(text.begin(), text.end());
  } catch (const nlohmann::json::parse_error& error) {
    throw InvalidInput(fmt::format("{}, byte {}: expected JSON text, got something else", file.path,
                                   container.json.begin + (error.byte > 0 ? error.byte - 1 : 0)));
  } catch (const nlohmann::json::exception&) {
    throw InvalidInput(file.path + ": expected JSON with numbers that a double can hold, got others");
  }
}

void require_version(const JsonValue& root) {
  const JsonValue version = root.at("asset").at("version");
  if (!version.text().starts_with("2.")) version.fail("2.0");
}

/// Extensions by which positions are something else than floats in buffers.
void require_plain_geometry(const JsonValue& root) {
  const JsonList required(root, "extensionsRequired");
  for (std::size_t i = 0; i < required.size(); ++i)
    for (const char* name :
         {"KHR_draco_mesh_compression", "KHR_mesh_quantization", "EXT_meshopt_compression", "KHR_meshopt_compression"})
      if (required[i].text() == name)
        required[i].fail("geometry as plain floats", fmt::format("{}, which is not supported", name));
}

/// Files of numbers that lie beside it, and of images.
void list_files_beside(const Contents& contents, MeshFile& file) {
  for (const Buffer& buffer : contents.buffers)
    if (buffer.in == Buffer::In::File) file.files_beside.push_back(buffer.path);
  for (const std::string& uri : contents.image_uris)
    if (const auto path = is_data_uri(uri) ? std::nullopt : relative_path(uri))
      file.files_named.push_back((std::filesystem::path(file.path).parent_path() / *path).string());
}

void list_extras(const JsonValue& root, const MeshBuilder& builder, MeshFile& file) {
  constexpr std::pair<const char*, const char*> kLists[] = {
      {"materials", "materials"},   {"textures", "textures"}, {"skins", "skins"},
      {"animations", "animations"}, {"cameras", "cameras"},   {"extensionsUsed", "extensions"}};
  file.extras = builder.attributes();
  for (const auto& [key, in_words] : kLists)
    if (JsonList(root, key).size() > 0) file.extras.emplace_back(in_words);
  if (builder.has_targets()) file.extras.emplace_back("morph targets");
  if (builder.others() > 0) file.extras.emplace_back("points and lines");
  file.extras.emplace_back("nodes");
}

std::vector<std::string> image_uris_of(const JsonValue& root) {
  std::vector<std::string> uris;
  const JsonList images(root, "images");
  for (std::size_t i = 0; i < images.size(); ++i)
    if (const auto uri = images[i].find("uri"); uri && uri->is_text()) uris.push_back(uri->text());
  return uris;
}

void set_precision(const Contents& contents, MeshFile& file) {
  file.precision = {Precision::Kind::Single};
  std::vector<AffineFrame> frames;
  std::vector<std::uint32_t> first;
  bool placed = false;
  for (const Block& block : contents.blocks) {
    frames.push_back(block.frame);
    first.push_back(block.first);
    placed |= !block.frame.is_identity();
  }
  first.push_back(static_cast<std::uint32_t>(file.polygons.positions.size()));
  if (placed) file.precision.frames = std::make_shared<const FileFrames>(frames, first, file.polygons.positions);
}

}  // namespace
}  // namespace gltf

void parse_gltf(MeshFile& file) {
  using namespace gltf;
  Contents contents;
  contents.container = read_container(file);
  const nlohmann::json text = parse_json(file, contents.container);
  const JsonValue root(file.path, text);
  require_version(root);
  require_plain_geometry(root);
  contents.buffers = read_buffers(file, contents.container, root);
  contents.image_uris = image_uris_of(root);
  MeshBuilder builder(file, root, contents);
  builder.build(read_placements(root));
  list_extras(root, builder, file);
  list_files_beside(contents, file);
  set_precision(contents, file);
  file.encoding = Encoding::LittleEndian;
  file.unit_micrometres = kMetre;
  for (const Block& block : contents.blocks)
    if (block.normal) file.normal_count = file.polygons.positions.size();
  file.document = std::make_shared<GltfDocument>(std::move(contents));
}

}  // namespace vdb_offset::io
