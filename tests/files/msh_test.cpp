// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "products/cells/make_cells.h"
#include "support/volume_meshes.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/io/volume_file.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shapes.h"
#include "volume/msh_entities.h"

using namespace vdb_offset;
using namespace vdb_offset::test;
using Catch::Matchers::Contains;

namespace {

/// Of each point the patches that it lies on.
std::vector<std::set<std::uint32_t>> patches_of_points(const VolumeMesh& mesh) {
  std::vector<std::set<std::uint32_t>> patches(mesh.points.size());
  for (std::uint32_t i = 0; i < mesh.patches.size(); ++i)
    for (const auto p : mesh.patches[i].corners) patches[p].insert(i);
  return patches;
}

/// Of each edge of the boundary the patches that it lies on.
std::map<CornerList, std::set<std::uint32_t>> patches_of_edges(const VolumeMesh& mesh) {
  std::map<CornerList, std::set<std::uint32_t>> patches;
  for (std::uint32_t i = 0; i < mesh.patches.size(); ++i)
    for (std::size_t f = 0; f < mesh.patches[i].face_count(); ++f) {
      const auto face = mesh.patches[i].face(f);
      for (std::size_t k = 0; k < face.size(); ++k) {
        CornerList edge = {face[k], face[(k + 1) % face.size()]};
        std::sort(edge.begin(), edge.end());
        patches[edge].insert(i);
      }
    }
  return patches;
}

/// Each point is in one entity, of the dimension that its patches ask for; each edge between patches in one curve.
void check_entities(const VolumeMesh& mesh) {
  const io::MshEntities entities = io::find_entities(mesh);
  const auto of_point = patches_of_points(mesh);
  auto of_edge = patches_of_edges(mesh);
  std::erase_if(of_edge, [](const auto& edge) { return edge.second.size() < 2; });
  std::vector<int> seen(mesh.points.size(), 0);
  for (const auto p : entities.inside) {
    ++seen[p];
    CHECK(of_point[p].empty());
  }
  for (std::uint32_t i = 0; i < mesh.patches.size(); ++i)
    for (const auto p : entities.on_patch[i]) {
      ++seen[p];
      CHECK(of_point[p] == std::set<std::uint32_t>{i});
    }
  const std::set<std::uint32_t> corners(entities.corners.begin(), entities.corners.end());
  CHECK(corners.size() == entities.corners.size());
  for (const auto p : corners) {
    ++seen[p];
    CHECK(of_point[p].size() > 1);
  }
  for (std::uint32_t c = 0; c < entities.curves.size(); ++c) {
    const auto& [points, group] = entities.curves[c];
    const auto& patches = entities.groups[group];
    CHECK(corners.contains(points.front()));
    CHECK(corners.contains(points.back()));
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      if (k > 0) ++seen[points[k]];
      CornerList edge = {points[k], points[k + 1]};
      std::sort(edge.begin(), edge.end());
      REQUIRE(of_edge.contains(edge));
      CHECK(of_edge[edge] == std::set<std::uint32_t>(patches.begin(), patches.end()));
      of_edge.erase(edge);
    }
    for (std::uint32_t i = 0; i < mesh.patches.size(); ++i)
      CHECK(std::count_if(entities.around[i].begin(), entities.around[i].end(), [&](const auto& side) {
              return side.curve == c;
            }) == std::count(patches.begin(), patches.end(), i));
  }
  CHECK(of_edge.empty());
  CHECK(std::all_of(seen.begin(), seen.end(), [](int times) { return times == 1; }));
}

/// Layers with straight stacks, each vertex along its own direction.
VolumeMesh layers_on(const Polygons& mesh, const WallNames& names, double height) {
  LayersResult layers = grow_layers(mesh.view(), std::vector<Distances>{height / 2, height}, {});
  return make_cells(mesh.view(), layers, names);
}

/// An octahedron whose upper and lower halves have names of their own.
VolumeMesh octahedron() {
  Polygons mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const auto& [a, b, c] : std::initializer_list<std::array<std::uint32_t, 3>>{
           {0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}})
    mesh.add_face({a, b, c});
  return layers_on(mesh, {{"upper", "lower"}, {0, 0, 0, 0, 1, 1, 1, 1}}, 0.1);
}

