// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "bytes/append_number.h"
#include "bytes/chunked_output.h"
#include "vdb_offset/run.h"
#include "volume/volume_writers.h"

// https://su2code.github.io/docs_v7/Mesh-File/: types of elements are VTK's numbers.
namespace vdb_offset::io {
namespace {

constexpr unsigned kSu2Types[kCellTypeCount] = {10, 14, 13, 12, 0, 5, 9};
constexpr unsigned kSu2Faces[] = {0, 0, 3, 5, 9};  // type of a face by its number of corners

void append_su2_element(std::string& text, unsigned type, std::span<const std::uint32_t> corners) {
  append_integer(text, type);
  for (const std::uint32_t v : corners) append_integer(text += ' ', v);
}

Pieces su2_elements(const VolumeMesh& mesh) {
  return in_sections(fmt::format("NDIME= {}\nNELEM= {}\n", mesh.plane() ? 2 : 3, mesh.cell_count()),
                     {{mesh.cell_count(), [&mesh](std::string& text, std::size_t c) {
                         append_su2_element(text, kSu2Types[static_cast<std::size_t>(mesh.cell_types[c])],
                                            mesh.cell(c));
                         append_integer(text += ' ', c);
                         text += '\n';
                       }}});
}

Pieces su2_points(const VolumeMesh& mesh) {
  return in_sections(fmt::format("NPOIN= {}\n", mesh.points.size()),
                     {{mesh.points.size(), [&mesh](std::string& text, std::size_t p) {
                         for (int k = 0; k < (mesh.plane() ? 2 : 3); ++k)
                           append_number(text, mesh.points[p][k]), text += ' ';
                         append_integer(text, p);
                         text += '\n';
                       }}});
}

Pieces su2_marker(const BoundaryPatch& patch, const std::string& tag) {
  return in_sections(fmt::format("MARKER_TAG= {}\nMARKER_ELEMS= {}\n", tag, patch.face_count()),
                     {{patch.face_count(), [&patch](std::string& text, std::size_t f) {
                         const auto face = patch.face(f);
                         append_su2_element(text, kSu2Faces[face.size()], face);
                         text += '\n';
                       }}});
}

}  // namespace

void write_su2(const std::string& path, const VolumeMesh& mesh) {
  if (!mesh.plane()) require_standard_cells(path, mesh, "su2");
  else if (std::abs(mesh.normal[2]) != 1)
    throw InvalidInput(path + ": expected cells in a plane of constant z, as .su2 has x and y alone (write .vtu)");
  std::vector<Pieces> parts = {su2_elements(mesh), su2_points(mesh),
                               in_sections(fmt::format("NMARK= {}\n", mesh.patches.size()), {})};
  const std::vector<std::string> tags = patch_words(mesh);
  for (std::size_t i = 0; i < mesh.patches.size(); ++i) parts.push_back(su2_marker(mesh.patches[i], tags[i]));
  write_pieces(path, in_a_row(std::move(parts)));
}

}  // namespace vdb_offset::io
