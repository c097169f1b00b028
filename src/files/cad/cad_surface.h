// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "cad/cad_worker.h"
#include "messages/cad_mesh.h"
#include "vdb_offset/polygons.h"

namespace vdb_offset::io {

/// The surface of a CAD model, which OpenCASCADE's worker knows.
class CadSurface : public ExactSurface {
 public:
  CadSurface(std::shared_ptr<const CadMesh> mesh, CadWorker worker);

  std::span<const Vec3d> corner_normals() const override { return mesh_->corner_normals; }
  std::span<const std::uint32_t> piece_of_face() const override { return piece_of_face_; }
  double deflection() const override { return mesh_->deflection; }
  void bring_to_distances(std::span<const std::uint32_t> vertices, std::span<const double> distances,
                          std::span<const double> at_corner, std::span<Vec3d> points) const override;
  std::vector<double> distance_errors(std::span<const std::uint32_t> vertices, std::span<const double> distances,
                                      std::span<const double> at_corner, std::span<const Vec3d> points) const override;
  std::vector<double> distance_errors_near(std::span<const std::uint32_t> faces, std::span<const Vec3d> feet,
                                           std::span<const double> distances,
                                           std::span<const Vec3d> points) const override;

  const CadMesh& mesh() const { return *mesh_; }
  CadWritten write(WriteCad write, const ProgressCallback& progress) const;

 private:
  /// Where a vertex is on one of its faces.
  struct Place {
    std::uint32_t face;
    std::array<double, 2> parameters;
    std::uint32_t corner;  // of the mesh
  };

  void find_pieces();
  void find_places();
  std::span<const Place> places_of(std::uint32_t vertex) const;

  std::shared_ptr<const CadMesh> mesh_;
  std::vector<std::uint32_t> piece_of_face_;
  std::vector<Place> places_;  // of vertex v from place_begin_[v], each face once
  std::vector<std::uint32_t> place_begin_;
  mutable std::mutex one_at_a_time_;
  mutable CadWorker worker_;
};

}  // namespace vdb_offset::io
