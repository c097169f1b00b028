// SPDX-License-Identifier: Apache-2.0
// A libFuzzer target for 3MF: the first byte says whether the others are an archive or, made into a package in one of
// several ways, a model part, which another and a slicer's settings are the same as. Whatever they are, they are
// refused with InvalidInput or are a mesh that keeps the promises of io/mesh_file.h. What else is thrown ends the
// process.

#include <tbb/global_control.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "document/convert.h"
#include "fuzz/promise.h"
#include "support/threemf_packages.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;

namespace {

std::optional<io::MeshFile> parsed(const std::string& bytes) {
  try {
    return io::parse_mesh("fuzz.3mf", io::Format::ThreeMf, bytes);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

void check_mesh(const io::MeshFile& file) {
  const Polygons& mesh = file.polygons;
  require(mesh.face_count() > 0 && mesh.corners.size() == 3 * mesh.face_count(), "a mesh has triangles");
  for (const auto v : mesh.corners) require(v < mesh.positions.size(), "corners are indices of vertices");
  for (const Vec3d& p : mesh.positions) require(p.isFinite(), "coordinates are finite");
  require(file.unit_micrometres && *file.unit_micrometres > 0, "it has a unit");
  const io::Materials materials = io::read_materials(file);
  require(materials.of_face.empty() || materials.of_face.size() == mesh.face_count(), "a face has one material");
  for (const auto m : materials.of_face) require(m < materials.names.size(), "materials have names");
  const io::Attributes attributes = io::read_attributes(file);
  require(attributes.colours.empty() || attributes.colours.size() == mesh.positions.size(), "a vertex has one colour");
  require(io::wall_names(file).of_face.size() == mesh.face_count(), "a face has one group");
}

/// Writes the mesh with these positions and reads it again.
void check_moved(const io::MeshFile& file, const std::vector<Vec3d>& positions, bool is_exact) {
  std::string bytes;
  try {
    bytes = io::patched_bytes(file, positions);
  } catch (const InvalidInput&) {
    require(!is_exact, "objects in their own frames can be written");
    return;
  }
  const std::optional<io::MeshFile> back = parsed(bytes);
  // Transforms of extreme numbers may bring what was written beyond all numbers.
  if (!back && !is_exact) return;
  require(back.has_value(), "what was written can be read");
  require(back->polygons.corners == file.polygons.corners, "corners stay");
  require(back->extras == file.extras, "what else the file holds stays");
  require(!is_exact || back->polygons.positions == positions, "positions are those that were written");
  require(io::patched_bytes(*back, back->polygons.positions) == bytes, "what was written is written again as it is");
}

/// The mesh in a new package.
void check_new(const io::MeshFile& file) {
  io::WriteResult result;
  const std::string bytes =
      io::join(io::convert(file, io::Format::ThreeMf, file.polygons.positions, {}, io::Normals::Keep, result));
  const std::optional<io::MeshFile> back = parsed(bytes);
  if (!back) return;  // all triangles had a vertex twice
  check_mesh(*back);
  require(back->polygons.positions == file.polygons.positions, "positions are those that were written");
}

std::string as_package(std::uint8_t how, const std::string& model) {
  std::vector<ZipItem> items{{"[Content_Types].xml", kContentTypes},
                             {"_rels/.rels", kRelationships},
                             {"3D/3dmodel.model", model},
                             {"3D/o.model", model},
                             {"Metadata/model_settings.config", model}};
  for (ZipItem& item : items) {
    item.deflated = how & 1;
    item.described_behind = how & 2;
    item.wide = how & 4;
  }
  return zip_file(items);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data + 1), size - 1);
  constexpr std::uint8_t kArchive = 8;
  const std::string bytes = data[0] & kArchive ? text : as_package(data[0], text);
  const std::optional<io::MeshFile> file = parsed(bytes);
  if (!file) return 0;
  check_mesh(*file);
  require(io::patched_bytes(*file, file->polygons.positions) == bytes, "an unmoved mesh keeps every byte");
  const bool is_exact = !(data[0] & kArchive) && text.find("transform") == std::string::npos;
  std::vector<Vec3d> shifted = file->polygons.positions, turned = file->polygons.positions;
  for (Vec3d& p : shifted) p += Vec3d(1.0);
  check_moved(*file, shifted, is_exact);
  for (Vec3d& p : turned) p = Vec3d(-p[2] / 3, p[0] / 7, p[1]);
  check_moved(*file, turned, is_exact);
  check_new(*file);
  return 0;
}
