// SPDX-License-Identifier: Apache-2.0
// Writes what became of each vertex: its state, the distance asked for and the distance found. By its ending the file
// is a table (CSV, numbers with all their digits), or the mesh for a viewer to colour: PLY, binary in this machine's
// byte order, or VTK's .vtp, which also has shares, errors, faults and groups, and the words for numbers. In PLY and
// .vtp distances are in single precision, and a share is NaN where nothing was asked. Paths of vertices become lines of
// a .vtp with a line's vertex, state and distances; a vertex that stays has none. Vertices keep their order and number.
// Nothing is measured here.
#include "vdb_offset/io/view_file.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>

#include "states/vtp.h"
#include "vdb_offset/output_files.h"

namespace vdb_offset::io {
namespace {

std::vector<std::string> state_words() {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < kVertexStateCount; ++i) words.emplace_back(name(static_cast<VertexState>(i)));
  return words;
}

/// "0 reached", "1 collision" ...
std::vector<std::string> numbered_states() {
  std::vector<std::string> words = state_words();
  for (std::size_t i = 0; i < words.size(); ++i) words[i] = fmt::format("{} {}", i, words[i]);
  return words;
}

std::string as_csv(const VertexStates& states) {
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "vertex,state,target,achieved\n");
  for (std::size_t v = 0; v < states.state.size(); ++v)
    fmt::format_to(std::back_inserter(text), "{},{},{},{}\n", v, name(states.state[v]), states.target[v],
                   states.achieved[v]);
  return fmt::to_string(text);
}

template <class Number>
void append(std::string& bytes, Number number) {
  char raw[sizeof number];
  std::memcpy(raw, &number, sizeof number);
  bytes.append(raw, sizeof number);
}

std::string as_ply(PolygonView mesh, const VertexStates& states) {
  std::string bytes = fmt::format(
      "ply\nformat binary_{}_endian 1.0\ncomment state: {}\n"
      "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
      "property uchar state\nproperty float target\nproperty float achieved\n"
      "element face {}\nproperty list int int vertex_indices\nend_header\n",
      std::endian::native == std::endian::little ? "little" : "big", fmt::join(numbered_states(), ", "),
      mesh.positions.size(), mesh.face_count());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    for (int k = 0; k < 3; ++k) append(bytes, mesh.positions[v][k]);
    append(bytes, states.state[v]);
    append(bytes, static_cast<float>(states.target[v]));
    append(bytes, static_cast<float>(states.achieved[v]));
  }
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    append(bytes, static_cast<std::int32_t>(mesh.face(f).size()));
    for (const auto v : mesh.face(f)) append(bytes, static_cast<std::int32_t>(v));
  }
  return bytes;
}

/// States or faults as numbers of a file. A view: these outlive it.
template <class Word>
std::span<const std::uint8_t> as_numbers(std::span<const Word> words) {
  static_assert(sizeof(Word) == 1);
  return {reinterpret_cast<const std::uint8_t*>(words.data()), words.size()};
}

std::vector<std::string> fault_words() {
  std::vector<std::string> words;
  for (std::size_t f = 0; f < kFaceFaultCount; ++f) words.emplace_back(name(static_cast<FaceFault>(f)));
  return words;
}

void write_states_vtp(const std::string& path, PolygonView mesh, const VertexStates& states, const ResultFaces& faces) {
  const std::size_t count = states.state.size();
  std::vector<float> share(count), achieved(count), target(count);
  for (std::size_t v = 0; v < count; ++v) {
    achieved[v] = static_cast<float>(states.achieved[v]);
    target[v] = static_cast<float>(states.target[v]);
    share[v] = states.target[v] == 0 ? std::numeric_limits<float>::quiet_NaN()
                                     : static_cast<float>(states.achieved[v] / std::abs(states.target[v]));
  }
  VtpData data{.cells = mesh,
               .are_lines = faces.are_curves,
               .of_points = {{"share", std::span<const float>(share)},
                             {"state", as_numbers(states.state)},
                             {"achieved", std::span<const float>(achieved)},
                             {"target", std::span<const float>(target)}},
               .of_cells = {},
               .words = {{"state_words", state_words()}}};
  if (!faces.error.empty()) data.of_cells.push_back({"face_error", faces.error});
  if (!faces.fault.empty()) {
    data.of_cells.push_back({"fault", as_numbers(faces.fault)});
    data.words.push_back({"fault_words", fault_words()});
  }
  if (faces.groups && !faces.groups->of_face.empty()) {
    data.of_cells.push_back({"group", std::span<const std::uint32_t>(faces.groups->of_face)});
    data.words.push_back({"group_words", faces.groups->names});
  }
  write_vtp(path, data);
}

}  // namespace

bool is_states_file(const std::string& path) {
  return path.ends_with(".csv") || path.ends_with(".ply") || path.ends_with(".vtp");
}

void write_states(const std::string& path, PolygonView mesh, const VertexStates& states, const ResultFaces& faces) {
  if (path.ends_with(".vtp")) write_states_vtp(path, mesh, states, faces);
  else write_file(path, path.ends_with(".csv") ? as_csv(states) : as_ply(mesh, states));
}

bool is_lines_file(const std::string& path) { return path.ends_with(".vtp"); }

void write_path_lines(const std::string& path, const std::vector<std::vector<Vec3d>>& paths,
                      const VertexStates& states) {
  Polygons lines;
  std::vector<std::uint8_t> state;
  std::vector<std::uint32_t> vertex;
  std::vector<float> achieved, target;
  for (std::uint32_t v = 0; v < paths.size(); ++v) {
    if (paths[v].size() < 2) continue;  // a vertex that stays has no path
    for (const Vec3d& position : paths[v]) {
      lines.corners.push_back(static_cast<std::uint32_t>(lines.positions.size()));
      lines.positions.push_back(position);
    }
    lines.close_face();
    state.push_back(static_cast<std::uint8_t>(states.state[v]));
    achieved.push_back(static_cast<float>(states.achieved[v]));
    target.push_back(static_cast<float>(states.target[v]));
    vertex.push_back(v);
  }
  write_vtp(path, {.cells = lines.view(),
                   .are_lines = true,
                   .of_points = {},
                   .of_cells = {{"state", std::span<const std::uint8_t>(state)},
                                {"achieved", std::span<const float>(achieved)},
                                {"target", std::span<const float>(target)},
                                {"vertex", std::span<const std::uint32_t>(vertex)}},
                   .words = {{"state_words", state_words()}}});
}

}  // namespace vdb_offset::io
