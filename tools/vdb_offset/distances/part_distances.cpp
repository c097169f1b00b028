// SPDX-License-Identifier: Apache-2.0
#include "distances/part_distances.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "distances/evaluate.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

/// What is asked of all, then what is asked of parts.
std::vector<const DistanceRequest*> rules_of(const Job& job, const DistanceRequest& asked) {
  std::vector<const DistanceRequest*> rules{&asked};
  for (const PartDistance& each : job.request.distances_of) rules.push_back(&each.distance);
  return rules;
}

/// Of each face of the mesh which of the rules is its own: the last that names it.
std::vector<std::uint32_t> rule_of_faces(const Job& job) {
  std::vector<std::uint32_t> rule_of(job.source.view().face_count(), 0);
  std::uint32_t number = 0;
  for (const PartDistance& each : job.request.distances_of) {
    ++number;
    const std::vector<std::uint8_t> named = io::select_faces(*job.source.file, std::span(&each.part, 1));
    for (std::size_t f = 0; f < named.size(); ++f)
      if (named[f]) rule_of[f] = number;
  }
  return rule_of;
}

bool uses_texture(const DistanceRequest& rule) {
  return rule.distance.expression && rule.distance.expression->uses_texture();
}

double blend_of(const Job& job) {
  const GivenDistance& blend = job.request.blend;
  return blend.in_world_units(blend.percent ? used_diagonal(job.source.view()) : 0);
}

/// What expressions need at the corners of faces.
class CornerVariables {
 public:
  CornerVariables(const Job& job, std::span<const DistanceRequest* const> rules) : mesh_(job.source.view()) {
    const auto any = [&](auto&& uses) {
      return std::any_of(rules.begin(), rules.end(), [&](const DistanceRequest* rule) {
        return rule->distance.expression && uses(*rule->distance.expression);
      });
    };
    if (any([](const DistanceExpression& e) { return e.uses_normals(); })) find_normals(job);
    if (any([](const DistanceExpression& e) { return e.uses_texture(); })) find_texture(*job.source.file);
    if (any([](const DistanceExpression& e) { return e.uses_edges(); })) edges_ = mean_edges(mesh_, job.options.weld);
    if (any([](const DistanceExpression& e) { return e.is_percent(); })) diagonal_ = used_diagonal(mesh_);
  }

  double diagonal() const { return diagonal_; }
  PointVariables operator()(std::size_t corner) const {
    const std::uint32_t v = mesh_.corners[corner];
    PointVariables at{.position = mesh_.positions[v]};
    if (!corner_normals_.empty()) at.normal = corner_normals_[corner];
    else if (!vertex_normals_.empty()) at.normal = vertex_normals_[v];
    if (!texture_.empty()) at.texture = texture_[corner];
    if (!edges_.empty()) at.edge = edges_[v];
    return at;
  }

 private:
  void find_normals(const Job& job) {
    if (job.source.file->exact) corner_normals_ = job.source.file->exact->corner_normals();
    else vertex_normals_ = vertex_normals(mesh_, job.options.weld, job.options.orient);
  }

  void find_texture(const io::MeshFile& file) {
    const io::CornerValues<Vec2d> texture = io::read_attributes(file).texture;
    if (texture.empty())
      throw InvalidInput(file.path + ": expected texture coordinates, which the distance uses (u, v), found none");
    for (std::size_t c = 0; c < mesh_.corners.size(); ++c) {
      const std::uint32_t at = texture.index(c, mesh_.corners[c]);
      if (at == io::kNoNormal)
        throw InvalidInput(fmt::format(
            "{}: expected texture coordinates, which the distance uses (u, v), at all corners, found none at vertex {}",
            file.path, mesh_.corners[c]));
      texture_.push_back(texture.value[at]);
    }
  }

  PolygonView mesh_;
  std::span<const Vec3d> corner_normals_;
  std::vector<Vec3d> vertex_normals_;
  std::vector<Vec2d> texture_;
  std::vector<double> edges_;
  double diagonal_ = 0;
};

/// What a rule asks of the corners of those faces that it is the rule of.
void add_corners(const Job& job, const DistanceRequest& rule, std::uint32_t number,
                 std::span<const std::uint32_t> rule_of, const CornerVariables& variables,
                 std::vector<double>& at_corner) {
  const PolygonView mesh = job.source.view();
  const auto for_each_corner = [&](auto&& distance_at) {
    for (std::size_t f = 0; f < rule_of.size(); ++f)
      for (std::size_t c = mesh.face_begin[f]; rule_of[f] == number && c < mesh.face_begin[f + 1]; ++c)
        at_corner[c] = distance_at(c);
  };
  if (rule.distance.expression) {
    const auto at_point = rule.distance.expression->at_points(variables.diagonal());
    for_each_corner([&](std::size_t c) { return at_point(variables(c)); });
  } else {
    const Distances of_vertices = evaluate(job, rule);
    for_each_corner([&](std::size_t c) { return of_vertices[mesh.corners[c]]; });
  }
}

}  // namespace

bool are_of_parts(const Job& job, const DistanceRequest& asked) {
  const bool is_cad = job.source.file && job.source.file->exact;
  return !job.request.distances_of.empty() || (is_cad && uses_texture(asked));
}

Distances distances_of_parts(const Job& job, const DistanceRequest& asked) {
  const io::MeshFile& file = *job.source.file;
  const std::vector<const DistanceRequest*> rules = rules_of(job, asked);
  FaceDistances faces;
  faces.part = rule_of_faces(job);
  faces.at_corner.resize(file.polygons.corners.size());
  const CornerVariables variables(job, rules);
  for (std::uint32_t k = 0; k < rules.size(); ++k)
    add_corners(job, *rules[k], k, faces.part, variables, faces.at_corner);
  const auto model_face = io::cad_face_of(file);
  // Each face of a CAD model has a u and a v of its own.
  for (std::size_t f = 0; f < model_face.size(); ++f)
    if (uses_texture(*rules[faces.part[f]])) faces.part[f] = static_cast<std::uint32_t>(rules.size()) + model_face[f];
  if (file.exact) faces.piece.assign(file.exact->piece_of_face().begin(), file.exact->piece_of_face().end());
  faces.blend = blend_of(job);
  return vertex_distances(file.polygons.view(), faces);
}

io::CadDistances cad_distances(const Job& job, const DistanceRequest& asked, const Distances& of_vertices) {
  io::CadDistances distances;
  const double diagonal = used_diagonal(job.source.view());
  for (const DistanceRequest* const rule : rules_of(job, asked)) {
    if (!rule->from.empty())
      throw InvalidInput(
          fmt::format("{}: expected a number or an expression, for an output that is a CAD model, got '{}'",
                      job.request.output, rule->text));
    if (rule->distance.expression && rule->distance.expression->uses_edges())
      throw InvalidInput(
          fmt::format("{}: expected a distance without 'edge', for an output that is a CAD model, got '{}'",
                      job.request.output, rule->text));
    if (rule->distance.expression) distances.each.push_back({0, rule->distance.expression});
    else distances.each.push_back({rule->distance.in_world_units(diagonal), {}});
  }
  if (!job.request.distances_of.empty()) distances.of_face = rule_of_faces(job);
  distances.scale = of_vertices.scale();
  for (const io::CadDistance& each : distances.each) distances.scale = std::max(distances.scale, std::abs(each.number));
  if (distances.scale == 0)
    throw InvalidInput(job.request.output +
                       ": expected a distance other than 0, for an output that is a CAD model, got 0");
  distances.diagonal = diagonal;
  distances.blend = blend_of(job);
  return distances;
}

}  // namespace vdb_offset::tool
