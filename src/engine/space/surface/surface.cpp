// SPDX-License-Identifier: Apache-2.0
#include "space/surface/surface.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "ground/mesh/triangulate.h"
#include "ground/numbers/bucket_sort.h"
#include "ground/numbers/morton.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "space/surface/connect_faces.h"
#include "space/surface/seams.h"
#include "space/surface/weld.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// Leaves out triangles with a repeated corner: these are lines, and would make edges of three faces. A line stays if
/// one of its vertices is in no proper triangle.
void leave_out_lines(Surface& surface) {
  if (std::none_of(surface.triangles.begin(), surface.triangles.end(), repeats_corner)) return;
  std::vector<std::uint8_t> held(surface.vertices.size(), 0);
  for (const auto& t : surface.triangles)
    if (!repeats_corner(t)) held[t[0]] = held[t[1]] = held[t[2]] = 1;
  keep_triangles(surface, [&](std::size_t i) {
    const auto& t = surface.triangles[i];
    return !repeats_corner(t) || !held[t[0]] || !held[t[1]] || !held[t[2]];
  });
}

void count_corners(PolygonView polygons, MeshFacts& facts) {
  for (std::size_t f = 0; f < polygons.face_count();) {
    const std::size_t first = f, corners = polygons.face(f).size();
    while (f < polygons.face_count() && polygons.face(f).size() == corners) ++f;
    facts.faces_by_corners[corners] += f - first;
  }
}

/// Takes the triangles of all faces.
void split_faces(PolygonView polygons, Surface& surface) {
  count_corners(polygons, surface.facts);
  surface.triangles = split_polygons(polygons);
  surface.face.resize(surface.triangles.size());
  for_each_index(surface.triangles.size(), [&](std::size_t t) {
    for (auto& v : surface.triangles[t]) v = surface.welded[v];
  });
  for_each_index(polygons.face_count(), [&](std::size_t f) {
    std::fill_n(surface.face.begin() + static_cast<std::ptrdiff_t>(polygons.face_begin[f] - 2 * f),
                polygons.face(f).size() - 2, static_cast<std::uint32_t>(f));
  });
  leave_out_lines(surface);
}

/// The vertices in the order in which triangles use them first. The corners that use a vertex first are counted in
/// runs, so that any number of threads gives the same order.
std::vector<std::uint32_t> order_of_use(const Surface& surface) {
  constexpr std::size_t kRun = 1 << 16;  // corners that a thread takes at a time; not measured beside other lengths
  const std::size_t corners = 3 * surface.triangles.size(), runs = (corners + kRun - 1) / kRun;
  const auto vertex = [&](std::size_t i) { return surface.triangles[i / 3][i % 3]; };
  std::vector<std::uint32_t> first(surface.vertices.size(), kNone);
  for_each_index(corners, [&](std::size_t i) {
    const std::atomic_ref slot(first[vertex(i)]);
    std::uint32_t known = slot.load(std::memory_order_relaxed);
    while (i < known && !slot.compare_exchange_weak(known, static_cast<std::uint32_t>(i), std::memory_order_relaxed)) {
    }
  });
  const auto visit_first = [&](std::size_t run, auto&& visit) {
    for (std::size_t i = run * kRun; i < std::min(corners, (run + 1) * kRun); ++i)
      if (first[vertex(i)] == i) visit(vertex(i));
  };
  std::vector<std::size_t> before(runs + 1, 0);
  for_each_index(
      runs, [&](std::size_t run) { visit_first(run, [&](std::uint32_t) { ++before[run + 1]; }); }, 1);
  std::partial_sum(before.begin(), before.end(), before.begin());
  std::vector<std::uint32_t> order(surface.vertices.size());
  for_each_index(
      runs,
      [&](std::size_t run) {
        std::size_t at = before[run];
        visit_first(run, [&](std::uint32_t v) { order[at++] = v; });
      },
      1);
  // Vertices of faces that give no triangle come last.
  std::size_t at = before.back();
  for (std::uint32_t v = 0; at < order.size() && v < first.size(); ++v)
    if (first[v] == kNone) order[at++] = v;
  return order;
}

