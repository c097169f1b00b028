// SPDX-License-Identifier: Apache-2.0
#include "cad/proof/compare_faces.h"

#include <cmath>

#include "cad/proof/sampled_face.h"

namespace cad_proof {
namespace {

void compare(const SampledFace& source, const SampledFace& result, double distance, int points, FaceComparison& all,
             const std::string& name) {
  constexpr int kTrials = 20;  // for each point
  Numbers numbers(1);
  const int wanted = all.points + points;
  for (int k = 0; k < kTrials * points && all.points < wanted; ++k) {
    const auto uv = source.inside(numbers);
    if (!uv) return;
    const auto normal = source.outside(*uv);
    if (!normal || !result.has_inside(*uv)) continue;
    ++all.points;
    const double off =
        result.point(*uv).Distance(source.point(*uv).Translated(*normal * distance)) / std::abs(distance);
    if (off <= all.worst) continue;
    all.worst = off;
    all.worst_of = name;
  }
}

}  // namespace

FaceComparison compare_faces(const StepFile& source, const StepFile& result, double distance, int points) {
  FaceComparison all;
  for (const auto& [name, face] : source.faces) all.faces += result.faces.contains(name);
  if (all.faces == 0) return all;
  const int each = (points + all.faces - 1) / all.faces;
  for (const auto& [name, face] : source.faces)
    if (const auto made = result.faces.find(name); made != result.faces.end())
      compare(SampledFace(face), SampledFace(made->second), distance, each, all, name);
  return all;
}

}  // namespace cad_proof
