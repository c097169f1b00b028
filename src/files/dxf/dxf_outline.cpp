// SPDX-License-Identifier: Apache-2.0
// Draws the curves that entities are.
#include "dxf/dxf_outline.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ground/system/memory.h"

namespace vdb_offset::io {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// The point of the unit circle at an angle in degrees; exact at multiples of 90.
Vec2d unit_at(double degrees) {
  const double quarters = std::floor(degrees / 90 + 0.5), rest = (degrees - 90 * quarters) * kTurn / 360;
  const Vec2d p(std::cos(rest), std::sin(rest));
  switch (static_cast<int>(std::fmod(std::fmod(quarters, 4) + 4, 4))) {
    case 0:
      return p;
    case 1:
      return {-p[1], p[0]};
    case 2:
      return -p;
    default:
      return {p[1], -p[0]};
  }
}

/// The arc between two points of a polyline. Its bulge is the tangent of a quarter of its angle, above 0 if it runs
/// counterclockwise: what lies to the right of the chord.
SvgCurve bulge_arc(const Vec2d& first, const Vec2d& last, double bulge) {
  const Vec2d chord = last - first;
  const double length = std::hypot(chord[0], chord[1]);
  const Vec2d right(chord[1] / length, -chord[0] / length);
  const double radius = length / 4 * (1 / bulge + bulge), height = length / 2 * bulge;
  const Vec2d middle = radius * right;
  return SvgArc{first,
                last,
                (first + last) / 2 + (height - radius) * right,
                middle,
                {-middle[1], middle[0]},
                2 * std::atan(bulge)};
}

/// The matrix of what is given by a centre and the ends of two half axes, seen from it.
SvgMatrix axes_of(const Vec2d& centre, const Vec2d& u, const Vec2d& v) {
  return {u[0], u[1], v[0], v[1], centre[0], centre[1]};
}

/// Draws the unit circle under a matrix: all of it, with a like number of points in each quarter.
void draw_circle(const SvgMatrix& plane, double z, DxfPen& pen) {
  const Vec3d first = transformed(plane, Vec2d(1.0, 0.0));
  pen.point({first[0], first[1], z});
  for (int quarter = 0; quarter < 4; ++quarter)
    pen.arc(transformed(plane, quarter_of_ellipse({0.0, 0.0}, {1.0, 1.0}, quarter)), z,
            quarter == 3 ? DxfPen::Ends::AtFirstPoint : DxfPen::Ends::There);
  pen.end(true);
}

/// Draws the part of the unit circle between two directions, counterclockwise.
void draw_arc(const SvgMatrix& plane, double z, const Vec2d& first, const Vec2d& middle, const Vec2d& last,
              double sweep, DxfPen& pen) {
  const SvgArc arc{first, last, {0.0, 0.0}, middle, {-middle[1], middle[0]}, sweep / 2};
  const Vec3d begin = transformed(plane, first);
  pen.point({begin[0], begin[1], z});
  pen.arc(transformed(plane, SvgCurve(arc)), z, DxfPen::Ends::There);
  pen.end(false);
}

/// Draws polylines vertex by vertex.
class PolylinePen {
 public:
  struct Vertex {
    Vec3d at{0.0};
    double bulge = 0;
  };

  PolylinePen(const DxfPlacement& placement, DxfPen& pen) : placement_(placement), pen_(pen) {}

  void add(const Vertex& vertex) {
    if (count_++ == 0) first_ = vertex, pen_.point(placement_(vertex.at));
    else go_to(vertex, DxfPen::Ends::There);
    last_ = vertex;
  }
  /// Returns whether all segments are straight.
  bool end(bool closed) {
    if (count_ == 0) return true;
    if (closed && count_ > 1) go_to(first_, DxfPen::Ends::AtFirstPoint);
    pen_.end(closed);
    return is_straight_;
  }

