// SPDX-License-Identifier: Apache-2.0
#include "offset/contact.h"

#include <Geom2d_Curve.hxx>
#include <algorithm>
#include <cmath>

namespace vdb_offset::cad {
namespace {

constexpr int kMostSteps = 60;

// Solves (A + damping * diag A) x = b for a symmetric A, by elimination with pivots; false if it is singular.
bool solve_damped(std::vector<double> a, std::vector<double> b, double damping, std::vector<double>& x) {
  const int n = static_cast<int>(b.size());
  for (int i = 0; i < n; i++) a[i * n + i] *= 1 + damping;
  for (int c = 0; c < n; c++) {
    int pivot = c;
    for (int r = c + 1; r < n; r++)
      if (std::abs(a[r * n + c]) > std::abs(a[pivot * n + c])) pivot = r;
    if (!(std::abs(a[pivot * n + c]) > 1e-300)) return false;
    if (pivot != c) {
      for (int k = 0; k < n; k++) std::swap(a[c * n + k], a[pivot * n + k]);
      std::swap(b[c], b[pivot]);
    }
    for (int r = c + 1; r < n; r++) {
      const double f = a[r * n + c] / a[c * n + c];
      for (int k = c; k < n; k++) a[r * n + k] -= f * a[c * n + k];
      b[r] -= f * b[c];
    }
  }
  x.assign(n, 0);
  for (int r = n - 1; r >= 0; r--) {
    double sum = b[r];
    for (int k = r + 1; k < n; k++) sum -= a[r * n + k] * x[k];
    x[r] = sum / a[r * n + r];
  }
  return true;
}

// Levenberg and Marquardt: makes |residuals(x)| least. `fill` gives residuals and their derivatives (row by row).
template <class Fill>
void least_squares(std::vector<double>& x, std::size_t rows, Fill&& fill) {
  const int n = static_cast<int>(x.size());
  std::vector<double> r(rows), j(rows * n), r2(rows), j2(rows * n), step;
  fill(x, r, j);
  const auto norm = [](const std::vector<double>& v) {
    double s = 0;
    for (double e : v) s += e * e;
    return s;
  };
  double best = norm(r), damping = 1e-9;
  for (int i = 0; i < kMostSteps && best > 1e-28; i++) {
    std::vector<double> a(n * n), b(n);
    for (std::size_t k = 0; k < rows; k++)
      for (int p = 0; p < n; p++) {
        b[p] -= j[k * n + p] * r[k];
        for (int q = 0; q < n; q++) a[p * n + q] += j[k * n + p] * j[k * n + q];
      }
    for (int p = 0; p < n; p++) a[p * n + p] = std::max(a[p * n + p], 1e-12);
    if (!solve_damped(a, b, damping, step)) break;
    std::vector<double> y = x;
    for (int p = 0; p < n; p++) y[p] += step[p];
    fill(y, r2, j2);
    const double now = norm(r2);
    if (now < best) {
      const bool is_done = best - now < 1e-12 * best;
      x = y;
      std::swap(r, r2);
      std::swap(j, j2);
      best = now;
      damping = std::max(damping * 0.1, 1e-12);
      if (is_done) break;
    } else {
      damping = std::max(damping * 30, 1e-6);
      if (damping > 1e8) break;
    }
  }
}

void put(std::vector<double>& j, std::size_t n, std::size_t row, std::size_t column, const gp_Vec& d) {
  j[row * n + column] = d.X();
  j[(row + 1) * n + column] = d.Y();
  j[(row + 2) * n + column] = d.Z();
}

}  // namespace

gp_Pnt2d project(const Geom_Surface& surface, const gp_Pnt& point, gp_Pnt2d start, double* distance) {
  std::vector<double> x = {start.X(), start.Y()};
  least_squares(x, 3, [&](const std::vector<double>& at, std::vector<double>& r, std::vector<double>& j) {
    gp_Pnt p;
    gp_Vec du, dv;
    surface.D1(at[0], at[1], p, du, dv);
    r = {p.X() - point.X(), p.Y() - point.Y(), p.Z() - point.Z()};
    put(j, 2, 0, 0, du);
    put(j, 2, 0, 1, dv);
  });
  const gp_Pnt2d uv(x[0], x[1]);
  if (distance) *distance = surface.Value(x[0], x[1]).Distance(point);
  return uv;
}

Contact meet(const Geom_Surface& a, const Geom_Surface& b, const gp_Pnt& plane_point, const gp_Vec& plane_normal,
             gp_Pnt2d start_a, gp_Pnt2d start_b) {
  std::vector<double> x = {start_a.X(), start_a.Y(), start_b.X(), start_b.Y()};
  const gp_Vec t = plane_normal.Normalized();
  least_squares(x, 4, [&](const std::vector<double>& at, std::vector<double>& r, std::vector<double>& j) {
    gp_Pnt p, q;
    gp_Vec pu, pv, qu, qv;
    a.D1(at[0], at[1], p, pu, pv);
    b.D1(at[2], at[3], q, qu, qv);
    const gp_Vec off(q, p);
    r = {off.X(), off.Y(), off.Z(), (gp_Vec(plane_point, p) + gp_Vec(plane_point, q)).Dot(t) / 2};
    put(j, 4, 0, 0, pu);
    put(j, 4, 0, 1, pv);
    put(j, 4, 0, 2, -qu);
    put(j, 4, 0, 3, -qv);
    j[12] = pu.Dot(t) / 2;
    j[13] = pv.Dot(t) / 2;
    j[14] = qu.Dot(t) / 2;
    j[15] = qv.Dot(t) / 2;
  });
  Contact c;
  c.a = gp_Pnt2d(x[0], x[1]);
  c.b = gp_Pnt2d(x[2], x[3]);
  const gp_Pnt p = a.Value(x[0], x[1]), q = b.Value(x[2], x[3]);
  c.point = gp_Pnt((p.XYZ() + q.XYZ()) / 2);
  c.residual = std::max(p.Distance(q) / 2, std::abs(gp_Vec(plane_point, c.point).Dot(t)));
  return c;
}

double meet(std::vector<Support>& supports, gp_Pnt& point) {
  std::vector<double> x = {point.X(), point.Y(), point.Z()};
  for (const Support& s : supports) {
    if (s.curve.IsNull()) x.insert(x.end(), {s.uv.X(), s.uv.Y()});
    else x.push_back(s.t);
  }
  const std::size_t n = x.size();
  least_squares(x, 3 * supports.size(),
                [&](const std::vector<double>& at, std::vector<double>& r, std::vector<double>& j) {
                  std::fill(j.begin(), j.end(), 0.0);
                  std::size_t column = 3;
                  for (std::size_t i = 0; i < supports.size(); i++) {
                    const Support& s = supports[i];
                    gp_Pnt p;
                    gp_Vec du, dv;
                    if (s.curve.IsNull()) {
                      s.surface->D1(at[column], at[column + 1], p, du, dv);
                      put(j, n, 3 * i, column, du);
                      put(j, n, 3 * i, column + 1, dv);
                      column += 2;
                    } else {
                      gp_Pnt2d uv;
                      gp_Vec2d tangent;
                      evaluate(*s.curve, at[column], uv, tangent);
                      s.surface->D1(uv.X(), uv.Y(), p, du, dv);
                      put(j, n, 3 * i, column, du * tangent.X() + dv * tangent.Y());
                      column++;
                    }
                    r[3 * i] = p.X() - at[0];
                    r[3 * i + 1] = p.Y() - at[1];
                    r[3 * i + 2] = p.Z() - at[2];
                    for (int k = 0; k < 3; k++) j[(3 * i + k) * n + k] = -1;
                  }
                });
  point = gp_Pnt(x[0], x[1], x[2]);
  double worst = 0;
  std::size_t column = 3;
  for (Support& s : supports) {
    if (s.curve.IsNull()) {
      s.uv = gp_Pnt2d(x[column], x[column + 1]);
      column += 2;
    } else {
      s.t = x[column++];
      gp_Vec2d tangent;
      evaluate(*s.curve, s.t, s.uv, tangent);
    }
    worst = std::max(worst, s.surface->Value(s.uv.X(), s.uv.Y()).Distance(point));
  }
  return worst;
}

void evaluate(const Geom2d_Curve& curve, double t, gp_Pnt2d& p, gp_Vec2d& tangent) {
  const double inside = curve.IsPeriodic() ? t : std::clamp(t, curve.FirstParameter(), curve.LastParameter());
  curve.D1(inside, p, tangent);
  p.Translate(tangent * (t - inside));
}

}  // namespace vdb_offset::cad
