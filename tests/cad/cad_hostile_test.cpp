// SPDX-License-Identifier: Apache-2.0
// CAD files that are broken, workers that are gone or are others, and messages that are not what they ought to be.
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <random>
#include <thread>

#include "cad/cad_files.h"
#include "vdb_offset/api.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;
using Catch::Contains;
using test::cad_files;
using test::open_cad;

namespace {

io::CadMeshing coarse() { return {0.5, 0, 0.5}; }

/// What reading a file of such bytes ends with; empty: a mesh.
std::string reads(const std::string& bytes, const std::string& ending, double seconds = test::kCadSeconds) {
  try {
    const io::CadWorker worker("part" + ending, bytes, ending, coarse(), seconds, std::uint64_t{1} << 31);
    return worker.mesh().triangles.empty() ? "no triangles" : "";
  } catch (const Error& error) {
    return error.what();
  }
}

void check_one_line(const std::string& message, const std::string& start) {
  INFO(message);
  CHECK(message.starts_with(start + ": "));
  CHECK(message.find('\n') == std::string::npos);
}

/// The process whose parent is this one, of the worker's name.
std::optional<pid_t> child_of(pid_t parent) {
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::ifstream file(entry.path() / "stat");
    pid_t process = 0, its_parent = 0;
    std::string name, state;
    if (file >> process >> name >> state >> its_parent && its_parent == parent && name == "(vdb_offset_cad)")
      return process;
  }
  return std::nullopt;
}

/// Asks until the reader, which the system ends with its guard, is gone.
void ask_until_gone(io::CadWorker& worker) {
  for (int k = 0; k < 5000; ++k) {
    worker.distance_errors({});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// Sets a variable of the environment for a while.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name), before_(std::getenv(name)) {
    ::setenv(name, value.c_str(), 1);
  }
  ~Variable() { ::setenv(name_, before_.c_str(), 1); }

 private:
  const char* name_;
  std::string before_;
};

/// A folder with a program in the worker's place.
std::string folder_with(const std::string& name, const std::string& script) {
  const auto folder = cad_files().folder() / name;
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "vdb_offset_cad") << script;
  std::filesystem::permissions(folder / "vdb_offset_cad", std::filesystem::perms::all);
  return folder.string();
}

void cut_at(int places) {
  const std::string bytes = cad_files().bytes("block.step");
  for (int k = 0; k < places; ++k) {
    const std::string message = reads(bytes.substr(0, bytes.size() * static_cast<std::size_t>(k) / places), ".step");
    CHECK_FALSE(message.empty());
    check_one_line(message, "part.step");
  }
}

void flip_in(const char* name, int tries) {
  const std::string bytes = cad_files().bytes(name), ending = std::string(name).substr(std::string(name).rfind('.'));
  std::mt19937 random(5);
  for (int k = 0; k < tries; ++k) {
    std::string broken = bytes;
    for (int flips = 0; flips < 4; ++flips) broken[random() % broken.size()] = static_cast<char>(random() % 256);
    if (const std::string message = reads(broken, ending, 5); !message.empty())
      check_one_line(message, "part" + ending);
  }
}

}  // namespace

TEST_CASE("cad: files that are cut off or broken end with one line", "[cad]") {
  REQUIRE(cad_files().is_made());
  cut_at(5);
  flip_in("block.step", 4);
  CHECK(reads("", ".step") == "part.step: expected a STEP file, got one that OpenCASCADE cannot read");
  CHECK(reads("", ".iges") == "part.iges: expected an IGES file, got one that OpenCASCADE cannot read");
  CHECK(reads("nothing", ".brep") == "part.brep: expected a BREP file of OpenCASCADE's, got one that it cannot read");
  CHECK(reads(cad_files().bytes("curves.step"), ".step") ==
        "part.step: expected a STEP file with faces, got no face (3 free curves)");
  CHECK(reads("", ".sat") == "part.sat: expected a file .step, .stp, .iges, .igs or .brep, got .sat");
}

TEST_CASE("cad: files cut at 200 places, and with bytes flipped", "[cad][long]") {
  REQUIRE(cad_files().is_made());
  cut_at(200);
  flip_in("block.step", 60);
  flip_in("faces.igs", 30);
  flip_in("sphere.brep", 10);
}

