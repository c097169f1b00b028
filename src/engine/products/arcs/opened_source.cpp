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
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <span>
#include <utility>

#include "ground/mesh/miter_point.h"
#include "ground/mesh/planes_around.h"
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

Opening opening_within(double tolerance) {
  // Share of the widest step of an arc that is taken, for patches to be within the tolerance as well. Measured: see
  // docs/dev/tuning.md.
  constexpr double kStepShare = 0.92;
  const double widest = 2 * std::acos(1 - tolerance);
  return {.least_bend = widest, .step = kStepShare * widest, .farthest_plane = 1 + tolerance};
}

OpenedSource::OpenedSource(const PreparedMesh& mesh, const Distances& distances, const Paths& plain,
                           const Opening& opening)
    : mesh_(mesh),
      distances_(distances),
      plain_(plain),
      opening_(opening),
      number_(mesh.surface().vertices.size(), kNone) {
  const RidgeFinder finder(mesh, distances, opening.least_bend, opening.at_borders);
  find_vertices(finder);
  if (opening.farthest_plane) open_further(finder);
  lay(finder);
  find_ends();
  close_here(scraps());
  if (opening.straight_within > 0) find_straight();
}

/// Finds the vertices on ridges, and those that are too far off without one, and parts them into sectors.
void OpenedSource::find_vertices(const RidgeFinder& finder) {
  std::vector<std::optional<OpenedVertex>> found(number_.size());
  for_each_index(found.size(), [&](std::size_t w) {
    std::optional<RidgeFan> fan = finder(static_cast<std::uint32_t>(w));
    if (!fan) return;
    // A vertex that is not on a ridge may be the tip of a cone.
    const bool is_far =
        opening_.farthest_plane && plain_.achieved[w] > *opening_.farthest_plane * std::abs(distances_[w]);
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
    const double most = *opening_.farthest_plane * std::abs(distances_[fan.vertex]);
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
void OpenedSource::lay(const RidgeFinder& finder) {
  const double step = opening_.step;
  const ChainSteps chains(finder, opened_, step);
  require_few(chains, step, mesh_.mesh().face_count(), opening_.most_faces, opened_);
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
void OpenedSource::find_ends() {
  const Surface& surface = mesh_.surface();
  std::vector<Vec3d> points;
  for (const OpenedVertex& vertex : opened_) {
    const std::uint32_t w = vertex.fan.vertex;
    first_.push_back(static_cast<std::uint32_t>(copies_.size()));
    for (std::size_t i = 0; i < vertex.directions.size(); ++i) {
      const bool to_planes = opening_.farthest_plane && i < vertex.points.size();
      const Vec3d& way = to_planes ? vertex.points[i] : vertex.directions[i];
      copies_.push_back(
          {w, way * std::abs(distances_[w]), opening_.farthest_plane ? VertexState::Mitered : VertexState::Reached});
      points.push_back(surface.vertices[w] + copies_.back().displacement);
    }
  }
  const std::vector<Closest> closest = closest_points(mesh_.query(), points);
  std::vector<RidgeRay> rays;
  std::vector<std::uint32_t> copy_of_ray;
  for (std::uint32_t c = 0; c < copies_.size(); ++c) {
    const double distance = std::abs(distances_[copies_[c].vertex]);
    // Where a border's plane leans over a face, no edge beside that could be opened to bring its point nearer.
    const bool is_too_far = opening_.farthest_plane && closest[c].distance > *opening_.farthest_plane * distance &&
                            opened_[number_[copies_[c].vertex]].fan.is_at_border;
    if (closest[c].distance >= distance * (1 - kReachedTolerance) && !is_too_far) continue;
    rays.push_back({surface.vertices[copies_[c].vertex], copies_[c].displacement.unit(), distance});
    copy_of_ray.push_back(c);
  }
  const std::vector<RidgeRayEnd> ends = ray_ends(mesh_.query(), rays, opening_.longest);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Copy& copy = copies_[copy_of_ray[i]];
    copy.displacement = rays[i].direction * ends[i].length;
    copy.state = ends[i].is_there ? VertexState::Reached : VertexState::Collision;
    // Without room for one of its copies a vertex goes as far as it can as a whole.
    if (!ends[i].is_there) number_[copy.vertex] = kNone;
  }
}

/// The vertices that are not opened, and near to one that is. Sorted.
Indices OpenedSource::near_fans() const {
  const Surface& surface = mesh_.surface();
  std::vector<double> length(number_.size(), std::numeric_limits<double>::infinity());
  using Place = std::pair<double, std::uint32_t>;
  std::priority_queue<Place, std::vector<Place>, std::greater<>> next;
  for (const OpenedVertex& vertex : opened_)
    if (const std::uint32_t w = vertex.fan.vertex; number_[w] != kNone) next.emplace(length[w] = 0, w);
  Indices near;
  while (!next.empty()) {
    const auto [here, w] = next.top();
    next.pop();
    if (here > length[w]) continue;
    if (number_[w] == kNone) near.push_back(w);
    for (const std::uint32_t t : surface.triangles_around(w))
      for (const std::uint32_t v : surface.triangles[t]) {
        const double to = here + (surface.vertices[v] - surface.vertices[w]).length();
        if (to < length[v] && to <= opening_.straight_within * std::abs(distances_[v])) next.emplace(length[v] = to, v);
      }
  }
  std::sort(near.begin(), near.end());
  return near;
}

/// Finds where vertices near to fans end that go straight away from their own faces.
void OpenedSource::find_straight() {
  const Surface& surface = mesh_.surface();
  const Indices near = near_fans();
  std::vector<RidgeRay> rays;
  Indices of_ray;
  for (const std::uint32_t w : near) {
    if (falls_short(plain_.state[w]) || distances_[w] == 0) continue;
    const int side = distances_[w] < 0 ? -1 : 1;
    const auto point = miter_point(
        planes_around(surface, w, [&](std::uint32_t t) { return surface.triangle_normals[t] * side; }).normals);
    if (!point) continue;
    rays.push_back({surface.vertices[w], point->position.unit(), std::abs(distances_[w])});
    of_ray.push_back(w);
  }
  const std::vector<RidgeRayEnd> ends = ray_ends(mesh_.query(), rays, opening_.longest);
  straight_.assign(number_.size(), Vec3d(0.0));
  goes_straight_.assign(number_.size(), 0);
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (ends[i].is_there) {
      straight_[of_ray[i]] = rays[i].direction * ends[i].length;
      goes_straight_[of_ray[i]] = 1;
    }
}

bool OpenedSource::empty() const {
  return std::all_of(number_.begin(), number_.end(), [](std::uint32_t number) { return number == kNone; });
}

/// Opened vertices, by their numbers, that are joined by ridges.
DisjointSets OpenedSource::ridges() const {
  DisjointSets ridges(opened_.size());
  for (std::uint32_t i = 0; i < opened_.size(); ++i) {
    const RidgeFan& fan = opened_[i].fan;
    for (std::size_t e = 0; e < fan.is_open.size(); ++e)
      if (fan.is_open[e] && number_[fan.vertex] != kNone && number_[fan.across[e]] != kNone)
        ridges.join(i, number_[fan.across[e]]);
  }
  return ridges;
}

/// Opened vertices on ridges that are too short for their number of ends.
Indices OpenedSource::scraps() const {
  if (!(opening_.edges_for_end > 0)) return {};
  const Surface& surface = mesh_.surface();
  const double for_end = opening_.edges_for_end * surface.facts.median_edge;
  const std::vector<std::uint32_t> first = ridges().firsts();
  std::vector<double> length(opened_.size(), 0), asked(opened_.size(), 0);
  for (std::uint32_t i = 0; i < opened_.size(); ++i) {
    const RidgeFan& fan = opened_[i].fan;
    if (number_[fan.vertex] == kNone) continue;
    for (std::size_t e = 0; e < fan.is_open.size(); ++e) {
      if (!fan.is_open[e]) continue;
      const bool ends_here = number_[fan.across[e]] == kNone;
      const double edge = (surface.vertices[fan.across[e]] - surface.vertices[fan.vertex]).length();
      length[first[i]] += ends_here ? edge : edge / 2;  // one between two opened vertices is seen from both
      if (ends_here) asked[first[i]] += for_end;
    }
  }
  Indices found;
  for (std::uint32_t i = 0; i < opened_.size(); ++i)
    if (number_[opened_[i].fan.vertex] != kNone && length[first[i]] < asked[first[i]])
      found.push_back(opened_[i].fan.vertex);
  return found;
}

Indices OpenedSource::connected(const Indices& vertices) const {
  const std::vector<std::uint32_t> first = ridges().firsts();
  std::vector<std::uint8_t> leads_there(opened_.size(), 0);
  for (const std::uint32_t w : vertices)
    if (number_[w] != kNone) leads_there[first[number_[w]]] = 1;
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < opened_.size(); ++i)
    if (leads_there[first[i]]) found.push_back(opened_[i].fan.vertex);
  sort_unique(found);
  return found;
}

void OpenedSource::close_here(const Indices& vertices) {
  for (const std::uint32_t w : vertices) number_[w] = kNone;
}

void OpenedSource::close(const Indices& vertices) {
  close_here(vertices);
  close_here(scraps());
  if (straight_.empty()) return;
  goes_straight_.assign(number_.size(), 0);
  for (const std::uint32_t w : near_fans()) goes_straight_[w] = straight_[w] != Vec3d(0.0);
}

}  // namespace vdb_offset
