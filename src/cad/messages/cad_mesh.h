// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vdb_offset/numbers.h"

namespace vdb_offset::io {

/// How finely a CAD model is tessellated.
struct CadFineness {
  double deflection = 0;              ///< Most distance of a triangle from its face, in the file's unit; 0: as follows.
  double deflection_of_diagonal = 0;  ///< The same, as a share of the diagonal of the model's bounding box.
  double angle = 0;                   ///< Most angle between neighbouring normals on a face, in radians, > 0.
  double least_of_diagonal = 0, most_of_diagonal = 1;  ///< Bounds of the deflection, as shares of the diagonal.
};

/// How a CAD model becomes a mesh.
struct CadMeshing : CadFineness {
  bool fuses_bodies = false;  ///< Solids that touch or get into each other are one.
};

/// What a face of a CAD model is, as far as the file states it.
struct CadFaceFacts {
  std::string name, layer;                      ///< Empty: none.
  std::optional<std::array<double, 3>> colour;  ///< Red, green, blue, 0 .. 1, as they are shown on a screen (sRGB).
  std::string solid;                            ///< The name of the solid or the part that it is of.
  std::string kind;                             ///< plane, cylinder, cone, sphere, torus, b-spline, ...
  std::array<double, 2> u{}, v{};               ///< The ranges of its parameters.
  std::string instance;  ///< What the part, or the innermost assembly that has a name, is called where it is placed.
  std::vector<std::string> within;  ///< The names of all parts and assemblies that it is in, and of their places.
  std::uint32_t body = 0;           ///< The number of the solid that it is of; the last one if it is of none.
};

/// How the faces of a CAD model meet along an edge of the tessellation.
enum class CadEdge : std::uint8_t { Tangent, Sharp };

/// A tessellated CAD model: triangles that share their vertices along the model's edges. Each face of the model lies in
/// one piece, in the order of the file's faces (numbered from 1 in messages).
struct CadMesh {
  std::vector<Vec3d> positions;                          ///< In the file's unit.
  std::vector<std::array<std::uint32_t, 3>> triangles;   ///< Counter-clockwise from outside.
  std::vector<std::uint32_t> face_of;                    ///< Of each triangle, an index of `faces`.
  std::vector<std::array<double, 2>> corner_parameters;  ///< Three a triangle: (u, v) on its face, not scaled.
  std::vector<Vec3d> corner_normals;                     ///< Three a triangle: the face's own, unit, outward.
  std::vector<CadFaceFacts> faces;
  /// Edges of triangles that lie on edges of the model where two faces meet, as pairs of vertices, lower first, in
  /// increasing order; and how the faces meet there, by the model's normals.
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<CadEdge> edge_kinds;
  double deflection = 0;             ///< The most distance of triangles from their faces, as measured; > 0.
  double unit_micrometres = 1000;    ///< The length of the file's unit.
  bool has_unit = false;             ///< Whether the file states it.
  std::vector<std::string> extras;   ///< What the file holds besides faces, in words ("3 free curves").
  std::vector<std::string> remarks;  ///< What was mended, or could not be, in words.
};

}  // namespace vdb_offset::io
