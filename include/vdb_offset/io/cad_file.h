// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/result.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {

/// How far faces of a CAD model are offset: by a number of world units, or by an expression, in which u and v are those
/// of the face, scaled to its range.
struct CadDistance {
  double number = 0;
  std::optional<DistanceExpression> expression;  ///< Counts in place of the number.
};

/// The distances of the faces of a CAD model, towards the outside; negative is inward.
struct VDB_OFFSET_API CadDistances {
  CadDistances() = default;
  CadDistances(double number);  // NOLINT(google-explicit-constructor): one for all is the usual case

  std::vector<CadDistance> each;
  std::vector<std::uint32_t> of_face;  ///< Of each face of the mesh, which of them is its own. Empty: the first.
  double scale = 0;                    ///< The largest of them without its sign, world units, > 0.
  double diagonal = 0;                 ///< What percentages in expressions refer to, world units.
  double blend = 0;  ///< Over how far distances change across smooth edges, world units: as FaceDistances::blend.
};

/// The offset of a CAD model could not be made.
struct VDB_OFFSET_API NoCadModel : Error {
  using Error::Error;
};

struct CadWriting {
  std::optional<Format> format;  ///< Step or Brep, of a file with another ending.
  double fit_tolerance = 0;  ///< The most distance of a fitted face from its offset, world units; 0: 1e-4 distances.
  std::vector<std::uint8_t> only;  ///< Of each face of the mesh: 1 if it is offset; the others stay. Empty: all are.
  bool thick = false;              ///< Write the solids between the source and its offset.
  /// Hold faces back where the fronts of two parts of the model meet, as Collision::Limit does vertices. Else faces
  /// that meet so are cut along the curves in which they cross.
  bool holds_back = false;
  PolygonView obstacles;      ///< With holds_back: meshes that the result must not come nearer to than `clearance`.
  double clearance = 0;       ///< World units.
  bool exact = false;         ///< Write exact faces or nothing: no triangles where these fail.
  ProgressCallback progress;  ///< See run.h; all of it is Stage::Write. May cancel.
};

/// Whether a CAD model can be written in a format: in Step and Brep.
VDB_OFFSET_API bool is_cad_output(Format format);

/// Of each face of the mesh the face of the CAD model that it is of, counted from 0. Empty for other files.
VDB_OFFSET_API std::span<const std::uint32_t> cad_face_of(const MeshFile& source);

/// Of each face of the mesh the body of the CAD model that it is of, counted from 0: a solid, or all that is of none.
/// Empty for other files.
VDB_OFFSET_API std::vector<std::uint32_t> cad_body_of(const MeshFile& source);

/// Writes the offset of a CAD model as one, through a temporary file that is renamed at the end: each face becomes one
/// over the same (u, v), and where such faces fail, triangles of the offset mesh take their place, in one solid with
/// the others. The file is read again before. \param positions of the offset mesh, of which each body is best offset by
/// itself; empty: as if `how.exact` were asked for \throw InvalidInput if the source is no CAD model, or a part of one
/// of its faces has another distance; NoCadModel if nothing could be made; WriteError
VDB_OFFSET_API CadFileFacts write_cad(const std::string& path, const MeshFile& source, const CadDistances& distances,
                                      std::span<const Vec3d> positions, const CadWriting& how = {});

}  // namespace vdb_offset::io
