// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <BRepAdaptor_Curve.hxx>
#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "read/cad_model.h"
#include "surface/face_surface.h"

namespace vdb_offset::cad {

using Triangle = std::array<std::uint32_t, 3>;

/// A vertex as a face has it: twice, with other parameters, on a seam.
struct Node {
  std::uint32_t vertex;
  double u, v;
};

/// The triangles of a face, of numbers of its nodes, counter-clockwise from outside.
struct FaceMesh {
  FaceSurface surface;
  double side = 1;  ///< What turns the surface's own normal outward.
  bool is_missing = false;
  std::vector<Node> nodes;
  std::vector<Triangle> triangles;
};

/// A part of an edge of the model between two vertices.
struct Segment {
  std::uint32_t edge;   ///< An index of `curves`.
  double lower, upper;  ///< The curve's parameters at the vertex of the lower number, and at the other.
};

/// The triangles of a body, whose faces share their vertices along edges.
struct BodyMesh {
  std::vector<gp_Pnt> positions;
  std::vector<std::uint8_t> is_on_edge;  ///< Whether the vertex is of an edge of the model.
  std::vector<FaceMesh> faces;
  std::vector<BRepAdaptor_Curve> curves;
  std::unordered_map<std::uint64_t, Segment> segments;  ///< By the numbers of their vertices.
  std::vector<std::uint32_t> numbers;                   ///< Of vertices in the CadMesh; kNone: no triangle has it.
  std::size_t unmatched = 0;                            ///< Edges that two faces have divided in two ways.

  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return a < b ? std::uint64_t{a} << 32 | b : std::uint64_t{b} << 32 | a;
  }
};

/// How many edges of the body's faces have no second face.
std::size_t count_free_edges(const Body& body);

/// Sews faces whose edges lie in one place and are two, where the body has open edges; names what it closed, and gives
/// whether there is any.
bool sew_open_edges(Body& body, double tolerance, double diagonal, std::vector<std::string>& remarks);

/// Takes what OpenCASCADE has meshed, joining the faces where they have edges in common.
BodyMesh take_mesh(const Body& body);

/// Moves vertices that several faces have onto all of their surfaces, as far as there is such a point.
void place_on_surfaces(BodyMesh& mesh);

/// Divides edges of triangles until none is farther from its face, or its curve, than `deflection`; gives the most
/// distance that is left.
double divide_to_deflection(BodyMesh& mesh, double deflection);

/// Gives triangles of a face whose vertices lie on a line another side, in common with a neighbour, that is none.
void flip_slivers(BodyMesh& mesh);

/// Turns faces so that neighbours go round in one sense, and closed bodies outward; gives how many it turned.
std::size_t orient(BodyMesh& mesh, bool is_solid);

/// The normal of a corner of a triangle, outward, at poles that of the direction that the triangle comes from.
gp_Vec corner_normal(const BodyMesh& mesh, const FaceMesh& face, const Triangle& triangle, std::size_t corner);

/// Adds a body to the result, and numbers its vertices.
void append_body(BodyMesh& mesh, const Body& body, io::CadMesh& result);

}  // namespace vdb_offset::cad
