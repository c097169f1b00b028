// SPDX-License-Identifier: Apache-2.0
#include "offset/arrange.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "offset/contract.h"
#include "offset/resolve.h"

namespace vdb_offset::cad {
namespace {

constexpr int kMostRounds = 60;

bool is_inverted(const Model& model, int edge) {
  const ModelEdge& e = model.edges[edge];
  if (e.is_gone || e.kind == EdgeKind::Pole) return false;
  if (!e.curve.IsNull() || e.kind == EdgeKind::Smooth) return e.range[1] - e.range[0] < 1e-9 * (e.last - e.first);
  return false;
}

// How much of a face's border is inverted, if the face cannot be any more: two sides and half of them at least, or the
// seam of a face that closes. 0: it can be.
double dead_share(const Model& model, int face) {
  const ModelFace& f = model.faces[face];
  if (f.is_gone) return 0;
  if (f.offset.surface.IsNull()) return 1;
  for (int first : f.loops)
    for (int h = first;;) {
      const int twin = model.halves[h].twin;
      if (twin >= 0 && model.halves[twin].face == face && is_inverted(model, model.halves[h].edge)) return 1;
      h = model.halves[h].next;
      if (h == first) break;
    }
  const std::vector<int> sides = sides_of_face(model, face);
  const auto inverted = std::count_if(sides.begin(), sides.end(), [&](int e) { return is_inverted(model, e); });
  const double share = static_cast<double>(inverted) / static_cast<double>(std::max<std::size_t>(1, sides.size()));
  return inverted >= 2 && share > 0.49 ? share : 0;
}

int deadest_face(const Model& model) {
  int best = -1;
  double best_share = 0;
  for (int f = 0; f < static_cast<int>(model.faces.size()); f++) {
    const double share = dead_share(model, f);
    if (share <= best_share) continue;
    best = f;
    best_share = share;
  }
  return best;
}

// The dead faces that hang together with one of them.
std::vector<int> dead_with(const Model& model, int face) {
  std::vector<int> group = {face};
  for (std::size_t i = 0; i < group.size(); i++)
    for (int e : sides_of_face(model, group[i]))
      for (int h : model.edges[e].half) {
        const int f = model.halves[h].face;
        if (std::find(group.begin(), group.end(), f) == group.end() && dead_share(model, f) > 0) group.push_back(f);
      }
  return group;
}

bool remove_dead(Model& model, int face, std::vector<std::string>& gaps) {
  const std::string name = "face " + std::to_string(face + 1);
  const std::vector<int> group = dead_with(model, face);
  if (const std::optional<bool> is_closed = close_neck(model, group)) {
    if (!*is_closed) gaps.push_back(name + " is swallowed, and its neighbours do not close the gap");
    return *is_closed;
  }
  if (close_hole(model, group) || remove_face(model, face)) return true;
  gaps.push_back(name + " is swallowed, and its neighbours do not close the gap");
  return false;
}

// Takes faces out of which contractions have left two edges between the same two vertices.
bool remove_lenses(Model& model, std::vector<std::string>& gaps) {
  for (int f = 0; f < static_cast<int>(model.faces.size()); f++) {
    const ModelFace& face = model.faces[f];
    if (face.is_gone || face.loops.size() != 1) continue;
    const int h = face.loops.front(), other = model.halves[h].next;
    if (other == h || model.halves[other].next != h || face.sides < 3) continue;
    if (model.halves[h].twin < 0 || model.halves[other].twin < 0 || model.halves[h].twin == other) continue;
    if (remove_face(model, f)) continue;
    gaps.push_back("face " + std::to_string(f + 1) + " is swallowed, and its neighbours do not close the gap");
    return false;
  }
  return true;
}

bool remove_swallowed(Model& model, std::vector<std::string>& gaps) {
  for (int f = 0; f < static_cast<int>(model.faces.size()); f++)
    if (!model.faces[f].is_gone && model.faces[f].offset.surface.IsNull() && !remove_dead(model, f, gaps)) return false;
  return true;
}

// Places all vertices; those that could not be in words.
std::vector<std::string> resolve_vertices(Model& model, const Tolerances& tolerances) {
  std::vector<std::string> missed;
  for (int v = 0; v < static_cast<int>(model.vertices.size()); v++) {
    if (model.vertices[v].is_gone || resolve_vertex(model, v, tolerances)) continue;
    missed.push_back("vertex " + std::to_string(v + 1) + " of " + std::to_string(model.vertices[v].ring.size()) +
                     " edges: faces miss by " + std::to_string(model.vertices[v].residual));
  }
  return missed;
}

// Lets an edge whose ends have changed places go the other way.
void turn(Model& model, int edge) {
  ModelEdge& e = model.edges[edge];
  std::swap(e.range[0], e.range[1]);
  std::swap(e.half[0], e.half[1]);
  for (int h : e.half)
    if (h >= 0) model.halves[h].forward = !model.halves[h].forward;
}

}  // namespace

void arrange_turned(Model& model, const Tolerances& tolerances, std::vector<std::string>& gaps) {
  if (!remove_swallowed(model, gaps) || !remove_lenses(model, gaps)) return;
  const std::vector<std::string> missed = resolve_vertices(model, tolerances);
  gaps.insert(gaps.end(), missed.begin(), missed.end());
  for (int e = 0; e < static_cast<int>(model.edges.size()); e++)
    if (is_inverted(model, e) && model.edges[e].range[0] > model.edges[e].range[1]) turn(model, e);
}

void arrange(Model& model, const Tolerances& tolerances, std::vector<std::string>& gaps) {
  if (!remove_swallowed(model, gaps)) return;
  for (int round = 0; round < kMostRounds; round++) {
    if (!remove_lenses(model, gaps)) return;
    const std::vector<std::string> missed = resolve_vertices(model, tolerances);
    const int face = deadest_face(model);
    if (face >= 0) {
      if (remove_dead(model, face, gaps)) continue;
      return;
    }
    int edge = -1;
    for (int e = 0; e < static_cast<int>(model.edges.size()) && edge < 0; e++)
      if (is_inverted(model, e)) edge = e;
    if (edge < 0) {
      gaps.insert(gaps.end(), missed.begin(), missed.end());
      return;
    }
    if (!contract_edges(model, {edge})) {
      gaps.push_back("edge " + std::to_string(edge + 1) + " shrinks to nothing");
      return;
    }
  }
  gaps.push_back("edges go on shrinking to nothing");
}

}  // namespace vdb_offset::cad
