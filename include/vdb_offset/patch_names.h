// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "vdb_offset/api.h"

namespace vdb_offset {

/// The names of the parts of a mesh: one for each face.
struct WallNames {
  std::vector<std::string> names;
  std::vector<std::uint32_t> of_face;  ///< Index into `names`, of each face of the input. Empty: all are "wall".
};

/// \throw InvalidInput unless each of so many faces has one of the names, or no face has any
VDB_OFFSET_API void require_names(const WallNames& walls, std::size_t faces);

/// The names of the boundary patches of a volume mesh, in the order of `names`; {"wall"} if there are none. They hold
/// only ASCII letters, digits and _ - . and start with a letter, as OpenFOAM's words and SU2's tags ask for: other
/// characters become _, and a name that starts otherwise gets wall_ in front. Where two names would be equal, or one
/// would be "outer" or "sides", the later gets _2, _3 ... behind it.
VDB_OFFSET_API std::vector<std::string> patch_names(const WallNames& walls);

}  // namespace vdb_offset
