// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "products/fill/front.h"

namespace vdb_offset {

/// A face of four corners that a pyramid is to stand on, and the first of the two triangles that stand for it in the
/// front.
struct QuadOfFront {
  std::array<std::uint32_t, 4> corners;  ///< As the cell behind it has them.
  std::uint32_t triangle;
};

/// Puts pyramids on the quads of a front, and their sides in its place. A pyramid leans over each of its edges by no
/// more than a third of the angle that is free there, and is lower where it would cross another face.
/// \throw FillFailed where faces cross however low pyramids are
void put_pyramids_on(std::span<const QuadOfFront> quads, FillFront& front, VolumeMesh& volume);

}  // namespace vdb_offset