TEST_CASE("cad: a deflection that no memory would hold the triangles of is refused", "[cad]") {
  REQUIRE(cad_files().is_made());
  CHECK_THROWS_WITH(open_cad("sphere.brep", 1e-9),
                    Contains("expected a deflection of at least") && Contains("got 1e-09 (--deflection)"));
}

TEST_CASE("cad: a file whose triangles have little to do with its faces is refused", "[cad]") {
  REQUIRE(cad_files().is_made());
  // An edge's end, one digit of which is gone.
  std::string bytes = cad_files().bytes("pit.brep");
  const std::string end = "  10 -10 2.25  10 10 2.25";
  const std::size_t at = bytes.find(end);
  REQUIRE(at != std::string::npos);
  bytes.replace(at, end.size(), "  0 -10 2.25  10 10 2.25");
  CHECK_THROWS_WITH(io::CadWorker("pit.brep", bytes, "brep", {1e-4, 0, 0.5}, 60, 0),
                    Contains("pit.brep: expected triangles within") && Contains("as of a damaged file"));
}

TEST_CASE("cad: what is asked of a file shares its time", "[cad]") {
  REQUIRE(cad_files().is_made());
  const std::string bytes = cad_files().bytes("sphere.brep");
  io::CadWorker worker("ball.brep", bytes, "brep", {0.01, 0, 15}, 2, 0);
  const std::vector<io::CadPoint> points(20000, io::CadPoint{1.5, 0.2, 0.1, 0.1, 0.1, 0.5, 0});
  const auto start = std::chrono::steady_clock::now();
  const auto ask_on = [&] {
    while (std::chrono::steady_clock::now() - start < std::chrono::seconds(60)) worker.distance_errors(points);
  };
  CHECK_THROWS_WITH(ask_on(), Contains("longer than 2 s in all"));
}

TEST_CASE("cad: a file that takes too long or too much is given up", "[cad]") {
  REQUIRE(cad_files().is_made());
  const std::string bytes = cad_files().bytes("sphere.brep");
  const auto start = std::chrono::steady_clock::now();
  CHECK_THROWS_WITH(
      io::CadWorker("ball.brep", bytes, "brep", {4e-6, 0, 0.5}, 0.25, 0),
      "ball.brep: expected a CAD file, got one that takes OpenCASCADE longer than 0.25 s in all (--cad-seconds)");
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(5));
#ifndef __SANITIZE_ADDRESS__  // where memory has no limit
  CHECK_THROWS_AS(io::CadWorker("ball.brep", bytes, "brep", {1e-4, 0, 0.5}, 60, 8 << 20), OutOfBudget);
  CHECK_THROWS_WITH(io::CadWorker("ball.brep", bytes, "brep", {1e-4, 0, 0.5}, 60, 8 << 20),
                    "ball.brep: needs more memory than --max-memory allows (8 MiB)");
#endif
}

#ifndef __SANITIZE_ADDRESS__
TEST_CASE("cad: where the memory is too little the file is not blamed", "[cad]") {
  REQUIRE(cad_files().is_made());
  std::size_t refused = 0;
  for (const char* const name : {"block.step", "sphere.brep", "faces.igs"}) {
    const std::string bytes = cad_files().bytes(name), ending = std::string(name).substr(std::string(name).rfind('.'));
    const auto read = [&](std::uint64_t memory) { io::CadWorker(name, bytes, ending, coarse(), 60, memory); };
    CHECK_THROWS_AS(read(1 << 20), OutOfBudget);
    CHECK_THROWS_WITH(read(1 << 20), Contains("needs at least 3") && Contains("more than --max-memory allows (1 MiB)"));
    read(64 << 20);
    for (std::uint64_t memory = 1 << 20; memory < 6 << 20; memory += 1 << 18) try {
        read(memory);
      } catch (const OutOfBudget&) {
        ++refused;
      }
  }
  CHECK(refused >= 3 * 8);
  // A file that is broken is, however much of it would fit.
  CHECK_THROWS_AS(
      io::CadWorker("cut.step", cad_files().bytes("block.step").substr(0, 9000), ".step", coarse(), 60, 32 << 20),
      InvalidInput);
}
#endif

