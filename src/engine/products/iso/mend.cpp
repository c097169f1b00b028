// SPDX-License-Identifier: Apache-2.0
// Takes crossings and triangles without area out of a mesh. In a round, each faulty triangle has its corners tried at
// positions on the surface, towards the middle of their neighbours and towards each neighbour, and then its edges
// flipped; a change stays only if it leaves fewer faults, so that their number falls with each. If faults are left, the
// longest edges of faulty triangles are split by new vertices on the surface, and another round begins. Mending ends
// without faults, without anything to split, or after three rounds in a row that were no better than the best, which is
// then the result. A mesh that is closed and manifold stays so. Faults are mended one after the other in the order of
// triangles; those that are left are counted, and the caller decides about them.
#include "products/iso/mend.h"

#include <algorithm>
#include <array>
#include <optional>
#include <unordered_map>

#include "ground/system/assert.h"
#include "valid/faults/triangle_crossings.h"

namespace vdb_offset {
namespace {

using TriangleList = std::vector<std::uint32_t>;

// The number of rounds of splits that leave no fewer faults than the best so far after which mending ends: splits alone
// make more faults before the moves after them take some out. Not measured.
constexpr int kFruitlessRounds = 3;

void make_set(TriangleList& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

bool stands_as_needle(const Surface& mesh, std::uint32_t t) {
  const auto& [i, j, k] = mesh.triangles[t];
  const Vec3d ab = mesh.vertices[j] - mesh.vertices[i], ac = mesh.vertices[k] - mesh.vertices[i], bc = ac - ab;
  return is_needle(ab.cross(ac).lengthSqr(), std::max({ab.lengthSqr(), ac.lengthSqr(), bc.lengthSqr()}));
}

/// One round of mending, by moves and flips.
class MendingRound {
 public:
  MendingRound(Surface& mesh, const Onto& onto, MendStatistics& statistics)
      : mesh_(mesh), positions_(mesh.vertices), onto_(onto), statistics_(statistics), finder_(mesh, mesh.vertices) {
    crossings_ = finder_.all();
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      if (stands_as_needle(t)) needles_.push_back(t);
  }

  MeshFaults faults() const { return {crossings_.size(), needles_.size()}; }

  /// Tries to mend each fault in turn, as long as that leaves fewer faults.
  void move_and_flip() {
    for (std::size_t before = 0; before != faults().total() && faults().total() > 0;) {
      before = faults().total();
      const TriangleList faulty = faulty_triangles();
      for (const auto t : faulty) {
        if (!is_faulty(t)) continue;
        for (const auto v : std::array(mesh_.triangles[t]))
          if (is_faulty(t)) try_to_move(v);
        for (std::size_t k = 0; k < 3 && is_faulty(t); ++k) try_to_flip(t, k);
      }
    }
  }

  /// The triangles with a fault. Sorted.
  TriangleList faulty_triangles() const {
    TriangleList faulty = needles_;
    for (const auto& [s, t] : crossings_) faulty.insert(faulty.end(), {s, t});
    make_set(faulty);
    return faulty;
  }

 private:
  std::span<const std::uint32_t> around(std::uint32_t vertex) const {
    const auto changed = changed_.find(vertex);
    return changed == changed_.end() ? mesh_.triangles_around(vertex) : std::span<const std::uint32_t>(changed->second);
  }

  bool stands_as_needle(std::uint32_t t) const { return vdb_offset::stands_as_needle(mesh_, t); }

  bool is_faulty(std::uint32_t t) const {
    return std::binary_search(needles_.begin(), needles_.end(), t) ||
           std::any_of(crossings_.begin(), crossings_.end(),
                       [&](const TrianglePair& pair) { return pair.first == t || pair.second == t; });
  }

  /// Finds the faults of triangles, sorted, at their present positions.
  MeshFaults find_faults_of(const TriangleList& changed) {
    finder_.update(changed);
    found_ = finder_.of_updated();
    const auto needles =
        std::count_if(changed.begin(), changed.end(), [&](std::uint32_t t) { return stands_as_needle(t); });
    return {found_.size(), static_cast<std::size_t>(needles)};
  }

  /// The number of known faults of triangles, as noted by settle().
  std::size_t known_faults(const TriangleList& of) const {
    const auto is_one = [&](std::uint32_t t) { return std::binary_search(of.begin(), of.end(), t); };
    return static_cast<std::size_t>(std::count_if(needles_.begin(), needles_.end(), is_one) +
                                    std::count_if(crossings_.begin(), crossings_.end(), [&](const TrianglePair& pair) {
                                      return is_one(pair.first) || is_one(pair.second);
                                    }));
  }

  /// Notes the faults of triangles that were found last as the known ones.
  void settle(const TriangleList& changed) {
    const auto is_one = [&](std::uint32_t t) { return std::binary_search(changed.begin(), changed.end(), t); };
    std::erase_if(crossings_, [&](const TrianglePair& pair) { return is_one(pair.first) || is_one(pair.second); });
    std::erase_if(needles_, is_one);
    crossings_.insert(crossings_.end(), found_.begin(), found_.end());
    std::sort(crossings_.begin(), crossings_.end());
    for (const auto t : changed)
      if (stands_as_needle(t)) needles_.push_back(t);
    make_set(needles_);
  }

  TriangleList star_of(std::uint32_t vertex) const {
    const auto triangles = around(vertex);
    TriangleList star(triangles.begin(), triangles.end());
    make_set(star);
    return star;
  }

  /// Positions to try for a vertex: towards the middle of its neighbours, and towards each of them.
  std::vector<Vec3d> wishes_of(std::uint32_t vertex, const TriangleList& star) const {
    std::vector<std::uint32_t> ring;
    for (const auto t : star)
      for (const auto w : mesh_.triangles[t])
        if (w != vertex) ring.push_back(w);
    make_set(ring);
    const Vec3d& here = positions_[vertex];
    Vec3d middle(0.0);
    for (const auto w : ring) middle += positions_[w] / static_cast<double>(ring.size());
    std::vector<Vec3d> wishes;
    for (const double share : {0.5, 1.0}) wishes.push_back(here + (middle - here) * share);
    for (const double share : {0.25, 0.5})
      for (const auto w : ring) wishes.push_back(here + (positions_[w] - here) * share);
    return wishes;
  }

  void try_to_move(std::uint32_t vertex) {
    const TriangleList star = star_of(vertex);
    const Vec3d before = positions_[vertex];
    std::size_t fewest = known_faults(star);
    std::optional<Vec3d> best;
    for (const Vec3d& wish : wishes_of(vertex, star)) {
      if (fewest == 0) break;
      const auto position = onto_(wish);
      if (!position) continue;
      positions_[vertex] = *position;
      if (const std::size_t faults = find_faults_of(star).total(); faults < fewest) {
        fewest = faults;
        best = position;
      }
    }
    positions_[vertex] = best.value_or(before);
    find_faults_of(star);
    if (!best) return;
    settle(star);
    ++statistics_.moved_vertices;
  }

  /// The triangle across edge k of a triangle, and its corner opposite to the edge; kNone unless there is exactly one.
  std::pair<std::uint32_t, std::uint32_t> across(std::uint32_t t, std::size_t k) const {
    const std::uint32_t a = mesh_.triangles[t][k], b = mesh_.triangles[t][(k + 1) % 3];
    std::pair<std::uint32_t, std::uint32_t> found{kNone, kNone};
    for (const auto other : around(a)) {
      const auto& corners = mesh_.triangles[other];
      if (other == t || std::find(corners.begin(), corners.end(), b) == corners.end()) continue;
      if (found.first != kNone) return {kNone, kNone};
      for (const auto w : corners)
        if (w != a && w != b) found = {other, w};
    }
    return found;
  }

  bool is_edge(std::uint32_t v, std::uint32_t w) const {
    const auto triangles = around(v);
    return std::any_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
      return std::find(mesh_.triangles[t].begin(), mesh_.triangles[t].end(), w) != mesh_.triangles[t].end();
    });
  }

