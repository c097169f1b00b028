// SPDX-License-Identifier: Apache-2.0
#include "space/curve/curve_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "ground/numbers/median.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

double median_length(const PlaneChains& plane) {
  std::vector<double> lengths;
  for (const auto& [a, b] : plane.chains.segments) lengths.push_back((plane.points[b] - plane.points[a]).length());
  return median(lengths);
}

/// Of all segments.
double length_of(CurvesView curves) {
  double length = 0;
  for (std::size_t c = 0; c < curves.face_count(); ++c) {
    const auto curve = curves.face(c);
    for (std::size_t i = 1; i < curve.size(); ++i)
      length += (curves.positions[curve[i]] - curves.positions[curve[i - 1]]).length();
  }
  return length;
}

/// Closes a curve. If one curve of the input runs between the two ends, its first point is appended to it; otherwise a
/// curve of one segment is added.
void close(Curves& curves, const OpenCurve& open) {
  const CurvesView view = curves.view();
  for (std::size_t c = 0; c < view.face_count(); ++c) {
    const auto curve = view.face(c);
    const bool runs = curve.front() == open.first && curve.back() == open.last,
               runs_back = curve.front() == open.last && curve.back() == open.first;
    if (!runs && !runs_back) continue;
    const auto first = curve.front();
    curves.corners.insert(curves.corners.begin() + curves.face_begin[c + 1], first);
    for (std::size_t later = c + 1; later < curves.face_begin.size(); ++later) ++curves.face_begin[later];
    return;
  }
  curves.add_face({open.last, open.first});
}

}  // namespace

PlaneChains chains_in_plane(CurvesView curves) {
  PlaneChains plane{plane_of(curves), {}, {}};
  plane.points.reserve(curves.positions.size());
  for (const Vec3d& p : curves.positions) plane.points.push_back(plane.frame.to_plane(p));
  plane.chains = join_curves(curves, plane.points);
  if (plane.chains.segments.empty()) throw InvalidInput("curves: expected a segment, got single points alone");
  return plane;
}

MeshFacts facts_of(CurvesView curves, const PlaneChains& plane) {
  const CurveChains& chains = plane.chains;
  MeshFacts facts;
  facts.vertices = plane.points.size();
  facts.unused_vertices = static_cast<std::size_t>(std::count(chains.welded_to.begin(), chains.welded_to.end(), kNone));
  for (std::uint32_t p = 0; p < plane.points.size(); ++p) facts.welded_vertices += chains.welded_to[p] == p;
  facts.faces_by_corners[2] = chains.segments.size();
  facts.components = chains.chains;
  facts.closed_components = chains.closed;
  facts.boundary_edges = facts.boundary_left = chains.ends;
  facts.non_manifold_edges = facts.non_manifold_left = chains.branchings;
  facts.median_edge = median_length(plane);
  facts.lower = facts.upper = curves.positions[curves.corners.front()];
  for (const auto p : curves.corners) {
    facts.lower = openvdb::math::minComponent(facts.lower, curves.positions[p]);
    facts.upper = openvdb::math::maxComponent(facts.upper, curves.positions[p]);
  }
  facts.diagonal = (facts.upper - facts.lower).length();
  return facts;
}

DrawnLine draw_line(const PlaneChains& plane, const Vec3d& origin, double z) {
  DrawnLine drawn;
  drawn.vertex.assign(plane.points.size(), kNone);
  std::vector<Vec3d> vertices;
  std::vector<Segment> segments = plane.chains.segments;
  for (Segment& segment : segments)
    for (auto& p : segment) {
      if (drawn.vertex[p] == kNone) {
        drawn.vertex[p] = static_cast<std::uint32_t>(drawn.source.size());
        drawn.source.push_back(plane.points[p]);
        vertices.emplace_back(plane.points[p][0] - origin[0], plane.points[p][1] - origin[1], z);
      }
      p = drawn.vertex[p];
    }
  for (std::uint32_t p = 0; p < plane.points.size(); ++p)
    if (plane.chains.welded_to[p] != kNone) drawn.vertex[p] = drawn.vertex[plane.chains.welded_to[p]];
  drawn.line = make_polyline(std::move(vertices), std::move(segments), plane.chains);
  drawn.line.origin = origin;
  return drawn;
}

std::vector<OpenCurve> open_curves(CurvesView curves) {
  const PlaneChains plane = chains_in_plane(curves);
  const auto& segments = plane.chains.segments;
  std::vector<std::uint8_t> degree(plane.points.size(), 0);
  for (const Segment& segment : segments)
    for (const auto p : segment) degree[p] = static_cast<std::uint8_t>(std::min(degree[p] + 1, 3));
  // Of each point a segment that begins there. A chain's segments may begin anywhere on it, where a piece of the file
  // does.
  std::vector<std::uint32_t> begins(plane.points.size(), kNone);
  for (std::uint32_t s = 0; s < segments.size(); ++s) begins[segments[s][0]] = s;
  std::vector<OpenCurve> open;
  for (const Segment& first : segments) {
    const std::uint32_t from = first[0];
    if (degree[from] != 1) continue;
    std::uint32_t to = from;
    double length = 0;
    while (to == from || (degree[to] == 2 && begins[to] != kNone)) {
      const Segment& segment = segments[begins[to]];
      length += (plane.points[segment[1]] - plane.points[segment[0]]).length();
      to = segment[1];
    }
    if (degree[to] == 1) open.push_back({from, to, length, (plane.points[to] - plane.points[from]).length()});
  }
  return open;
}

std::vector<OpenCurve> close_curves(Curves& curves) {
  const std::vector<OpenCurve> open = open_curves(curves.view());
  std::vector<OpenCurve> closed;
  std::ranges::copy_if(open, std::back_inserter(closed), &OpenCurve::is_nearly_closed);
  double length = 0;
  for (const OpenCurve& each : open) length += each.length;
  // Nothing else is there but lines that are open, up to rounding of their lengths.
  constexpr double kRounding = 1e-9;
  if (closed.empty() && !open.empty() && length_of(curves.view()) <= (1 + kRounding) * length) {
    const OpenCurve& first = open.front();
    throw InvalidInput(
        fmt::format("expected a closed curve, or ends nearer to each other than {:g} of the length "
                    "between them, got a gap of {:.6g} in {:.6g}",
                    OpenCurve::kNearlyClosed, first.gap, first.length));
  }
  for (const OpenCurve& each : closed) close(curves, each);
  return closed;
}

bool OpenCurve::is_nearly_closed() const { return gap < kNearlyClosed * length; }

}  // namespace vdb_offset
