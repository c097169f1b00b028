// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#ifdef __SSE2__
#include <immintrin.h>
#endif

namespace vdb_offset {

/// Two numbers that are worked on at once, in the registers that every x86-64 has. Comparisons give all ones or zero.
using double2 = double __attribute__((vector_size(16)));
using PairMask = std::int64_t __attribute__((vector_size(16)));

inline double root(double square) { return std::sqrt(square); }
inline double2 root(const double2& squares) {
#ifdef __SSE2__
  return reinterpret_cast<double2>(_mm_sqrt_pd(reinterpret_cast<__m128d>(squares)));
#else
  return double2{std::sqrt(squares[0]), std::sqrt(squares[1])};
#endif
}

inline void store_floats(const double2& values, float* to) {
  to[0] = static_cast<float>(values[0]), to[1] = static_cast<float>(values[1]);
}

#ifdef __AVX2__
/// Four numbers, where a source is compiled for such registers: see prism_quality_columns_avx2.cpp.
using double4 = double __attribute__((vector_size(32)));
inline double4 root(const double4& squares) {
  return reinterpret_cast<double4>(_mm256_sqrt_pd(reinterpret_cast<__m256d>(squares)));
}
inline void store_floats(const double4& values, float* to) {
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

/// A 3-D vector with lanes: a component is one number, or two or four of them. A function that is a template over Real
/// then works on several things at once.
template <class Real>
struct Vec3Of {
  Real x, y, z;

  /// Sets one lane to a vector that has x, y and z at 0, 1 and 2.
  template <class Vector>
  void set(std::size_t lane, const Vector& v) {
    x[lane] = v[0], y[lane] = v[1], z[lane] = v[2];
  }
  Real dot(const Vec3Of& o) const { return x * o.x + y * o.y + z * o.z; }
  Vec3Of cross(const Vec3Of& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
};
template <class Real>
Vec3Of<Real> operator+(const Vec3Of<Real>& a, const Vec3Of<Real>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class Real>
Vec3Of<Real> operator-(const Vec3Of<Real>& a, const Vec3Of<Real>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class Vector>
Vec3Of<double2> both(const Vector& a, const Vector& b) {
  return {double2{a[0], b[0]}, double2{a[1], b[1]}, double2{a[2], b[2]}};
}

}  // namespace vdb_offset
