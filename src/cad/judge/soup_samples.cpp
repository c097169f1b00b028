// SPDX-License-Identifier: Apache-2.0
#include "judge/soup_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>

namespace vdb_offset::cad {
namespace {

// How far beside triangles it is counted how often the result goes round, in distances: nearer, too, before a fault is
// called one, as triangles may fold up to what is thinner.
constexpr double kBeside[] = {1e-5, 1e-7};

// Numbers in [0, 1) that are the same on every machine (splitmix64).
class Numbers {
 public:
  double next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_ = 1;
};

}  // namespace

std::vector<SoupPoint> spread(const Soup& soup, int count) {
  std::vector<double> sums = {0};
  for (const Soup::Triangle& t : soup.triangles())
    sums.push_back(sums.back() +
                   gp_Vec(t.points[0], t.points[1]).Crossed(gp_Vec(t.points[0], t.points[2])).Magnitude());
  std::vector<SoupPoint> points;
  Numbers numbers;
  std::size_t at = 0;
  for (int i = 0; i < count; i++) {
    const double area = sums.back() * (i + numbers.next()) / count;
    while (at + 2 < sums.size() && sums[at + 1] <= area) at++;
    const double a = numbers.next(), b = numbers.next();
    points.push_back(soup.on_triangle(static_cast<int>(at), a, b));
  }
  // Small faces too: one point in every face's largest triangle.
  std::vector<int> largest(soup.faces().size(), -1);
  for (std::size_t t = 0; t + 1 < sums.size(); t++) {
    int& best = largest[soup.triangles()[t].face];
    if (best < 0 || sums[t + 1] - sums[t] > sums[best + 1] - sums[best]) best = static_cast<int>(t);
  }
  for (int t : largest)
    if (t >= 0) points.push_back(soup.on_triangle(t, 1.0 / 3, 1.0 / 3));
  return points;
}

std::size_t step_of_turns(const Soup& soup, std::size_t points) {
  constexpr std::size_t kMost = 20000000;  // triangles, for all points together
  return soup.is_closed() ? 1 : std::max<std::size_t>(1, points * soup.triangles().size() / kMost);
}

gp_Pnt middle_of(const Soup::Triangle& triangle) {
  const auto& [a, b, c] = triangle.points;
  return (a.XYZ() + b.XYZ() + c.XYZ()) / 3;
}

std::vector<int> turned_triangles(const Soup& soup, double scale, int samples, bool may_fold) {
  std::vector<int> turned;
  const std::vector<SoupPoint> points = spread(soup, samples);
  const std::size_t every = step_of_turns(soup, points.size());
  const double outside = soup.volume() < 0 ? -1 : 0;  // of a cavity by itself
  const auto is_other = [](double turns, double expected) {
    // Between whole numbers triangles have gaps, or miss each other, which is reported elsewhere.
    return std::abs(turns - std::round(turns)) < 0.05 && std::round(turns) != expected;
  };
  for (std::size_t i = 0; i < points.size(); i += every) {
    const Soup::Triangle& at = soup.triangles()[points[i].triangle];
    const auto& [a, b, c] = at.points;
    const gp_Vec across = gp_Vec(a, b).Crossed(gp_Vec(a, c));
    const gp_Pnt middle = middle_of(at);
    if (across.Magnitude() < 1e-6 * scale * scale) continue;
    const auto is_turned = [&](double beside) {
      const gp_Vec out = across.Normalized() * (beside * scale);
      const double beyond = soup.turns(middle.Translated(out)), within = soup.turns(middle.Translated(-out));
      if (may_fold && std::abs(within - beyond) < 0.05) return false;
      return is_other(beyond, outside) || is_other(within, outside + 1);
    };
    if (std::all_of(std::begin(kBeside), std::end(kBeside), is_turned)) turned.push_back(points[i].triangle);
  }
  return turned;
}

}  // namespace vdb_offset::cad
