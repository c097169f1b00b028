// SPDX-License-Identifier: Apache-2.0
// Offsets a mesh as it is, and then with its faces split until all points of them are proven to be at the distance.
// Shells, fields, paths and distances by axis are refused.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "ground/numbers/rounding.h"
#include "ground/system/call_progress.h"
#include "products/offset/field_stage.h"
#include "products/offset/make_results.h"
#include "products/offset/prepared_mesh.h"
#include "products/tolerance/offset_with_arcs.h"
#include "products/tolerance/split_faces.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

// The least tolerance, as a share of the distance. Reasoned: ten times as much as vertices may be off.
constexpr double kLeastTolerance = 1e-5;
void require_usable(const OffsetOptions& options, const Tolerance& tolerance) {
  const bool by_share = tolerance.share != 0, by_length = tolerance.length != 0;
  if (by_share == by_length) throw InvalidInput("tolerance: expected a share or a length, got both or none of them");
  if (by_share && !(tolerance.share >= kLeastTolerance && tolerance.share < 1))
    throw InvalidInput(
        fmt::format("tolerance: expected a share from {} to 1, got {}", kLeastTolerance, tolerance.share));
  const double most = options.distance.scale(), least = kLeastTolerance * most;
  if (by_length && most > 0 && !(tolerance.length >= least && tolerance.length < most))
    throw InvalidInput(fmt::format("tolerance: expected a length from {:g} to {:g} (the distance), got {:g}", least,
                                   most, tolerance.length));
  if (!options.metric.even() || options.off_source || options.inner_skin_last || options.keep_field ||
      options.keep_paths)
    throw InvalidInput(
        "tolerance: expected an offset whose distance is the same along all axes, no shell, and neither a field nor "
        "paths to be kept");
}

/// The mesh as it is, where no vertex moves.
RefinedOffset unmoved(PolygonView mesh, const OffsetOptions& options) {
  RefinedOffset result;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) result.refinement.parent.push_back(f);
  result.refinement.polygons = {{mesh.positions.begin(), mesh.positions.end()},
                                {mesh.corners.begin(), mesh.corners.end()},
                                {mesh.face_begin.begin(), mesh.face_begin.end()}};
  result.result = offset(mesh, options);
  return result;
}

RefinedOffset offset_and_split(PolygonView mesh, const OffsetOptions& options, const Tolerance& tolerance,
                               int threads) {
  OffsetOptions of_coarse = options;
  of_coarse.progress = part_of(options.progress, 0, kCoarseShare);
  of_coarse = with_call_progress(of_coarse);
  const InMetric space(mesh, options.metric);
  PreparedMesh prepared(space, of_coarse, threads, farthest_of({&options.distance, 1}),
                        {.by_corner = !options.distance.at_corner().empty()});
  const AskedDistances asked = ask(prepared, {&options.distance, 1});
  const OffsetResult coarse =
      std::move(make_results(prepared, asked, prepared.march(asked.moved, ridges_of(of_coarse))).front());
  prepared.field() = {};
  return split_faces(prepared, coarse,
                     {.tolerance = tolerance,
                      .most_faces = tolerance.limit_of_faces(mesh.face_count()),
                      .threads = threads,
                      .progress = part_of(options.progress, kCoarseShare, 1)});
}

}  // namespace

double Tolerance::at(double distance) const { return share > 0 ? share * std::abs(distance) : length; }

std::size_t Tolerance::limit_of_faces(std::size_t mesh_faces) const {
  constexpr std::size_t kFacesForEach = 20, kFacesInAnyCase = 1000000;  // as the declaration says
  return most_faces > 0 ? most_faces : std::max(kFacesForEach * mesh_faces, kFacesInAnyCase);
}

RefinedOffset offset_to_tolerance(PolygonView mesh, const OffsetOptions& given, const Tolerance& tolerance) {
  const bool has_arcs = given.corners == Corners::Arc;
  OffsetOptions options = given;
  if (has_arcs) {
    options.corners = Corners::Miter;
    options.exact = nullptr;
  }
  vdb_offset::require_usable(mesh, {&options.distance, 1}, options);
  require_usable(options, tolerance);
  std::vector<Vec3d> rounded;
  if (tolerance.precision.rounds_all) {
    rounded.assign(mesh.positions.begin(), mesh.positions.end());
    const Rounding precision(tolerance.precision);
    for (Vec3d& position : rounded) position = precision(position);
    mesh.positions = rounded;
  }
  if (!goes_anywhere(farthest_of({&options.distance, 1}))) return unmoved(mesh, options);
  if (has_arcs) return offset_with_arcs(mesh, options, tolerance);
  return in_arena(options.threads, [&](int threads) { return offset_and_split(mesh, options, tolerance, threads); });
}

}  // namespace vdb_offset
