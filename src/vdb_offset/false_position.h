#pragma once

namespace vdb_offset {

/// Where f vanishes, between a and b, at which it is f_a and f_b, of opposite signs: false position as Illinois has it,
/// until settled(f) or after so many steps. The last place that f was asked for; b, if that was settled.
template <class F, class Settled>
double false_position(double a, double f_a, double b, double f_b, int most_steps, F&& f, Settled&& settled) {
  for (int i = 0; i < most_steps && !settled(f_b); ++i) {
    const double c = (a * f_b - b * f_a) / (f_b - f_a), f_c = f(c);
    if ((f_c > 0) == (f_b > 0)) {
      f_a /= 2;
    } else {
      a = b;
      f_a = f_b;
    }
    b = c;
    f_b = f_c;
  }
  return b;
}

}  // namespace vdb_offset
