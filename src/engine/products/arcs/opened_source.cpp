// SPDX-License-Identifier: Apache-2.0
// Finds which vertices are opened, and where their copies go. The fans of all vertices on ridges are parted into
// sectors, each of which gets the point in which the planes of its faces meet. Where that is too far from the surface,
// as at the tip of a cone of many narrow faces, all convex edges of the sector are opened. Then arcs are laid between
// neighbouring sectors, and patches into the loops of arcs; what is not at its distance straight away goes along its
// ray.
#include "products/arcs/opened_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "ground/numbers/disjoint_sets.h"
#include "ground/numbers/index_set.h"
#include "ground/system/parallel.h"
#include "products/arcs/ray_ends.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

// The least bend of an edge that is opened because the vertex is too far off, in radians. Not measured: below, edges of
// flat faces are opened whose normals differ by the rounding of coordinates.
constexpr double kLeastBendAtTip = 1e-3;

using RidgeEdge = std::pair<std::uint32_t, std::uint32_t>;
RidgeEdge edge_of(const RidgeFan& fan, std::size_t i) { return std::minmax(fan.vertex, fan.across[i]); }

/// How many steps the arcs around each ridge have: as many along a whole chain of them as the sharpest one needs, so
/// that strips have the same faces from end to end.
class ChainSteps {
 public:
  ChainSteps(const RidgeFinder& finder, std::span<const OpenedVertex> vertices, double step) {
    std::vector<double> bend;
    for (const OpenedVertex& vertex : vertices)
      for (std::size_t i = 0; i < vertex.fan.is_open.size(); ++i)
        if (vertex.fan.is_open[i] && number_.try_emplace(edge_of(vertex.fan, i), bend.size()).second)
          bend.push_back(finder.bend(vertex.fan, i));
    DisjointSets chains(bend.size());
    for (const OpenedVertex& vertex : vertices) {
      std::vector<std::uint32_t> edges;
      for (std::size_t i = 0; i < vertex.fan.is_open.size(); ++i)
        if (vertex.fan.is_open[i]) edges.push_back(number_.at(edge_of(vertex.fan, i)));
      if (edges.size() == 2) chains.join(edges[0], edges[1]);
    }
    chain_ = std::move(chains).firsts();
    steps_.assign(bend.size(), 1);
    for (std::size_t e = 0; e < bend.size(); ++e)
      steps_[chain_[e]] = std::max(steps_[chain_[e]], static_cast<std::size_t>(std::ceil(bend[e] / step)));
  }

  std::size_t operator()(const RidgeFan& fan, std::size_t edge) const {
    return steps_[chain_[number_.at(edge_of(fan, edge))]];
  }

 private:
  std::map<RidgeEdge, std::uint32_t> number_;
  std::vector<std::uint32_t> chain_;
  std::vector<std::size_t> steps_;  // of the first of each chain
};

/// \throw OutOfBudget if about more faces would be made
void require_few(const ChainSteps& chains, double step, std::size_t mesh_faces, std::size_t most,
                 std::span<const OpenedVertex> vertices) {
  double count = static_cast<double>(mesh_faces);
  for (const OpenedVertex& vertex : vertices) {
    double around = 0;
    std::size_t ridges = 0;
    for (std::size_t i = 0; i < vertex.fan.is_open.size(); ++i)
      if (vertex.fan.is_open[i]) around += static_cast<double>(chains(vertex.fan, i)), ++ridges;
    count += around;  // half of two triangles a step: each strip has two ends
    // A patch is about as many rings wide as its loop goes around.
    if (ridges > 2) count += around * around * step / 2;
  }
  if (count > static_cast<double>(most))
    throw OutOfBudget(
        fmt::format("arcs: expected at most {} faces, got about {:.0f}. Use a larger tolerance, or allow "
                    "more faces",
                    most, count));
}

}  // namespace

OpenedSource::OpenedSource(const PreparedMesh& mesh, const Distances& distances, const Paths& plain, double tolerance,
                           double longest, std::size_t most_faces)
    : mesh_(mesh),
      distances_(distances),
      plain_(plain),
      tolerance_(tolerance),
      number_(mesh.surface().vertices.size(), kNone) {
  const RidgeFinder finder(mesh, distances, tolerance);
  find_vertices(finder);
  open_further(finder);
  lay(finder, most_faces);
  find_ends(longest);
}

/// Finds the vertices on ridges, and those that are too far off without one, and parts them into sectors.
void OpenedSource::find_vertices(const RidgeFinder& finder) {
  std::vector<std::optional<OpenedVertex>> found(number_.size());
  for_each_index(found.size(), [&](std::size_t w) {
    std::optional<RidgeFan> fan = finder(static_cast<std::uint32_t>(w));
    if (!fan) return;
    // A vertex that is not on a ridge may be the tip of a cone.
    const bool is_far = plain_.achieved[w] > (1 + tolerance_) * std::abs(distances_[w]);
    if (!is_far && std::count(fan->is_open.begin(), fan->is_open.end(), 1) == 0) return;
    OpenedVertex vertex{std::move(*fan), {}, {}, {}, {}};
    if (find_sectors(mesh_.surface(), vertex)) found[w] = std::move(vertex);
  });
  for (std::optional<OpenedVertex>& vertex : found)
    if (vertex) opened_.push_back(std::move(*vertex));
}

