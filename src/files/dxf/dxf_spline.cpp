// SPDX-License-Identifier: Apache-2.0
#include "dxf/dxf_spline.h"

#include <algorithm>
#include <utility>

namespace vdb_offset::io {
namespace {

DxfWeighted between(const DxfWeighted& a, const DxfWeighted& b, double t) {
  DxfWeighted p;
  for (std::size_t k = 0; k < p.size(); ++k) p[k] = (1 - t) * a[k] + t * b[k];
  return p;
}

/// The blossom of the polynomial over a knot span, at `before` arguments of its end and all others of its beginning: a
/// control point of the Bézier curve over it. \param span number of the knot that the span begins with
DxfWeighted blossom(const DxfSpline& spline, std::size_t span, std::size_t at_end) {
  const std::vector<double>& u = spline.knots;
  const std::size_t degree = spline.degree;
  std::vector<DxfWeighted> d(spline.points.begin() + static_cast<std::ptrdiff_t>(span - degree),
                             spline.points.begin() + static_cast<std::ptrdiff_t>(span + 1));
  for (std::size_t r = 1; r <= degree; ++r) {
    const double at = r <= at_end ? u[span + 1] : u[span];
    for (std::size_t j = degree; j >= r; --j) {
      const double from = u[span + j - degree], to = u[span + 1 + j - r];
      d[j] = between(d[j - 1], d[j], (at - from) / (to - from));
    }
  }
  return d[degree];
}

double distance_to_chord(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d along = b - a, to = p - a;
  const double length = std::hypot(along[0], along[1], along[2]);
  if (!(length > 0)) return std::hypot(to[0], to[1], to[2]);
  const Vec3d unit(along[0] / length, along[1] / length, along[2] / length);
  const Vec3d off = to - unit * std::clamp(to.dot(unit), 0.0, length);
  return std::hypot(off[0], off[1], off[2]);
}

}  // namespace

std::vector<DxfBezier> bezier_pieces(const DxfSpline& spline) {
  std::vector<DxfBezier> pieces;
  for (std::size_t span = spline.degree; span < spline.points.size(); ++span) {
    if (!(spline.knots[span] < spline.knots[span + 1])) continue;
    DxfBezier& piece = pieces.emplace_back();
    for (std::size_t k = 0; k <= spline.degree; ++k) piece.push_back(blossom(spline, span, k));
    // Pieces meet; what each computes for the point where they do may differ by rounding.
    if (pieces.size() > 1) piece.front() = pieces[pieces.size() - 2].back();
  }
  return pieces;
}

std::array<DxfBezier, 2> halves_of(const DxfBezier& curve) {
  DxfBezier left, right(curve.size()), row = curve;
  left.reserve(curve.size());
  for (std::size_t n = curve.size(); n-- > 0;) {
    left.push_back(row.front());
    right[n] = row[n];
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t i = 0; i < row[k].size(); ++i) row[k][i] = 0.5 * row[k][i] + 0.5 * row[k + 1][i];
  }
  return {std::move(left), std::move(right)};
}

bool is_flat(const DxfBezier& curve, double tolerance) {
  const Vec3d first = point_of(curve.front()), last = point_of(curve.back());
  return std::all_of(curve.begin(), curve.end(),
                     [&](const DxfWeighted& p) { return distance_to_chord(point_of(p), first, last) <= tolerance; });
}

}  // namespace vdb_offset::io
