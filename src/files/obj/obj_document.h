// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "document/rows.h"

namespace vdb_offset::io {

/// The lines of an OBJ file.
class ObjRows final : public Rows {
 public:
  ObjRows() : Rows({'#', true}) {}

  NormalsOf normals_of() const override { return NormalsOf::Corners; }
  void read_attributes(const MeshFile& source, Attributes& attributes) const override;
  Materials read_materials(const MeshFile& source) const override;
  void visit_labels(const MeshFile& source, LabelListener& listener) const override;
  WrittenDocument derive(const std::shared_ptr<const DerivedMesh>& mesh, const std::string& path) const override;
};

}  // namespace vdb_offset::io
