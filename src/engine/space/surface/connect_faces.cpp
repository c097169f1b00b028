// SPDX-License-Identifier: Apache-2.0
#include "space/surface/connect_faces.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "ground/mesh/repeated_faces.h"
#include "ground/numbers/bucket_sort.h"
#include "ground/numbers/median.h"
#include "ground/system/parallel.h"
#include "space/surface/orientation.h"

namespace vdb_offset {
namespace {

/// Half-edges in buckets, one for each vertex as the smaller end. Half-edges of a bucket that have the same larger end
/// are one edge.
class HalfEdges {
 public:
  explicit HalfEdges(const Surface& surface) : surface_(surface) {
    const std::size_t count = 3 * surface.triangles.size();
    Buckets buckets(surface.vertices.size());
    for_each_index(count, [&](std::size_t e) { buckets.count(smaller(static_cast<std::uint32_t>(e))); });
    sorted_.resize(buckets.close());
    for_each_index(count, [&](std::size_t e) {
      sorted_[buckets.next(smaller(static_cast<std::uint32_t>(e)))] = static_cast<std::uint32_t>(e);
    });
    begin_ = buckets.take();
  }

  /// Sorts the bucket of vertex v, and calls visit(half-edges) for each of its edges.
  template <class Visit>
  void visit_from(std::size_t v, Visit&& visit) {
    const auto first = sorted_.begin() + begin_[v], last = sorted_.begin() + begin_[v + 1];
    std::sort(first, last,
              [&](std::uint32_t a, std::uint32_t b) { return std::pair(larger(a), a) < std::pair(larger(b), b); });
    for (auto run = first; run != last;) {
      auto end = run;
      while (end != last && larger(*end) == larger(*run)) ++end;
      if (larger(*run) != v) visit(std::span<const std::uint32_t>(run, end));  // not where a triangle repeats a corner
      run = end;
    }
  }

 private:
  std::uint32_t smaller(std::uint32_t e) const { return std::min(surface_.from(e), surface_.to(e)); }
  std::uint32_t larger(std::uint32_t e) const { return std::max(surface_.from(e), surface_.to(e)); }

  const Surface& surface_;
  std::vector<std::uint32_t> begin_, sorted_;
};

/// Disjoint sets that any number of threads may unite. The first member of a set stands for it, whatever the order in
/// which sets were united.
class Sets {
 public:
  explicit Sets(std::size_t count) : parent_(count) {
    for_each_index(count, [&](std::size_t i) { parent_[i] = static_cast<std::uint32_t>(i); });
  }
  std::uint32_t first(std::uint32_t i) {
    for (std::uint32_t up = parent(i).load(std::memory_order_relaxed); up != i;) {
      const std::uint32_t further = parent(up).load(std::memory_order_relaxed);
      // This shortens the path for later look-ups.
      if (further != up) parent(i).compare_exchange_strong(up, further, std::memory_order_relaxed);
      i = further;
      up = parent(i).load(std::memory_order_relaxed);
    }
    return i;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    for (;;) {
      a = first(a), b = first(b);
      if (a == b) return;
      if (a < b) std::swap(a, b);
      std::uint32_t expected = a;
      if (parent(a).compare_exchange_strong(expected, b, std::memory_order_relaxed)) return;
    }
  }

 private:
  std::atomic_ref<std::uint32_t> parent(std::uint32_t i) { return std::atomic_ref(parent_[i]); }
  std::vector<std::uint32_t> parent_;
};

/// Numbers the components in the order of their first face and hands them to the vertices; a vertex
/// that several components share belongs to the last of them. Returns the component of each triangle.
std::vector<std::uint32_t> number_components(Surface& surface, Sets& faces, std::size_t face_count) {
  std::vector<std::uint32_t> number(face_count, kNone), component_of(surface.triangles.size());
  for_each_index(component_of.size(), [&](std::size_t t) { component_of[t] = faces.first(surface.face[t]); });
  surface.facts.components = 0;
  for (auto& component : component_of) {
    auto& known = number[component];
    if (known == kNone) known = static_cast<std::uint32_t>(surface.facts.components++);
    component = known;
  }
  surface.component.assign(surface.vertices.size(), 0);
  if (surface.facts.components > 1)
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
      for (const auto v : surface.triangles[t]) surface.component[v] = component_of[t];
  return component_of;
}

/// What join() finds.
struct Joined {
  std::size_t boundary = 0, non_manifold = 0, conflicts = 0;  // numbers of edges
  bool folded = false;                                        // two triangles over the same corners share an edge
  std::vector<std::uint32_t> component_of;                    // of each triangle
  std::vector<double> lengths;                                // of all edges, in any order

