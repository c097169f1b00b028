// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Shape.hxx>
#include <array>
#include <gp_Pnt.hxx>
#include <gp_Pnt2d.hxx>
#include <string>
#include <vector>

#include "offset/offset_surface.h"

namespace vdb_offset::cad {

/// The use of an edge by a face. Faces are gone round with the material's outside above and the face to the left.
struct HalfEdge {
  int edge = -1;
  int face = -1;
  int next = -1, previous = -1;
  int twin = -1;                ///< -1: the border of an open shell, or a pole.
  int vertex = -1;              ///< Where it starts.
  bool forward = true;          ///< Goes as the parameter of the edge's curve rises.
  Handle(Geom2d_Curve) pcurve;  ///< Over the edge's range; null for edges that the source does not have.
  gp_Pnt2d origin;              ///< (u, v) of its start in the source.
  gp_Pnt2d start, end;          ///< (u, v) on the offset surface, as the half-edge goes.
};

enum class EdgeKind { Sharp, Smooth, Pole, Chord };  ///< A chord is straight, and no edge of the source.

struct ModelEdge {
  EdgeKind kind = EdgeKind::Sharp;
  std::array<int, 2> half = {-1, -1};    ///< The forward one first (but for borders of shells, where it may be either).
  TopoDS_Edge source;                    ///< Null for edges that the source does not have.
  Handle(Geom_Curve) curve;              ///< The source's, untrimmed.
  double first = 0, last = 0;            ///< The range of the source's edge.
  std::array<double, 2> range = {0, 0};  ///< The range found for the offset, in the same parameter.
  bool is_step = false;                  ///< The faces are joined smoothly, and their distances differ.
  double gap = 0;                        ///< Between the two faces' offsets along a smooth edge.
  bool is_within = false;                ///< Smooth, and the two faces' offsets are one surface.
  std::array<bool, 2> strays = {false, false};  ///< Of one within a surface: which ends are off its trimming curves.
  bool is_gone = false;

  /// Whether it keeps its trimming curves.
  bool keeps_curves() const { return kind == EdgeKind::Smooth && !strays[0] && !strays[1]; }
};

struct ModelVertex {
  std::vector<int> ring;  ///< Half-edges that start here, each with its face to the left, in turn; poles left out.
  gp_Pnt source;          ///< Where it is in the source.
  gp_Pnt point;           ///< Where it is in the offset.
  gp_Pnt near;            ///< Where to look for it first, if `has_near`: faces may meet in more than one point.
  bool has_near = false;
  double residual = 0;   ///< How far the faces miss the point.
  bool is_open = false;  ///< On the border of a shell: the ring starts at one end of the border.
  bool is_gone = false;
};

struct ModelFace {
  TopoDS_Face source;  ///< As it lies in the shell; half-edges go round it the right way.
  double sign = 1;     ///< Of the material's outside along Su x Sv.
  Box2 box;
  Handle(Geom_Surface) surface;
  OffsetSurface offset;
  FaceDistance distance;   ///< Along Su x Sv.
  std::vector<int> loops;  ///< One half-edge of each; the outer one need not be first.
  int sides = 0;           ///< How many edges it has in the source.
  bool is_gone = false;
};

/// A shell's topology as half-edges that can be changed, with the geometry of source and offset.
struct Model {
  std::vector<HalfEdge> halves;
  std::vector<ModelEdge> edges;
  std::vector<ModelVertex> vertices;
  std::vector<ModelFace> faces;
  std::string failure;  ///< Why the shell cannot be taken; empty if it can.
};

/// A source edge's curve, drawn out straight beyond its range unless it is a line or a conic.
void evaluate(const Geom_Curve& curve, double t, gp_Pnt& p, gp_Vec& tangent);

/// Takes a shell apart. `failure` says if it is no manifold, or has faces without wires. Trimming curves that lead more
/// than `off` past their edges are mended.
Model read_model(const TopoDS_Shape& shell, double off);

/// Adds the vertices of half-edges that know those before and after them, and their twins: rings in the order of their
/// first half-edges. Where a source's vertex has more than one ring, each becomes a vertex.
void add_vertices(Model& model);

/// The half-edge before it round its face, poles left out.
int previous_drawn(const Model& model, int half);
int next_drawn(const Model& model, int half);

/// The vertex where a half-edge ends.
int end_vertex(const Model& model, int half);

}  // namespace vdb_offset::cad
