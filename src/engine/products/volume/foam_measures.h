// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "products/volume/volume_faces.h"
#include "vdb_offset/cells.h"

/// OpenFOAM's own measures of a mesh, as its checkMesh takes them (primitiveMesh: FaceCentresAndAreas,
/// CellCentresAndVols, Check and Tools), and by which it refuses meshes or warns of them.
namespace vdb_offset {

/// A face's centre and its area vector, outward. A face of more than three corners has those of the triangles around
/// the mean of its corners, with centres weighted by area.
struct FoamFace {
  Vec3d centre, area;
};
FoamFace foam_face(const VolumeMesh& mesh, std::span<const std::uint32_t> face);

/// The centre of a cell: that of the pyramids from the mean of the faces' centres to the faces, weighted by volume.
Vec3d foam_centre(const VolumeMesh& mesh, std::size_t cell);

/// Whether the pyramids from a cell's centre to all of its faces have positive volumes. Two such cells lie on opposite
/// sides of the face between them.
bool has_foam_pyramids(const VolumeMesh& mesh, std::size_t cell);

/// Measures a mesh. \pre `faces` are those of `mesh`, which is not plane. The result does not depend on the number of
/// threads.
FoamQuality measure_foam(const VolumeMesh& mesh, const VolumeFaces& faces);

}  // namespace vdb_offset
