// SPDX-License-Identifier: Apache-2.0
// Times reading and writing beside OpenMesh's, in alternating runs. On both sides, reading leads from the file to
// arrays of positions and faces: building OpenMesh's half-edges is timed separately.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::bench {
namespace {

using Json = nlohmann::ordered_json;
using FloatMesh = OpenMesh::PolyMesh_ArrayKernelT<>;

/// Collects what OpenMesh's readers find in arrays, without half-edges.
class Collector : public OpenMesh::IO::ImporterT<FloatMesh> {
 public:
  explicit Collector(FloatMesh& mesh) : ImporterT(mesh) {}

  OpenMesh::VertexHandle add_vertex(const OpenMesh::Vec3f& p) override {
    points.push_back(p);
    return OpenMesh::VertexHandle(static_cast<int>(points.size()) - 1);
  }
  OpenMesh::VertexHandle add_vertex(const OpenMesh::Vec3d& p) override { return add_vertex(OpenMesh::Vec3f(p)); }
  OpenMesh::FaceHandle add_face(const VHandles& corners) override {
    for (const auto v : corners) faces.push_back(v.idx());
    face_begin.push_back(static_cast<std::uint32_t>(faces.size()));
    return OpenMesh::FaceHandle(static_cast<int>(face_begin.size()) - 1);
  }
  void add_face_texcoords(OpenMesh::FaceHandle, OpenMesh::VertexHandle, const std::vector<OpenMesh::Vec2f>&) override {}
  void add_face_texcoords(OpenMesh::FaceHandle, OpenMesh::VertexHandle, const std::vector<OpenMesh::Vec3f>&) override {}
  std::size_t n_vertices() const override { return points.size(); }
  std::size_t n_faces() const override { return face_begin.size(); }

  std::vector<OpenMesh::Vec3f> points;
  std::vector<int> faces;
  std::vector<std::uint32_t> face_begin;
};

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

void require(bool done, const std::string& path) {
  if (!done) throw std::runtime_error("OpenMesh failed on " + path);
}

/// The seconds that both sides take for one file. Written files go to `folder`.
Json run(const std::string& path, int repeat, const std::filesystem::path& folder) {
  const std::string name = std::filesystem::path(path).filename(), ours = folder / ("ours_" + name),
                    theirs = folder / ("openmesh_" + name);
  std::vector<double> read, write, their_read, their_mesh, their_write;
  for (int i = 0; i < repeat; ++i) {
    io::MeshFile file;
    read.push_back(seconds_of([&] { file = io::read_mesh(path); }));
    std::vector<Vec3d> moved = file.polygons.positions;
    for (Vec3d& p : moved) p += Vec3d(1e-3);
    write.push_back(seconds_of([&] { io::write_mesh(ours, file, moved); }));

    FloatMesh mesh;
    OpenMesh::IO::Options found;
    Collector collector(mesh);
    their_read.push_back(seconds_of([&] { require(OpenMesh::IO::IOManager().read(path, collector, found), path); }));
    their_mesh.push_back(seconds_of([&] { require(OpenMesh::IO::read_mesh(mesh, path), path); }));
    OpenMesh::IO::Options same;
    if (file.encoding != io::Encoding::Ascii) same += OpenMesh::IO::Options::Binary;
    their_write.push_back(seconds_of([&] { require(OpenMesh::IO::write_mesh(mesh, theirs, same), theirs); }));
  }
  return {{"file", name},
          {"bytes", std::filesystem::file_size(path)},
          {"read_s", median(read)},
          {"openmesh_read_s", median(their_read)},
          {"read_times_faster", median(their_read) / median(read)},
          {"openmesh_read_and_connect_s", median(their_mesh)},
          {"write_s", median(write)},
          {"openmesh_write_s", median(their_write)},
          {"write_times_faster", median(their_write) / median(write)}};
}

}  // namespace
}  // namespace vdb_offset::bench

int main(int argc, char** argv) {
  using namespace vdb_offset;
  CLI::App app("Times reading and writing beside OpenMesh", "vdb_offset_io_bench");
  std::vector<std::string> files;
  std::string folder = std::filesystem::temp_directory_path();
  int repeat = 5;
  app.add_option("FILES", files, "Meshes (.obj .ply .stl .off)")->required();
  app.add_option("--repeat", repeat, "Runs; medians are printed")->capture_default_str();
  app.add_option("--folder", folder, "Where written files go")->capture_default_str();
  try {
    app.parse(argc, argv);
    omlog().disable();
    omout().disable();
    for (const std::string& file : files) fmt::print("{}\n", bench::run(file, repeat, folder).dump());
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    fmt::print(stderr, "vdb_offset_io_bench: {}\n", error.what());
    return 2;
  }
}