 private:
  void go_to(const Vertex& vertex, DxfPen::Ends ends) {
    const Vec2d from(last_.at[0], last_.at[1]), to(vertex.at[0], vertex.at[1]);
    // Of a flatter arc, rounding would put points farther off than its chord is.
    constexpr double kFlattest = 1e-8;
    if (std::abs(last_.bulge) > kFlattest && from != to) {
      is_straight_ = false;
      pen_.arc(transformed(placement_.plane, bulge_arc(from, to, last_.bulge)), placement_(vertex.at)[2], ends);
    } else if (ends == DxfPen::Ends::There) {
      pen_.point(placement_(vertex.at));
    }
  }

  const DxfPlacement placement_;
  DxfPen& pen_;
  Vertex first_, last_;
  std::size_t count_ = 0;
  bool is_straight_ = true;
};

class EntityDrawer {
 public:
  EntityDrawer(const DxfText& text, const DxfEntity& entity, const DxfPlacement& placement, DxfPen& pen)
      : text_(text), entity_(entity), placement_(placement), pen_(pen) {}

  bool run() const {
    switch (entity_.kind) {
      case DxfKind::Line:
        return line();
      case DxfKind::LwPolyline:
        return lw_polyline();
      case DxfKind::Polyline:
        return polyline();
      case DxfKind::Arc:
      case DxfKind::Circle:
        return circle();
      case DxfKind::Ellipse:
        return ellipse();
      case DxfKind::Spline:
        return spline();
      default:
        return false;
    }
  }

 private:
  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    text_.fail_at(entity_.begin, expected, found);
  }

  DxfPlacement own_placement() const {
    return is_mirrored(text_, entity_) ? product(placement_, kDxfMirrored) : placement_;
  }

  bool line() const {
    const DxfValues values(text_, entity_, {10, 20, 30, 11, 21, 31});
    pen_.point(placement_(values.point(10)));
    pen_.point(placement_(values.point(11)));
    pen_.end(false);
    return true;
  }

  bool lw_polyline() const {
    const DxfValues values(text_, entity_, {38, 70});
    PolylinePen pen(own_placement(), pen_);
    PolylinePen::Vertex vertex;
    bool is_begun = false;
    text_.for_each_own(entity_.begin, entity_.body_end, [&](const DxfGroup& group) {
      if (group.code == 10) {
        if (is_begun) pen.add(vertex);
        is_begun = true;
        vertex = {{text_.number(group), 0, values.value(38)}};
      } else if (group.code == 20) {
        vertex.at[1] = text_.number(group);
      } else if (group.code == 42) {
        vertex.bulge = text_.number(group);
      }
    });
    if (is_begun) pen.add(vertex);
    return pen.end((values.flags(70) & 1) != 0);
  }

  bool polyline() const {
    const DxfValues values(text_, entity_, {30, 70});
    constexpr std::int64_t kClosed = 1, kSplineFit = 4, kInSpace = 8;
    const std::int64_t flags = values.flags(70);
    const bool in_space = (flags & kInSpace) != 0;
    PolylinePen pen(in_space ? placement_ : own_placement(), pen_);
    PolylinePen::Vertex vertex;
    bool is_begun = false;
    const auto end_vertex = [&] {
      if (is_begun) pen.add(vertex);
      is_begun = true;
      vertex = {{0, 0, in_space ? 0 : values.value(30)}};
    };
    text_.for_each_own(entity_.body_end, entity_.end, [&](const DxfGroup& group) {
      if (group.code == 0) end_vertex();  // SEQEND ends the last one
      else if (group.code == 10 || group.code == 20) vertex.at[group.code / 10 - 1] = text_.number(group);
      else if (group.code == 30) take_height(group, vertex, in_space);
      else if (group.code == 42 && !in_space) vertex.bulge = text_.number(group);
      else if (group.code == 70 && is_frame_vertex(text_.integer(group))) is_begun = false;
    });
    return pen.end((flags & kClosed) != 0) && (flags & kSplineFit) == 0;
  }

