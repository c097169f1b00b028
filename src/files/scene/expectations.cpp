// SPDX-License-Identifier: Apache-2.0
// What scenes expect of a result, and where vertices should be in closed form.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vdb_offset/scene.h"

namespace vdb_offset::scene {

Vec3d Answer::lifted(const Vec3d& source, double distance) const {
  const double x = std::abs(source[0]), y = std::abs(source[1]);
  constexpr double kOnEdge = 1e-9;  // world units; scenes have a size near 1
  if (std::max(x, y) > radius + kOnEdge) return source;
  if (std::max(x, y) < radius - kOnEdge) return source + Vec3d(0, 0, distance);
  Vec3d direction(x < radius - kOnEdge ? 0.0 : std::copysign(shift[0], source[0]),
                  y < radius - kOnEdge ? 0.0 : std::copysign(shift[1], source[1]), shift[2]);
  return direction.lengthSqr() > 0 ? source + direction.unit() * distance : source;
}

Vec3d Answer::operator()(const Vec3d& source, double distance) const {
  switch (form) {
    case Form::Sphere:
      return source.unit() * radius;
    case Form::Box: {
      Vec3d clamped;
      for (int k = 0; k < 3; ++k) clamped[k] = std::clamp(source[k], -half[k], half[k]);
      return clamped;
    }
    case Form::Torus: {
      const Vec3d centre = Vec3d(source[0], source[1], 0).unit() * major;
      return centre + (source - centre).unit() * minor;
    }
    case Form::Ray:
      return source + source.unit() * distance;
    case Form::Under: {
      const Vec3d end = source + source.unit() * distance;
      return end[2] <= shift[2] ? end : source + (end - source) * ((shift[2] - source[2]) / (end[2] - source[2]));
    }
    case Form::Lift:
      return lifted(source, distance);
    case Form::Shift:
      break;
  }
  return source + shift;
}

std::vector<std::string> unmet(const Expectations& expect, PolygonView source, const OffsetResult& result) {
  std::size_t used = 0, reached = 0;
  double worst = 0;
  for (std::size_t v = 0; v < result.states.size(); ++v) {
    if (result.states[v] == VertexState::Unused) continue;
    ++used;
    const bool there = !falls_short(result.states[v]);
    reached += there;
    // The answer for a vertex under an obstacle also holds where the obstacle stops it.
    if (expect.answer && (there || expect.answer->form == Answer::Form::Under))
      worst =
          std::max(worst, (result.positions[v] - (*expect.answer)(source.positions[v], result.distances[v])).length());
  }
  const double share = used ? static_cast<double>(reached) / static_cast<double>(used) : 0;
  std::vector<std::string> failed;
  if (expect.min_reached && share < *expect.min_reached)
    failed.push_back(fmt::format("expected a share reached of at least {}, got {:.6f}", *expect.min_reached, share));
  if (expect.max_reached && share > *expect.max_reached)
    failed.push_back(fmt::format("expected a share reached of at most {}, got {:.6f}", *expect.max_reached, share));
  if (expect.max_position_error && worst > *expect.max_position_error)
    failed.push_back(
        fmt::format("expected positions within {} of the answer, got {:.3g}", *expect.max_position_error, worst));
  const FaceError& faces = result.statistics.faces;
  if (expect.max_face_error && !(faces.quantile_99 <= *expect.max_face_error))
    failed.push_back(fmt::format("expected 99 % of the faces' area within a share of {} of the distance, got {:.3g}",
                                 *expect.max_face_error, faces.quantile_99));
  if (const auto& fit = result.statistics.fit) {
    if (expect.min_gap && !(fit->gap >= *expect.min_gap))
      failed.push_back(fmt::format("expected a gap of at least {}, got {:.9g}", *expect.min_gap, fit->gap));
    if (expect.max_gap && !(fit->gap <= *expect.max_gap))
      failed.push_back(fmt::format("expected a gap of at most {}, got {:.9g}", *expect.max_gap, fit->gap));
  }
  return failed;
}

std::vector<std::string> unmet(const Expectations& expect, const ShellFacts& shell) {
  std::vector<std::string> failed;
  const auto require = [&](bool holds, const std::string& what) {
    if (!holds) failed.push_back("expected a shell " + what);
  };
  require(shell.closed && shell.border_edges_left == 0, "that is closed");
  require(shell.oriented, "whose faces agree about the outside");
  require(shell.non_manifold_edges == 0, fmt::format("without non-manifold edges, got {}", shell.non_manifold_edges));
  const std::size_t crossings = shell.crossings + shell.crossings_near_source + shell.source_crossings;
  require(crossings == 0, fmt::format("that does not cross itself, got {} pairs of triangles that meet", crossings));
  if (!expect.volume) return failed;
  const double error = std::abs(shell.volume - *expect.volume);
  require(error <= *expect.max_volume_error * *expect.volume,
          fmt::format("of volume {}, within a share of {}, got {:.9g}", *expect.volume, *expect.max_volume_error,
                      shell.volume));
  return failed;
}

}  // namespace vdb_offset::scene
