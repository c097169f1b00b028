// SPDX-License-Identifier: Apache-2.0
// Cells and blocks as VTK's XML (VTK File Formats, "UnstructuredGrid" and "StructuredGrid"), compressed.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bytes/append_number.h"
#include "bytes/scanner.h"
#include "bytes/vtk_xml.h"
#include "ground/system/parallel.h"
#include "volume/volume_writers.h"

namespace vdb_offset::io {
namespace {

constexpr std::size_t kMostInt32 = std::numeric_limits<std::int32_t>::max();

void add_volume_fields(VtkXml& xml, const char* where, const std::vector<VolumeField>& fields) {
  xml.add_text(fmt::format("<{}>\n", where));
  for (const VolumeField& field : fields)
    if (!field.values.empty()) xml.add(array_of(field.name, 1, std::span<const float>(field.values)));
  xml.add_text(fmt::format("</{}>\n", where));
}

void add_points(VtkXml& xml, std::span<const Vec3d> points) {
  static_assert(sizeof(Vec3d) == 3 * sizeof(double));
  const std::span<const double> numbers(points.empty() ? nullptr : points.front().asPointer(), 3 * points.size());
  xml.add_text("<Points>\n");
  xml.add(array_of("Points", 3, numbers));
  xml.add_text("</Points>\n");
}

/// Whole numbers, each made by at(i): of 31 bits (VTK's 32 without the sign) if these can count them.
template <class At>
VtkArray indices(const char* name, std::size_t count, bool narrow, At at) {
  return {name,
          narrow ? "Int32" : "Int64",
          1,
          narrow ? sizeof(std::int32_t) : sizeof(std::int64_t),
          {count, [narrow, at](std::string& bytes, std::size_t i) {
             if (narrow) append_binary(bytes, static_cast<std::int32_t>(at(i)));
             else append_binary(bytes, static_cast<std::int64_t>(at(i)));
           }}};
}

/// VTK's numbers of cells: VTK_TETRA, VTK_PYRAMID, VTK_WEDGE, VTK_HEXAHEDRON, VTK_POLYHEDRON, VTK_TRIANGLE, VTK_QUAD.
std::uint8_t vtk_number(CellType type) {
  constexpr std::uint8_t kNumbers[kCellTypeCount] = {10, 14, 13, 12, 42, 5, 9};
  return kNumbers[static_cast<std::size_t>(type)];
}

VtkArray types_of(const VolumeMesh& mesh) {
  return {"types", "UInt8", 1, 1, {mesh.cell_count(), [&mesh](std::string& bytes, std::size_t c) {
                                     append_binary(bytes, vtk_number(mesh.cell_types[c]));
                                   }}};
}

/// Gives prisms VTK's order of corners: the normal of the first triangle points away from the other one, so that two
/// corners of each are exchanged. All other cells have VTK's order already.
void turn_prisms(VolumeMesh& mesh) {
  for_each_index(mesh.cell_count(), [&](std::size_t c) {
    if (mesh.cell_types[c] != CellType::Prism) return;
    std::uint32_t* const corners = mesh.corners.data() + mesh.cell_begin[c];
    std::swap(corners[1], corners[2]);
    std::swap(corners[4], corners[5]);
  });
}

/// Cells with polyhedra among them: the points of each, and for those that are polyhedra a stream of faces, which is
/// the mesh's own.
struct CellStreams {
  std::vector<std::uint32_t> points, faces;
  std::vector<std::uint64_t> points_end;
  std::vector<std::int64_t> faces_end;  ///< -1 of a cell that is no polyhedron.

  explicit CellStreams(const VolumeMesh& mesh) {
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
      const auto cell = mesh.cell(c);
      const auto first = static_cast<std::ptrdiff_t>(points.size());
      if (mesh.cell_types[c] == CellType::Polyhedron) {
        for (std::size_t at = 1; at < cell.size(); at += cell[at] + 1)
          points.insert(points.end(), cell.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                        cell.begin() + static_cast<std::ptrdiff_t>(at) + 1 + cell[at]);
        std::sort(points.begin() + first, points.end());
        points.erase(std::unique(points.begin() + first, points.end()), points.end());
        faces.insert(faces.end(), cell.begin(), cell.end());
        faces_end.push_back(static_cast<std::int64_t>(faces.size()));
      } else {
        points.insert(points.end(), cell.begin(), cell.end());
        faces_end.push_back(-1);
      }
      points_end.push_back(points.size());
    }
  }
};

void add_patches(VtkXml& xml, const VolumeMesh& mesh) {
  std::vector<std::string> names;
  std::string faces;
  for (const BoundaryPatch& patch : mesh.patches) {
    names.push_back(patch.name);
    faces += fmt::format("{} ", patch.face_count());
  }
  xml.add_text("<FieldData>\n");
  xml.add_words("patch_names", names);
  xml.add_text(
      fmt::format("<DataArray type=\"Int32\" Name=\"patch_faces\" NumberOfTuples=\"{}\" format=\"ascii\">\n{}\n"
                  "</DataArray>\n</FieldData>\n",
                  names.size(), faces));
}

}  // namespace

void write_vtu(const WrittenFile& file, VolumeMesh& mesh) {
  turn_prisms(mesh);
  VtkXml xml("UnstructuredGrid");
  if (!mesh.patches.empty()) add_patches(xml, mesh);
  xml.add_text(
      fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", mesh.points.size(), mesh.cell_count()));
  add_volume_fields(xml, "PointData", mesh.point_fields);
  add_volume_fields(xml, "CellData", mesh.cell_fields);
  add_points(xml, mesh.points);
  xml.add_text("<Cells>\n");
  std::optional<CellStreams> streams;
  if (has_polyhedra(mesh)) {
    streams.emplace(mesh);
    const CellStreams& all = *streams;
    xml.add(indices("connectivity", all.points.size(), false, [&all](std::size_t i) { return all.points[i]; }));
    xml.add(indices("offsets", mesh.cell_count(), false, [&all](std::size_t c) { return all.points_end[c]; }));
    xml.add(types_of(mesh));
    xml.add(indices("faces", all.faces.size(), false, [&all](std::size_t i) { return all.faces[i]; }));
    xml.add(indices("faceoffsets", mesh.cell_count(), false, [&all](std::size_t c) { return all.faces_end[c]; }));
  } else {
    const bool narrow = mesh.points.size() <= kMostInt32 && mesh.corners.size() <= kMostInt32;
    xml.add(indices("connectivity", mesh.corners.size(), narrow, [&mesh](std::size_t i) { return mesh.corners[i]; }));
    xml.add(indices("offsets", mesh.cell_count(), narrow, [&mesh](std::size_t c) { return mesh.cell_begin[c + 1]; }));
    xml.add(types_of(mesh));
  }
  xml.add_text("</Cells>\n</Piece>\n");
  std::move(xml).write_packed(file.temporary, file.path);
}

void write_vts(const WrittenFile& file, const StructuredBlock& block) {
  const std::string extent = fmt::format("0 {} 0 {} 0 {}", block.ni - 1, block.nj - 1, block.nk - 1);
  VtkXml xml("StructuredGrid", fmt::format(" WholeExtent=\"{}\"", extent));
  xml.add_text(fmt::format("<Piece Extent=\"{}\">\n", extent));
  add_volume_fields(xml, "PointData", block.point_fields);
  add_points(xml, block.points);
  xml.add_text("</Piece>\n");
  std::move(xml).write_packed(file.temporary, file.path);
}

}  // namespace vdb_offset::io
