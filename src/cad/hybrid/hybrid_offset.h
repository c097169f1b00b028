// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gp_Pnt.hxx>
#include <memory>
#include <vector>

#include "hybrid/shell_mesh.h"
#include "offset/offset_solid.h"

namespace vdb_offset::cad {

/// Which triangles stand for exact faces: those whose vertices are near to these, those whose vertices are there, none.
enum class ExactParts { Near, There, None };

/// An offset whose faces are exact where the offset mesh lies on the offsets of the source's faces, and its triangles
/// elsewhere: these are valid wherever the mesh is. Edges between exact faces are their common curves, others straight.
class HybridOffset {
 public:
  /// \param meshes of the shells of the request's source
  HybridOffset(const OffsetCadRequest& request, std::vector<ShellMesh> meshes, ExactParts parts);
  ~HybridOffset();
  HybridOffset(const HybridOffset&) = delete;
  HybridOffset& operator=(const HybridOffset&) = delete;

  OffsetCadResult make();
  /// Has triangles take the place of all that is exact near some places; false if nothing is.
  bool take_off_near(const std::vector<gp_Pnt>& places);

 private:
  class Shell;
  static void report(const Shell& shell, const ShellMesh& mesh, std::size_t first, OffsetCadResult& result);

  const OffsetCadRequest request_;
  const std::vector<ShellMesh> meshes_;
  const Tolerances tolerances_;
  std::vector<std::unique_ptr<Shell>> shells_;
};

}  // namespace vdb_offset::cad