/// Opens all convex edges of sectors whose points are too far from the surface.
void OpenedSource::open_further(const RidgeFinder& finder) {
  const Surface& surface = mesh_.surface();
  std::vector<Vec3d> points;
  for (const OpenedVertex& vertex : opened_)
    for (const Vec3d& point : vertex.points)
      points.push_back(surface.vertices[vertex.fan.vertex] + point * std::abs(distances_[vertex.fan.vertex]));
  const std::vector<Closest> closest = closest_points(mesh_.query(), points);
  auto next = closest.begin();
  std::vector<OpenedVertex> kept;
  for (OpenedVertex& vertex : opened_) {
    RidgeFan& fan = vertex.fan;
    const double most = (1 + tolerance_) * std::abs(distances_[fan.vertex]);
    bool is_opened = false;
    for (std::uint32_t s = 0; s < vertex.points.size(); ++s)
      if ((next++)->distance > most)
        for (std::size_t e = 0; e < fan.triangles.size(); ++e)
          if (fan.sector[e] == s && fan.sector[fan.next(e)] == s && finder.bend(fan, e) > kLeastBendAtTip)
            fan.is_open[e] = 1, is_opened = true;
    if (is_opened) fan.part();
    if (!is_opened || find_sectors(surface, vertex)) kept.push_back(std::move(vertex));
  }
  opened_ = std::move(kept);
}

/// Lays arcs and patches, and leaves vertices out at which that is not possible.
void OpenedSource::lay(const RidgeFinder& finder, std::size_t most_faces) {
  const double step = arc_step(tolerance_);
  const ChainSteps chains(finder, opened_, step);
  require_few(chains, step, mesh_.mesh().face_count(), most_faces, opened_);
  const ArcSteps steps = [&](const RidgeFan& fan, std::size_t edge) { return chains(fan, edge); };
  std::vector<std::uint8_t> is_laid(opened_.size(), 0);
  for_each_index(opened_.size(),
                 [&](std::size_t i) { is_laid[i] = lay_arcs(mesh_.surface(), finder, steps, step, opened_[i]); });
  std::vector<OpenedVertex> kept;
  for (std::size_t i = 0; i < opened_.size(); ++i)
    if (is_laid[i]) kept.push_back(std::move(opened_[i]));
  opened_ = std::move(kept);
  for (std::uint32_t i = 0; i < opened_.size(); ++i) number_[opened_[i].fan.vertex] = i;
}

/// Finds where all copies end: those that have points there, unless something is nearer to them, and all others along
/// their directions.
void OpenedSource::find_ends(double longest) {
  const Surface& surface = mesh_.surface();
  std::vector<Vec3d> points;
  for (const OpenedVertex& vertex : opened_) {
    const std::uint32_t w = vertex.fan.vertex;
    first_.push_back(static_cast<std::uint32_t>(copies_.size()));
    for (std::size_t i = 0; i < vertex.directions.size(); ++i) {
      const Vec3d& way = i < vertex.points.size() ? vertex.points[i] : vertex.directions[i];
      copies_.push_back({w, way * std::abs(distances_[w]), VertexState::Mitered});
      points.push_back(surface.vertices[w] + copies_.back().displacement);
    }
  }
  const std::vector<Closest> closest = closest_points(mesh_.query(), points);
  std::vector<RidgeRay> rays;
  std::vector<std::uint32_t> copy_of_ray;
  for (std::uint32_t c = 0; c < copies_.size(); ++c) {
    const double distance = std::abs(distances_[copies_[c].vertex]);
    if (closest[c].distance >= distance * (1 - kReachedTolerance)) continue;
    rays.push_back({surface.vertices[copies_[c].vertex], copies_[c].displacement.unit(), distance});
    copy_of_ray.push_back(c);
  }
  const std::vector<RidgeRayEnd> ends = ray_ends(mesh_.query(), rays, longest);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Copy& copy = copies_[copy_of_ray[i]];
    copy.displacement = rays[i].direction * ends[i].length;
    copy.state = ends[i].is_there ? VertexState::Reached : VertexState::Collision;
    // Without room for one of its copies a vertex goes as far as it can as a whole.
    if (!ends[i].is_there) number_[copy.vertex] = kNone;
  }
}

bool OpenedSource::empty() const {
  return std::all_of(number_.begin(), number_.end(), [](std::uint32_t number) { return number == kNone; });
}

void OpenedSource::close(const std::vector<std::uint32_t>& vertices) {
  for (const std::uint32_t w : vertices) number_[w] = kNone;
}

}  // namespace vdb_offset
