// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "ground/system/progress_count.h"
#include "space/query/closest_query.h"
#include "valid/proof/offset_prover.h"
#include "vdb_offset/options.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// A triangle of an offset.
struct OffsetFace {
  std::array<std::uint32_t, 3> vertex;
  /// The triangle of the surface that it lies in before it is moved; kNone: it is in none, and nothing is proven of it.
  std::uint32_t source;
};

/// What faces are proven against. Spans have a value for each vertex.
struct CertifiedMesh {
  const ClosestQuery& query;          ///< Of the moving part.
  const Surface& surface;             ///< That has the faces' triangles, in the same frame.
  std::span<const OffsetFace> faces;  ///< Those that move.
  std::span<const Vec3d> source;      ///< Positions in the source, world coordinates.
  std::span<const Vec3d> positions;   ///< In the offset, as written.
  std::span<const double> asked;      ///< World units, negative inward.
  std::span<const double> tolerance;  ///< World units.
  std::span<const VertexState> states;
  Corners corners;
  bool by_area_moved = false;  ///< Faces count by their area in the offset: those over ridges have none in the source.
};

/// A face for its proof. \pre all of its vertices are asked to go to one side
OffsetTriangle offset_triangle(const CertifiedMesh& mesh, const OffsetFace& face);

/// Tells what is proven of all faces. The result does not depend on the number of threads. \param progress told of each
/// face, if there is one
CertifiedFaces certify(const CertifiedMesh& mesh, Progress* progress = nullptr);

/// Whether a vertex gets to its distance, or to that from its own planes.
constexpr bool is_there(VertexState state) { return state == VertexState::Reached || state == VertexState::Mitered; }

}  // namespace vdb_offset