void renumber_vertices(Surface& surface) {
  const std::vector<std::uint32_t> order = order_of_use(surface);
  std::vector<Vec3d> vertices(order.size());
  std::vector<std::uint32_t> representative(order.size()), number(order.size());
  for_each_index(order.size(), [&](std::size_t i) {
    vertices[i] = surface.vertices[order[i]];
    representative[i] = surface.representative[order[i]];
    number[order[i]] = static_cast<std::uint32_t>(i);
  });
  surface.vertices = std::move(vertices);
  surface.representative = std::move(representative);
  for_each_index(surface.triangles.size(), [&](std::size_t t) {
    for (auto& v : surface.triangles[t]) v = number[v];
  });
  for (SplitTriangle& split : surface.split)
    for (auto& v : split.corners) v = number[v];
  for_each_index(surface.welded.size(), [&](std::size_t v) {
    if (surface.welded[v] != kNone) surface.welded[v] = number[surface.welded[v]];
  });
}

void find_bounds(Surface& surface) {
  MeshFacts& facts = surface.facts;
  facts.lower = facts.upper = surface.vertices.front();
  for (const Vec3d& p : surface.vertices) {
    facts.lower = openvdb::math::minComponent(facts.lower, p);
    facts.upper = openvdb::math::maxComponent(facts.upper, p);
  }
  facts.diagonal = (facts.upper - facts.lower).length();
  if (!std::isfinite(facts.diagonal))
    throw InvalidInput("mesh: expected a bounding box with a finite diagonal, got coordinates too far apart");
}

/// By the coordinates of some vertices: all of them take long to look at.
void find_vertex_error(Surface& surface) {
  constexpr std::size_t kLookedAt = 1000;
  const std::size_t step = 1 + surface.vertices.size() / kLookedAt;
  std::vector<double> numbers;
  for (std::size_t v = 0; v < surface.vertices.size(); v += step)
    for (int k = 0; k < 3; ++k) numbers.push_back(surface.vertices[v][k]);
  double largest = 0;
  for (const Vec3d& corner : {surface.facts.lower, surface.facts.upper})
    for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(corner[k]));
  if (largest > 0) surface.vertex_error = std::sqrt(3.0) * unit_in_last_place(numbers, largest);
}

/// Sorts triangles and vertices along a space-filling curve, so that those near in space are near in memory, whatever
/// their order in the file.
void sort_in_space(Surface& surface) {
  const MortonCurve curve(surface.facts.lower, surface.facts.upper);
  const std::size_t count = surface.triangles.size();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> on_curve(count);
  for_each_index(count, [&](std::size_t t) {
    const auto& [a, b, c] = surface.triangles[t];
    const Vec3d centre = surface.vertices[a] / 3.0 + surface.vertices[b] / 3.0 + surface.vertices[c] / 3.0;
    on_curve[t] = {curve(centre), static_cast<std::uint32_t>(t)};
  });
  tbb::parallel_sort(on_curve.begin(), on_curve.end());
  std::vector<std::array<std::uint32_t, 3>> triangles(count);
  std::vector<std::uint32_t> faces(count), piece_of(surface.piece_of.size());
  for_each_index(count, [&](std::size_t i) {
    triangles[i] = surface.triangles[on_curve[i].second];
    faces[i] = surface.face[on_curve[i].second];
    if (!piece_of.empty()) piece_of[i] = surface.piece_of[on_curve[i].second];
  });
  surface.triangles = std::move(triangles);
  surface.face = std::move(faces);
  surface.piece_of = std::move(piece_of);
  renumber_vertices(surface);
}

struct TriangleShape {
  Vec3d normal;  // unit, or zero for a needle
  double area;
};

TriangleShape shape_of(const Surface& surface, std::size_t t) {
  const auto& [i, j, k] = surface.triangles[t];
  const Vec3d ab = surface.vertices[j] - surface.vertices[i], ac = surface.vertices[k] - surface.vertices[i],
              bc = ac - ab, n = ab.cross(ac);
  if (is_needle(n.lengthSqr(), std::max({ab.lengthSqr(), ac.lengthSqr(), bc.lengthSqr()}))) return {Vec3d(0.0), 0};
  const double twice = n.length();
  return {n / twice, twice / 2};
}

