// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/cad/offset/arrange.h"

#include <algorithm>
#include <cmath>

#include "vdb_offset/cad/offset/contract.h"
#include "vdb_offset/cad/offset/resolve.h"

namespace vdb_offset::cad {
namespace {

constexpr int kMostRounds = 60;

bool is_inverted(const Model& model, int edge) {
  const ModelEdge& e = model.edges[edge];
  if (e.is_gone || e.kind == EdgeKind::Pole) return false;
  if (!e.curve.IsNull() || e.kind == EdgeKind::Smooth) return e.range[1] - e.range[0] < 1e-9 * (e.last - e.first);
  return false;
}

// The face with most of its sides inverted, two at least and half of them; -1 if there is none.
int most_inverted_face(const Model& model) {
  int best = -1;
  double best_share = 0.49;
  for (int f = 0; f < static_cast<int>(model.faces.size()); f++) {
    if (model.faces[f].is_gone) continue;
    const std::vector<int> sides = sides_of_face(model, f);
    const auto inverted = std::count_if(sides.begin(), sides.end(), [&](int e) { return is_inverted(model, e); });
    const double share = static_cast<double>(inverted) / static_cast<double>(std::max<std::size_t>(1, sides.size()));
    if (inverted >= 2 && share > best_share) {
      best = f;
      best_share = share;
    }
  }
  return best;
}

// The swallowed faces that hang together with one of them.
std::vector<int> swallowed_with(const Model& model, int face) {
  std::vector<int> group = {face};
  for (std::size_t i = 0; i < group.size(); i++)
    for (int e : sides_of_face(model, group[i]))
      for (int h : model.edges[e].half) {
        const int f = model.halves[h].face;
        if (model.faces[f].offset.surface.IsNull() && std::find(group.begin(), group.end(), f) == group.end())
          group.push_back(f);
      }
  return group;
}

// Takes faces out of which contractions have left two edges between the same two vertices.
bool remove_lenses(Model& model, std::vector<std::string>& gaps) {
  for (int f = 0; f < static_cast<int>(model.faces.size()); f++) {
    const ModelFace& face = model.faces[f];
    if (face.is_gone || face.loops.size() != 1) continue;
    const int h = face.loops.front(), other = model.halves[h].next;
    if (other == h || model.halves[other].next != h || face.sides < 3) continue;
    if (model.halves[h].twin < 0 || model.halves[other].twin < 0 || model.halves[h].twin == other) continue;
    model.steps.push_back("face " + std::to_string(f + 1) + " has no width left");
    if (remove_face(model, f)) continue;
    gaps.push_back("face " + std::to_string(f + 1) + " is swallowed, and its neighbours do not close the gap");
    return false;
  }
  return true;
}

bool remove_swallowed(Model& model, std::vector<std::string>& gaps) {
  for (int f = 0; f < static_cast<int>(model.faces.size()); f++) {
    if (model.faces[f].is_gone || !model.faces[f].offset.surface.IsNull()) continue;
    if (close_hole(model, swallowed_with(model, f)) || remove_face(model, f)) {
      model.steps.push_back("face " + std::to_string(f + 1) + " is swallowed");
      continue;
    }
    gaps.push_back("face " + std::to_string(f + 1) + " is swallowed, and its neighbours do not close the gap");
    return false;
  }
  return true;
}

}  // namespace

void arrange(Model& model, const Tolerances& tolerances, std::vector<std::string>& gaps) {
  if (!remove_swallowed(model, gaps)) return;
  for (int round = 0; round < kMostRounds; round++) {
    if (!remove_lenses(model, gaps)) return;
    std::vector<std::string> missed;
    for (int v = 0; v < static_cast<int>(model.vertices.size()); v++) {
      if (model.vertices[v].is_gone || resolve_vertex(model, v, tolerances)) continue;
      missed.push_back("vertex " + std::to_string(v + 1) + " of " + std::to_string(model.vertices[v].ring.size()) +
                       " edges: faces miss by " + std::to_string(model.vertices[v].residual));
    }
    const int face = most_inverted_face(model);
    if (face >= 0) {
      model.steps.push_back("face " + std::to_string(face + 1) + " shrinks to nothing");
      if (remove_face(model, face)) continue;
      gaps.push_back("face " + std::to_string(face + 1) + " is swallowed, and its neighbours do not close the gap");
      return;
    }
    int edge = -1;
    for (int e = 0; e < static_cast<int>(model.edges.size()) && edge < 0; e++)
      if (is_inverted(model, e)) edge = e;
    if (edge < 0) {
      gaps.insert(gaps.end(), missed.begin(), missed.end());
      return;
    }
    model.steps.push_back("edge " + std::to_string(edge + 1) + " shrinks to nothing");
    if (!contract_edges(model, {edge})) {
      gaps.push_back("edge " + std::to_string(edge + 1) + " shrinks to nothing");
      return;
    }
  }
  gaps.push_back("edges go on shrinking to nothing");
}

}  // namespace vdb_offset::cad
