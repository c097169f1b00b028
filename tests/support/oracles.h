// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "products/cells/measure_cells.h"
#include "vdb_offset/offset.h"

namespace vdb_offset::test {

/// Every face with corners of its own, as STL and hard-edge exports store them.
Polygons torn(const Polygons& mesh);

/// A square tube that is sheared along x, between the planes z = 0 and z = 1.
Polygons oblique_tube();

/// Needles from a circle in z = 0 to a rectangle in z = 30, of so many vertices each.
Polygons open_loft(std::uint32_t count);

/// So small and far from the origin that single precision moves each vertex, and distances to grow its upper part by.
std::pair<Polygons, std::vector<double>> far_sphere();

/// Distance from x to the nearest triangle of a fan-triangulated mesh, by trying them all in a way that shares
/// nothing with the library: projection onto the plane and signed areas, else the three segments.
double brute_force_distance(PolygonView mesh, const Vec3d& x);

/// What a closed mesh of faces that point outward encloses: the sum of its triangles' tetrahedra with the origin.
double enclosed_volume(const Polygons& mesh);

/// Whether x lies inside a closed mesh, by the winding number: the sum of its triangles' solid angles.
bool is_inside(PolygonView mesh, const Vec3d& x);

struct DistanceErrors {
  double worst_reached = 0;  ///< Largest |distance - target| / target of a vertex whose state is reached.
  double worst_beyond = 0;   ///< Largest (distance - target) / target of any vertex.
  double worst_told = 0;     ///< Largest |distance - achieved| / target of any vertex.
  std::size_t wrong_side = 0;
};
/// Judges every `stride`-th vertex of a result against brute force; sides only if `closed`.
DistanceErrors judge(PolygonView source, const OffsetResult& result, double distance, std::size_t stride, bool closed);

/// Largest distance of a position from what a function of the source vertex says, and the root mean square.
struct PositionErrors {
  double worst, rms;
};
template <class Answer>
PositionErrors position_errors(PolygonView source, const OffsetResult& result, Answer&& answer) {
  PositionErrors errors{0, 0};
  for (std::size_t v = 0; v < result.positions.size(); ++v) {
    const double error = (result.positions[v] - answer(source.positions[v])).length();
    errors.worst = std::max(errors.worst, error);
    errors.rms += error * error;
  }
  errors.rms = std::sqrt(errors.rms / static_cast<double>(result.positions.size()));
  return errors;
}

/// Checks what was measured of cells before they were made against what the made ones have.
void check_measured(const LayerQuality& measured, const VolumeMesh& made, const LayersResult& layers,
                    const LayerCells& cells);

/// The result's share of vertices in a state, among those in use.
double share(const OffsetResult& result, VertexState state);

}  // namespace vdb_offset::test
