#include "vdb_offset/surface.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <string>

#include "vdb_offset/error.h"
#include "vdb_offset/mix.h"
#include "vdb_offset/morton.h"
#include "vdb_offset/orientation.h"
#include "vdb_offset/parallel.h"
#include "vdb_offset/repeated_faces.h"
#include "vdb_offset/triangulate.h"

namespace vdb_offset {
namespace {

void check(PolygonView polygons, std::uint32_t least_corners = 3) {
  if (polygons.face_count() == 0) throw InvalidInput("mesh: expected at least one face, got none");
  // The guard leaves room for the two triangles fewer than corners that each face gives.
  if (polygons.corners.size() >= (std::size_t{1} << 31) / 3)
    throw InvalidInput("mesh: expected fewer than 2^31 half-edges, got " + std::to_string(polygons.corners.size()) +
                       " face corners");
  if (polygons.face_begin.front() != 0 || polygons.face_begin.back() != polygons.corners.size())
    throw InvalidInput("mesh: expected face_begin to run from 0 to the number of corners");
  for (std::size_t f = 0; f < polygons.face_count(); ++f)
    if (polygons.face_begin[f] > polygons.face_begin[f + 1] ||
        polygons.face_begin[f + 1] - polygons.face_begin[f] < least_corners)
      throw InvalidInput("mesh: expected at least " + std::to_string(least_corners) + " corners in face " +
                         std::to_string(f));
  for (const auto v : polygons.corners)
    if (v >= polygons.positions.size())
      throw InvalidInput("mesh: expected vertex indices below " + std::to_string(polygons.positions.size()) + ", got " +
                         std::to_string(v));
  for (const auto v : polygons.corners)
    if (!polygons.positions[v].isFinite())
      throw InvalidInput("mesh: expected finite coordinates, got a NaN or an infinity at vertex " + std::to_string(v));
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

bool repeats_corner(const std::array<std::uint32_t, 3>& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// Keeps the triangles, and the faces they are of, that `is_kept(t)`, in their order.
template <class IsKept>
void keep_triangles(Surface& surface, IsKept&& is_kept) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (!is_kept(t)) continue;
    surface.triangles[kept] = surface.triangles[t];
    surface.face[kept++] = surface.face[t];
  }
  surface.triangles.resize(kept);
  surface.face.resize(kept);
}

/// Triangles with a repeated corner are lines that would only make edges of three faces. Those stay that hold a vertex
/// which is in no other.
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
  leave_out_lines(surface);
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

/// Half-edges bucketed by their smaller end, in order; in a bucket, those with the same larger end make an edge.
template <class Visit>
void for_each_edge(const Surface& surface, Visit&& visit) {
  const auto half_edges = static_cast<std::uint32_t>(3 * surface.triangles.size());
  std::vector<std::uint32_t> begin(surface.vertices.size() + 2, 0), bucket(half_edges);
  const auto smaller = [&](std::uint32_t e) { return std::min(surface.from(e), surface.to(e)); };
  const auto larger = [&](std::uint32_t e) { return std::max(surface.from(e), surface.to(e)); };
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
/// components share by a corner belongs to the last of them. Returns the component of each triangle.
std::vector<std::uint32_t> number_components(Surface& surface, std::vector<std::uint32_t>& parent) {
  std::vector<std::uint32_t> number(parent.size(), kNone), component_of(surface.triangles.size());
  surface.component.resize(surface.vertices.size());
  surface.facts.components = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    auto& component = number[root(parent, surface.face[t])];
    if (component == kNone) component = static_cast<std::uint32_t>(surface.facts.components++);
    for (const auto v : surface.triangles[t]) surface.component[v] = component;
    component_of[t] = component;
  }
  return component_of;
}

/// What joining finds.
struct Joined {
  std::size_t boundary = 0, non_manifold = 0, conflicts = 0;  // edges
  bool folded = false;                                        // two triangles over the same corners share an edge
  std::vector<std::uint32_t> component_of;                    // each triangle
};

Joined join(Surface& surface, std::size_t face_count) {
  Joined joined;
  surface.next_around_edge.resize(3 * surface.triangles.size());
  std::iota(surface.next_around_edge.begin(), surface.next_around_edge.end(), 0u);
  std::vector<std::uint32_t> parent(face_count);
  std::iota(parent.begin(), parent.end(), 0u);
  std::vector<double> lengths;
  lengths.reserve(surface.triangles.size() * 3 / 2);
  const auto across = [&](std::uint32_t e) { return surface.triangles[e / 3][(e + 2) % 3]; };
  for_each_edge(surface, [&](std::span<const std::uint32_t> edge) {
    for (std::size_t i = 0; i < edge.size(); ++i) {
      surface.next_around_edge[edge[i]] = edge[(i + 1) % edge.size()];
      parent[root(parent, surface.face[edge[i] / 3])] = root(parent, surface.face[edge[0] / 3]);
    }
    const bool pair = edge.size() == 2;
    joined.boundary += edge.size() == 1;
    joined.non_manifold += edge.size() > 2;
    joined.conflicts += pair && surface.from(edge[0]) == surface.from(edge[1]);
    joined.folded |= pair && across(edge[0]) == across(edge[1]);
    lengths.push_back((surface.vertices[surface.from(edge[0])] - surface.vertices[surface.to(edge[0])]).length());
  });
  // A line that had to stay is all border: it has no side.
  joined.boundary +=
      static_cast<std::size_t>(std::count_if(surface.triangles.begin(), surface.triangles.end(), repeats_corner));
  joined.component_of = number_components(surface, parent);
  if (!lengths.empty()) {
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    surface.facts.median_edge = *middle;
  }
  return joined;
}

/// Whether a triangle faces against the polygon that it is part of, as where a bent one's fan folds over.
bool is_folded_over(PolygonView polygons, const Surface& surface, std::size_t t) {
  const auto polygon = polygons.face(surface.face[t]);
  if (polygon.size() == 3) return false;
  const auto at = [&](std::size_t k) { return polygons.positions[polygon[k]] - polygons.positions[polygon[0]]; };
  Vec3d normal(0.0);
  for (std::size_t k = 2; k < polygon.size(); ++k) normal += at(k - 1).cross(at(k));
  const auto& [i, j, k] = surface.triangles[t];
  return normal.dot((surface.vertices[j] - surface.vertices[i]).cross(surface.vertices[k] - surface.vertices[i])) < 0;
}

/// The triangles that are folded over onto another one: of two bent polygons that share three corners in a row, for
/// one.
std::vector<std::uint8_t> find_folded_triangles(PolygonView polygons, const Surface& surface) {
  const std::size_t count = surface.triangles.size();
  std::vector<std::uint8_t> folded(count), result(count, 0);
  for_each_index(count, [&](std::size_t t) { folded[t] = is_folded_over(polygons, surface, t); });
  std::vector<std::uint32_t> order(count), corners, begin(count + 1);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_partition(order.begin(), order.end(), [&](std::uint32_t t) { return !folded[t]; });
  corners.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto& triangle = surface.triangles[order[i]];
    corners.insert(corners.end(), triangle.begin(), triangle.end());
    begin[i + 1] = static_cast<std::uint32_t>(corners.size());
  }
  const std::vector<std::uint8_t> repeated = find_repeated_faces(corners, begin);
  for (std::size_t i = 0; i < count; ++i) result[order[i]] = repeated[i] && folded[order[i]];
  return result;
}

/// Leaves out every face that repeats another, whichever way round, and of the others the triangles that are folded
/// over onto another. False if there are none.
bool leave_out_repeated_faces(PolygonView polygons, Surface& surface) {
  std::vector<std::uint32_t> corners(polygons.corners.size());
  for_each_index(corners.size(), [&](std::size_t i) { corners[i] = surface.welded[polygons.corners[i]]; });
  const std::vector<std::uint8_t> repeats = find_repeated_faces(corners, polygons.face_begin);
  surface.facts.repeated_faces = static_cast<std::size_t>(std::count(repeats.begin(), repeats.end(), 1));
  const std::size_t before = surface.triangles.size();
  keep_triangles(surface, [&](std::size_t t) { return !repeats[surface.face[t]]; });
  const std::vector<std::uint8_t> folded = find_folded_triangles(polygons, surface);
  surface.facts.folded_triangles = static_cast<std::size_t>(std::count(folded.begin(), folded.end(), 1));
  keep_triangles(surface, [&](std::size_t t) { return !folded[t]; });
  return surface.triangles.size() < before;
}

/// Joins the triangles and settles which side is outward. Sheets that lie on each other, as doubled faces do, would
/// join into edges of four faces with no side at all; one of them says where they all go.
void join_and_settle(PolygonView polygons, Orient orient, Surface& surface) {
  MeshFacts& facts = surface.facts;
  Joined joined = join(surface, polygons.face_count());
  facts.boundary_edges = joined.boundary;
  facts.non_manifold_edges = joined.non_manifold;
  if ((joined.non_manifold > 0 || joined.folded) && leave_out_repeated_faces(polygons, surface))
    joined = join(surface, polygons.face_count());
  facts.boundary_left = joined.boundary;
  facts.non_manifold_left = joined.non_manifold;
  facts.orientation_conflicts = joined.conflicts;
  settle_orientation(surface);
  settle_outside(surface, joined.component_of, orient);
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

Surface build_surface(PolygonView polygons, const WeldOptions& options, Orient orient) {
  check(polygons);
  Surface surface;
  weld(polygons, options, surface);
  find_bounds(surface);
  split_faces(polygons, surface);
  sort_in_space(surface);
  measure(polygons, surface);
  join_and_settle(polygons, orient, surface);
  list_incident_triangles(surface);
  return surface;
}

std::vector<std::uint32_t> weld_by_position(PolygonView polygons, const WeldOptions& options) {
  check(polygons, 1);
  Surface surface;
  weld(polygons, options, surface);
  std::vector<std::uint32_t> first(polygons.positions.size(), kNone);
  for (std::size_t v = 0; v < first.size(); ++v)
    if (surface.welded[v] != kNone) first[v] = surface.representative[surface.welded[v]];
  return first;
}

void place(Surface& surface, double voxel_size) {
  const double leaf = 8 * voxel_size;
  Vec3d origin;
  for (int k = 0; k < 3; ++k) origin[k] = leaf * std::floor(surface.facts.lower[k] / leaf);
  place_in_frame(surface, origin);
}

namespace {

/// A border vertex has two edges on it; where it has more, several borders meet.
void find_conormals(Surface& surface) {
  surface.conormals.clear();
  if (surface.facts.boundary_left == 0) return;
  surface.conormals.assign(surface.vertices.size(), Vec3d(0.0));
  std::vector<std::uint8_t> edges(surface.vertices.size(), 0);
  for (std::uint32_t edge = 0; edge < surface.next_around_edge.size(); ++edge) {
    if (surface.next_around_edge[edge] != edge) continue;
    const std::uint32_t from = surface.from(edge), to = surface.to(edge);
    const Vec3d over = (surface.vertices[to] - surface.vertices[from]).cross(surface.triangle_normals[edge / 3]);
    for (const auto v : {from, to}) {
      if (over.lengthSqr() > 0) surface.conormals[v] += over.unit();
      edges[v] = static_cast<std::uint8_t>(std::min(edges[v] + 1, 3));
    }
  }
  constexpr double kTurnsBack = 0.1;  // a border that does leads nowhere
  for (std::size_t v = 0; v < edges.size(); ++v) {
    Vec3d& c = surface.conormals[v];
    const double length = c.length();
    c = edges[v] == 2 && length > kTurnsBack ? c / length : Vec3d(0.0);
  }
}

}  // namespace

void place_in_frame(Surface& surface, const Vec3d& origin) {
  surface.origin = origin;
  for_each_index(surface.vertices.size(), [&](std::size_t v) { surface.vertices[v] -= surface.origin; });
  find_normals(surface);
  find_conormals(surface);
}

std::vector<Vec3d> vertex_normals(PolygonView polygons, const WeldOptions& weld, Orient orient) {
  Surface surface = build_surface(polygons, weld, orient);
  find_normals(surface);
  std::vector<Vec3d> normals(polygons.positions.size(), Vec3d(0.0));
  for_each_index(normals.size(), [&](std::size_t v) {
    if (surface.welded[v] == kNone) return;
    const Vec3d& sum = surface.vertex_normals[surface.welded[v]];
    if (const double length = sum.length(); length > 0) normals[v] = sum / length;
  });
  return normals;
}

void append(Surface& surface, const Surface& other) {
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
