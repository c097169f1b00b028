// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "document/rows.h"

namespace vdb_offset::io {

/// The facets of an STL file, text or binary: three vertices and a normal each.
class StlRows final : public Rows {
 public:
  NormalsOf normals_of() const override { return NormalsOf::Facets; }
  bool shares_vertices() const override { return false; }
  /// Lists what only STL can hold, and other formats lose: the header's text, and the facets' attribute bytes.
  void read_attributes(const MeshFile& source, Attributes& attributes) const override;
  /// The names of solids, in a text, are groups.
  void visit_labels(const MeshFile& source, LabelListener& listener) const override;
  WrittenDocument derive(const std::shared_ptr<const DerivedMesh>& mesh, const std::string& path) const override;
};

}  // namespace vdb_offset::io
