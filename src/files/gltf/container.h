// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io::gltf {

/// A file's JSON text and, of a .glb, the chunk of binary data behind it, as bytes of the file.
struct Container {
  struct Span {
    std::size_t begin = 0, size = 0;
  };
  bool is_binary = false;
  Span json;                ///< Without the blanks that fill a .glb's chunk up, and without a byte order mark.
  Span json_chunk;          ///< What the chunk holds, of a .glb.
  std::optional<Span> bin;  ///< What the second chunk of a .glb holds, if it is one of binary data.

  std::string_view json_of(std::string_view file) const { return file.substr(json.begin, json.size); }
};

/// \throw InvalidInput for a file of which the header or the first two chunks are not what they have to be
Container read_container(const MeshFile& file);

/// The header of a .glb and its JSON chunk around another text; `file` is the one that the container was read of.
/// \throw InvalidInput if the file would be larger than a .glb can be
std::string glb_head(const std::string& path, const Container& container, std::string_view file, std::string_view json);

/// A new .glb's header, its JSON chunk, and the head of the chunk of binary data, of a multiple of 4 bytes.
/// \throw InvalidInput if the file would be larger than a .glb can be
std::string glb_head(std::string json, std::size_t binary_bytes);

}  // namespace vdb_offset::io::gltf
