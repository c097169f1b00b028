// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "document/rows.h"

namespace vdb_offset::io {

/// The rows of a PLY file, text or binary.
class PlyRows final : public Rows {
 public:
  bool has_strips = false;  ///< Strips of triangles in the place of faces.

  void read_attributes(const MeshFile& source, Attributes& attributes) const override;
  std::vector<double> vertex_numbers(const MeshFile& source, const std::string& name) const override;
  bool takes_faces() const override { return !has_strips; }
  std::string with_face_rows(const MeshFile& source, std::vector<std::string>& lost) const override;
  WrittenDocument derive(const std::shared_ptr<const DerivedMesh>& mesh, const std::string& path) const override;
};

}  // namespace vdb_offset::io
