// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "tessellate/body_mesh.h"

namespace vdb_offset::cad {
namespace {

// Surfaces that meet at a smaller angle (its sine) leave the place along them open: where they miss each other by the
// file's tolerance, a point on both may be as far away as one likes.
constexpr double kLeastSine = 0.02;
constexpr int kMostRounds = 4;      // each squares the error
constexpr double kMostFactor = 10;  // of a move, times what it is to mend

struct Use {
  std::uint32_t face, node;
};

struct Constraint {
  gp_Vec normal;
  double distance;
  bool is_analytic;
};

/// Uses of vertices of edges, those of a vertex one behind the other.
struct Uses {
  std::vector<std::uint32_t> start;
  std::vector<Use> list;
};

Uses uses_of_edges(const BodyMesh& mesh) {
  Uses uses;
  uses.start.assign(mesh.positions.size() + 1, 0);
  const auto each = [&](auto&& then) {
    for (std::uint32_t f = 0; f < mesh.faces.size(); ++f)
      for (std::uint32_t n = 0; n < mesh.faces[f].nodes.size(); ++n)
        if (mesh.is_on_edge[mesh.faces[f].nodes[n].vertex]) then(mesh.faces[f].nodes[n].vertex, Use{f, n});
  };
  each([&](std::uint32_t vertex, Use) { ++uses.start[vertex + 1]; });
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) uses.start[v + 1] += uses.start[v];
  uses.list.resize(uses.start.back());
  std::vector<std::uint32_t> next(uses.start.begin(), uses.start.end() - 1);
  each([&](std::uint32_t vertex, Use use) { uses.list[next[vertex]++] = use; });
  return uses;
}

/// The shortest move that takes a point onto the planes that are independent of those before them.
gp_Vec shortest_move(const std::vector<Constraint>& constraints) {
  gp_Vec move(0, 0, 0);
  std::vector<gp_Vec> basis;
  for (const Constraint& constraint : constraints) {
    gp_Vec free = constraint.normal;
    for (const gp_Vec& direction : basis) free -= direction * free.Dot(direction);
    const double sine = free.Magnitude();
    if (sine < kLeastSine || basis.size() == 3) continue;
    free /= sine;
    move -= free * ((constraint.distance + move.Dot(constraint.normal)) / sine);
    basis.push_back(free);
  }
  return move;
}

/// Moves one vertex, unless it would go far. The nodes' parameters follow.
void place(BodyMesh& mesh, std::uint32_t vertex, const Use* first, const Use* last) {
  gp_Pnt at = mesh.positions[vertex];
  double start = 0;
  std::vector<Constraint> constraints;
  for (int round = 0; round < kMostRounds; ++round) {
    constraints.clear();
    double most = 0;
    for (const Use* use = first; use != last; ++use) {
      FaceMesh& face = mesh.faces[use->face];
      Node& node = face.nodes[use->node];
      const Foot foot = face.surface.foot(at, node.u, node.v);
      node.u = foot.u, node.v = foot.v;
      most = std::max(most, std::abs(foot.distance));
      if (const auto normal = face.surface.normal(foot.u, foot.v))
        constraints.push_back({*normal, foot.distance, face.surface.is_analytic()});
    }
    // Where faces contradict each other, those that are what they are by a formula are kept to.
    std::stable_partition(constraints.begin(), constraints.end(), [](const Constraint& c) { return c.is_analytic; });
    if (round == 0) start = most;
    const double scale = std::max({std::abs(at.X()), std::abs(at.Y()), std::abs(at.Z())});
    if (most <= 4e-16 * scale) break;
    const gp_Pnt to = at.Translated(shortest_move(constraints));
    if (!(to.Distance(mesh.positions[vertex]) <= kMostFactor * start)) break;
    if (round + 1 < kMostRounds) at = to;
  }
  mesh.positions[vertex] = at;
}

}  // namespace

void place_on_surfaces(BodyMesh& mesh) {
  const Uses uses = uses_of_edges(mesh);
  for (std::uint32_t v = 0; v < mesh.positions.size(); ++v)
    if (uses.start[v] < uses.start[v + 1])
      place(mesh, v, uses.list.data() + uses.start[v], uses.list.data() + uses.start[v + 1]);
}

}  // namespace vdb_offset::cad
