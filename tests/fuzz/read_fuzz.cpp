// SPDX-License-Identifier: Apache-2.0
// A libFuzzer target for one format, FUZZ_FORMAT: whatever the bytes are, they are refused with InvalidInput or are a
// mesh that keeps the promises of io/mesh_file.h. What else is thrown ends the process, as do the sanitizers.

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "document/rows.h"
#include "fuzz/promise.h"
#include "ground/numbers/rounding.h"
#include "ply/ply_header.h"
#include "support/splitter.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;

namespace {

constexpr io::Format kFormat = io::Format::FUZZ_FORMAT;

const std::string& file_name() {
  static const std::string name = std::string("fuzz.") + io::name(kFormat);
  return name;
}

std::optional<io::MeshFile> parsed(const std::string& bytes) {
  try {
    return io::parse_mesh(file_name(), kFormat, bytes);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

io::MeshFile parsed_again(const std::string& bytes) {
  std::optional<io::MeshFile> file = parsed(bytes);
  require(file.has_value(), "what was written can be read");
  return *std::move(file);
}

void check_mesh(const io::MeshFile& file) {
  const Polygons& mesh = file.polygons;
  require(!mesh.face_begin.empty() && mesh.face_begin.front() == 0, "face_begin starts with 0");
  require(mesh.face_begin.back() == mesh.corners.size(), "face_begin ends with the number of corners");
  require(mesh.face_count() > 0, "a mesh has a face");
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    require(mesh.face_begin[f] < mesh.face_begin[f + 1] && mesh.face_begin[f + 1] - mesh.face_begin[f] >= 3,
            "a face has three corners");
  for (const auto v : mesh.corners) require(v < mesh.positions.size(), "corners are indices of vertices");
  for (const Vec3d& p : mesh.positions)
    for (int k = 0; k < 3; ++k) require(std::isfinite(p[k]), "coordinates are finite");

  require(!io::has_rows(file) || io::rows_of(file).position_at.size() == mesh.positions.size(),
          "every vertex has its byte offset in the file");
  require(io::has_rows(file) || file.normal_count == 0 || file.normal_count == mesh.positions.size(),
          "a document has a normal for each vertex, or none");
  if (!io::has_rows(file)) return;
  const std::vector<std::uint32_t>& normal = io::rows_of(file).corner_normal;
  require(normal.empty() || normal.size() == mesh.corners.size(), "one normal a corner");
  for (const auto n : normal)
    require(n == io::kNoNormal || n < file.normal_count, "corner_normal holds indices of normals");
}

void require_same_topology(const io::MeshFile& a, const io::MeshFile& b) {
  require(a.polygons.positions.size() == b.polygons.positions.size(), "the number of vertices stays");
  require(a.polygons.corners == b.polygons.corners, "corners stay");
  require(a.polygons.face_begin == b.polygons.face_begin, "faces stay");
  require(!io::has_rows(a) || io::rows_of(a).corner_normal == io::rows_of(b).corner_normal,
          "the corners' normals stay");
  require(a.normal_count == b.normal_count, "the number of normals stays");
  require(a.encoding == b.encoding, "the encoding stays");
  require(a.extras == b.extras, "what else the file holds stays");
}

/// Writes the mesh with these positions and reads it again.
void check_moved(const io::MeshFile& file, const std::vector<Vec3d>& positions) {
  std::vector<Vec3d> kept;
  for (std::size_t v = 0; v < positions.size(); ++v)
    kept.push_back(Rounding(file.precision)(file.polygons.positions[v], positions[v]));
  // A frame of the file may be so small or large that it cannot hold them.
  if (!std::all_of(kept.begin(), kept.end(), [](const Vec3d& p) { return p.isFinite(); })) return;
  const std::string bytes = io::patched_bytes(file, positions);
  const io::MeshFile back = parsed_again(bytes);
  check_mesh(back);
  require_same_topology(file, back);

  for (std::size_t v = 0; v < positions.size(); ++v)
    require(back.polygons.positions[v] == kept[v], "positions are those that were written");
  require(io::patched_bytes(back, back.polygons.positions) == bytes, "what was written is written again as it is");

  if (file.precision.frames) return;  // of which numbers need not be the same after a way to and fro
  // Numbers of other lengths than the first time, normals that were computed before.
  const io::MeshFile home = parsed_again(io::patched_bytes(back, file.polygons.positions));
  require_same_topology(file, home);
  require(home.polygons.positions == file.polygons.positions, "vertices can be moved back");
}

/// The properties of a PLY file's vertices: refused, or finite numbers, one for each.
void check_properties(const io::MeshFile& file) {
  if (kFormat != io::Format::Ply) return;
  const io::ply::Header header = io::ply::read_header(file);
  for (const io::ply::Property& property : io::ply::find(header, "vertex")->properties) {
    try {
      const std::vector<double> numbers = io::vertex_property(file, property.name);
      require(numbers.size() == file.polygons.positions.size(), "one number a vertex");
      for (const double number : numbers) require(std::isfinite(number), "properties are finite");
    } catch (const InvalidInput&) {
      continue;
    }
  }
}

/// Splits the longest face, and faces on the other sides of its first two edges. The refined file holds the refinement,
/// or this throws.
void check_refined(const io::MeshFile& file) {
  const PolygonView mesh = file.polygons.view();
  std::uint32_t longest = 0;
  for (std::uint32_t f = 1; f < mesh.face_count(); ++f)
    if (mesh.face(f).size() > mesh.face(longest).size()) longest = f;
  const auto face = mesh.face(longest);
  const Refinement refinement = Splitter(file).edge(face[0], face[1]).edge(face[1], face[2]).inside(longest).run();
  const io::RefinedFile refined = io::refine_file(file, refinement);
  check_mesh(refined.file);
  require(!io::has_rows(file) || refined.file.encoding == file.encoding, "the encoding stays");
  require(io::rows_of(refined.file).has_carriage_returns ||
              io::patched_bytes(refined.file, refined.file.polygons.positions) == refined.file.text(),
          "a refined mesh that is not moved keeps every byte");
  io::read_attributes(refined.file);
}

/// Takes a few lines away, copies or moves them: what single bytes seldom come to, such as a second element of a name.
/// False if nothing was done.
bool mutate_lines(std::string& text, std::minstd_rand& random) {
  std::vector<std::size_t> starts{0};
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') starts.push_back(i + 1);
  if (starts.size() < 2) return false;
  const auto any = [&](std::size_t count) { return random() % count; };
  const std::size_t lines = starts.size() - 1, first = any(lines), last = std::min(lines, first + 1 + any(4));
  const std::string run = text.substr(starts[first], starts[last] - starts[first]);
  const bool removes = any(3) == 0, inserts = !removes || any(2) == 0;
  if (inserts) text.insert(starts[any(starts.size())], run);
  if (removes) text.erase(text.find(run), run.size());
  return true;
}

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  std::minstd_rand random(seed);
  std::string text(reinterpret_cast<const char*>(data), size);
  if (random() % 4 != 0 || !mutate_lines(text, random) || text.empty() || text.size() > most)
    return LLVMFuzzerMutate(data, size, most);
  std::copy(text.begin(), text.end(), data);
  return text.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // Small inputs are not worth a second thread; the result is the same.
  static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const std::optional<io::MeshFile> file = parsed(bytes);
  if (!file) return 0;
  check_mesh(*file);
  check_properties(*file);
  require(io::patched_bytes(*file, file->polygons.positions) == bytes, "an unmoved mesh keeps every byte");

  std::vector<Vec3d> shifted = file->polygons.positions, turned = file->polygons.positions;
  for (Vec3d& p : shifted) p += Vec3d(1.0);
  check_moved(*file, shifted);
  // Coordinates of all digits, and faces that turn; nothing becomes larger than it was, so that it can be stored.
  for (Vec3d& p : turned) p = Vec3d(-p[2] / 3, p[0] / 7, p[1]);
  check_moved(*file, turned);
  check_refined(*file);
  return 0;
}
