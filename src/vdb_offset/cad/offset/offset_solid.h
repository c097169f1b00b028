// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <functional>
#include <string>
#include <vector>

namespace vdb_offset::cad {

struct OffsetCadRequest {
  TopoDS_Shape source;  ///< Solids or shells.
  double distance = 0;  ///< Towards the outside of the material; below 0 inward.
  /// Along the outside of a face (numbered as TopExp_Explorer meets them) at its (u, v), in place of `distance`.
  std::function<double(int face, double u, double v)> distance_at;
  std::vector<double> of_face;  ///< In place of `distance`: of each face, by the same numbers; or empty.
  double fit_tolerance = 0;     ///< 0: 1e-4 |distance|.
};

enum class CadKind { Solid, Shells, Faces };
enum class CadFace { Kept, Fitted, Swallowed, Missing };

struct OffsetCadResult {
  TopoDS_Shape shape;  ///< Null if there is nothing good.
  CadKind kind = CadKind::Faces;
  std::vector<CadFace> faces;         ///< How each face of the source was made.
  std::vector<TopoDS_Shape> made_of;  ///< The face of the result for each face of the source; null if none.
  double fit_error = 0;               ///< The worst of the fitted surfaces.
  std::vector<std::string> steps;     ///< What was changed of the topology, in words.
  std::vector<std::string> gaps;      ///< What is missing or not good, in words.
};

/// Offsets solids and shells as B-Rep: each face becomes a surface over the same (u, v), sharp edges are cut anew where
/// two offset faces meet (mitred).
OffsetCadResult offset_cad(const OffsetCadRequest& request);

}  // namespace vdb_offset::cad
