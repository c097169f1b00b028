// SPDX-License-Identifier: Apache-2.0
#include "cad/cad_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "ground/numbers/disjoint_sets.h"

namespace vdb_offset::io {

CadSurface::CadSurface(std::shared_ptr<const CadMesh> mesh, CadWorker worker)
    : mesh_(std::move(mesh)), worker_(std::move(worker)) {
  find_pieces();
  find_places();
}

/// Joins the model's faces across edges where they are tangent.
void CadSurface::find_pieces() {
  DisjointSets joined(mesh_->faces.size());
  // The two triangles at each tangent edge are found by its vertices.
  std::vector<std::pair<std::array<std::uint32_t, 2>, std::uint32_t>> faces_at;
  for (std::size_t t = 0; t < mesh_->triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh_->triangles[t][k], b = mesh_->triangles[t][(k + 1) % 3];
      const std::array edge{std::min(a, b), std::max(a, b)};
      const auto at = std::lower_bound(mesh_->edges.begin(), mesh_->edges.end(), edge);
      if (at == mesh_->edges.end() || *at != edge) continue;
      if (mesh_->edge_kinds[static_cast<std::size_t>(at - mesh_->edges.begin())] == CadEdge::Tangent)
        faces_at.emplace_back(edge, mesh_->face_of[t]);
    }
  std::sort(faces_at.begin(), faces_at.end());
  for (std::size_t i = 1; i < faces_at.size(); ++i)
    if (faces_at[i].first == faces_at[i - 1].first) joined.join(faces_at[i].second, faces_at[i - 1].second);
  piece_of_face_.reserve(mesh_->face_of.size());
  for (const std::uint32_t f : mesh_->face_of) piece_of_face_.push_back(joined.first(f));
}

void CadSurface::find_places() {
  std::vector<std::pair<std::uint32_t, Place>> all;
  for (std::size_t t = 0; t < mesh_->triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      all.push_back({mesh_->triangles[t][k],
                     {mesh_->face_of[t], mesh_->corner_parameters[3 * t + k], static_cast<std::uint32_t>(3 * t + k)}});
  const auto key = [](const auto& each) { return std::pair(each.first, each.second.face); };
  std::stable_sort(all.begin(), all.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  all.erase(std::unique(all.begin(), all.end(), [&](const auto& a, const auto& b) { return key(a) == key(b); }),
            all.end());
  place_begin_.assign(mesh_->positions.size() + 1, 0);
  for (const auto& [vertex, place] : all) {
    ++place_begin_[vertex + 1];
    places_.push_back(place);
  }
  std::partial_sum(place_begin_.begin(), place_begin_.end(), place_begin_.begin());
}

std::span<const CadSurface::Place> CadSurface::places_of(std::uint32_t vertex) const {
  return std::span(places_).subspan(place_begin_[vertex], place_begin_[vertex + 1] - place_begin_[vertex]);
}

void CadSurface::bring_to_distances(std::span<const std::uint32_t> vertices, std::span<const double> distances,
                                    std::span<const double> at_corner, std::span<Vec3d> points) const {
  std::vector<CadAim> aims;
  std::vector<CadPlace> places;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto own = places_of(vertices[i]);
    aims.push_back({points[i].x(), points[i].y(), points[i].z(), std::abs(distances[i]), own.size()});
    for (const Place& place : own)
      places.push_back({place.parameters[0], place.parameters[1],
                        at_corner.empty() ? distances[i] : at_corner[place.corner], place.face});
  }
  const std::lock_guard lock(one_at_a_time_);
  const std::vector<Vec3d> ends = worker_.offset_points(aims, places);
  std::copy(ends.begin(), ends.end(), points.begin());
}

std::vector<double> CadSurface::distance_errors(std::span<const std::uint32_t> vertices,
                                                std::span<const double> distances, std::span<const double> at_corner,
                                                std::span<const Vec3d> points) const {
  std::vector<CadPoint> of_faces;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (const Place& place : places_of(vertices[i]))
      of_faces.push_back({points[i].x(), points[i].y(), points[i].z(), place.parameters[0], place.parameters[1],
                          at_corner.empty() ? distances[i] : at_corner[place.corner], place.face});
  const std::lock_guard lock(one_at_a_time_);
  const std::vector<double> found = worker_.distance_errors(of_faces);
  std::vector<double> errors;
  for (std::size_t i = 0, at = 0; i < vertices.size(); ++i) {
    double most = 0;
    for (std::size_t k = 0; k < places_of(vertices[i]).size(); ++k) most = std::max(most, std::abs(found[at++]));
    errors.push_back(most);
  }
  return errors;
}

std::vector<double> CadSurface::distance_errors_near(std::span<const std::uint32_t> faces, std::span<const Vec3d> feet,
                                                     std::span<const double> distances,
                                                     std::span<const Vec3d> points) const {
  std::vector<CadPoint> of_faces;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto& corners = mesh_->triangles[faces[i]];
    const Vec3d a = mesh_->positions[corners[0]], ab = mesh_->positions[corners[1]] - a,
                ac = mesh_->positions[corners[2]] - a, normal = ab.cross(ac);
    const double twice = normal.lengthSqr();
    double weight[3] = {1, 0, 0};
    if (twice > 0) {
      weight[1] = normal.dot((feet[i] - a).cross(ac)) / twice;
      weight[2] = normal.dot(ab.cross(feet[i] - a)) / twice;
      weight[0] = 1 - weight[1] - weight[2];
    }
    double u = 0, v = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      u += weight[k] * mesh_->corner_parameters[3 * faces[i] + k][0];
      v += weight[k] * mesh_->corner_parameters[3 * faces[i] + k][1];
    }
    of_faces.push_back({points[i].x(), points[i].y(), points[i].z(), u, v, distances[i], mesh_->face_of[faces[i]]});
  }
  const std::lock_guard lock(one_at_a_time_);
  return worker_.distance_errors(of_faces);
}

CadWritten CadSurface::write(WriteCad write, const ProgressCallback& progress) const {
  const std::lock_guard lock(one_at_a_time_);
  return worker_.write(std::move(write), progress);
}

}  // namespace vdb_offset::io
