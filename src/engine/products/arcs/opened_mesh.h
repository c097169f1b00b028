// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "products/arcs/opened_source.h"
#include "products/offset/field_stage.h"
#include "products/offset/prepared_mesh.h"
#include "products/offset/vertex_targets.h"
#include "vdb_offset/distances.h"

namespace vdb_offset {

/// An opened source as a mesh of its own, whose vertices are about to go to their targets. It stands a tiny share of
/// the way off the source, as faces without an area say nothing about where they are crossed; distances are the same
/// there to that share.
class OpenedMesh {
 public:
  /// Keeps a reference to the source. \param distances of the source's input, for each vertex or for all
  OpenedMesh(const PreparedMesh& source, const OpenedSource::Faces& faces, std::span<const Distances> distances,
             const Yield& yield, int threads);
  OpenedMesh(const OpenedMesh&) = delete;
  OpenedMesh& operator=(const OpenedMesh&) = delete;

  PreparedMesh& prepared() { return *prepared_; }
  const PreparedMesh& prepared() const { return *prepared_; }
  /// Of its vertices, as many sets as were given.
  std::span<const Distances> distances() const { return distances_; }
  const VertexTargets& targets() const { return targets_; }

 private:
  Polygons polygons_;
  OffsetOptions options_;
  std::vector<Distances> distances_;
  VertexTargets targets_;
  std::optional<InMetric> space_;
  std::optional<PreparedMesh> prepared_;
};

/// Of each vertex of an opened mesh: the source's that it is a copy of.
std::vector<std::uint32_t> origins_of(const Refinement& refinement);

/// The mesh of an opened source, with ridges left closed where their strips would be in each other's way at any
/// distance; nullptr if no ridge is opened then. Parameters as those of OpenedMesh.
/// \param faces receives the opened source's faces
std::unique_ptr<OpenedMesh> open_without_tangles(const PreparedMesh& source, OpenedSource& opened,
                                                 std::span<const Distances> distances, const Yield& yield, int threads,
                                                 OpenedSource::Faces& faces);

}  // namespace vdb_offset