  void try_to_flip(std::uint32_t t, std::size_t k) {
    const auto [other, d] = across(t, k);
    const std::uint32_t a = mesh_.triangles[t][k], b = mesh_.triangles[t][(k + 1) % 3],
                        c = mesh_.triangles[t][(k + 2) % 3];
    if (other == kNone || c == d || is_edge(c, d)) return;
    const std::array before{mesh_.triangles[t], mesh_.triangles[other]};
    const TriangleList both = {std::min(t, other), std::max(t, other)};
    const std::size_t known = known_faults(both);
    mesh_.triangles[t] = {a, d, c};
    mesh_.triangles[other] = {d, b, c};
    if (find_faults_of(both).total() >= known) {
      mesh_.triangles[t] = before[0];
      mesh_.triangles[other] = before[1];
      find_faults_of(both);
      return;
    }
    settle(both);
    ++statistics_.flipped_edges;
    for (const auto& [vertex, gone, come] :
         {std::array{a, other, kNone}, {b, t, kNone}, {c, kNone, other}, {d, kNone, t}})
      change_star(vertex, gone, come);
  }

  void change_star(std::uint32_t vertex, std::uint32_t gone, std::uint32_t come) {
    const auto old = around(vertex);
    TriangleList star(old.begin(), old.end());
    std::erase(star, gone);
    if (come != kNone) star.push_back(come);
    changed_[vertex] = std::move(star);
  }

