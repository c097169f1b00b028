// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include "space/sheets/sheet_sides.h"
#include "support/folder.h"
#include "valid/faults/triangle_crossings.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/report.h"
#include "vdb_offset/shapes.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::test::rooms {

/// As the command makes it.
struct Made {
  OffsetResult result;
  Shell shell;
};

inline Made made_of(const Polygons& mesh, double distance, std::vector<std::uint8_t> only = {}) {
  OffsetOptions options;
  options.distance = distance;
  options.off_source = true;
  options.only = std::move(only);
  Made made{offset(mesh.view(), options), {}};
  made.shell = shell_of(mesh.view(), made.result, options);
  report_states(made.shell, made.result);
  return made;
}

/// Judged by what reads meshes: every edge has two faces, which run through it in both directions and meet nowhere
/// else.
inline void check_one_solid(const Shell& shell) {
  CHECK(shell.facts.closed);
  CHECK(shell.facts.oriented);
  CHECK(shell.facts.non_manifold_edges == 0);
  CHECK(shell.facts.crossings + shell.facts.crossings_near_source + shell.facts.source_crossings == 0);
  CHECK(shell.facts.volume > 0);
  const Surface surface = build_surface(shell.polygons.view(), {});
  CHECK(surface.facts.boundary_edges == 0);
  CHECK(surface.facts.non_manifold_edges == 0);
  CHECK(surface.facts.orientation_conflicts == 0);
}

/// Walls of height 8 over lines between points of a plane, each of so many quads along and up.
inline Polygons walls(const std::vector<std::array<Vec3d, 2>>& lines, std::uint32_t along = 1, std::uint32_t up = 1) {
  Polygons mesh;
  for (const auto& [from, to] : lines) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (std::uint32_t j = 0; j <= up; ++j)
      for (std::uint32_t i = 0; i <= along; ++i)
        mesh.positions.push_back(from + (to - from) * (1.0 * i / along) + Vec3d(0, 0, 8.0 * j / up));
    for (std::uint32_t j = 0; j < up; ++j)
      for (std::uint32_t i = 0; i < along; ++i) {
        const std::uint32_t v = first + j * (along + 1) + i;
        mesh.add_face({v, v + 1, v + along + 2, v + along + 1});
      }
  }
  return mesh;
}

/// Four rooms of 10 by 10 with walls between them, as plans have them: drawn from left to right, and upwards.
inline std::vector<std::array<Vec3d, 2>> four_rooms() {
  std::vector<std::array<Vec3d, 2>> lines;
  for (const double a : {0.0, 10.0, 20.0})
    for (const double b : {0.0, 10.0}) {
      lines.push_back({Vec3d(b, a, 0), Vec3d(b + 10, a, 0)});
      lines.push_back({Vec3d(a, b, 0), Vec3d(a, b + 10, 0)});
    }
  return lines;
}

}  // namespace vdb_offset::test::rooms
