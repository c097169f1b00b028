#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#ifdef __SSE2__
#include <immintrin.h>
#endif

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

inline void store_floats(const Pair& values, float* to) {
  to[0] = static_cast<float>(values[0]), to[1] = static_cast<float>(values[1]);
}

#ifdef __AVX2__
/// Four numbers, where a source is compiled for such registers: see prism_quality_columns_avx2.cpp.
using Quad = double __attribute__((vector_size(32)));
inline Quad root(const Quad& squares) {
  return reinterpret_cast<Quad>(_mm256_sqrt_pd(reinterpret_cast<__m256d>(squares)));
}
inline void store_floats(const Quad& values, float* to) {
  _mm_storeu_ps(to, _mm256_cvtpd_ps(reinterpret_cast<__m256d>(values)));
}
#endif

template <class Real>
Real lesser(const Real& a, const Real& b) {
  return b < a ? b : a;
}
template <class Real>
Real greater(const Real& a, const Real& b) {
  return b > a ? b : a;
}

/// A vector of so many dimensions as space has, of one number each or of several: what is a template over Real is then
/// done for several things at once.
template <class Real>
struct Way {
  Real x, y, z;

  /// `way` has an x, y and z at 0, 1 and 2.
  template <class Place>
  void set(std::size_t lane, const Place& way) {
    x[lane] = way[0], y[lane] = way[1], z[lane] = way[2];
  }
  Real dot(const Way& o) const { return x * o.x + y * o.y + z * o.z; }
  Way cross(const Way& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
};
template <class Real>
Way<Real> operator+(const Way<Real>& a, const Way<Real>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class Real>
Way<Real> operator-(const Way<Real>& a, const Way<Real>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class Place>
Way<Pair> both(const Place& a, const Place& b) {
  return {Pair{a[0], b[0]}, Pair{a[1], b[1]}, Pair{a[2], b[2]}};
}

}  // namespace vdb_offset
