// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cad/proof/step_files.h"

namespace cad_proof {

struct FaceComparison {
  int faces = 0;         ///< That source and result both have, by name.
  int points = 0;        ///< That were measured.
  double worst = 0;      ///< The most that a point is off, as a share of |distance|.
  std::string worst_of;  ///< The face where that is.
};

/// Measures |S'(u, v) - (S(u, v) + distance * n(u, v))| at random (u, v) that lie within the wires of both S, a face of
/// the source, and S', the face of the result with its name: `points` of them, as many on each face.
FaceComparison compare_faces(const StepFile& source, const StepFile& result, double distance, int points);

}  // namespace cad_proof