/// The sum of all areas, and unmarks the faces of triangles that have one. Areas are added in runs of one length, so
/// that the sum does not depend on the number of threads.
double add_areas(const Surface& surface, std::vector<std::uint8_t>& degenerate) {
  constexpr std::size_t kRun = 4096;  // triangles; another length would change the last bits of the sum
  std::vector<double> sums((surface.triangles.size() + kRun - 1) / kRun, 0);
  for_each_index(
      sums.size(),
      [&](std::size_t run) {
        for (std::size_t t = run * kRun; t < std::min(surface.triangles.size(), (run + 1) * kRun); ++t) {
          const double area = shape_of(surface, t).area;
          sums[run] += area;
          if (area > 0) std::atomic_ref(degenerate[surface.face[t]]).store(0, std::memory_order_relaxed);
        }
      },
      1);
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// Whether a face has one vertex at two of its corners.
bool repeats_vertex(PolygonView polygons, const Surface& surface, std::size_t f, std::vector<std::uint32_t>& corners) {
  corners.clear();
  for (const auto v : polygons.face(f)) corners.push_back(surface.welded[v]);
  std::sort(corners.begin(), corners.end());
  return std::adjacent_find(corners.begin(), corners.end()) != corners.end();
}

void measure(PolygonView polygons, Surface& surface) {
  MeshFacts& facts = surface.facts;
  std::vector<std::uint8_t> degenerate(polygons.face_count(), 1);
  facts.area = add_areas(surface, degenerate);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, polygons.face_count(), 1024), [&](const auto& range) {
    std::vector<std::uint32_t> corners;
    for (std::size_t f = range.begin(); f != range.end(); ++f)
      if (repeats_vertex(polygons, surface, f, corners)) degenerate[f] = 1;
  });
  facts.degenerate_faces = static_cast<std::size_t>(std::count(degenerate.begin(), degenerate.end(), 1));
}

double angle_at(const Vec3d& tip, const Vec3d& a, const Vec3d& b) {
  const Vec3d u = a - tip, v = b - tip;
  return std::atan2(u.cross(v).length(), u.dot(v));
}

}  // namespace

void find_normals(Surface& surface) {
  surface.triangle_normals.resize(surface.triangles.size());
  for_each_index(surface.triangles.size(),
                 [&](std::size_t t) { surface.triangle_normals[t] = shape_of(surface, t).normal; });
  surface.vertex_normals.resize(surface.vertices.size());
  for_each_index(surface.vertices.size(), [&](std::size_t v) {
    const auto vertex = static_cast<std::uint32_t>(v);
    Vec3d sum(0.0);
    for (const auto t : surface.triangles_around(vertex)) {
      const auto& corners = surface.triangles[t];
      for (int k = 0; k < 3; ++k)
        if (corners[k] == vertex)
          sum +=
              surface.triangle_normals[t] * angle_at(surface.vertices[vertex], surface.vertices[corners[(k + 1) % 3]],
                                                     surface.vertices[corners[(k + 2) % 3]]);
    }
    surface.vertex_normals[v] = sum;
  });
}

double MeshFacts::tolerance_above(double length) {
  constexpr double kSpare = 1.5;  // a chain of such gaps is a little longer than one; not measured
  return std::pow(10.0, std::ceil(std::log10(kSpare * length)));
}

Vec3d Surface::pseudonormal(std::uint32_t triangle, Feature feature) const {
  if (feature == Feature::Face) return triangle_normals[triangle];
  const auto f = static_cast<std::uint32_t>(feature);
  if (f < 3) return vertex_normals[triangles[triangle][f]];
  const std::uint32_t first = 3 * triangle + (f - 3);
  Vec3d sum = triangle_normals[triangle];
  for (std::uint32_t e = next_around_edge[first]; e != first; e = next_around_edge[e]) sum += triangle_normals[e / 3];
  return sum;
}

Vec3d Surface::across(std::uint32_t triangle, Feature feature, const Vec3d& away, const Vec3d& displacement) const {
  if (feature == Feature::Face) return away * (away.dot(displacement) / away.lengthSqr());
  const auto f = static_cast<std::uint32_t>(feature);
  if (f < 3) return displacement;
  const auto& corners = triangles[triangle];
  const Vec3d edge = vertices[corners[(f - 2) % 3]] - vertices[corners[f - 3]];
  return displacement - edge * (edge.dot(displacement) / edge.lengthSqr());
}

