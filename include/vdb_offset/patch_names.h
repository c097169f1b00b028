#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace vdb_offset {

/// What the parts of a mesh are called: a name for each face.
struct WallNames {
  std::vector<std::string> names;
  std::vector<std::uint32_t> of_face;  ///< Index into `names`, of each face of the input. Empty: all are "wall".
};

/// \throw InvalidInput unless each of so many faces has one of the names, or none is told of
void require_names(const WallNames& walls, std::size_t faces);

/// The names as patches of a volume mesh have them, in their order; {"wall"} if there are none. They hold ASCII
/// letters, digits and _ - . alone and start with a letter, as OpenFOAM's words and SU2's tags ask for: other
/// characters become _, and what starts otherwise has wall_ in front. Where two would be alike, or one were "outer" or
/// "sides", the later has _2, _3 ... behind it.
std::vector<std::string> patch_names(const WallNames& walls);

}  // namespace vdb_offset