  /// The height of a plane polyline is its own. Writers that give one to vertices alone mean that.
  void take_height(const DxfGroup& group, PolylinePen::Vertex& vertex, bool in_space) const {
    const double z = text_.number(group);
    if (in_space || z != 0) vertex.at[2] = z;
  }

  bool circle() const {
    const DxfValues values(text_, entity_, {10, 20, 30, 40, 50, 51});
    const double radius = values.value(40);
    if (!(radius >= 0)) fail("a radius of 0 or more", fmt::format("{}", radius));
    const DxfPlacement placement = own_placement();
    const Vec3d centre = values.point(10);
    const double z = placement(centre)[2];
    const SvgMatrix plane = product(placement.plane, axes_of({centre[0], centre[1]}, {radius, 0.0}, {0.0, radius}));
    if (radius == 0) return false;
    if (entity_.kind == DxfKind::Circle) {
      draw_circle(plane, z, pen_);
      return false;
    }
    const double first = values.value(50), last = values.value(51, 360);
    double sweep = std::fmod(last - first, 360);
    if (!(sweep > 0)) sweep += 360;
    draw_arc(plane, z, unit_at(first), unit_at(first + sweep / 2), unit_at(last), sweep * kTurn / 360, pen_);
    return false;
  }

  bool ellipse() const {
    const DxfValues values(text_, entity_, {10, 20, 30, 11, 21, 31, 40, 41, 42});
    const Vec3d centre = values.point(10), major = values.point(11);
    if (major[2] != 0) fail("an ELLIPSE in a plane z = constant", fmt::format("an axis that rises by {}", major[2]));
    const double ratio = values.value(40, 1) * (is_mirrored(text_, entity_) ? -1 : 1);
    if (ratio == 0) fail("a ratio of the axes that is not 0", "0");
    const Vec2d u(major[0], major[1]), v(-ratio * major[1], ratio * major[0]);
    const SvgMatrix plane = product(placement_.plane, axes_of({centre[0], centre[1]}, u, v));
    const double z = placement_(centre)[2], first = values.value(41), last = values.value(42, kTurn);
    if (u == Vec2d(0.0, 0.0)) return false;
    double sweep = std::fmod(last - first, kTurn);
    constexpr double kWhole = 1e-6;  // of a turn: what is left where it is written with six decimals
    if (std::abs(std::abs(last - first) - kTurn) < kWhole || !(std::abs(sweep) > 0)) {
      draw_circle(plane, z, pen_);
      return false;
    }
    if (sweep < 0) sweep += kTurn;
    const auto at = [](double angle) { return Vec2d(std::cos(angle), std::sin(angle)); };
    draw_arc(plane, z, at(first), at(first + sweep / 2), at(last), sweep, pen_);
    return false;
  }

  bool spline() const {
    const DxfSpline spline = read_spline();
    bool is_begun = false;
    for (const DxfBezier& piece : bezier_pieces(spline)) {
      if (!is_begun) pen_.point(point_of(piece.front()));
      is_begun = true;
      pen_.spline(piece);
    }
    if (is_begun) pen_.end(false);
    return false;
  }

  DxfSpline read_spline() const {
    DxfSpline spline;
    std::vector<Vec3d> points;
    std::vector<double> weights;
    std::size_t fit_points = 0;
    std::int64_t degree = 3;
    const char* const where = text_.path().c_str();
    text_.for_each_own(entity_.begin, entity_.body_end, [&](const DxfGroup& group) {
      if (group.code == 71) degree = text_.integer(group);
      else if (group.code == 40) append_within_limit(spline.knots, text_.number(group), where);
      else if (group.code == 41) append_within_limit(weights, text_.number(group), where);
      else if (group.code == 10) append_within_limit(points, Vec3d(text_.number(group), 0, 0), where);
      else if (group.code == 11) ++fit_points;
      else if ((group.code == 20 || group.code == 30) && !points.empty())
        points.back()[group.code / 10 - 1] = text_.number(group);
    });
    if (points.empty() && fit_points > 0) fail("a SPLINE with control points", "one with fit points alone");
    constexpr std::int64_t kMostDegree = 25;
    if (degree < 1 || degree > kMostDegree)
      fail(fmt::format("a SPLINE of a degree from 1 to {}", kMostDegree), fmt::format("{}", degree));
    spline.degree = static_cast<std::size_t>(degree);
    require_knots(spline, points.size());
    if (!weights.empty() && weights.size() != points.size())
      fail(fmt::format("a SPLINE with {} weights, one for each control point", points.size()),
           fmt::format("{}", weights.size()));
    for (std::size_t k = 0; k < points.size(); ++k) {
      const double weight = weights.empty() ? 1 : weights[k];
      if (!(weight > 0)) fail("a SPLINE with weights above 0", fmt::format("{}", weight));
      const Vec3d p = placement_(points[k]) * weight;
      append_within_limit(spline.points, DxfWeighted{p[0], p[1], p[2], weight}, where);
    }
    return spline;
  }

