// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "vdb_offset/vec.h"

namespace vdb_offset {

/// What a file keeps of a coordinate. Validity is judged on what is kept.
struct Precision {
  enum class Kind { Double, Single, Digits };

  Kind kind = Kind::Double;
  int digits = 17;  ///< Significant decimal digits; for Kind::Digits, 1 .. 17.
  /// Positions are so many times as large as the file has them.
  Vec3d scale{1.0};
  /// Vertices that have not moved are written anew as well, as in a file of another format; else they keep their bytes.
  bool rounds_all = false;
};

}  // namespace vdb_offset
