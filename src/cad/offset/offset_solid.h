// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "offset/place.h"

namespace vdb_offset::cad {

struct OffsetCadRequest {
  TopoDS_Shape source;  ///< Solids or shells.
  double distance = 0;  ///< Towards the outside of the material; below 0 inward. Of uneven ones, the largest.
  /// In place of `distance`: towards the outside, of each face as TopExp_Explorer meets them; or empty.
  std::vector<FaceDistance> of_face;
  double fit_tolerance = 0;   ///< 0: 1e-4 |distance|.
  bool keeps_turned = false;  ///< Leaves what the distance turns round, to be trimmed.
};

enum class CadFace { Kept, Fitted, Swallowed, Faceted };  ///< The last: at least in part.

CadFace made_by(FaceMade made);

struct OffsetCadResult {
  TopoDS_Shape shape;                    ///< Null if there is nothing good.
  std::vector<CadFace> faces;            ///< How each face of the source was made.
  std::vector<TopoDS_Shape> made_of;     ///< The face of the result for each face of the source; null if none.
  double fit_error = 0;                  ///< The worst of the fitted surfaces.
  double exact_area = 0, flat_area = 0;  ///< Of a hybrid, by its mesh: of exact faces, and of triangles.
  std::size_t triangles = 0;             ///< Of a hybrid.
  std::vector<std::string> gaps;         ///< What is missing or not good, in words.
};

Tolerances tolerances_of(const OffsetCadRequest& request);

/// A shell's topology with the offsets of its faces, and which of its edges are smooth. \param first_face how many
/// faces of the request come before the shell's
Model offset_faces(const TopoDS_Shape& shell, const OffsetCadRequest& request, std::size_t first_face);

/// Offsets solids and shells as B-Rep: each face becomes a surface over the same (u, v), sharp edges are cut anew where
/// two offset faces meet (mitered).
OffsetCadResult offset_cad(const OffsetCadRequest& request);

}  // namespace vdb_offset::cad
