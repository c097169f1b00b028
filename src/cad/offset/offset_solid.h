// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "offset/offset_surface.h"

namespace vdb_offset::cad {

struct OffsetCadRequest {
  TopoDS_Shape source;  ///< Solids or shells.
  double distance = 0;  ///< Towards the outside of the material; below 0 inward. Of uneven ones, the largest.
  /// In place of `distance`: towards the outside, of each face as TopExp_Explorer meets them; or empty.
  std::vector<FaceDistance> of_face;
  double fit_tolerance = 0;   ///< 0: 1e-4 |distance|.
  bool keeps_turned = false;  ///< Leaves what the distance turns round, to be trimmed.
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
/// two offset faces meet (mitered).
OffsetCadResult offset_cad(const OffsetCadRequest& request);

}  // namespace vdb_offset::cad
