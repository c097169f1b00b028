// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <BRepAdaptor_Surface.hxx>
#include <IMeshTools_Parameters.hxx>
#include <Poly_Triangulation.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Wire.hxx>
#include <array>
#include <gp_Pnt.hxx>
#include <gp_Pnt2d.hxx>
#include <vector>

namespace vdb_offset::cad {

/// Triangles of a face between its trimming curves, over a grid in (u, v): for faces that OpenCASCADE's mesher gives
/// up, as it does where trimming curves miss their common end by a rounding.
///
/// Borders are divided as the neighbours' triangles divide the edges, and have one point where two of them meet,
/// although their trimming curves miss each other there.
class FaceGrid {
 public:
  /// An edge as a border goes along it.
  struct Side {
    TopoDS_Edge edge;
    std::vector<double> parameters;  ///< Of the edge, rising.
    std::vector<int> points;         ///< As many, by number.
  };

  FaceGrid(const TopoDS_Face& face, const IMeshTools_Parameters& parameters);

  /// Gives the face its triangles, and the edges theirs; nothing if its borders cross.
  void make_triangles();

 private:
  struct Point {
    gp_Pnt2d uv;  // in steps of the grid
    gp_Pnt at;
  };
  struct EdgePoint {
    double parameter;
    gp_Pnt2d uv;
    gp_Pnt at;
  };

  void choose_steps();
  bool add_border(const TopoDS_Wire& wire);
  std::vector<TopoDS_Edge> in_turn(const TopoDS_Wire& wire) const;
  bool is_way_round(const std::vector<TopoDS_Edge>& edges) const;
  std::vector<EdgePoint> divided(const TopoDS_Edge& edge) const;
  void add_inner_points();
  bool is_inner(const gp_Pnt2d& uv) const;
  double border_area() const;
  std::vector<std::array<int, 3>> triangles(int border_points) const;
  void keep(const std::vector<std::array<int, 3>>& triangles) const;

  int add(const gp_Pnt2d& uv, const gp_Pnt& at);
  gp_Pnt2d in_steps(const gp_Pnt2d& uv) const { return {uv.X() / step_[0], uv.Y() / step_[1]}; }
  gp_Pnt2d from_steps(const gp_Pnt2d& uv) const { return {uv.X() * step_[0], uv.Y() * step_[1]}; }

  TopoDS_Face face_;
  IMeshTools_Parameters parameters_;
  BRepAdaptor_Surface surface_;
  std::array<double, 2> step_{1, 1};
  std::vector<Point> points_;
  std::vector<Side> sides_;
  std::vector<std::array<int, 2>> border_;  // lines between points, with the face to the left
};

}  // namespace vdb_offset::cad
