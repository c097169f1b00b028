// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace vdb_offset {

/// Four floats, or four integers, that are worked on at once: the vector registers that every x86-64 has, and most
/// other machines. Comparisons give all ones or zero; `mask ? a : b` chooses lane by lane.
inline constexpr int kLanes = 4;
using Lanes = float __attribute__((vector_size(4 * kLanes)));
using IntLanes = std::int32_t __attribute__((vector_size(4 * kLanes)));

namespace detail {
template <class Vector, class Value>
Vector load_as(const Value* from) {
  Vector lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
}  // namespace detail

inline Lanes load_lanes(const float* from) { return detail::load_as<Lanes>(from); }
inline IntLanes load_lanes(const std::int32_t* from) { return detail::load_as<IntLanes>(from); }
template <class Vector, class Value>
void store_lanes(Value* to, const Vector& lanes) {
  std::memcpy(to, &lanes, sizeof lanes);
}
inline Lanes max_lanes(const Lanes& a, const Lanes& b) { return a > b ? a : b; }
inline Lanes sqrt_lanes(const Lanes& a) {
#ifdef __SSE2__
  return reinterpret_cast<Lanes>(_mm_sqrt_ps(reinterpret_cast<__m128>(a)));
#else
  return Lanes{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
#endif
}

/// Bit i is whether lane i of a comparison holds.
inline unsigned lane_bits(const IntLanes& mask) {
#ifdef __SSE2__
  return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(mask)));
#else
  return (mask[0] & 1u) | (mask[1] & 2u) | (mask[2] & 4u) | (mask[3] & 8u);
#endif
}
inline bool any(const IntLanes& mask) { return lane_bits(mask) != 0; }

}  // namespace vdb_offset
