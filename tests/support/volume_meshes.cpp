// SPDX-License-Identifier: Apache-2.0
#include "support/volume_meshes.h"
#include "vdb_offset/cells.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <map>

namespace vdb_offset::test {
namespace {

CornerList sorted(CornerList face) {
  std::sort(face.begin(), face.end());
  return face;
}

/// Faces that one cell alone has go to the lower wall, the side or the outer patch, by their height.
void add_patches(VolumeMesh& mesh) {
  std::map<CornerList, int> cells;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c)
    for (const CornerList& face : faces_of(mesh.cell_types[c], mesh.cell(c))) ++cells[sorted(face)];
  mesh.patches = {{"the \"wall\"", BoundaryPatch::Kind::Wall, {}, {0}, {}},
                  {"outer", BoundaryPatch::Kind::Outer, {}, {0}, {}},
                  {"side", BoundaryPatch::Kind::Side, {}, {0}, {}}};
  for (std::uint32_t c = 0; c < mesh.cell_count(); ++c)
    for (const CornerList& face : faces_of(mesh.cell_types[c], mesh.cell(c))) {
      if (cells[sorted(face)] > 1) continue;
      double low = 1e9, high = -1e9;
      for (const std::uint32_t v : face) {
        low = std::min(low, mesh.points[v].z());
        high = std::max(high, mesh.points[v].z());
      }
      BoundaryPatch& patch = mesh.patches[high == -1 ? 0 : low >= 1 ? 1 : 2];
      patch.corners.insert(patch.corners.end(), face.begin(), face.end());
      patch.face_begin.push_back(static_cast<std::uint32_t>(patch.corners.size()));
      patch.cell.push_back(c);
    }
}

/// Twice the face's area vector, and six times the volume between it and the origin.
std::pair<Vec3d, double> area_and_volume(const std::vector<Vec3d>& points, const CornerList& face) {
  Vec3d area(0);
  double volume = 0;
  for (std::size_t k = 2; k < face.size(); ++k) {
    const Vec3d a = points[face[0]], b = points[face[k - 1]], c = points[face[k]];
    area += (b - a).cross(c - a);
    volume += a.dot(b.cross(c));
  }
  return {area, volume};
}

}  // namespace

void add_cell(VolumeMesh& mesh, CellType type, const CornerList& corners) {
  mesh.cell_types.push_back(type);
  mesh.corners.insert(mesh.corners.end(), corners.begin(), corners.end());
  mesh.cell_begin.push_back(mesh.corners.size());
}

std::vector<CornerList> faces_of(CellType type, std::span<const std::uint32_t> cell) {
  static const std::map<CellType, std::vector<CornerList>> kFaces = {
      {CellType::Tetrahedron, {{2, 1, 0}, {1, 3, 0}, {2, 3, 1}, {0, 3, 2}}},
      {CellType::Pyramid, {{3, 2, 1, 0}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}},
      {CellType::Prism, {{2, 1, 0}, {3, 4, 5}, {1, 4, 3, 0}, {2, 5, 4, 1}, {0, 3, 5, 2}}},
      {CellType::Hexahedron, {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}}};
  std::vector<CornerList> faces;
  if (type == CellType::Polyhedron) {
    for (std::size_t at = 1; at < cell.size(); at += cell[at] + 1)
      faces.emplace_back(&cell[at] + 1, &cell[at] + 1 + cell[at]);
  } else {
    faces = kFaces.at(type);
    for (CornerList& face : faces)
      for (std::uint32_t& v : face) v = cell[v];
  }
  return faces;
}

VolumeMesh mixed_cells() {
  VolumeMesh mesh;
  for (const double z : {-1., 0., 1.})
    for (const auto& [x, y] : {std::pair(0., 0.), {1., 0.}, {1., 1.}, {0., 1.}, {2., 0.5}})
      mesh.points.emplace_back(x, y, z);
  mesh.points.emplace_back(0.5, 0.5, 1.75);
  mesh.points.emplace_back(0.5, -1 / 3., 1.5);
  add_cell(mesh, CellType::Tetrahedron, {10, 11, 15, 16});
  add_cell(mesh, CellType::Hexahedron, {5, 6, 7, 8, 10, 11, 12, 13});
  add_cell(mesh, CellType::Prism, {1, 4, 2, 6, 9, 7});
  add_cell(mesh, CellType::Pyramid, {10, 11, 12, 13, 15});
  add_cell(mesh, CellType::Hexahedron, {0, 1, 2, 3, 5, 6, 7, 8});
  add_cell(mesh, CellType::Prism, {6, 9, 7, 11, 14, 12});
  add_cell(mesh, CellType::Tetrahedron, {11, 14, 12, 15});
  add_patches(mesh);
  for (std::size_t p = 0; p < mesh.points.size(); ++p) mesh.points[p] *= 1 + 1 / 3.;
  mesh.point_fields = {{"height", {}}, {"nothing", {}}};
  for (const Vec3d& point : mesh.points) mesh.point_fields[0].values.push_back(static_cast<float>(point.z()));
  mesh.cell_fields = {{"layer", {6, 5, 4, 3, 2, 1, 0}}};
  return mesh;
}