  void require_knots(const DxfSpline& spline, std::size_t points) const {
    const std::vector<double>& knots = spline.knots;
    if (points <= spline.degree)
      fail(fmt::format("a SPLINE of degree {} with {} control points or more", spline.degree, spline.degree + 1),
           fmt::format("{}", points));
    if (knots.size() != points + spline.degree + 1)
      fail(fmt::format("a SPLINE with {} knots, for {} control points and degree {}", points + spline.degree + 1,
                       points, spline.degree),
           fmt::format("{}", knots.size()));
    if (!std::is_sorted(knots.begin(), knots.end())) fail("a SPLINE with knots that do not fall", "one that does");
    for (std::size_t k = 0; k + spline.degree < knots.size(); ++k)
      if (knots[k] == knots[k + spline.degree] && knots[spline.degree] < knots[k] && knots[k] < knots[points])
        fail(fmt::format("a SPLINE of degree {} with no knot more often than that", spline.degree),
             fmt::format("{} more often", knots[k]));
  }

  const DxfText& text_;
  const DxfEntity& entity_;
  const DxfPlacement& placement_;
  DxfPen& pen_;
};

}  // namespace

DxfPlacement product(const DxfPlacement& outer, const DxfPlacement& inner) {
  return {product(outer.plane, inner.plane), outer.z_scale * inner.z_scale,
          outer.z_scale * inner.z_shift + outer.z_shift};
}

DxfValues::DxfValues(const DxfText& text, const DxfEntity& entity, std::initializer_list<int> codes) {
  for (const int code : codes) values_.emplace_back(code, std::nullopt);
  text.for_each_own(entity.begin, entity.body_end, [&](const DxfGroup& group) {
    for (auto& [code, value] : values_)
      if (code == group.code) value = text.number(group);
  });
}

std::optional<double> DxfValues::find(int code) const {
  for (const auto& [known, value] : values_)
    if (known == code) return value;
  return std::nullopt;
}

std::int64_t DxfValues::flags(int code) const {
  constexpr double kMost = 1 << 30;
  const double number = value(code);
  return std::abs(number) < kMost ? static_cast<std::int64_t>(number) : 0;
}

bool is_mirrored(const DxfText& text, const DxfEntity& entity) {
  const DxfValues values(text, entity, {210, 220, 230});
  const Vec3d direction(values.value(210), values.value(220), values.value(230, 1));
  if (direction == Vec3d(0.0)) return false;  // some writers have it where they have none
  constexpr double kAside = 1e-9;             // share: the rounding of what should be 0
  if (!(std::hypot(direction[0], direction[1]) <= kAside * std::abs(direction[2])))
    text.fail_at(entity.begin, "an extrusion direction of (0, 0, 1) or (0, 0, -1)",
                 fmt::format("({}, {}, {})", direction[0], direction[1], direction[2]));
  return direction[2] < 0;
}

bool draw_dxf(const DxfText& text, const DxfEntity& entity, const DxfPlacement& placement, DxfPen& pen) {
  return EntityDrawer(text, entity, placement, pen).run();
}

}  // namespace vdb_offset::io
