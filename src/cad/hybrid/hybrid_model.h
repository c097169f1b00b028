// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "hybrid/shell_mesh.h"
#include "offset/place.h"

namespace vdb_offset::cad {

/// A placed model of exact faces and of triangles.
struct HybridModel {
  Model model;                    ///< Faces of several triangles come first.
  std::vector<int> source_faces;  ///< Of each face: the source's; -1: it is a triangle.
  std::vector<std::vector<int>> triangles_of_face;
  std::vector<std::vector<int>> triangles_of_edge;  ///< Those beside it.
  std::vector<int> off;                             ///< Triangles at vertices that their exact faces miss.
};

/// Where the corners of triangles are on the offsets of their faces, and which triangles lie on these.
class OnSurfaces {
 public:
  /// \param near how far a vertex may be from the surface that it is on
  OnSurfaces(const Model& source, const ShellMesh& mesh, double near);

  const gp_Pnt2d& uv(int triangle, int corner) const { return uv_[3 * static_cast<std::size_t>(triangle) + corner]; }
  bool is_on(int triangle) const { return is_on_[triangle] != 0; }
  void take_off(int triangle) { is_on_[triangle] = 0; }

 private:
  bool lies_on(const Model& source, const ShellMesh& mesh, int triangle) const;

  std::vector<gp_Pnt2d> uv_;
  std::vector<char> is_near_;  // by corner
  std::vector<char> is_on_;
};

/// Joins triangles that lie on one face's offset to faces of it; edges of the source between two of these keep their
/// curves, all others are straight. \pre triangles of a shell: no edge has more than two
HybridModel hybrid_model(const Model& source, const ShellMesh& mesh, const OnSurfaces& on,
                         const Tolerances& tolerances);

}  // namespace vdb_offset::cad