  Surface& mesh_;
  std::vector<Vec3d>& positions_;
  const Onto& onto_;
  MendStatistics& statistics_;
  CrossingFinder finder_;
  std::vector<TrianglePair> crossings_, found_;
  TriangleList needles_;
  std::unordered_map<std::uint32_t, TriangleList> changed_;  // stars of vertices whose edges were flipped
};

/// The triangles at an edge.
TriangleList triangles_at(const Surface& mesh, std::uint32_t a, std::uint32_t b) {
  TriangleList found;
  for (const auto t : mesh.triangles_around(a))
    if (const auto& corners = mesh.triangles[t]; std::find(corners.begin(), corners.end(), b) != corners.end())
      found.push_back(t);
  return found;
}

/// The corner of a triangle at which its longest edge starts.
std::size_t longest_edge(const Surface& mesh, std::uint32_t t) {
  const auto& corners = mesh.triangles[t];
  std::array<double, 3> squared;
  for (std::size_t k = 0; k < 3; ++k)
    squared[k] = (mesh.vertices[corners[k]] - mesh.vertices[corners[(k + 1) % 3]]).lengthSqr();
  return static_cast<std::size_t>(std::max_element(squared.begin(), squared.end()) - squared.begin());
}

/// Splits the longest edge of each of these triangles in the middle, unless a triangle beside it is split already.
/// Stars have to be listed anew then. Returns the number of splits.
std::size_t split_longest_edges(Surface& mesh, const TriangleList& faulty, const Onto& onto) {
  TriangleList taken;
  std::size_t splits = 0;
  for (const auto t : faulty) {
    // A triangle that is split has a new corner, for which no star is listed.
    if (std::find(taken.begin(), taken.end(), t) != taken.end()) continue;
    const std::size_t k = longest_edge(mesh, t);
    const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
    const TriangleList sides = triangles_at(mesh, a, b);
    // If there is one triangle, the other one has been split, and is not listed.
    if (sides.size() != 2) continue;
    if (std::find_first_of(taken.begin(), taken.end(), sides.begin(), sides.end()) != taken.end()) continue;
    const auto position = onto((mesh.vertices[a] + mesh.vertices[b]) / 2.0);
    if (!position) continue;
    const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back(*position);
    for (const auto s : sides) {
      auto half = mesh.triangles[s];
      std::replace(mesh.triangles[s].begin(), mesh.triangles[s].end(), b, middle);
      std::replace(half.begin(), half.end(), a, middle);
      mesh.triangles.push_back(half);
    }
    taken.insert(taken.end(), sides.begin(), sides.end());
    ++splits;
  }
  return splits;
}

}  // namespace

MeshFaults find_faults(const Surface& mesh) {
  MeshFaults faults;
  faults.crossings = CrossingFinder(mesh, mesh.vertices).all().size();
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) faults.needles += stands_as_needle(mesh, t);
  return faults;
}

std::vector<std::uint32_t> find_faulty(const Surface& mesh, std::span<const std::uint32_t> some) {
  VDB_OFFSET_ASSERT(std::is_sorted(some.begin(), some.end()));
  CrossingFinder finder(mesh, mesh.vertices);
  finder.update(some);
  TriangleList faulty;
  for (const auto& [s, t] : finder.of_updated()) faulty.insert(faulty.end(), {s, t});
  for (const auto t : some)
    if (stands_as_needle(mesh, t)) faulty.push_back(t);
  make_set(faulty);
  return faulty;
}

MendStatistics mend(Surface& mesh, const Onto& onto) {
  VDB_OFFSET_ASSERT(mesh.incident.size() == 3 * mesh.triangles.size());  // it is built
  MendStatistics statistics, kept;
  std::optional<std::size_t> fewest;  // faults of any mesh so far
  std::vector<Vec3d> positions;       // of the mesh with the fewest faults
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (int fruitless = 0; fruitless < kFruitlessRounds;) {
    TriangleList faulty;
    {
      MendingRound round(mesh, onto, statistics);
      if (!fewest) statistics.before = round.faults();
      ++statistics.rounds;
      round.move_and_flip();
      faulty = round.faulty_triangles();
      if (!fewest || round.faults().total() < *fewest) {
        fewest = round.faults().total();
        statistics.left = round.faults();
        kept = statistics;
        positions = mesh.vertices;
        triangles = mesh.triangles;
        fruitless = 0;
      } else {
        ++fruitless;
      }
    }
    if (faulty.empty()) break;
    list_incident_triangles(mesh);  // edges were flipped
    const std::size_t splits = split_longest_edges(mesh, faulty, onto);
    if (splits == 0) break;
    statistics.split_edges += splits;
    list_incident_triangles(mesh);
  }
  mesh.vertices = std::move(positions);
  mesh.triangles = std::move(triangles);
  list_incident_triangles(mesh);
  return kept;
}

}  // namespace vdb_offset
