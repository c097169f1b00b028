// SPDX-License-Identifier: Apache-2.0
#include "body_meshes.h"

#include <algorithm>
#include <map>
#include <utility>

#include "vdb_offset/io/cad_file.h"

namespace vdb_offset::tool {
namespace {

/// Some faces of a mesh as a mesh, with the model's surface under them.
class PartOfSurface : public ExactSurface {
 public:
  PartOfSurface(const ExactSurface& whole, PolygonView mesh, std::vector<std::uint32_t> faces)
      : whole_(whole), all_corners_(mesh.corners.size()), faces_(std::move(faces)) {
    std::map<std::uint32_t, std::uint32_t> numbers;
    for (const std::uint32_t f : faces_) {
      for (std::size_t c = mesh.face_begin[f]; c < mesh.face_begin[f + 1]; ++c) {
        const auto [at, is_new] = numbers.try_emplace(mesh.corners[c], static_cast<std::uint32_t>(vertices_.size()));
        if (is_new) vertices_.push_back(mesh.corners[c]);
        polygons_.corners.push_back(at->second);
        corners_.push_back(c);
        normals_.push_back(whole.corner_normals()[c]);
      }
      polygons_.close_face();
      pieces_.push_back(whole.piece_of_face()[f]);
    }
    for (const std::uint32_t v : vertices_) polygons_.positions.push_back(mesh.positions[v]);
  }

  const Polygons& polygons() const { return polygons_; }
  // Numbers of the whole.
  const std::vector<std::uint32_t>& vertices() const { return vertices_; }
  const std::vector<std::size_t>& corners() const { return corners_; }
  const std::vector<std::uint32_t>& faces() const { return faces_; }

  std::span<const Vec3d> corner_normals() const override { return normals_; }
  std::span<const std::uint32_t> piece_of_face() const override { return pieces_; }
  double deflection() const override { return whole_.deflection(); }
  void bring_to_distances(std::span<const std::uint32_t> vertices, std::span<const double> distances,
                          std::span<const double> at_corner, std::span<Vec3d> points) const override {
    whole_.bring_to_distances(of_whole(vertices, vertices_), distances, at_corners(at_corner), points);
  }
  std::vector<double> distance_errors(std::span<const std::uint32_t> vertices, std::span<const double> distances,
                                      std::span<const double> at_corner, std::span<const Vec3d> points) const override {
    return whole_.distance_errors(of_whole(vertices, vertices_), distances, at_corners(at_corner), points);
  }
  std::vector<double> distance_errors_near(std::span<const std::uint32_t> faces, std::span<const Vec3d> feet,
                                           std::span<const double> distances,
                                           std::span<const Vec3d> points) const override {
    return whole_.distance_errors_near(of_whole(faces, faces_), feet, distances, points);
  }

 private:
  static std::vector<std::uint32_t> of_whole(std::span<const std::uint32_t> numbers,
                                             const std::vector<std::uint32_t>& known) {
    std::vector<std::uint32_t> all;
    all.reserve(numbers.size());
    for (const std::uint32_t each : numbers) all.push_back(known[each]);
    return all;
  }

  std::vector<double> at_corners(std::span<const double> at_corner) const {
    std::vector<double> all(at_corner.empty() ? 0 : all_corners_);
    for (std::size_t c = 0; c < at_corner.size(); ++c) all[corners_[c]] = at_corner[c];
    return all;
  }

  const ExactSurface& whole_;
  std::size_t all_corners_;
  std::vector<std::uint32_t> faces_, vertices_, pieces_;
  std::vector<std::size_t> corners_;  // of the whole
  std::vector<Vec3d> normals_;
  Polygons polygons_;
};

/// Moves the vertices of a body to its offset.
void offset_body(const Job& job, const Distances& distances, const PartOfSurface& body, std::vector<Vec3d>& positions) {
  OffsetOptions options = job.options;
  options.exact = &body;
  options.keep_field = options.keep_paths = options.keep_face_errors = false;
  options.progress = {};
  options.distance = distances;
  if (!distances.uniform()) {
    std::vector<double> of_vertices;
    for (const std::uint32_t v : body.vertices()) of_vertices.push_back(distances[v]);
    std::vector<double> at_corner;
    if (!distances.at_corner().empty())
      for (const std::size_t c : body.corners()) at_corner.push_back(distances.at_corner()[c]);
    options.distance = Distances(std::move(of_vertices), std::move(at_corner));
  }
  options.only.clear();
  if (!job.options.only.empty())
    for (const std::uint32_t f : body.faces()) options.only.push_back(job.options.only[f]);
  const OffsetResult made = offset(body.polygons().view(), options);
  for (std::size_t v = 0; v < made.positions.size(); ++v) positions[body.vertices()[v]] = made.positions[v];
}

}  // namespace

std::vector<Vec3d> offset_bodies(const Job& job, const Distances& distances, const OffsetResult& whole) {
  std::vector<Vec3d> positions = whole.positions;
  const PolygonView mesh = job.source.view();
  std::map<std::uint32_t, std::vector<std::uint32_t>> bodies;
  const std::vector<std::uint32_t> body_of = io::cad_body_of(*job.source.file);
  for (std::uint32_t f = 0; f < body_of.size(); ++f) bodies[body_of[f]].push_back(f);
  if (bodies.size() < 2) return positions;
  for (auto& [number, faces] : bodies) {
    const PartOfSurface body(*job.source.file->exact, mesh, std::move(faces));
    const auto is_offset = [&](std::uint32_t f) { return job.options.only.empty() || job.options.only[f] != 0; };
    const auto falls_short_here = [&](std::uint32_t v) { return falls_short(whole.states[v]); };
    if (std::any_of(body.faces().begin(), body.faces().end(), is_offset) &&
        std::any_of(body.vertices().begin(), body.vertices().end(), falls_short_here))
      offset_body(job, distances, body, positions);
  }
  return positions;
}

}  // namespace vdb_offset::tool
