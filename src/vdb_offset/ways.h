#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "vdb_offset/polygons.h"

namespace vdb_offset {

/// Two numbers that are worked on at once, as the registers of every x86-64 do; comparisons give all ones or zero.
using Pair = double __attribute__((vector_size(16)));
using PairMask = std::int64_t __attribute__((vector_size(16)));

inline double root(double square) { return std::sqrt(square); }
inline Pair root(const Pair& squares) {
#ifdef __SSE2__
  return reinterpret_cast<Pair>(_mm_sqrt_pd(reinterpret_cast<__m128d>(squares)));
#else
  return Pair{std::sqrt(squares[0]), std::sqrt(squares[1])};
#endif
}
template <class Real>
Real lesser(const Real& a, const Real& b) {
  return b < a ? b : a;
}
template <class Real>
Real greater(const Real& a, const Real& b) {
  return b > a ? b : a;
}

/// A vector of so many dimensions as space has, of one number each or of two: what is a template over Real is then done
/// for two things at once.
template <class Real>
struct Way {
  Real x, y, z;

  void set(std::size_t lane, const Vec3d& way) { x[lane] = way[0], y[lane] = way[1], z[lane] = way[2]; }
  Real dot(const Way& o) const { return x * o.x + y * o.y + z * o.z; }
  Way cross(const Way& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
};
template <class Real>
Way<Real> operator-(const Way<Real>& a, const Way<Real>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Way<Pair> both(const Vec3d& a, const Vec3d& b) { return {Pair{a[0], b[0]}, Pair{a[1], b[1]}, Pair{a[2], b[2]}}; }

}  // namespace vdb_offset
