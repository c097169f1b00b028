// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <cstdint>

namespace cad_proof {

/// The part of a seed: one solid of some 20 to 60 units. Null if OpenCASCADE does not build it, or not as a valid
/// solid.
TopoDS_Shape random_part(std::uint64_t seed);

/// How far to offset it: 0.5 to 5 % of its diagonal, in or out.
double random_share(std::uint64_t seed);

}  // namespace cad_proof
