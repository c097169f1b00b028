#include "vdb_offset/surface.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <string>

#include "vdb_offset/error.h"
#include "vdb_offset/morton.h"
#include "vdb_offset/parallel.h"
#include "vdb_offset/triangulate.h"

namespace vdb_offset {
namespace {

void check(PolygonView polygons) {
  if (polygons.face_count() == 0) throw InvalidInput("mesh: expected at least one face, got none");
  // The guard leaves room for the two triangles fewer than corners that each face gives.
  if (polygons.corners.size() >= (std::size_t{1} << 31) / 3)
    throw InvalidInput("mesh: expected fewer than 2^31 half-edges, got " + std::to_string(polygons.corners.size()) +
                       " face corners");
  if (polygons.face_begin.front() != 0 || polygons.face_begin.back() != polygons.corners.size())
    throw InvalidInput("mesh: expected face_begin to run from 0 to the number of corners");
  for (std::size_t f = 0; f < polygons.face_count(); ++f)
    if (polygons.face_begin[f] > polygons.face_begin[f + 1] || polygons.face_begin[f + 1] - polygons.face_begin[f] < 3)
      throw InvalidInput("mesh: expected at least 3 corners in face " + std::to_string(f));
  for (const auto v : polygons.corners)
    if (v >= polygons.positions.size())
      throw InvalidInput("mesh: expected vertex indices below " + std::to_string(polygons.positions.size()) + ", got " +
                         std::to_string(v));
  for (const auto v : polygons.corners)
    if (!polygons.positions[v].isFinite())
      throw InvalidInput("mesh: expected finite coordinates, got a NaN or an infinity at vertex " + std::to_string(v));
}

std::uint64_t mix(std::uint64_t x) {
  x ^= x >> 32;
  x *= 0xd6e8feb86659fd93ULL;
  x ^= x >> 32;
  return x;
}

/// Finds the first vertex that stands where another one does. Open addressing over vertex numbers.
class Welder {
 public:
  Welder(std::span<const Vec3d> positions, const WeldOptions& options, std::size_t count)
      : positions_(positions), tolerance_(options.tolerance), slots_(std::bit_ceil(2 * count + 16), kNone) {}