void list_incident_triangles(Surface& surface) {
  Buckets buckets(surface.vertices.size());
  const auto for_each_corner = [&](auto&& visit) {
    for_each_index(surface.triangles.size(), [&](std::size_t t) {
      for (const auto v : surface.triangles[t]) visit(v, static_cast<std::uint32_t>(t));
    });
  };
  for_each_corner([&](std::uint32_t v, std::uint32_t) { buckets.count(v); });
  surface.incident.resize(buckets.close());
  for_each_corner([&](std::uint32_t v, std::uint32_t t) { surface.incident[buckets.next(v)] = t; });
  surface.incident_begin = buckets.take();
  for_each_index(surface.vertices.size(), [&](std::size_t v) {
    std::sort(surface.incident.begin() + surface.incident_begin[v],
              surface.incident.begin() + surface.incident_begin[v + 1]);
  });
}

namespace {

/// Lists the pieces of triangles that were split, which have their directions and numbers now.
void list_pieces(Surface& surface) {
  for (std::uint32_t t = 0; t < surface.piece_of.size(); ++t)
    if (surface.piece_of[t] != kNone) surface.split[surface.piece_of[t]].pieces.push_back(t);
  for (SplitTriangle& split : surface.split)
    if (!split.pieces.empty() && surface.is_turned(split.pieces[0])) std::swap(split.corners[1], split.corners[2]);
}

}  // namespace

Surface build_surface(PolygonView polygons, const WeldOptions& options, Orient orient) {
  require_usable(polygons);
  return build_welded(polygons, weld_usable(polygons, options), orient);
}

Surface build_welded(PolygonView polygons, const Welding& welding, Orient orient) {
  Surface surface;
  give_vertices(polygons, welding, surface);
  find_bounds(surface);
  find_vertex_error(surface);
  split_faces(polygons, surface);
  if (welding.hanging) join_hanging_vertices(surface, *welding.hanging);
  sort_in_space(surface);
  measure(polygons, surface);
  join_and_settle(polygons, orient, surface);
  list_pieces(surface);
  list_incident_triangles(surface);
  return surface;
}

void require_area(const Surface& surface) {
  if (surface.facts.area > 0) return;
  throw InvalidInput("mesh: expected a face with an area, got corners at one point or on a line in all of " +
                     std::to_string(surface.facts.degenerate_faces));
}

void to_local_frame(Surface& surface, double voxel_size) {
  VDB_OFFSET_ASSERT(voxel_size > 0 &&
                    surface.triangle_normals.empty());  // a surface with normals has been moved already
  const double leaf = 8 * voxel_size;
  Vec3d origin;
  for (int k = 0; k < 3; ++k) origin[k] = leaf * std::floor(surface.facts.lower[k] / leaf);
  to_frame(surface, origin);
}

namespace {

/// Finds the conormals of border vertices.
void find_conormals(Surface& surface) {
  surface.conormals.clear();
  if (surface.facts.boundary_left == 0) return;
  surface.conormals.assign(surface.vertices.size(), Vec3d(0.0));
  std::vector<std::uint8_t> on_border(surface.vertices.size(), 0);
  for (std::uint32_t edge = 0; edge < surface.next_around_edge.size(); ++edge)
    if (surface.next_around_edge[edge] == edge) on_border[surface.from(edge)] = on_border[surface.to(edge)] = 1;
  for_each_index(on_border.size(), [&](std::size_t v) {
    if (on_border[v]) surface.conormals[v] = surface.own_conormal(static_cast<std::uint32_t>(v));
  });
}

}  // namespace

void to_frame(Surface& surface, const Vec3d& origin) {
  surface.origin = origin;
  for_each_index(surface.vertices.size(), [&](std::size_t v) { surface.vertices[v] -= surface.origin; });
  find_normals(surface);
  find_conormals(surface);
}

namespace {

// Length of the sum of two unit vectors below which a border turns back on itself, within six degrees, and leads
// nowhere. Not measured.
constexpr double kTurnsBack = 0.1;

/// Calls visit(along, over) for the border's edges at a vertex: their direction, and what leads over them in the plane
/// of their face; both of unit length.
template <class Visit>
void visit_border(const Surface& surface, std::uint32_t vertex, Visit&& visit) {
  for (const auto t : surface.triangles_around(vertex))
    for (std::uint32_t edge = 3 * t; edge < 3 * t + 3; ++edge) {
      if (surface.next_around_edge[edge] != edge || (surface.from(edge) != vertex && surface.to(edge) != vertex))
        continue;
      const Vec3d along = surface.vertices[surface.to(edge)] - surface.vertices[surface.from(edge)],
                  over = along.cross(surface.triangle_normals[t]);
      const bool is_flat = over.lengthSqr() > 0;
      visit(is_flat ? along.unit() : Vec3d(0.0), is_flat ? over.unit() : Vec3d(0.0));
    }
}

}  // namespace