/// A cylinder's wall without its ends.
VolumeMesh pipe() {
  const Polygons whole = shapes::cylinder(0.5, 1, 12, 3, 1);
  Polygons mesh;
  mesh.positions = whole.positions;
  for (std::size_t f = 0; f < whole.face_count(); ++f) {
    const auto face = whole.view().face(f);
    if (std::all_of(face.begin(), face.end(),
                    [&](auto v) { return whole.positions[v][2] == whole.positions[face[0]][2]; }))
      continue;
    mesh.corners.insert(mesh.corners.end(), face.begin(), face.end());
    mesh.close_face();
  }
  return layers_on(mesh, {}, -0.05);
}

/// A house of 3 x 3 unit cubes on the ground, where it is open, and on its roof a chimney of two more: an ASCII STL of
/// six solids.
std::string house_with_chimney() {
  using Cube = std::array<int, 3>;
  std::set<Cube> cubes = {{1, 1, 1}, {1, 1, 2}};
  for (const int i : {0, 1, 2})
    for (const int j : {0, 1, 2}) cubes.insert({i, j, 0});
  std::map<std::string, std::string> solids;
  for (const Cube& cube : cubes)
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        Cube next = cube;
        next[axis] += 2 * side - 1;
        if (next[2] < 0 || cubes.contains(next)) continue;
        std::array<Cube, 4> face = {cube, cube, cube, cube};
        for (const std::size_t k : {1, 2}) ++face[k][(axis + 1) % 3];
        for (const std::size_t k : {2, 3}) ++face[k][(axis + 2) % 3];
        for (Cube& corner : face) corner[axis] += side;
        if (side == 0) std::swap(face[1], face[3]);
        const bool chimney = cube[2] > 0;
        const std::string wall = std::string(axis == 0 ? "x" : "y") + (side == 1 ? "_most" : "_least");
        std::string& text = solids[axis == 2 ? (chimney ? "outlet" : "roof") : chimney ? "chimney" : wall];
        for (const auto& [b, c] : {std::pair(1, 2), std::pair(2, 3)}) {
          text += "facet normal 0 0 0\nouter loop\n";
          for (const int k : {0, b, c}) {
            text += "vertex";
            for (const int x : face[static_cast<std::size_t>(k)]) text += " " + std::to_string(x);
            text += "\n";
          }
          text += "endloop\nendfacet\n";
        }
      }
  std::string stl;
  for (const auto& [name, text] : solids) stl += "solid " + name + "\n" + text + "endsolid " + name + "\n";
  return stl;
}

/// Has Gmsh fill a box above the ground around layers: they are surface `outer`, and meet the ground at curve `rim`.
std::string fill_above_ground(std::size_t outer, std::size_t rim) {
  return "Merge \"layers.msh\";\n"
         "Point(1001) = {-4, -4, 0, 2}; Point(1002) = {7, -4, 0, 2};\n"
         "Point(1003) = {7, 7, 0, 2}; Point(1004) = {-4, 7, 0, 2};\n"
         "Line(1001) = {1001, 1002}; Line(1002) = {1002, 1003};\n"
         "Line(1003) = {1003, 1004}; Line(1004) = {1004, 1001};\n"
         "Curve Loop(1001) = {1001, 1002, 1003, 1004}; Plane Surface(1001) = {1001};\n"
         "box[] = Extrude {0, 0, 8} { Surface{1001}; };\n"
         "Delete { Volume{box[1]}; }\n"
         "Delete { Surface{1001}; }\n"
         "Curve Loop(1002) = {" +
         std::to_string(rim) +
         "}; Plane Surface(1101) = {1001, 1002};\n"
         "Surface Loop(1001) = {1101, box[0], box[2], box[3], box[4], box[5], " +
         std::to_string(outer) +
         "};\n"
         "Volume(1001) = {1001};\n"
         "Physical Volume(\"around\", 1001) = {1001}; Physical Surface(\"ground\", 1002) = {1101};\n"
         "Physical Surface(\"far\", 1003) = {box[0], box[2], box[3], box[4], box[5]};\n"
         "Mesh.MshFileVersion = 2.2; Mesh.Binary = 0;\n";
}

/// Of a file of any version.
std::vector<int> numbers_of_groups(const std::string& text) {
  std::istringstream in(text.substr(text.find("$PhysicalNames") + 14));
  std::size_t count = 0;
  in >> count;
  std::vector<int> numbers(count);
  for (int& number : numbers) {
    int dimension = 0;
    std::string name;
    in >> dimension >> number >> name;
  }
  CHECK(in);
  return numbers;
}

