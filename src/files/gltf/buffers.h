// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "gltf/container.h"
#include "gltf/json.h"
#include "vdb_offset/io/file_bytes.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io::gltf {

/// Where a file's binary data are.
struct Buffer {
  enum class In { Nowhere, Chunk, Text, File };  ///< Of a .glb; in base64 in the JSON text; beside the file.
  In in = In::Nowhere;
  std::string_view bytes;                   ///< As many as byteLength says.
  FileBytes file;                           ///< In::File: all of it.
  std::string path, uri;                    ///< In::File: where it was found; the URI.
  std::shared_ptr<const std::string> text;  ///< In::Text: decoded.
};

/// All buffers, with no more bytes than there are. Files beside are mapped.
/// \throw InvalidInput for one with fewer bytes than it says, or that is not where it says; ReadError
std::vector<Buffer> read_buffers(const MeshFile& file, const Container& container, const JsonValue& root);

}  // namespace vdb_offset::io::gltf
