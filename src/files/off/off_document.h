// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "document/rows.h"

namespace vdb_offset::io {

/// The rows of an OFF file, text or binary.
class OffRows final : public Rows {
 public:
  OffRows() : Rows({'#', false}) {}

  void read_attributes(const MeshFile& source, Attributes& attributes) const override;
  Pieces with_shell(const std::shared_ptr<const ShellContent>& content, std::vector<std::string>& lost) const override;
  Pieces refined(const std::shared_ptr<const RefinedContent>& content, std::vector<std::string>& lost) const override;
};

}  // namespace vdb_offset::io