/// Coordinates that several nodes of an ASCII file of version 2.2 have.
std::size_t repeated_nodes(const std::string& text) {
  std::istringstream in(text.substr(text.find("$Nodes") + 6));
  std::size_t count = 0, repeated = 0;
  in >> count;
  REQUIRE(count > 0);
  std::set<std::array<double, 3>> positions;
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t tag = 0;
    std::array<double, 3> at{};
    in >> tag >> at[0] >> at[1] >> at[2];
    repeated += !positions.insert(at).second;
  }
  CHECK(in);
  return repeated;
}

}  // namespace

TEST_CASE("msh: points and edges belong to corners, curves, surfaces and the volume", "[msh]") {
  check_entities(mixed_cells());
  const VolumeMesh closed = octahedron();
  check_entities(closed);
  const io::MshEntities equator = io::find_entities(closed);
  CHECK(equator.groups == std::vector<std::vector<std::uint32_t>>{{0, 1}});
  REQUIRE(equator.curves.size() == 1);
  CHECK(equator.curves[0].points == CornerList{0, 2, 1, 3, 0});
  CHECK(equator.corners == CornerList{0});  // where it is cut open
  CHECK(equator.on_patch[0] == CornerList{4});
  CHECK(equator.on_patch[2].size() == 6);  // the outer surface touches no wall
  CHECK(equator.inside.size() == 6);
  check_entities(pipe());
}

TEST_CASE("msh: patches that touch at a point have a corner there", "[msh]") {
  // Two tetrahedra, tip to tip, of different walls.
  VolumeMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 1}, {0, 1, 1}, {-1, -1, 1}, {1, 0, -1}, {0, 1, -1}, {-1, -1, -1}};
  add_cell(mesh, CellType::Tetrahedron, {0, 2, 1, 3});
  add_cell(mesh, CellType::Tetrahedron, {0, 4, 5, 6});
  for (std::uint32_t c = 0; c < 2; ++c) {
    BoundaryPatch& patch = mesh.patches.emplace_back();
    patch.name = "wall_" + std::to_string(c);
    for (const CornerList& face : faces_of(mesh.cell_types[c], mesh.cell(c))) {
      patch.corners.insert(patch.corners.end(), face.begin(), face.end());
      patch.face_begin.push_back(static_cast<std::uint32_t>(patch.corners.size()));
      patch.cell.push_back(c);
    }
  }
  check_entities(mesh);
  CHECK(io::find_entities(mesh).corners == CornerList{0});
}

TEST_CASE("msh: each opening of a pipe is a patch, and curves are named by what they part", "[msh]") {
  const Folder folder;
  const VolumeMesh mesh = pipe();
  std::vector<std::string> names;
  for (const BoundaryPatch& patch : mesh.patches) names.push_back(patch.name);
  CHECK(names == std::vector<std::string>{"wall", "outer", "sides_1", "sides_2"});
  for (const std::size_t side : {2, 3}) {
    CHECK(mesh.patches[side].face_count() == 2 * 12);
    for (const auto p : mesh.patches[side].corners)
      CHECK(mesh.points[p][2] == mesh.points[mesh.patches[side].corners[0]][2]);
  }
  io::write_volume(folder.file("pipe.msh"), mesh);
  const std::string text = slurp(folder.file("pipe.msh"));
  for (const char* const name : {"1 6 \"wall-sides_1\"", "1 9 \"outer-sides_2\"", "2 3 \"sides_1\"", "3 5 \"layers\""})
    CHECK_THAT(text, Contains(name));
  if (!installed("gmsh")) return;
  const std::string output = output_of(folder, "gmsh -check " + folder.file("pipe.msh"));
  INFO(output);
  CHECK_THAT(output, !Contains("Warning") && !Contains("Error"));
}

