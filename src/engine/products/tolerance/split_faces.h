// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "products/offset/prepared_mesh.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

/// What of a call is done once the mesh has been offset as it is, before faces are split. Measured: 0.1 to 0.4.
inline constexpr double kCoarseShare = 0.25;

/// How faces are split.
struct SplitFaces {
  const Tolerance& tolerance;  ///< Its precision is what vertices that are added are rounded to.
  std::size_t most_faces;      ///< No more are made, but for the pieces of faces that vertices hang on.
  int threads;
  ProgressCallback progress;  ///< Of this part of a call.
  /// The mesh is an opened one: it stands off its source, its faces over ridges come behind so many others, and all is
  /// to be at the distance.
  std::optional<std::uint32_t> before_arcs;
};

/// Splits the faces of a mesh until its offset is proven to be within a tolerance, and makes that valid.
/// \param coarse the offset of the mesh as it is \return the mesh with its faces split, and the offset of that
RefinedOffset split_faces(const PreparedMesh& prepared, const OffsetResult& coarse, const SplitFaces& asked);

}  // namespace vdb_offset
