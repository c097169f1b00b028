// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "write/check_body.h"

namespace vdb_offset::cad {

/// A body to be offset, with all that attempts at it need.
struct BodyTask {
  const OffsetBody& body;
  const Asked& asked;
  std::function<void(const MadeBody&)> keep;  ///< Keeps what is doubtful for the case that time ends.
  OffsetCadRequest request() const { return request_of(body, asked); }
  bool is_even_solid() const { return body.is_even() && body.body.is_solid; }
  /// Whether it is to be a thick solid with openings, and of one thickness.
  bool is_opened_solid() const { return asked.write.thick && body.body.is_solid && body.distance_of_moved(); }
  bool may_be_trimmed() const { return is_even_solid() || is_opened_solid(); }
};

/// A way to offset a body.
struct Attempt {
  bool (*may)(const BodyTask&);       ///< Whether it is one for this body.
  MadeBody (*make)(const BodyTask&);  ///< \throw Standard_Failure
  bool is_of_mesh;                    ///< Takes triangles of the offset mesh where exact faces fail.
  unsigned seconds;                   ///< Of a processor at most; 0: as many as it takes.
  double most_time;                   ///< How much of the time that is left it may take.
  double share;                       ///< How much of the whole is shown as done after it: most succeed at first.
};

/// All ways, in the order in which they are tried until one is good.
std::span<const Attempt> attempts();

}  // namespace vdb_offset::cad
