// SPDX-License-Identifier: Apache-2.0
// Writes cells as a binary MSH file of Gmsh: names of physical groups, entities with their boxes and boundaries, points
// by the entity that they lie on, elements by entity and type, and a view for each field. Points keep their numbers,
// counted from 1; elements are numbered in the order in which they are written, curves first, then patches, then cells
// by type. Physical groups of all dimensions have tags of their own, as other programs look at the tag alone. The file
// is made in pieces, which can be made on several threads and are the same whatever their number. Numbers are as this
// machine holds them, which readers see by the first one. Polyhedra are refused.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <span>
#include <unordered_map>

#include "bytes/append_number.h"
#include "bytes/chunked_output.h"
#include "volume/msh_entities.h"
#include "volume/volume_writers.h"

/// Gmsh's reference manual, "MSH file format", version 4.1. Tags of points and elements count from 1; so do those of
/// entities in each dimension: surfaces are patches.
namespace vdb_offset::io {
namespace {

constexpr int kLine = 1, kTriangle = 2, kQuadrilateral = 3, kMshTypes[kCellTypeCount] = {4, 7, 6, 5, 0};
constexpr int kPoint = 0, kCurve = 1, kSurface = 2, kVolume = 3, kVolumeTag = 1;

int tag_of(std::size_t number) { return static_cast<int>(number) + 1; }

/// The tag of a physical group: those of surfaces come first, then that of the volume, then those of curves. Gmsh
/// allows groups of different dimensions to share a tag, but gmshToFoam names patches by the tag alone.
int group_tag(const VolumeMesh& mesh, int dimension, std::size_t number) {
  const std::size_t surfaces = mesh.patches.size();
  return tag_of(dimension == kSurface ? number : dimension == kVolume ? surfaces : surfaces + 1 + number);
}

/// Elements of one type, on one curve or surface or in the volume.
struct MshBlock {
  int dimension, tag, type;
  std::size_t count;
  std::function<std::span<const std::uint32_t>(std::size_t)> corners;  ///< The corners of an element.
  std::vector<std::uint32_t> cells = {};                               ///< The cells of a block in the volume.
  std::size_t first = 0;                                               ///< Tag of the first element.
};
using MshBlocks = std::vector<MshBlock>;

void add_patch(const BoundaryPatch& patch, int tag, MshBlocks& blocks) {
  std::array<std::vector<std::uint32_t>, 2> faces;
  for (std::uint32_t f = 0; f < patch.face_count(); ++f) faces[patch.face(f).size() - 3].push_back(f);
  for (const int type : {kTriangle, kQuadrilateral}) {
    std::vector<std::uint32_t>& of_type = faces[type == kTriangle ? 0 : 1];
    const std::size_t count = of_type.size();
    blocks.push_back({kSurface, tag, type, count,
                      [&patch, faces = std::move(of_type)](std::size_t i) { return patch.face(faces[i]); }});
  }
}

void add_cells(const VolumeMesh& mesh, MshBlocks& blocks) {
  std::array<std::vector<std::uint32_t>, kCellTypeCount> cells;
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c)
    cells[static_cast<std::size_t>(mesh.cell_types[c])].push_back(c);
  for (std::size_t type = 0; type < kCellTypeCount; ++type) {
    MshBlock block{kVolume, kVolumeTag, kMshTypes[type], cells[type].size(), nullptr, std::move(cells[type])};
    block.corners = [&mesh, of_type = block.cells.data()](std::size_t i) { return mesh.cell(of_type[i]); };
    blocks.push_back(std::move(block));
  }
}

MshBlocks msh_blocks(const VolumeMesh& mesh, const MshEntities& entities) {
  MshBlocks blocks;
  for (std::size_t c = 0; c < entities.curves.size(); ++c) {
    const MshEntities::Curve& curve = entities.curves[c];
    blocks.push_back({kCurve, tag_of(c), kLine, curve.edge_count(),
                      [&curve](std::size_t i) { return std::span(curve.points).subspan(i, 2); }});
  }
  for (std::size_t i = 0; i < mesh.patches.size(); ++i) add_patch(mesh.patches[i], tag_of(i), blocks);
  add_cells(mesh, blocks);
  std::erase_if(blocks, [](const MshBlock& block) { return block.count == 0; });
  std::size_t first = 1;
  for (MshBlock& block : blocks) first = (block.first = first) + block.count;
  return blocks;
}

/// The name of the curves between patches: the patches' names, joined.
std::string group_name(const std::vector<std::string>& words, const std::vector<std::uint32_t>& patches) {
  std::string name;
  for (const std::uint32_t patch : patches) name += (name.empty() ? "" : "-") + words[patch];
  return name;
}

std::string msh_names(const VolumeMesh& mesh, const MshEntities& entities) {
  constexpr std::size_t kLongest = 127;  // bytes of a name, as Gmsh's manual says
  const std::vector<std::string> words = patch_words(mesh, kLongest);
  std::vector<std::string> groups;
  for (const auto& patches : entities.groups) groups.push_back(group_name(words, patches));
  groups = distinct_words(groups, kLongest);
  std::string text = fmt::format("$PhysicalNames\n{}\n", groups.size() + words.size() + 1);
  const auto add = [&](int dimension, std::size_t number, const std::string& name) {
    text += fmt::format("{} {} \"{}\"\n", dimension, group_tag(mesh, dimension, number), name);
  };
  for (std::size_t i = 0; i < groups.size(); ++i) add(kCurve, i, groups[i]);
  for (std::size_t i = 0; i < words.size(); ++i) add(kSurface, i, words[i]);
  add(kVolume, 0, "layers");
  return text + "$EndPhysicalNames\n";
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

void append_position(std::string& bytes, const Vec3d& position) {
  for (int k = 0; k < 3; ++k) append_binary(bytes, position[k]);
}

/// Appends a curve, a surface or the volume. `bounded_by` are the tags of the entities around it, of one dimension
/// less; negative for entities of the opposite direction.
void append_entity(std::string& bytes, int tag, const std::array<Vec3d, 2>& box, int group,
                   const std::vector<int>& bounded_by) {
  append_binary(bytes, tag);
  for (const Vec3d& corner : box) append_position(bytes, corner);
  append_binary(bytes, std::uint64_t{1});
  append_binary(bytes, group);
  append_binary(bytes, std::uint64_t{bounded_by.size()});
  for (const int by : bounded_by) append_binary(bytes, by);
}

/// Appends a corner, which is in no physical group.
void append_corner(std::string& bytes, int tag, const Vec3d& position) {
  append_binary(bytes, tag);
  append_position(bytes, position);
  append_binary(bytes, std::uint64_t{0});
}

std::string msh_entities(const VolumeMesh& mesh, const MshEntities& entities) {
  std::string bytes = "$Entities\n";
  for (const std::size_t count : {entities.corners.size(), entities.curves.size(), mesh.patches.size(), std::size_t{1}})
    append_binary(bytes, std::uint64_t{count});
  std::unordered_map<std::uint32_t, int> corner_tags;
  for (std::size_t i = 0; i < entities.corners.size(); ++i) {
    corner_tags[entities.corners[i]] = tag_of(i);
    append_corner(bytes, tag_of(i), mesh.points[entities.corners[i]]);
  }
  for (std::size_t i = 0; i < entities.curves.size(); ++i) {
    const auto& [points, group] = entities.curves[i];
    append_entity(bytes, tag_of(i), box_of(mesh, points), group_tag(mesh, kCurve, group),
                  {corner_tags[points.front()], -corner_tags[points.back()]});
  }
  for (std::size_t i = 0; i < mesh.patches.size(); ++i) {
    std::vector<int> curves;
    for (const auto& [curve, forwards] : entities.around[i])
      curves.push_back(forwards ? tag_of(curve) : -tag_of(curve));
    append_entity(bytes, tag_of(i), box_of(mesh, mesh.patches[i].corners), group_tag(mesh, kSurface, i), curves);
  }
  std::vector<int> surfaces;
  for (std::size_t i = 0; i < mesh.patches.size(); ++i) surfaces.push_back(tag_of(i));
  append_entity(bytes, kVolumeTag, box_of(mesh, mesh.corners), group_tag(mesh, kVolume, 0), surfaces);
  return bytes + "\n$EndEntities\n";
}

std::string msh_start(const VolumeMesh& mesh, const MshEntities& entities) {
  std::string bytes = "$MeshFormat\n4.1 1 8\n";
  append_binary(bytes, 1);  // readers recognise the order of bytes by it
  return bytes + "\n$EndMeshFormat\n" + msh_names(mesh, entities) + msh_entities(mesh, entities);
}

/// The points of one entity.
Pieces msh_nodes(const VolumeMesh& mesh, int dimension, int tag, std::span<const std::uint32_t> points) {
  std::string head;
  for (const int number : {dimension, tag, 0}) append_binary(head, number);
  append_binary(head, std::uint64_t{points.size()});
  return in_sections(
      head, {{points.size(),
              [points](std::string& bytes, std::size_t i) { append_binary(bytes, std::uint64_t{points[i]} + 1); }},
             {points.size(),
              [&mesh, points](std::string& bytes, std::size_t i) { append_position(bytes, mesh.points[points[i]]); }}});
}

Pieces msh_all_nodes(const VolumeMesh& mesh, const MshEntities& entities) {
  std::vector<Pieces> blocks;
  const auto add = [&](int dimension, std::size_t number, std::span<const std::uint32_t> points) {
    if (!points.empty()) blocks.push_back(msh_nodes(mesh, dimension, tag_of(number), points));
  };
  for (std::size_t i = 0; i < entities.corners.size(); ++i) add(kPoint, i, std::span(entities.corners).subspan(i, 1));
  for (std::size_t i = 0; i < entities.curves.size(); ++i) {
    const std::span points(entities.curves[i].points);
    add(kCurve, i, points.subspan(1, points.size() - 2));
  }
  for (std::size_t i = 0; i < mesh.patches.size(); ++i) add(kSurface, i, entities.on_patch[i]);
  add(kVolume, kVolumeTag - 1, entities.inside);
  std::string head = "$Nodes\n";
  const std::uint64_t count = mesh.points.size();
  for (const std::uint64_t number : {std::uint64_t{blocks.size()}, count, std::uint64_t{1}, count})
    append_binary(head, number);
  blocks.insert(blocks.begin(), in_sections(head, {}));
  blocks.push_back(in_sections("\n$EndNodes\n", {}));
  return in_a_row(std::move(blocks));
}

Pieces msh_elements(const MshBlock& block) {
  std::string head;
  for (const int number : {block.dimension, block.tag, block.type}) append_binary(head, number);
  append_binary(head, std::uint64_t{block.count});
  return in_sections(head, {{block.count, [&block](std::string& bytes, std::size_t i) {
                               append_binary(bytes, std::uint64_t{block.first + i});
                               for (const std::uint32_t v : block.corners(i))
                                 append_binary(bytes, std::uint64_t{v} + 1);
                             }}});
}

/// A view of one time step and one component, with a tag and a value for each point or cell.
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
      values.push_back({block.count, [&field, &block](std::string& bytes, std::size_t i) {
                          append_value(bytes, block.first + i, field.values[block.cells[i]]);
                        }});
  return msh_data("ElementData", field, std::move(values));
}

Pieces msh_all_elements(const MshBlocks& blocks) {
  std::uint64_t count = 0;
  for (const MshBlock& block : blocks) count += block.count;
  std::string head = "$Elements\n";
  for (const std::uint64_t number : {std::uint64_t{blocks.size()}, count, std::uint64_t{1}, count})
    append_binary(head, number);
  std::vector<Pieces> parts = {in_sections(head, {})};
  for (const MshBlock& block : blocks) parts.push_back(msh_elements(block));
  parts.push_back(in_sections("\n$EndElements\n", {}));
  return in_a_row(std::move(parts));
}

}  // namespace

void write_msh(const std::string& path, const VolumeMesh& mesh) {
  require_standard_cells(path, mesh, "msh");
  const MshEntities entities = find_entities(mesh);
  const MshBlocks blocks = msh_blocks(mesh, entities);
  std::vector<Pieces> parts = {in_sections(msh_start(mesh, entities), {}), msh_all_nodes(mesh, entities),
                               msh_all_elements(blocks)};
  for (const VolumeField& field : mesh.point_fields)
    if (!field.values.empty()) parts.push_back(msh_point_field(field));
  for (const VolumeField& field : mesh.cell_fields)
    if (!field.values.empty()) parts.push_back(msh_cell_field(field, blocks));
  write_pieces(path, in_a_row(std::move(parts)));
}

}  // namespace vdb_offset::io
