// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

/// Names some faces of a mesh.
struct Selector {
  enum class By {
    Group,     ///< OBJ: a name of a `g` or `o` line; ASCII STL: the name of a solid.
    Material,  ///< OBJ: a name of a `usemtl` line.
    File,      ///< A text file: a 0 or 1 for each face, or else the indices of faces, counted from 0.
  };
  By by;
  std::string name;
};

/// \throw InvalidOption unless the text is `group=NAME`, `material=NAME` or `faces=FILE`.
VDB_OFFSET_API Selector parse_selector(const std::string& text);

/// One number a face: 1 if any of the selectors names it. \throw InvalidOption for a name that no face has; it tells
/// those that there are. ReadError, InvalidInput for a file that cannot be read, or holds no faces of this mesh.
VDB_OFFSET_API std::vector<std::uint8_t> select_faces(const MeshFile& mesh, std::span<const Selector> selectors);

}  // namespace vdb_offset::io