TEST_CASE("cad: a worker that is killed is told of, whatever becomes of children", "[cad]") {
  REQUIRE(cad_files().is_made());
  for (const bool is_ignored : {false, true}) {
    const auto before = std::signal(SIGCHLD, is_ignored ? SIG_IGN : SIG_DFL);
    {
      io::CadWorker worker = open_cad("cone.brep", 0.5);
      const auto guard = child_of(::getpid());
      REQUIRE(guard);
      const auto reader = child_of(*guard);
      REQUIRE(reader);
      ::kill(*reader, SIGKILL);
      CHECK_THROWS_WITH(
          worker.distance_errors({}),
          "cone.brep: expected a CAD file that OpenCASCADE can read, got one that ends its reader by signal 9");
      CHECK_THROWS_WITH(worker.distance_errors({}), Contains("expected a CAD file that is still being read"));
    }
    {
      io::CadWorker worker = open_cad("cone.brep", 0.5);
      const auto guard = child_of(::getpid());
      REQUIRE(guard);
      ::kill(*guard, SIGKILL);
      CHECK_THROWS_WITH(ask_until_gone(worker), Contains("got one that ends its reader"));
    }
    CHECK_FALSE(child_of(::getpid()));
    std::signal(SIGCHLD, before);
  }
}

TEST_CASE("cad: a worker that is missing, or another, is told of", "[cad]") {
  REQUIRE(cad_files().is_made());
  const auto message = [](const std::string& folder) {
    const Variable modules("VDB_OFFSET_MODULES", folder);
    try {
      open_cad("cone.brep");
    } catch (const ReadError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK_THAT(message((cad_files().folder() / "none").string()),
             Contains("cone.brep: expected the program vdb_offset_cad, which reads it, got: ") &&
                 Contains("No such file or directory (install the whole package, or convert it first)"));
  CHECK_THAT(message(folder_with("silent", "#!/bin/sh\n")), Contains("got: one that does not start"));
  // The version is the first message: its start, its kind, its length, each of eight bytes.
  const std::string zeros = "\\000\\000\\000\\000\\000\\000\\000";
  CHECK_THAT(
      message(folder_with("older", "#!/bin/sh\nprintf 'vdbo-cad\\001" + zeros + "\\005" + zeros + "0.0.1' >&3\n")),
      Contains("got: version 0.0.1 for a program of version " VDB_OFFSET_VERSION));
}

TEST_CASE("cad: messages that are cut off or lead astray are refused", "[cad]") {
  io::CadMesh mesh;
  mesh.deflection = 0.1;
  mesh.positions = {Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)};
  mesh.triangles = {{0, 1, 2}};
  mesh.face_of = {0};
  mesh.corner_parameters.resize(3);
  mesh.corner_normals.assign(3, Vec3d(0, 0, 1));
  mesh.faces = {{"name", "layer", {{0.1, 0.2, 0.3}}, "solid", "plane", {0, 1}, {2, 3}, "left", {"left", "arm"}, 3}};
  mesh.edges = {{0, 1}};
  mesh.edge_kinds = {io::CadEdge::Sharp};
  mesh.extras = {"3 free curves"};
  mesh.remarks = {"a", "b"};
  const std::string bytes = pack(mesh);
  const io::CadMesh back = io::unpack_mesh(bytes);
  CHECK(pack(back) == bytes);
  CHECK(back.faces[0].name == "name");
  CHECK((*back.faces[0].colour)[2] == 0.3);
  CHECK(back.faces[0].instance == "left");
  CHECK(back.faces[0].body == 3);
  CHECK(back.faces[0].within == mesh.faces[0].within);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    REQUIRE_THROWS_AS(io::unpack_mesh(std::string_view(bytes).substr(0, size)), BadMessage);
  CHECK_THROWS_AS(io::unpack_mesh(bytes + "x"), BadMessage);
  const auto refused = [&](auto&& change) {
    io::CadMesh other = mesh;
    change(other);
    CHECK_THROWS_AS(io::unpack_mesh(pack(other)), BadMessage);
  };
  refused([](io::CadMesh& m) { m.triangles[0][1] = 3; });
  refused([](io::CadMesh& m) { m.face_of[0] = 1; });
  refused([](io::CadMesh& m) { m.corner_normals.pop_back(); });
  refused([](io::CadMesh& m) { m.positions[0][1] = std::nan(""); });
  refused([](io::CadMesh& m) { m.edges[0] = {1, 0}; });
  refused([](io::CadMesh& m) { m.edges[0] = {1, 3}; });
  refused([](io::CadMesh& m) { m.edge_kinds.clear(); });
  refused([](io::CadMesh& m) { m.unit_micrometres = 0; });
}
