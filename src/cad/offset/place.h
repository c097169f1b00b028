// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "offset/contact.h"
#include "offset/model.h"

namespace vdb_offset::cad {

/// Lengths that decide, in the shape's unit.
struct Tolerances {
  double distance = 0;  ///< The largest |distance|.
  double fit = 0;       ///< Of surfaces.
  double curve = 0;     ///< Of edges on their surfaces.
  double gap = 0;       ///< Offsets of two faces that are closer along an edge keep its trimming curves.
};

/// Finds which edges are smooth: the offsets of their two faces stay together along the trimming curves.
void classify_edges(Model& model, const Tolerances& tolerances);

/// The sides of a face's box at which it has a sharp edge: its offset may have to reach farther there.
Sides sharp_sides(const Model& model, int face);

/// Where a face is over the start of one of its half-edges: the point moved by the face's distance.
gp_Pnt moved_start(const Model& model, int half);

/// The material's outside at the start of a half-edge.
gp_Vec start_normal(const Model& model, int half);

/// Lets the ends of spokes that lie within one surface be off their trimming curves, or has them there again. False if
/// there are none.
bool let_stray(Model& model, const std::vector<int>& spokes, bool may_stray);

/// What the offset of the corner lies on: the smooth spokes' curves, and the faces that have none. `spokes` are
/// half-edges that start at the vertex; only those that are asked for count.
std::vector<Support> supports_of(const Model& model, const std::vector<int>& faces_of, const std::vector<int>& spokes);

/// Places a vertex where the offsets of its faces meet, and gives its half-edges their (u, v).
void place_vertex(Model& model, int vertex, const Tolerances& tolerances);

/// Places it where its faces meet if edges within one surface leave their trimming curves. False if there are none, or
/// the faces do not.
bool place_astray(Model& model, int vertex, const Tolerances& tolerances);

/// Sets (u, v) and ranges of the half-edges that start or end at a vertex that has its point.
void spread_vertex(Model& model, int vertex);

/// The point where the three or more planes of faces meet: least squares, and the shortest way where they leave a
/// choice.
gp_Pnt miter_point_of(const Model& model, const gp_Pnt& source, const std::vector<int>& halves);

}  // namespace vdb_offset::cad
