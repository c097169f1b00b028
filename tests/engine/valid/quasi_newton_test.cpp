// SPDX-License-Identifier: Apache-2.0
#include "valid/untangle/quasi_newton.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using namespace vdb_offset;

namespace {

using Vector = std::vector<double>;

/// The gradient of x'Ax / 2 - b'x, where A has 1 .. n on its diagonal and 1 / 8 beside it, and b is 1.
Vector gradient(const Vector& x) {
  Vector g(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    g[i] = static_cast<double>(i + 1) * x[i] - 1;
    if (i > 0) g[i] += x[i - 1] / 8;
    if (i + 1 < x.size()) g[i] += x[i + 1] / 8;
  }
  return g;
}

Vector moved(const Vector& x, double t, const Vector& step) {
  Vector there = x;
  for (std::size_t i = 0; i < x.size(); ++i) there[i] += t * step[i];
  return there;
}

}  // namespace

TEST_CASE("quasi-newton: the dot product of any number of values", "[quasi_newton]") {
  for (std::size_t n = 0; n < 10; ++n) {
    Vector a(n), b(n);
    double expected = 0;
    for (std::size_t i = 0; i < n; ++i) {
      a[i] = static_cast<double>(i + 1);
      b[i] = static_cast<double>(2 * i) - 3;
      expected += a[i] * b[i];
    }
    CHECK(dot(a, b) == expected);
  }
}

TEST_CASE("quasi-newton: without a step, down the gradient; with one, what that step tells", "[quasi_newton]") {
  QuasiNewton model;
  const Vector g{3, -1, 0.5}, x{0, 0, 0}, next{1, 2, -1}, next_g{5, 3, 0};
  Vector step(3);
  model.descend(g, step);
  CHECK(step == Vector{-3, 1, -0.5});
  // The secant equation: where the gradient is y, the step that made it y is gone back.
  model.remember(x, next, g, next_g);
  const Vector y{2, 4, -0.5};
  model.descend(y, step);
  for (std::size_t i = 0; i < 3; ++i) CHECK(step[i] == Approx(x[i] - next[i]).epsilon(1e-14));
}

TEST_CASE("quasi-newton: a step along which the gradient does not grow is not remembered", "[quasi_newton]") {
  QuasiNewton model;
  model.remember(Vector{0, 0}, Vector{1, 0}, Vector{1, 1}, Vector{0.5, 1});  // it falls
  model.remember(Vector{0, 0}, Vector{1, 0}, Vector{1, 1}, Vector{1, 7});    // it changes across the step alone
  Vector step(2);
  model.descend(Vector{2, 3}, step);
  CHECK(step == Vector{-2, -3});
}

TEST_CASE("quasi-newton: a quadratic of n variables is at its least after n exact steps", "[quasi_newton][oracle]") {
  // With exact line searches L-BFGS makes the steps of conjugate gradients, as long as it remembers all of them.
  const std::size_t n = QuasiNewton::kMemory;
  Vector x(n, 0.0), g = gradient(x), step(n);
  QuasiNewton model;
  for (std::size_t i = 0; i < n; ++i) {
    CHECK(dot(g, g) > 1e-12);  // not before
    model.descend(g, step);
    // The gradient is linear: A step = gradient(x + step) - gradient(x).
    Vector curvature = gradient(moved(x, 1, step));
    for (std::size_t k = 0; k < n; ++k) curvature[k] -= g[k];
    const Vector next = moved(x, -dot(g, step) / dot(step, curvature), step), next_g = gradient(next);
    model.remember(x, next, g, next_g);
    x = next;
    g = next_g;
  }
  CHECK(std::sqrt(dot(g, g)) < 1e-10);
  // More steps than it remembers keep it there.
  for (int i = 0; i < 5; ++i) {
    model.descend(g, step);
    const Vector next = moved(x, 1, step), next_g = gradient(next);
    model.remember(x, next, g, next_g);
    x = next;
    g = next_g;
  }
  CHECK(std::sqrt(dot(g, g)) < 1e-10);
}
