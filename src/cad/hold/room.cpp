// SPDX-License-Identifier: Apache-2.0
#include "hold/room.h"

#include <algorithm>
#include <array>

namespace vdb_offset::cad {
namespace {

constexpr double kNearEnough = 4e-3;  // to where fronts meet, of the way that is asked for
constexpr int kMostSteps = 60;        // where a point goes along what it must not meet

using Corners = std::array<gp_Pnt2d, 3>;  // as shares of the second and third corner of a triangle

class TriangleVisit {
 public:
  TriangleVisit(const Soup& soup, int triangle, double apart, double far, const Opposite& opposite,
                const std::function<void(const SourcePlace&)>& visit)
      : soup_(soup), triangle_(triangle), apart_(apart), far_(far), opposite_(opposite), visit_(visit) {}

  bool run() {
    part({gp_Pnt2d(0, 0), gp_Pnt2d(1, 0), gp_Pnt2d(0, 1)});
    return is_all_;
  }

 private:
  gp_Pnt flat(const gp_Pnt2d& shares) const {
    const auto& p = soup_.triangles()[static_cast<std::size_t>(triangle_)].points;
    return gp_Pnt(p[0].XYZ() * (1 - shares.X() - shares.Y()) + p[1].XYZ() * shares.X() + p[2].XYZ() * shares.Y());
  }

  void part(const Corners& corners) {
    const gp_Pnt2d middle((corners[0].XY() + corners[1].XY() + corners[2].XY()) / 3);
    const gp_Pnt centre = flat(middle);
    double radius = 0, longest = 0;
    int side = 0;  // the longest, across from this corner
    for (int k = 0; k < 3; ++k) {
      radius = std::max(radius, centre.Distance(flat(corners[k])));
      const double length = flat(corners[(k + 1) % 3]).Distance(flat(corners[(k + 2) % 3]));
      if (length <= longest) continue;
      longest = length;
      side = k;
    }
    const SoupPoint at = soup_.on_triangle(triangle_, middle.X(), middle.Y());
    const Soup::Facing facing{opposite_.faces, soup_.outside(at), opposite_.most_cosine};
    if (!opposite_.soup->has_near(centre, far_ + radius, facing)) {
      is_all_ = false;
      return;
    }
    if (longest <= apart_) {
      visit_({at.point, at.uv, soup_.outside(at), triangle_});
      return;
    }
    const gp_Pnt2d &from = corners[(side + 1) % 3], &to = corners[(side + 2) % 3];
    const gp_Pnt2d between((from.XY() + to.XY()) / 2);
    part({corners[side], from, between});
    part({corners[side], between, to});
  }

  const Soup& soup_;
  const int triangle_;
  const double apart_, far_;
  const Opposite& opposite_;
  const std::function<void(const SourcePlace&)>& visit_;
  bool is_all_ = true;
};

}  // namespace

Room room_along(const gp_Pnt& from, const gp_Vec& way, const gp_Vec& outside, double most, const Opposite& opposite) {
  const Soup::Facing facing{opposite.faces, outside, opposite.most_cosine};
  double gone = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    // What is farther away cannot be met on the rest of the way.
    const double reach = opposite.keep + opposite.speed * most + (most - gone);
    const Soup::Nearest nearest = opposite.soup->nearest(from.Translated(way * gone), reach, facing);
    if (nearest.triangle < 0) return {most};
    const double safe = (nearest.distance - opposite.keep - opposite.speed * gone) / (1 + opposite.speed);
    if (safe <= kNearEnough * most) return {gone, nearest.triangle};
    gone += safe;
    if (gone >= most) return {most};
  }
  return {gone, -1};
}

bool visit_triangle(const Soup& soup, int triangle, double apart, double far, const Opposite& opposite,
                    const std::function<void(const SourcePlace&)>& visit) {
  return TriangleVisit(soup, triangle, apart, far, opposite, visit).run();
}

}  // namespace vdb_offset::cad
