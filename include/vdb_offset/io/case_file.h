// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/cells.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset::io {

/// A flow that has one density, in units that fit each other.
struct Flow {
  Vec3d direction{1, 0, 0};  ///< Of the flow far away, any length.
  double speed = 1;          ///< Far away, and into inlets.
  double viscosity = 0;      ///< Kinematic, > 0.
  double length = 1;     ///< What coefficients of forces refer to, with its square, or its product with the thickness
                         ///< of a mesh that is one cell thick.
  double thickness = 0;  ///< Of such a mesh; 0: it is another.
};

/// A patch of the mesh that a case is for.
struct CasePatch {
  std::string name;
  BoundaryPatch::Kind kind;
};

/// What became of a case's files. Those that are there stay as they are: a user may have changed them.
struct CaseFiles {
  std::vector<std::string> written;
  std::vector<std::string> kept;  ///< Were there, with another text than this case has.
  /// Folders with results of an earlier run, which a solver goes on from, whatever mesh they belong to.
  std::vector<std::string> results;
};

/// Writes a case for OpenFOAM's simpleFoam, steady and laminar, into a folder that has the mesh in constant/polyMesh:
/// fields with conditions by the patches' kinds, schemes and solvers that suit layers and tetrahedra, forces on the
/// walls, and a README of how to run it. \throw InvalidInput for a viscosity that is not above 0, for patches of kind
/// Side, which say nothing of the flow, and for names that a file of the mesh has otherwise (is_patch_word()), or that
/// two patches have; WriteError
VDB_OFFSET_API CaseFiles write_openfoam_case(const std::string& folder, std::span<const CasePatch> patches,
                                             const Flow& flow);

/// Writes a case for SU2's solver of incompressible flows, steady and laminar, beside a .su2 file: flow.cfg, with
/// markers by the patches' kinds, and a README. Plane meshes have a thickness above 0, which does not count.
/// \throw as write_openfoam_case()
VDB_OFFSET_API CaseFiles write_su2_case(const std::string& mesh, std::span<const CasePatch> patches, const Flow& flow);

}  // namespace vdb_offset::io
