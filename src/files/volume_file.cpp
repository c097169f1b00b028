// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/volume_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <span>

#include "bytes/scanner.h"
#include "ground/system/parallel.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"
#include "volume/volume_writers.h"

namespace vdb_offset::io {
namespace {

std::string_view ending_of(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : path.substr(dot + 1);
}

void require(bool fits, const std::string& path, const char* what) {
  if (!fits) throw InvalidInput(path + ": expected " + what);
}

void require_fields(const std::string& path, const std::vector<VolumeField>& fields, std::size_t count,
                    const char* things) {
  for (const VolumeField& field : fields)
    if (!field.values.empty() && field.values.size() != count)
      throw InvalidInput(fmt::format("{}: field {}: expected {} values, one for each of the {}, got {}", path,
                                     field.name, count, things, field.values.size()));
}

bool are_points(const VolumeMesh& mesh, std::span<const std::uint32_t> corners) {
  return std::all_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return v < mesh.points.size(); });
}

bool is_cell(const VolumeMesh& mesh, CellType type, std::span<const std::uint32_t> cell) {
  constexpr std::size_t kCorners[kCellTypeCount] = {4, 5, 6, 8, 0, 3, 4};
  if (type != CellType::Polyhedron)
    return cell.size() == kCorners[static_cast<std::size_t>(type)] && are_points(mesh, cell);
  std::size_t at = 1, faces = 0;
  for (; at < cell.size() && cell[at] < cell.size() - at; at += cell[at] + 1, ++faces)
    if (cell[at] < 3 || !are_points(mesh, cell.subspan(at + 1, cell[at]))) return false;
  return at == cell.size() && faces == cell[0];
}

void require_cells(const std::string& path, const VolumeMesh& mesh) {
  constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::atomic<std::uint64_t> first_wrong = kNone;
  for_each_index(mesh.cell_count(), [&](std::size_t c) {
    if (!is_cell(mesh, mesh.cell_types[c], mesh.cell(c))) lower_to(first_wrong, c);
  });
  if (first_wrong != kNone)
    throw InvalidInput(fmt::format("{}: cell {}: expected the corners of one of the {}, each a point of the mesh", path,
                                   first_wrong.load(), name(mesh.cell_types[first_wrong])));
}

void require_consistent(const std::string& path, const VolumeMesh& mesh) {
  require(mesh.cell_count() > 0, path, "a mesh of at least one cell, got none");
  require(mesh.cell_begin.size() == mesh.cell_count() + 1 && mesh.cell_begin.back() == mesh.corners.size() &&
              std::is_sorted(mesh.cell_begin.begin(), mesh.cell_begin.end()),
          path, "cells whose corners end where the next one's begin");
  require_cells(path, mesh);
  const auto is_of_a_plane = [](CellType type) { return type >= CellType::Triangle; };
  const auto of_planes = std::count_if(mesh.cell_types.begin(), mesh.cell_types.end(), is_of_a_plane);
  require(of_planes == (mesh.plane() ? static_cast<std::ptrdiff_t>(mesh.cell_count()) : 0), path,
          "triangles and quadrilaterals in a plane mesh, and in no other");
  for (const BoundaryPatch& patch : mesh.patches) {
    require(patch.cell.size() == patch.face_count() && patch.face_begin.back() == patch.corners.size(), path,
            "a cell behind each face of a patch");
    require(are_points(mesh, patch.corners), path, "patches' corners that are points of the mesh");
  }
  require_fields(path, mesh.point_fields, mesh.points.size(), "points");
  require_fields(path, mesh.cell_fields, mesh.cell_count(), "cells");
}

}  // namespace

std::optional<VolumeFormat> volume_format_of(std::string_view path) {
  if (is_word(ending_of(path), "vtu")) return VolumeFormat::Vtu;
  if (is_word(ending_of(path), "msh")) return VolumeFormat::Msh;
  if (is_word(ending_of(path), "cgns")) return VolumeFormat::Cgns;
  if (is_word(ending_of(path), "su2")) return VolumeFormat::Su2;
  while (path.ends_with('/')) path.remove_suffix(1);
  if (path.substr(path.rfind('/') + 1) == "polyMesh") return VolumeFormat::Foam;
  return std::nullopt;
}

void require_standard_cells(const std::string& path, const VolumeMesh& mesh, const char* ending) {
  if (has_polyhedra(mesh))
    throw InvalidInput(
        fmt::format("{}: expected cells of up to eight corners, got polyhedra: .{} has none (write .vtu, "
                    ".cgns or polyMesh)",
                    path, ending));
  for (const BoundaryPatch& patch : mesh.patches)
    for (std::size_t f = 0; f < patch.face_count(); ++f)
      if (patch.face(f).size() != 3 && patch.face(f).size() != 4)
        throw InvalidInput(fmt::format("{}: patch {}: expected triangles and quadrilaterals, got a face of {} corners",
                                       path, patch.name, patch.face(f).size()));
}

void require_volume_writer(const std::string& path) {
  if (volume_format_of(path) == VolumeFormat::Cgns) require_cgns(path);
}

VolumeWriteResult write_volume(const std::string& path, VolumeMesh mesh) {
  const auto format = volume_format_of(path);
  if (!format)
    throw InvalidInput(path + ": expected a name that ends in .vtu, .msh, .cgns or .su2, or a folder named polyMesh");
  require_consistent(path, mesh);
  require(!mesh.plane() || *format == VolumeFormat::Vtu || *format == VolumeFormat::Su2, path,
          "a name that ends in .vtu or .su2, as the cells lie in a plane");
  // Empty patches are left out, but for a .vtu, whose cells refer to patches by their numbers.
  if (*format != VolumeFormat::Vtu)
    std::erase_if(mesh.patches, [](const BoundaryPatch& patch) { return patch.face_count() == 0; });
  VolumeWriteResult result;
  switch (*format) {
    case VolumeFormat::Vtu:
      replace_file(path, [&](const std::string& temporary) { write_vtu({temporary, path}, mesh); });
      break;
    case VolumeFormat::Msh:
      write_msh(path, mesh);
      break;
    case VolumeFormat::Cgns:
      replace_file(path, [&](const std::string& temporary) { write_cgns({temporary, path}, mesh); });
      break;
    case VolumeFormat::Su2:
      write_su2(path, mesh);
      break;
    case VolumeFormat::Foam:
      result.foam = write_foam(path, mesh);
  }
  return result;
}

}  // namespace vdb_offset::io
