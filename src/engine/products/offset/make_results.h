// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "products/offset/prepared_mesh.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// What is asked of all vertices (see PreparedMesh): one set of distances for each result of a run.
struct AskedDistances {
  std::vector<Distances> asked;  ///< Means of the distances that the input's vertices are given.
  std::vector<Distances> moved;  ///< The distances that vertices are moved by: 0 at junctions, else those asked for.
  std::vector<std::size_t> disagreeing;  ///< Of each result: input vertices with another distance than is asked for.
  /// Of each vertex of the moving part: 1 if it is at a junction. Empty if none is, or if no shell is made of the
  /// results.
  std::vector<std::uint8_t> junctions;
};
AskedDistances ask(const PreparedMesh& mesh, std::span<const Distances> of_input);

/// Makes a result of each set of paths: valid, with Collision::Limit, and with all its figures.
///
/// A few results are made at the same time. With Collision::Limit those that others begin with (see find_warm_starts())
/// go first; and with `inner_skin_last` the last of all before them, since the others keep off it. The results do not
/// depend on the number of threads.
/// \param marched of each result; used up
std::vector<OffsetResult> make_results(const PreparedMesh& mesh, const AskedDistances& distances,
                                       std::vector<PreparedMesh::Marched> marched);

}  // namespace vdb_offset
