// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gltf/json.h"
#include "ground/numbers/rounding.h"

namespace vdb_offset::io::gltf {

/// Where a scene places a mesh first.
struct Placement {
  std::size_t nodes = 0;  ///< That place it.
  AffineFrame frame;
  std::string node_name;
  bool is_skinned = false;  ///< Then it has no frame of its own: its bones place it.
};

/// The placement of each mesh in the file's scene; without a scene, in the trees of all nodes.
/// \throw InvalidInput for nodes that are no trees, or a transform of a mesh that cannot be undone
std::vector<Placement> read_placements(const JsonValue& root);

}  // namespace vdb_offset::io::gltf