  void add(const Surface& surface, std::span<const std::uint32_t> edge) {
    const auto across = [&](std::uint32_t e) { return surface.triangles[e / 3][(e + 2) % 3]; };
    const bool pair = edge.size() == 2;
    boundary += edge.size() == 1;
    non_manifold += edge.size() > 2;
    conflicts += pair && surface.from(edge[0]) == surface.from(edge[1]);
    folded |= pair && across(edge[0]) == across(edge[1]);
    lengths.push_back((surface.vertices[surface.from(edge[0])] - surface.vertices[surface.to(edge[0])]).length());
  }
  void add(Joined&& part) {
    boundary += part.boundary, non_manifold += part.non_manifold, conflicts += part.conflicts;
    folded |= part.folded;
    lengths.insert(lengths.end(), part.lengths.begin(), part.lengths.end());
  }
};

Joined join(Surface& surface, std::size_t face_count) {
  surface.next_around_edge.resize(3 * surface.triangles.size());
  for_each_index(surface.next_around_edge.size(),
                 [&](std::size_t e) { surface.next_around_edge[e] = static_cast<std::uint32_t>(e); });
  Sets faces(face_count);
  HalfEdges half_edges(surface);
  tbb::enumerable_thread_specific<Joined> parts;
  for_each_index(surface.vertices.size(), [&](std::size_t v) {
    Joined& part = parts.local();
    half_edges.visit_from(v, [&](std::span<const std::uint32_t> edge) {
      for (std::size_t i = 0; i < edge.size(); ++i) {
        surface.next_around_edge[edge[i]] = edge[(i + 1) % edge.size()];
        faces.unite(surface.face[edge[i] / 3], surface.face[edge[0] / 3]);
      }
      part.add(surface, edge);
    });
  });
  Joined joined;
  for (Joined& part : parts) joined.add(std::move(part));
  // A triangle that is no more than a line has no neighbours: it counts as border.
  joined.boundary +=
      static_cast<std::size_t>(std::count_if(surface.triangles.begin(), surface.triangles.end(), repeats_corner));
  joined.component_of = number_components(surface, faces, face_count);
  if (std::vector<double>& lengths = joined.lengths; !lengths.empty()) {
    MeshFacts& facts = surface.facts;
    facts.median_edge = median(lengths);
    facts.sliver_edges = 0, facts.longest_sliver = 0;
    for (const double length : std::span(lengths).first(lengths.size() / 2)) {
      if (length >= MeshFacts::kSliver * facts.median_edge) continue;
      ++facts.sliver_edges;
      facts.longest_sliver = std::max(facts.longest_sliver, length);
    }
  }
  return joined;
}

/// Whether a triangle faces against the polygon that it is part of. The fan of a bent polygon may have such triangles.
bool is_folded_over(PolygonView polygons, const Surface& surface, std::size_t t) {
  const auto polygon = polygons.face(surface.face[t]);
  if (polygon.size() == 3) return false;
  const auto at = [&](std::size_t k) { return polygons.positions[polygon[k]] - polygons.positions[polygon[0]]; };
  Vec3d normal(0.0);
  for (std::size_t k = 2; k < polygon.size(); ++k) normal += at(k - 1).cross(at(k));
  const auto& [i, j, k] = surface.triangles[t];
  return normal.dot((surface.vertices[j] - surface.vertices[i]).cross(surface.vertices[k] - surface.vertices[i])) < 0;
}

/// The triangles that face against their polygon and have the same corners as another triangle. Two bent polygons that
/// share three successive corners may have them.
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
  for (const RepeatedFace& repeated : find_repeated_faces(corners, begin))
    result[order[repeated.face]] = folded[order[repeated.face]];
  return result;
}

/// Leaves out every face that repeats an earlier one, in either direction, then the triangles of
/// find_folded_triangles(). Returns whether there were any.
bool leave_out_repeated_faces(PolygonView polygons, Surface& surface) {
  std::vector<std::uint32_t> corners(polygons.corners.size());
  for_each_index(corners.size(), [&](std::size_t i) { corners[i] = surface.welded[polygons.corners[i]]; });
  surface.repeated = find_repeated_faces(corners, polygons.face_begin);
  surface.facts.repeated_faces = surface.repeated.size();
  std::vector<std::uint8_t> repeats(polygons.face_count(), 0);
  for (const RepeatedFace& repeated : surface.repeated) repeats[repeated.face] = 1;
  const std::size_t before = surface.triangles.size();
  keep_triangles(surface, [&](std::size_t t) { return !repeats[surface.face[t]]; });
  const std::vector<std::uint8_t> folded = find_folded_triangles(polygons, surface);
  surface.facts.folded_triangles = static_cast<std::size_t>(std::count(folded.begin(), folded.end(), 1));
  keep_triangles(surface, [&](std::size_t t) { return !folded[t]; });
  return surface.triangles.size() < before;
}

}  // namespace

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

}  // namespace vdb_offset