VolumeMesh with_polyhedra() {
  const VolumeMesh plain = mixed_cells();
  VolumeMesh mesh = plain;
  mesh.cell_types.clear();
  mesh.corners.clear();
  mesh.cell_begin = {0};
  for (std::size_t c = 0; c < plain.cell_count(); ++c) {
    const CellType type = plain.cell_types[c];
    const auto cell = plain.cell(c);
    if (type != CellType::Hexahedron && type != CellType::Prism) {
      add_cell(mesh, type, CornerList(cell.begin(), cell.end()));
      continue;
    }
    const auto faces = faces_of(type, cell);
    CornerList stream = {static_cast<std::uint32_t>(faces.size())};
    for (const CornerList& face : faces) {
      stream.push_back(static_cast<std::uint32_t>(face.size()));
      stream.insert(stream.end(), face.begin(), face.end());
    }
    add_cell(mesh, CellType::Polyhedron, stream);
  }
  return mesh;
}

double volume_of(const std::vector<Vec3d>& points, const std::vector<CornerList>& faces) {
  Vec3d area(0);
  double volume = 0;
  for (const CornerList& face : faces) {
    const auto [of_face, below] = area_and_volume(points, face);
    area += of_face;
    volume += below / 6;
  }
  CHECK(area.length() < 1e-12);
  CHECK(volume > 0.01);
  return volume;
}

std::vector<double> volumes_of(const VolumeMesh& mesh) {
  std::vector<double> volumes;
  for (std::size_t c = 0; c < mesh.cell_count(); ++c)
    volumes.push_back(volume_of(mesh.points, faces_of(mesh.cell_types[c], mesh.cell(c))));
  return volumes;
}

bool installed(const std::string& program) {
  if (std::system(("command -v " + program + " >/dev/null").c_str()) == 0) return true;
  WARN(program << " is not installed: what it would read is left unread");
  return false;
}

std::string output_of(const Folder& folder, const std::string& command) {
  const int code = std::system((command + " >" + folder.file("output") + " 2>&1").c_str());
  std::string output = slurp(folder.file("output"));
  INFO(output);
  CHECK(code == 0);
  return output;
}

namespace {

// In Debian's package, the caller has to say where the settings are.
const std::string kFoamSettings = "WM_PROJECT_DIR=${WM_PROJECT_DIR:-/usr/share/openfoam} ";

/// A case for OpenFOAM that has no mesh yet.
std::filesystem::path empty_foam_case(const Folder& folder) {
  const std::filesystem::path inside = folder.path / "case";
  std::filesystem::create_directories(inside / "constant");
  std::filesystem::create_directories(inside / "system");
  std::filesystem::remove(inside / "constant/polyMesh");
  const auto write = [&](const std::string& object, const std::string& entries) {
    folder.write("case/system/" + object,
                 "FoamFile { version 2.0; format ascii; class dictionary; object " + object + "; }\n" + entries + "\n");
  };
  write("controlDict", "startFrom startTime; startTime 0; stopAt endTime; endTime 0; deltaT 1; writeInterval 1;");
  write("fvSchemes", "ddtSchemes {} gradSchemes {} divSchemes {} laplacianSchemes {}");
  write("fvSolution", "");
  return inside;
}

}  // namespace

std::string check_mesh_of(const Folder& folder, const std::string& name) {
  const std::filesystem::path inside = empty_foam_case(folder);
  std::filesystem::create_directory_symlink(folder.path / name, inside / "constant/polyMesh");
  return output_of(folder, kFoamSettings + "checkMesh -constant -case " + inside.string());
}

void gmsh_to_foam(const Folder& folder, const std::string& msh, const std::string& name) {
  const std::filesystem::path inside = empty_foam_case(folder);
  output_of(folder, kFoamSettings + "gmshToFoam -keepOrientation -case " + inside.string() + " " + folder.file(msh));
  std::filesystem::rename(inside / "constant/polyMesh", folder.path / name);
}

}  // namespace vdb_offset::test