  /// The first vertex seen within the tolerance of vertex v: v itself if there is none.
  std::uint32_t first_at(std::uint32_t v) {
    if (tolerance_ > 0)
      if (const std::uint32_t near = search_around(v); near != kNone) return near;
    const auto key = cell(positions_[v]);
    std::size_t slot = hash(key) & (slots_.size() - 1);
    for (; slots_[slot] != kNone; slot = (slot + 1) & (slots_.size() - 1))
      if (tolerance_ == 0 && positions_[slots_[slot]] == positions_[v]) return slots_[slot];
    return slots_[slot] = v;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  /// The position's bits for exact welding (with -0 as 0), else the cell of side `tolerance` around it.
  Cell cell(const Vec3d& p) const {
    Cell c;
    for (int k = 0; k < 3; ++k)
      c[k] = tolerance_ > 0 ? static_cast<std::int64_t>(std::floor(p[k] / tolerance_))
                            : std::bit_cast<std::int64_t>(p[k] + 0.0);
    return c;
  }
  static std::size_t hash(const Cell& c) {
    return mix(static_cast<std::uint64_t>(c[0]) +
               mix(static_cast<std::uint64_t>(c[1]) + mix(static_cast<std::uint64_t>(c[2]))));
  }
  std::uint32_t search_around(std::uint32_t v) const {
    const Cell centre = cell(positions_[v]);
    std::uint32_t best = kNone;
    for (int n = 0; n < 27; ++n) {
      const Cell c = {centre[0] + n / 9 - 1, centre[1] + n / 3 % 3 - 1, centre[2] + n % 3 - 1};
      for (std::size_t s = hash(c) & (slots_.size() - 1); slots_[s] != kNone; s = (s + 1) & (slots_.size() - 1))
        if (slots_[s] < best && cell(positions_[slots_[s]]) == c &&
            (positions_[slots_[s]] - positions_[v]).length() <= tolerance_)
          best = slots_[s];
    }
    return best;
  }

  std::span<const Vec3d> positions_;
  double tolerance_;
  std::vector<std::uint32_t> slots_;
};

void check(PolygonView polygons, const WeldOptions& options) {
  if (!(options.tolerance >= 0) || !std::isfinite(options.tolerance))
    throw InvalidInput("weld: expected a tolerance >= 0, got " + std::to_string(options.tolerance));
  if (options.tolerance == 0) return;
  for (const auto v : polygons.corners)
    for (int k = 0; k < 3; ++k)
      if (std::abs(polygons.positions[v][k]) > 0x1p52 * options.tolerance)
        throw InvalidInput("weld: expected a tolerance above the rounding of the coordinates (use bit-equal welding)");
}

void weld(PolygonView polygons, const WeldOptions& options, Surface& surface) {
  check(polygons, options);
  const std::size_t count = polygons.positions.size();
  std::vector<std::uint8_t> used(count, 0);
  for (const auto v : polygons.corners) used[v] = 1;
  surface.welded.assign(count, kNone);
  Welder welder(polygons.positions, options, options.enabled ? count : 0);
  for (std::uint32_t v = 0; v < count; ++v) {
    if (!used[v]) continue;
    const std::uint32_t first = options.enabled ? welder.first_at(v) : v;
    if (first == v) {
      surface.welded[v] = static_cast<std::uint32_t>(surface.vertices.size());
      surface.vertices.push_back(polygons.positions[v]);
      surface.representative.push_back(v);
    } else {
      surface.welded[v] = surface.welded[first];
    }
  }
  surface.facts.vertices = count;
  surface.facts.unused_vertices = static_cast<std::size_t>(std::count(used.begin(), used.end(), 0));
  surface.facts.welded_vertices = surface.vertices.size();
}

void split_faces(PolygonView polygons, Surface& surface) {
  std::vector<std::uint32_t> face;
  surface.triangles.reserve(polygons.corners.size() - 2 * polygons.face_count());
  surface.face.reserve(surface.triangles.capacity());
  for (std::size_t f = 0; f < polygons.face_count(); ++f) {
    face.clear();
    for (const auto v : polygons.face(f)) face.push_back(surface.welded[v]);
    ++surface.facts.faces_by_corners[face.size()];
    triangulate(surface.vertices, face, surface.triangles);
    surface.face.resize(surface.triangles.size(), static_cast<std::uint32_t>(f));
  }
}

/// Numbers the vertices as the triangles come to use them.
void renumber_vertices(Surface& surface) {
  std::vector<std::uint32_t> number(surface.vertices.size(), kNone), order;
  order.reserve(number.size());
  for (auto& triangle : surface.triangles)
    for (auto& v : triangle) {
      if (number[v] == kNone) {
        number[v] = static_cast<std::uint32_t>(order.size());
        order.push_back(v);
      }
      v = number[v];
    }
  // A face may be in use and yet give no triangle.
  for (std::uint32_t v = 0; v < number.size(); ++v)
    if (number[v] == kNone) {
      number[v] = static_cast<std::uint32_t>(order.size());
      order.push_back(v);
    }
  std::vector<Vec3d> vertices(order.size());
  std::vector<std::uint32_t> representative(order.size());
  for_each_index(order.size(), [&](std::size_t i) {
    vertices[i] = surface.vertices[order[i]];
    representative[i] = surface.representative[order[i]];
  });
  surface.vertices = std::move(vertices);
  surface.representative = std::move(representative);
  for (auto& v : surface.welded)
    if (v != kNone) v = number[v];
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

/// Sorts triangles and vertices along a space-filling curve: whoever works in one place finds them together in memory,
/// however the file orders them.
void sort_in_space(Surface& surface) {
  const MortonCurve curve(surface.facts.lower, surface.facts.upper);
  const std::size_t count = surface.triangles.size();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> places(count);
  for_each_index(count, [&](std::size_t t) {
    const auto& [a, b, c] = surface.triangles[t];
    const Vec3d centre = surface.vertices[a] / 3.0 + surface.vertices[b] / 3.0 + surface.vertices[c] / 3.0;
    places[t] = {curve(centre), static_cast<std::uint32_t>(t)};
  });
  tbb::parallel_sort(places.begin(), places.end());
  std::vector<std::array<std::uint32_t, 3>> triangles(count);
  std::vector<std::uint32_t> faces(count);
  for_each_index(count, [&](std::size_t i) {
    triangles[i] = surface.triangles[places[i].second];
    faces[i] = surface.face[places[i].second];
  });
  surface.triangles = std::move(triangles);
  surface.face = std::move(faces);
  renumber_vertices(surface);
}

std::uint32_t from(const Surface& s, std::uint32_t half_edge) { return s.triangles[half_edge / 3][half_edge % 3]; }
std::uint32_t to(const Surface& s, std::uint32_t half_edge) {
  return s.triangles[half_edge / 3][(half_edge % 3 + 1) % 3];
}

/// Half-edges bucketed by their smaller end, in order; in a bucket, those with the same larger end make an edge.
template <class Visit>
void for_each_edge(const Surface& surface, Visit&& visit) {
  const auto half_edges = static_cast<std::uint32_t>(3 * surface.triangles.size());
  std::vector<std::uint32_t> begin(surface.vertices.size() + 2, 0), bucket(half_edges);
  const auto smaller = [&](std::uint32_t e) { return std::min(from(surface, e), to(surface, e)); };
  const auto larger = [&](std::uint32_t e) { return std::max(from(surface, e), to(surface, e)); };
  for (std::uint32_t e = 0; e < half_edges; ++e) ++begin[smaller(e) + 2];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  for (std::uint32_t e = 0; e < half_edges; ++e) bucket[begin[smaller(e) + 1]++] = e;
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    const auto first = bucket.begin() + begin[v], last = bucket.begin() + begin[v + 1];
    std::sort(first, last,
              [&](std::uint32_t a, std::uint32_t b) { return std::pair(larger(a), a) < std::pair(larger(b), b); });
    for (auto run = first; run != last;) {
      auto end = run;
      while (end != last && larger(*end) == larger(*run)) ++end;
      if (larger(*run) != v) visit(std::span<const std::uint32_t>(run, end));  // a repeated corner makes no edge
      run = end;
    }
  }
}

std::uint32_t root(std::vector<std::uint32_t>& parent, std::uint32_t x) {
  while (parent[x] != x) x = parent[x] = parent[parent[x]];
  return x;
}

/// Numbers the components in the order of their first face and hands them to the vertices; one that several
/// components share by a corner belongs to the last of them.
void number_components(Surface& surface, std::vector<std::uint32_t>& parent) {
  std::vector<std::uint32_t> number(parent.size(), kNone);
  surface.component.resize(surface.vertices.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    auto& component = number[root(parent, surface.face[t])];
    if (component == kNone) component = static_cast<std::uint32_t>(surface.facts.components++);
    for (const auto v : surface.triangles[t]) surface.component[v] = component;
  }
}

void join(Surface& surface, std::size_t face_count) {
  MeshFacts& facts = surface.facts;
  surface.next_around_edge.resize(3 * surface.triangles.size());
  std::iota(surface.next_around_edge.begin(), surface.next_around_edge.end(), 0u);
  std::vector<std::uint32_t> parent(face_count);
  std::iota(parent.begin(), parent.end(), 0u);
  std::vector<double> lengths;
  lengths.reserve(surface.triangles.size() * 3 / 2);
  for_each_edge(surface, [&](std::span<const std::uint32_t> edge) {
    for (std::size_t i = 0; i < edge.size(); ++i) {
      surface.next_around_edge[edge[i]] = edge[(i + 1) % edge.size()];
      parent[root(parent, surface.face[edge[i] / 3])] = root(parent, surface.face[edge[0] / 3]);
    }
    facts.boundary_edges += edge.size() == 1;
    facts.non_manifold_edges += edge.size() > 2;
    facts.orientation_conflicts += edge.size() == 2 && from(surface, edge[0]) == from(surface, edge[1]);
    lengths.push_back((surface.vertices[from(surface, edge[0])] - surface.vertices[to(surface, edge[0])]).length());
  });
  number_components(surface, parent);
  if (!lengths.empty()) {
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    facts.median_edge = *middle;
  }
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

/// Triangles that hang together over edges with two faces, and which of them agree with the first.
struct OrientablePatch {
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint8_t> agrees;
  bool orientable = true;
};

/// The patch around a triangle that no patch holds yet. `state`: 0 not seen, 1 agrees with the seed, 2 does not.
OrientablePatch collect_patch(const Surface& surface, std::uint32_t seed, std::vector<std::uint8_t>& state) {
  OrientablePatch patch;
  patch.triangles.push_back(seed);
  state[seed] = 1;
  for (std::size_t i = 0; i < patch.triangles.size(); ++i) {
    const std::uint32_t t = patch.triangles[i];
    for (std::uint32_t e = 3 * t; e < 3 * t + 3; ++e) {
      const std::uint32_t twin = surface.next_around_edge[e], other = twin / 3;
      if (twin == e || surface.next_around_edge[twin] != e) continue;
      const bool conflict = from(surface, e) == from(surface, twin);
      const auto wanted = static_cast<std::uint8_t>(conflict ? 3 - state[t] : state[t]);
      if (state[other] == 0) {
        state[other] = wanted;
        patch.triangles.push_back(other);
      } else if (state[other] != wanted) {
        patch.orientable = false;
      }
    }
  }
  for (const auto t : patch.triangles) patch.agrees.push_back(state[t] == 1);
  return patch;
}

/// Half-edge k of a triangle whose last two corners change places becomes half-edge 2 - k.
std::uint32_t renamed(std::uint32_t half_edge, const std::vector<std::uint8_t>& turned) {
  return turned[half_edge / 3] ? 3 * (half_edge / 3) + 2 - half_edge % 3 : half_edge;
}

void turn_round(Surface& surface, const std::vector<std::uint8_t>& turned) {
  std::vector<std::uint32_t> next(surface.next_around_edge.size());
  for (std::uint32_t e = 0; e < next.size(); ++e)
    next[renamed(e, turned)] = renamed(surface.next_around_edge[e], turned);
  surface.next_around_edge = std::move(next);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    if (turned[t]) std::swap(surface.triangles[t][1], surface.triangles[t][2]);
}

void settle_orientation(Surface& surface) {
  MeshFacts& facts = surface.facts;
  if (facts.orientation_conflicts == 0) return;
  const std::size_t count = surface.triangles.size();
  std::vector<std::uint8_t> state(count, 0), turned(count, 0);
  for (std::uint32_t seed = 0; seed < count; ++seed) {
    if (state[seed] != 0) continue;
    const OrientablePatch patch = collect_patch(surface, seed, state);
    if (!patch.orientable) continue;
    double area[2] = {0, 0};
    for (std::size_t i = 0; i < patch.triangles.size(); ++i)
      area[patch.agrees[i]] += shape_of(surface, patch.triangles[i]).area;
    const std::uint8_t kept = area[1] >= area[0];
    for (std::size_t i = 0; i < patch.triangles.size(); ++i) turned[patch.triangles[i]] = patch.agrees[i] != kept;
  }
  facts.turned_triangles = static_cast<std::size_t>(std::count(turned.begin(), turned.end(), 1));
  turn_round(surface, turned);
  for (std::uint32_t e = 0; e < 3 * count; ++e) {
    const std::uint32_t twin = surface.next_around_edge[e];
    facts.unsettled_conflicts +=
        twin > e && surface.next_around_edge[twin] == e && from(surface, e) == from(surface, twin);
  }
}

void list_incident_triangles(Surface& surface) {
  auto& begin = surface.incident_begin;
  begin.assign(surface.vertices.size() + 2, 0);
  for (const auto& t : surface.triangles)
    for (const auto v : t) ++begin[v + 2];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  surface.incident.resize(3 * surface.triangles.size());
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t)
    for (const auto v : surface.triangles[t]) surface.incident[begin[v + 1]++] = t;
  begin.pop_back();
}

void measure(PolygonView polygons, Surface& surface) {
  MeshFacts& facts = surface.facts;
  std::vector<std::uint8_t> degenerate(polygons.face_count(), 1);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const double area = shape_of(surface, t).area;
    facts.area += area;
    if (area > 0) degenerate[surface.face[t]] = 0;
  }
  std::vector<std::uint32_t> face;
  for (std::size_t f = 0; f < polygons.face_count(); ++f) {
    face.clear();
    for (const auto v : polygons.face(f)) face.push_back(surface.welded[v]);
    std::sort(face.begin(), face.end());
    if (std::adjacent_find(face.begin(), face.end()) != face.end()) degenerate[f] = 1;
  }
  facts.degenerate_faces = static_cast<std::size_t>(std::count(degenerate.begin(), degenerate.end(), 1));
}

double angle_at(const Vec3d& tip, const Vec3d& a, const Vec3d& b) {
  const Vec3d u = a - tip, v = b - tip;
  return std::atan2(u.cross(v).length(), u.dot(v));
}

}  // namespace

Vec3d Surface::pseudonormal(std::uint32_t triangle, Feature feature) const {
  if (feature == Feature::Face) return triangle_normals[triangle];
  const auto f = static_cast<std::uint32_t>(feature);
  if (f < 3) return vertex_normals[triangles[triangle][f]];
  const std::uint32_t first = 3 * triangle + (f - 3);
  Vec3d sum = triangle_normals[triangle];
  for (std::uint32_t e = next_around_edge[first]; e != first; e = next_around_edge[e]) sum += triangle_normals[e / 3];
  return sum;
}

TrianglePoint Surface::walk_to_closest(const Vec3d& x, std::uint32_t& triangle) const {
  TrianglePoint best = closest_on(triangle, x);
  const auto is_nearer = [&](std::uint32_t other) {
    const TrianglePoint candidate = closest_on(other, x);
    if (candidate.squared_distance >= best.squared_distance) return false;
    best = candidate;
    triangle = other;
    return true;
  };
  // From a point p on an edge or a corner, a triangle leads nearer to x only if one of its corners w does:
  // (w - p) . (x - p) > 0. Inside an edge x - p is at right angles to it, and the corner across decides.
  for (bool moved = true; moved && best.feature != Feature::Face;) {
    moved = false;
    const std::uint32_t from = triangle;
    const auto feature = static_cast<std::uint32_t>(best.feature);
    const Vec3d p = best.point, towards = x - p;
    const auto lead = [&](std::uint32_t v) { return towards.dot(vertices[v] - p); };
    if (feature < 3) {
      // The one that leads nearest first: it is likely to be the only one to look at.
      const std::uint32_t centre = triangles[from][feature];
      const auto around = triangles_around(centre);
      std::uint32_t first = from;
      double most = 0;
      for (const auto other : around) {
        if (other == from) continue;
        const auto& t = triangles[other];
        const std::size_t corner = t[0] == centre ? 0 : t[1] == centre ? 1 : 2;
        const double leads = std::max(lead(t[(corner + 1) % 3]), lead(t[(corner + 2) % 3]));
        if (leads > most) {
          most = leads;
          first = other;
        }
      }
      if (first == from) break;
      moved = is_nearer(first);
      for (std::size_t i = 0; !moved && i < around.size(); ++i)
        moved = around[i] != from && around[i] != first && is_nearer(around[i]);
    } else {
      const std::uint32_t edge = 3 * from + (feature - 3);
      for (std::uint32_t e = next_around_edge[edge]; e != edge && !moved; e = next_around_edge[e])
        moved = lead(triangles[e / 3][(e + 2) % 3]) > 0 && is_nearer(e / 3);
    }
  }
  return best;
}

Surface build_surface(PolygonView polygons, const WeldOptions& options) {
  check(polygons);
  Surface surface;
  weld(polygons, options, surface);
  find_bounds(surface);
  split_faces(polygons, surface);
  sort_in_space(surface);
  join(surface, polygons.face_count());
  settle_orientation(surface);
  list_incident_triangles(surface);
  measure(polygons, surface);
  return surface;
}

void place(Surface& surface, double voxel_size) {
  const double leaf = 8 * voxel_size;
  for (int k = 0; k < 3; ++k) surface.origin[k] = leaf * std::floor(surface.facts.lower[k] / leaf);
  for_each_index(surface.vertices.size(), [&](std::size_t v) { surface.vertices[v] -= surface.origin; });
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

}  // namespace vdb_offset
