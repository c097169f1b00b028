// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "document/rows.h"

namespace vdb_offset::io {

/// The rows of an OFF file, text or binary.
class OffRows final : public Rows {
 public:
  OffRows() : Rows({'#', false}) {}

  void read_attributes(const MeshFile& source, Attributes& attributes) const override;
  WrittenDocument derive(const std::shared_ptr<const DerivedMesh>& mesh, const std::string& path) const override;
};

}  // namespace vdb_offset::io
