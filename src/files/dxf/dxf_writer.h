// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "ground/numbers/rounding.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset::io {

/// Appends groups of a DXF file to a text.
class DxfWriter {
 public:
  explicit DxfWriter(std::string& text, std::string_view line_end = "\n") : text_(text), line_end_(line_end) {}

  void group(int code, std::string_view value);
  void group(int code, double value, const Rounding& precision = {});
  void flags(int code, int value);
  /// The groups of a point: of its x, y and z.
  void point(int code, const Vec3d& p, const Rounding& precision = {});
  void verbatim(std::string_view groups) { text_ += groups; }

 private:
  void code(int code);

  std::string& text_;
  std::string_view line_end_;
};

}  // namespace vdb_offset::io
