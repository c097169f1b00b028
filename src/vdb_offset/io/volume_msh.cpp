#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "vdb_offset/io/numbers.h"
#include "vdb_offset/io/pieces.h"
#include "vdb_offset/io/volume_formats.h"

/// Gmsh's reference manual, "MSH file format", version 4.1. Tags of points and elements count from 1; so do those of
/// surfaces, which are patches. All points belong to the one volume.
namespace vdb_offset::io {
namespace {

constexpr int kTriangle = 2, kQuadrilateral = 3, kMshTypes[kCellTypeCount] = {4, 7, 6, 5, 0};
constexpr int kSurface = 2, kVolume = 3, kVolumeTag = 1;

/// Elements of one type on one surface or in the volume.
struct MshBlock {
  int dimension, tag, type;
  const VolumePatch* patch;            ///< Null for cells.
  std::vector<std::uint32_t> members;  ///< Faces of the patch, or cells.
  std::size_t first = 0;               ///< Tag of the first element.
};
using MshBlocks = std::vector<MshBlock>;

MshBlocks msh_blocks(const VolumeMesh& mesh) {
  MshBlocks blocks;
  const auto add = [&](MshBlock block) {
    if (block.members.empty()) return;
    block.first = blocks.empty() ? 1 : blocks.back().first + blocks.back().members.size();
    blocks.push_back(std::move(block));
  };
  for (std::size_t i = 0; i < mesh.patches.size(); ++i) {
    const VolumePatch& patch = mesh.patches[i];
    std::array<std::vector<std::uint32_t>, 2> members;
    for (std::uint32_t f = 0; f < patch.face_count(); ++f) members[patch.face(f).size() - 3].push_back(f);
    for (const int corners : {3, 4})
      add({kSurface, static_cast<int>(i) + 1, corners == 3 ? kTriangle : kQuadrilateral, &patch,
           std::move(members[static_cast<std::size_t>(corners) - 3])});
  }
  std::array<std::vector<std::uint32_t>, kCellTypeCount> cells;
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c)
    cells[static_cast<std::size_t>(mesh.cell_types[c])].push_back(c);
  for (std::size_t type = 0; type < kCellTypeCount; ++type)
    add({kVolume, kVolumeTag, kMshTypes[type], nullptr, std::move(cells[type])});
  return blocks;
}

std::string msh_names(const VolumeMesh& mesh) {
  const std::vector<std::string> words = patch_words(mesh, 127);
  std::string text = fmt::format("$PhysicalNames\n{}\n", words.size() + 1);
  for (std::size_t i = 0; i < words.size(); ++i) text += fmt::format("{} {} \"{}\"\n", kSurface, i + 1, words[i]);
  return text + fmt::format("{} {} \"layers\"\n$EndPhysicalNames\n", kVolume, kVolumeTag);
}

template <class Corners>
std::array<Vec3d, 2> box_of(const VolumeMesh& mesh, const Corners& corners) {
  constexpr double kMost = std::numeric_limits<double>::max();
  std::array<Vec3d, 2> box = {Vec3d(kMost), Vec3d(-kMost)};
  for (const std::uint32_t v : corners) {
    box[0] = openvdb::math::minComponent(box[0], mesh.points[v]);
    box[1] = openvdb::math::maxComponent(box[1], mesh.points[v]);
  }
  return corners.empty() ? std::array{Vec3d(0), Vec3d(0)} : box;
}

void append_entity(std::string& bytes, int tag, const std::array<Vec3d, 2>& box, std::size_t bounded_by) {
  append_binary(bytes, tag);
  for (const Vec3d& corner : box)
    for (int k = 0; k < 3; ++k) append_binary(bytes, corner[k]);
  append_binary(bytes, std::uint64_t{1});
  append_binary(bytes, tag);  // The physical group's.
  append_binary(bytes, std::uint64_t{bounded_by});
  for (std::size_t i = 0; i < bounded_by; ++i) append_binary(bytes, static_cast<int>(i) + 1);
}

std::string msh_entities(const VolumeMesh& mesh) {
  std::string bytes = "$Entities\n";
  for (const std::size_t count : {std::size_t{0}, std::size_t{0}, mesh.patches.size(), std::size_t{1}})
    append_binary(bytes, std::uint64_t{count});
  for (std::size_t i = 0; i < mesh.patches.size(); ++i)
    append_entity(bytes, static_cast<int>(i) + 1, box_of(mesh, mesh.patches[i].corners), 0);
  append_entity(bytes, kVolumeTag, box_of(mesh, mesh.corners), mesh.patches.size());
  return bytes + "\n$EndEntities\n";
}

std::string msh_start(const VolumeMesh& mesh) {
  std::string bytes = "$MeshFormat\n4.1 1 8\n";
  append_binary(bytes, 1);  // By which a reader finds out the order of bytes.
  return bytes + "\n$EndMeshFormat\n" + msh_names(mesh) + msh_entities(mesh);
}

Pieces msh_nodes(const VolumeMesh& mesh) {
  const std::uint64_t count = mesh.points.size();
  std::string head = "$Nodes\n";
  for (const std::uint64_t number : {std::uint64_t{1}, count, std::uint64_t{1}, count}) append_binary(head, number);
  for (const int number : {kVolume, kVolumeTag, 0}) append_binary(head, number);
  append_binary(head, count);
  return in_a_row({in_sections(head, {{count, [](std::string& bytes,
                                                 std::size_t p) { append_binary(bytes, std::uint64_t{p + 1}); }},
                                      {count,
                                       [&mesh](std::string& bytes, std::size_t p) {
                                         for (int k = 0; k < 3; ++k) append_binary(bytes, mesh.points[p][k]);
                                       }}}),
                   in_sections("\n$EndNodes\n", {})});
}

Pieces msh_elements(const VolumeMesh& mesh, const MshBlock& block) {
  std::string head;
  for (const int number : {block.dimension, block.tag, block.type}) append_binary(head, number);
  append_binary(head, std::uint64_t{block.members.size()});
  return in_sections(head, {{block.members.size(), [&mesh, &block](std::string& bytes, std::size_t i) {
                               const std::uint32_t m = block.members[i];
                               append_binary(bytes, std::uint64_t{block.first + i});
                               for (const std::uint32_t v : block.patch ? block.patch->face(m) : mesh.cell(m))
                                 append_binary(bytes, std::uint64_t{v} + 1);
                             }}});
}

/// A view of one step and one component: a tag and a value for each member.
Pieces msh_data(const char* section, const VolumeField& field, std::vector<Section> values) {
  std::string name = field.name;
  std::replace(name.begin(), name.end(), '"', '\'');
  const std::string head = fmt::format("${}\n1\n\"{}\"\n1\n0\n3\n0\n1\n{}\n", section, name, field.values.size());
  return in_a_row({in_sections(head, std::move(values)), in_sections(fmt::format("\n$End{}\n", section), {})});
}

void append_value(std::string& bytes, std::size_t tag, float value) {
  append_binary(bytes, static_cast<std::int32_t>(tag));
  append_binary(bytes, static_cast<double>(value));
}

Pieces msh_point_field(const VolumeField& field) {
  return msh_data("NodeData", field, {{field.values.size(), [&field](std::string& bytes, std::size_t p) {
                                         append_value(bytes, p + 1, field.values[p]);
                                       }}});
}

Pieces msh_cell_field(const VolumeField& field, const MshBlocks& blocks) {
  std::vector<Section> values;
  for (const MshBlock& block : blocks)
    if (block.dimension == kVolume)
      values.push_back({block.members.size(), [&field, &block](std::string& bytes, std::size_t i) {
                          append_value(bytes, block.first + i, field.values[block.members[i]]);
                        }});
  return msh_data("ElementData", field, std::move(values));
}

Pieces msh_all_elements(const VolumeMesh& mesh, const MshBlocks& blocks) {
  std::uint64_t count = 0;
  for (const MshBlock& block : blocks) count += block.members.size();
  std::string head = "$Elements\n";
  for (const std::uint64_t number : {std::uint64_t{blocks.size()}, count, std::uint64_t{1}, count})
    append_binary(head, number);
  std::vector<Pieces> parts = {in_sections(head, {})};
  for (const MshBlock& block : blocks) parts.push_back(msh_elements(mesh, block));
  parts.push_back(in_sections("\n$EndElements\n", {}));
  return in_a_row(std::move(parts));
}

}  // namespace

void write_msh(const std::string& path, const VolumeMesh& mesh) {
  require_standard_cells(path, mesh, "msh");
  const MshBlocks blocks = msh_blocks(mesh);
  std::vector<Pieces> parts = {in_sections(msh_start(mesh), {}), msh_nodes(mesh), msh_all_elements(mesh, blocks)};
  for (const VolumeField& field : mesh.point_fields)
    if (!field.values.empty()) parts.push_back(msh_point_field(field));
  for (const VolumeField& field : mesh.cell_fields)
    if (!field.values.empty()) parts.push_back(msh_cell_field(field, blocks));
  write_pieces(path, in_a_row(std::move(parts)), {});
}

}  // namespace vdb_offset::io
