// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cad/proof/compare_faces.h"
#include "cad/proof/step_files.h"

namespace cad_proof {

/// What an offset is by OpenCASCADE alone, without a line of what judges it in the project.
struct Findings {
  std::vector<std::string> faults;  ///< In words; empty if the result is what it ought to be.
  int points = 0;                   ///< Of which distances were measured, or on which side of the result they are.
  double least = 0;                 ///< Of the distances of the result's points, as a share of |distance|.
  double volume = 0;
  FaceComparison equal;  ///< At equal (u, v).
};

/// How many points there are at least: of the result as of the source, and at equal (u, v).
struct PointCounts {
  int beside, equal;
};

/// Judges the offset of a solid: valid and closed; each face on the offset of the face of its name; no point nearer to
/// the source than the distance, or on its wrong side; points beside the offset of the source are on the side of the
/// result that they ought to be on.
Findings judge_files(const StepFile& source, const StepFile& result, double distance, const PointCounts& points);

}  // namespace cad_proof
