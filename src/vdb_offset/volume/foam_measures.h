#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "vdb_offset/foam_quality.h"
#include "vdb_offset/volume/volume_faces.h"
#include "vdb_offset/volume_mesh.h"

/// OpenFOAM's own measures of a mesh, as its checkMesh takes them (primitiveMesh: FaceCentresAndAreas,
/// CellCentresAndVols, Check and Tools): what it refuses or warns of, whatever else is right with a cell.
namespace vdb_offset {

/// A face's centre and its area vector, outward: for more corners than three those of the triangles from the mean of
/// the corners, centres weighted by area.
struct FoamFace {
  Vec3d centre, area;
};
FoamFace foam_face(const VolumeMesh& mesh, std::span<const std::uint32_t> face);

/// Where the pyramids from the mean of the faces' centres to the faces have theirs.
Vec3d foam_centre(const VolumeMesh& mesh, std::size_t cell);

/// Whether all faces are seen from the cell's centre from inside: their pyramids have positive volumes. Two cells of
/// which that holds lie on opposite sides of the face between them.
bool has_foam_pyramids(const VolumeMesh& mesh, std::size_t cell);

/// \pre `faces` are those of `mesh`, which is not plane. The result does not depend on the number of threads.
FoamQuality measure_foam(const VolumeMesh& mesh, const VolumeFaces& faces);

}  // namespace vdb_offset
