// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "ground/distances/in_metric.h"
#include "products/offset/make_results.h"
#include "products/offset/prepared_mesh.h"
#include "products/offset/vertex_targets.h"
#include "products/tolerance/refined_triangles.h"
#include "products/tolerance/refiner.h"
#include "vdb_offset/options.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// Two faces of a mesh, the lower number first.
using FacePair = std::pair<std::uint32_t, std::uint32_t>;

/// A mesh with its faces split, which is offset like any other, with its vertices at their targets.
class RefinedMesh {
 public:
  /// Keeps a reference to the mesh that the triangles are of. `options` are those of the mesh, `precision` that
  /// which vertices were rounded to when they were added.
  /// \param yield that of the mesh
  /// \param crosses_nothing the mesh is known not to cross itself
  /// \param met pairs of the mesh's faces that meet in it, or in its offset without any splits: their pieces may
  RefinedMesh(const RefinedTriangles& triangles, PolygonView mesh, const OffsetOptions& options,
              const Rounding& precision, int threads, const Yield& yield, bool crosses_nothing,
              std::span<const FacePair> met);
  RefinedMesh(const RefinedMesh&) = delete;
  RefinedMesh& operator=(const RefinedMesh&) = delete;

  /// The triangles that would be faulty, or have a misplaced vertex; each once.
  std::vector<std::uint32_t> faulty_triangles(const std::vector<RefinedVertex>& vertices);
  /// The offset, made valid. May be called once.
  OffsetResult offset(const std::vector<RefinedVertex>& vertices);

  /// For each vertex of the triangles one of those that it is in the refinement; kNone for an obstacle's.
  const std::vector<std::uint32_t>& numbers() const { return numbers_.of_vertex; }
  Refinement take_refinement() { return std::move(refinement_); }

 private:
  void prepare(const std::vector<RefinedVertex>& vertices);
  bool has_met(std::uint32_t face, std::uint32_t other) const;

  PolygonView mesh_;
  OffsetOptions options_;
  const Rounding precision_;
  int threads_;
  Yield yield_;
  bool crosses_nothing_;
  std::span<const FacePair> met_;
  RefinedTriangles::Numbers numbers_;
  std::vector<std::uint32_t> triangle_of_face_;
  Refinement refinement_;
  std::optional<InMetric> space_;
  std::optional<PreparedMesh> prepared_;
  std::optional<AskedDistances> asked_;
  std::vector<PreparedMesh::Marched> marched_;
};

}  // namespace vdb_offset