Vec3d Surface::own_conormal(std::uint32_t vertex) const {
  Vec3d sum(0.0);
  int edges = 0;
  visit_border(*this, vertex, [&](const Vec3d&, const Vec3d& over) {
    sum += over;
    ++edges;
  });
  const double length = sum.length();
  return edges == 2 && length > kTurnsBack ? sum / length : Vec3d(0.0);
}

Vec3d Surface::over_border_beside_plane(std::uint32_t vertex) const {
  if (held.empty() || held[vertex] != 1) return Vec3d(0.0);
  constexpr double kInPlane = 1e-3;  // sine; reasoned: far above rounding, far below a corner
  Vec3d sum(0.0), normal = conormals[vertex];
  visit_border(*this, vertex, [&](const Vec3d& along, const Vec3d& over) {
    if (std::abs(normal.dot(along)) > kInPlane) sum += over - normal * normal.dot(over);
  });
  return sum.length() > kTurnsBack ? sum.unit() : Vec3d(0.0);
}

double Surface::tilt(std::uint32_t triangle) const {
  const auto& [a, b, c] = triangles[triangle];
  const Vec3d ab = vertices[b] - vertices[a], bc = vertices[c] - vertices[b], ca = vertices[a] - vertices[c];
  const double height = ab.cross(bc).length() / std::sqrt(std::max({ab.lengthSqr(), bc.lengthSqr(), ca.lengthSqr()}));
  return height > 2 * vertex_error ? 2 * vertex_error / height : 1;
}

Vec3d Surface::along_line(std::uint32_t vertex, const Vec3d& v) const {
  if (held[vertex] > 2) return Vec3d(0.0);
  const auto second = std::lower_bound(second_conormals.begin(), second_conormals.end(), vertex,
                                       [](const auto& each, std::uint32_t at) { return each.first < at; });
  VDB_OFFSET_ASSERT(second != second_conormals.end() && second->first == vertex);
  return v - second->second * second->second.dot(v);
}

void append(Surface& surface, const Surface& other) {
  VDB_OFFSET_ASSERT(surface.origin == other.origin);
  const auto vertices = static_cast<std::uint32_t>(surface.vertices.size()),
             triangles = static_cast<std::uint32_t>(surface.triangles.size()),
             components = static_cast<std::uint32_t>(surface.facts.components);
  const auto add_all = [](auto& to, const auto& from, auto&& of) {
    to.reserve(to.size() + from.size());
    for (const auto& value : from) to.push_back(of(value));
  };
  const auto as_it_is = [](const auto& value) { return value; };
  const auto shifted = [](std::uint32_t by) { return [by](std::uint32_t i) { return i + by; }; };
  add_all(surface.vertices, other.vertices, as_it_is);
  add_all(surface.triangles, other.triangles, [&](const std::array<std::uint32_t, 3>& t) {
    return std::array<std::uint32_t, 3>{t[0] + vertices, t[1] + vertices, t[2] + vertices};
  });
  add_all(surface.face, other.face, as_it_is);
  if (!surface.piece_of.empty()) surface.piece_of.resize(triangles + other.triangles.size(), kNone);
  surface.turned.resize(triangles, 0);
  add_all(surface.turned, other.turned, as_it_is);
  surface.turned.resize(surface.triangles.size(), 0);
  add_all(surface.next_around_edge, other.next_around_edge, shifted(3 * triangles));
  add_all(surface.triangle_normals, other.triangle_normals, as_it_is);
  add_all(surface.vertex_normals, other.vertex_normals, as_it_is);
  const auto incident = static_cast<std::uint32_t>(surface.incident.size());
  add_all(surface.incident, other.incident, shifted(triangles));
  surface.incident_begin.pop_back();
  add_all(surface.incident_begin, other.incident_begin, shifted(incident));
  add_all(surface.component, other.component, shifted(components));
  surface.representative.resize(surface.vertices.size(), kNone);
}

}  // namespace vdb_offset