TEST_CASE("msh: Gmsh fills the space around layers with no node twice", "[msh]") {
  const Folder folder;
  const VolumeMesh mesh = octahedron();
  const auto written = io::write_volume(folder.file("layers.msh"), mesh);
  CHECK_FALSE(written.foam);
  if (!installed("gmsh")) return;
  folder.write(
      "fill.geo",
      "Merge \"layers.msh\";\n"
      "Point(1001) = {-3, -3, -3, 2}; Point(1002) = {3, -3, -3, 2};\n"
      "Point(1003) = {3, 3, -3, 2}; Point(1004) = {-3, 3, -3, 2};\n"
      "Line(1001) = {1001, 1002}; Line(1002) = {1002, 1003};\n"
      "Line(1003) = {1003, 1004}; Line(1004) = {1004, 1001};\n"
      "Curve Loop(1001) = {1001, 1002, 1003, 1004}; Plane Surface(1001) = {1001};\n"
      "box[] = Extrude {0, 0, 6} { Surface{1001}; };\n"
      "Delete { Volume{box[1]}; }\n"
      "Surface Loop(1001) = {1001, box[0], box[2], box[3], box[4], box[5]};\n"
      "Surface Loop(1002) = {3};\n"
      "Volume(1001) = {1001, 1002};\n"
      "Physical Volume(\"far\") = {1001}; Physical Surface(\"box\") = {1001, box[0], box[2], box[3], box[4], box[5]};\n"
      "Mesh.MshFileVersion = 2.2; Mesh.Binary = 0;\n");
  const std::string output =
      output_of(folder, "gmsh -3 " + folder.file("fill.geo") + " -o " + folder.file("filled.msh"));
  INFO(output);
  CHECK_THAT(output, !Contains("Error") && Contains("Done meshing 3D"));
  const std::string filled = slurp(folder.file("filled.msh"));
  CHECK_THAT(filled, Contains("\"upper-lower\""));
  CHECK(repeated_nodes(filled) == 0);
}

TEST_CASE("msh: a chimney of several solids is filled around by Gmsh and goes on to OpenFOAM by its names", "[msh]") {
  const Folder folder;
  const io::MeshFile file = io::read_mesh(folder.write("chimney.stl", house_with_chimney()));
  const VolumeMesh mesh = layers_on(file.polygons, io::wall_names(file), 0.2);
  std::vector<std::string> names;
  for (const BoundaryPatch& patch : mesh.patches) names.push_back(patch.name);
  CHECK(names == std::vector<std::string>{"chimney", "outlet", "roof", "x_least", "x_most", "y_least", "y_most",
                                          "outer", "sides"});
  check_entities(mesh);
  const io::MshEntities entities = io::find_entities(mesh);
  CHECK(entities.curves.size() == 15);  // eight edges of walls, four on the ground, around the chimney twice, the rim
  const auto rim = std::find_if(entities.curves.begin(), entities.curves.end(), [&](const auto& curve) {
    return entities.groups[curve.group] == std::vector<std::uint32_t>{7, 8};
  });
  REQUIRE(rim != entities.curves.end());

  io::write_volume(folder.file("layers.msh"), mesh);
  std::vector<int> groups = numbers_of_groups(slurp(folder.file("layers.msh")));
  CHECK(groups.size() == 9 + 1 + entities.groups.size());
  std::sort(groups.begin(), groups.end());
  CHECK(std::adjacent_find(groups.begin(), groups.end()) == groups.end());  // gmshToFoam knows them by numbers alone
  if (!installed("gmsh")) return;
  folder.write("fill.geo",
               fill_above_ground(8, static_cast<std::size_t>(std::distance(entities.curves.begin(), rim)) + 1));
  const std::string output =
      output_of(folder, "gmsh -3 " + folder.file("fill.geo") + " -o " + folder.file("filled.msh"));
  INFO(output);
  CHECK_THAT(output, !Contains("Error") && Contains("Done meshing 3D"));
  CHECK(repeated_nodes(slurp(folder.file("filled.msh"))) == 0);
  if (!installed("gmshToFoam") || !installed("checkMesh")) return;
  gmsh_to_foam(folder, "filled.msh", "polyMesh");
  CHECK_THAT(check_mesh_of(folder, "polyMesh"), Contains("Mesh OK."));
  const std::string boundary = slurp(folder.file("polyMesh/boundary"));
  for (const char* const name :
       {"chimney", "outlet", "roof", "x_least", "x_most", "y_least", "y_most", "sides", "ground", "far"})
    CHECK_THAT(boundary, Contains(std::string("\n    ") + name + "\n"));
  CHECK_THAT(slurp(folder.file("polyMesh/faceZones")), Contains("\nouter\n"));
}
