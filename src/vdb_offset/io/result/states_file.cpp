// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/states_file.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <iterator>

#include "vdb_offset/output_files.h"

namespace vdb_offset::io {
namespace {

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
      "ply\nformat binary_{}_endian 1.0\ncomment state: 0 reached, 1 collision, 2 limited, 3 outside_field, 4 unused\n"
      "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
      "property uchar state\nproperty float target\nproperty float achieved\n"
      "element face {}\nproperty list int int vertex_indices\nend_header\n",
      std::endian::native == std::endian::little ? "little" : "big", mesh.positions.size(), mesh.face_count());
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

bool ends_with(const std::string& path, const char* ending) {
  const std::size_t length = std::strlen(ending);
  return path.size() >= length && path.compare(path.size() - length, length, ending) == 0;
}

}  // namespace

bool is_states_file(const std::string& path) { return ends_with(path, ".csv") || ends_with(path, ".ply"); }

void write_states(const std::string& path, PolygonView mesh, const VertexStates& states) {
  write_file(path, ends_with(path, ".csv") ? as_csv(states) : as_ply(mesh, states));
}

}  // namespace vdb_offset::io
