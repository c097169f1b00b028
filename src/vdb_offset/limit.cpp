#include "vdb_offset/limit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "vdb_offset/crossings.h"
#include "vdb_offset/parallel.h"
#include "vdb_offset/untangle.h"

namespace vdb_offset {
namespace {

// How much of its way a vertex of a wrong face keeps in a round; below the last share it keeps none.
constexpr double kKept = 0.85, kLastShare = 0.02;

// Patches are tried with so many rings around what is wrong, their normals smoothed so many times.
constexpr int kRings[] = {1, 2, 3, 4, 6, 8, 12, 16}, kSmoothings[] = {4, 10, 30};

// Rounds in which pulled vertices are let out again, each by one step.
constexpr int kReleases = 12;

// What the states mean by "reached" and no farther.
constexpr double kReachedTolerance = 1e-6;

enum class Fault : std::uint8_t { None, Inverted, Collapsed };

using Indices = std::vector<std::uint32_t>;  // sorted, no two the same

void sort_unique(Indices& indices) {
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
}

/// What is wrong with a state of the surface.
struct Faults {
  Indices faces, vertices;              // vertices: too far from the surface, or on the wrong side of it
  std::vector<TrianglePair> crossings;  // new ones, away from those of the source

  bool none() const { return faces.empty() && crossings.empty(); }
};

class Limiter {
 public:
  Limiter(const ClosestQuery& query, std::span<const Vec3d> source, const LimitOptions& options, Paths& paths)
      : query_(query),
        surface_(query.surface()),
        source_(source),
        options_(options),
        target_(std::abs(options.distance)),
        side_(options.distance < 0 ? -1 : 1),
        paths_(paths),
        whole_way_(paths.displacement),
        share_(source.size(), 1.0),
        place_(source.begin(), source.end()),
        away_(source.size()),
        distance_(source.size()),
        right_side_(source.size(), 1),
        fault_(surface_.triangles.size(), Fault::None),
        patch_(source.size(), kNone),
        finder_(surface_, place_) {
    statistics_.source_crossings = (source_crossings_ = finder_.all()).size();
    mark_near_source();
  }

  LimitStatistics run(Progress& progress) {
    Indices everything(source_.size());
    std::iota(everything.begin(), everything.end(), 0u);
    look(everything);
    statistics_.before = count();
    for (const int smoothing : kSmoothings)
      for (const int rings : kRings)
        if (!faults_.none()) {
          untangle(rings, smoothing);
          ++statistics_.untanglings;
          progress.advance(1);
        }
    while (pull_back()) progress.advance(1);
    statistics_.left = count();
    for (int i = 0; i < kReleases && release(); ++i) progress.advance(1);
    finish();
    return statistics_;
  }

 private:
  /// Vertices within two rings of a face that crosses another in the source.
  void mark_near_source() {
    near_source_.assign(source_.size(), 0);
    for (const auto& [s, t] : source_crossings_)
      for (const auto triangle : {s, t})
        for (const auto v : surface_.triangles[triangle]) near_source_[v] = 1;
    for (int ring = 0; ring < 2 && !source_crossings_.empty(); ++ring) {
      const std::vector<std::uint8_t> inner = near_source_;
      for (const auto& [a, b, c] : surface_.triangles)
        if (inner[a] || inner[b] || inner[c]) near_source_[a] = near_source_[b] = near_source_[c] = 1;
    }
  }
  bool is_near_source(std::uint32_t triangle) const {
    const auto& [a, b, c] = surface_.triangles[triangle];
    return near_source_[a] || near_source_[b] || near_source_[c];
  }

  Vec3d way(std::size_t v) const { return share_[v] == 1 ? whole_way_[v] : whole_way_[v] * share_[v]; }

  /// Where a vertex will be written.
  Vec3d written(std::size_t v) const {
    const Vec3d p = source_[v] + way(v);
    if (!options_.single_precision) return p;
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
  }

  Indices triangles_around(const Indices& vertices) const {
    Indices triangles;
    if (vertices.size() == source_.size()) {
      triangles.resize(surface_.triangles.size());
      std::iota(triangles.begin(), triangles.end(), 0u);
      return triangles;
    }
    for (const auto v : vertices) {
      const auto around = surface_.triangles_around(v);
      triangles.insert(triangles.end(), around.begin(), around.end());
    }
    sort_unique(triangles);
    return triangles;
  }

  /// Puts the moved vertices where their share of the way leads, and finds what is wrong around them.
  void look(const Indices& moved) {
    for_each_index(
        moved.size(), [&](std::size_t i) { measure(moved[i]); }, 64);
    const Indices touched = triangles_around(moved);
    for_each_index(
        touched.size(), [&](std::size_t i) { fault_[touched[i]] = judge(touched[i]); }, 64);
    replace(faults_.faces, touched, [&](std::uint32_t t) { return fault_[t] != Fault::None; });
    replace(faults_.vertices, moved, [&](std::uint32_t v) {
      return !right_side_[v] || distance_[v] > target_ * (1 + kReachedTolerance) + rounding(v);
    });
    look_for_crossings(touched);
  }

  /// Judges anew the members of `some`.
  template <class Wrong>
  static void replace(Indices& wrong, const Indices& some, Wrong&& is_wrong) {
    std::erase_if(wrong, [&](std::uint32_t i) { return std::binary_search(some.begin(), some.end(), i); });
    for (const auto i : some)
      if (is_wrong(i)) wrong.push_back(i);
    std::sort(wrong.begin(), wrong.end());
  }

  void look_for_crossings(const Indices& touched) {
    finder_.update(touched);
    const auto has_moved = [&](std::uint32_t t) { return std::binary_search(touched.begin(), touched.end(), t); };
    const bool first = touched.size() == surface_.triangles.size();
    // Pairs that have not moved meet as before.
    std::erase_if(faults_.crossings,
                  [&](const TrianglePair& pair) { return has_moved(pair.first) || has_moved(pair.second); });
    for (const TrianglePair& pair : first ? finder_.all() : finder_.of(touched)) {
      if (std::binary_search(source_crossings_.begin(), source_crossings_.end(), pair)) continue;
      if (is_near_source(pair.first) || is_near_source(pair.second)) statistics_.crossings_near_source += first;
      else faults_.crossings.push_back(pair);
    }
  }

  void measure(std::size_t v) {
    place_[v] = written(v);
    const Vec3d x = place_[v] - surface_.origin;
    const auto vertex = static_cast<std::uint32_t>(v);
    const Closest closest = query_(x, surface_.triangles_around(vertex).front());
    distance_[v] = closest.distance;
    away_[v] = x - closest.point;
    const bool sided = surface_.facts.closed() && surface_.facts.oriented();
    right_side_[v] = !sided || closest.distance <= 1e-3 * target_ ||
                     side_ * surface_.pseudonormal(closest.triangle, closest.feature).dot(away_[v]) > 0;
  }

  /// How far rounding may have moved a vertex.
  double rounding(std::size_t v) const {
    double size = 0;
    for (int k = 0; k < 3; ++k) size = std::max(size, std::abs(place_[v][k]));
    return size * (options_.single_precision ? 0x1p-23 : 0x1p-51);
  }

  Vec3d twice_area(std::uint32_t t, std::span<const Vec3d> at) const {
    const auto& [a, b, c] = surface_.triangles[t];
    return (at[b] - at[a]).cross(at[c] - at[a]);
  }

  Fault judge(std::uint32_t t) const {
    constexpr double kCollapsed = 1e-6;
    const Vec3d before = twice_area(t, source_), now = twice_area(t, place_);
    if (!(before.lengthSqr() > 0)) return Fault::None;
    if (now.length() <= kCollapsed * before.length()) return Fault::Collapsed;
    // A place very near the source says nothing; with none left the source's normal decides.
    const double near = 1e-3 * target_;
    bool any = false;
    for (const auto v : surface_.triangles[t]) {
      if (distance_[v] < near) continue;
      any = true;
      if (side_ * now.dot(away_[v]) >= 0) return Fault::None;
    }
    const auto& [a, b, c] = surface_.triangles[t];
    const Vec3d centre = (place_[a] + place_[b] + place_[c]) / 3.0 - surface_.origin;
    const Closest closest = query_(centre, t);
    if (closest.distance >= near) return side_ * now.dot(centre - closest.point) < 0 ? Fault::Inverted : Fault::None;
    return any || now.dot(before) < 0 ? Fault::Inverted : Fault::None;
  }

  FaultCounts count() const {
    FaultCounts counts;
    for (const auto t : faults_.faces) ++(fault_[t] == Fault::Inverted ? counts.inverted : counts.collapsed);
    counts.crossings = faults_.crossings.size();
    return counts;
  }

  /// Calls visit(vertex) for each corner of each face that is wrong, and of each that crosses another.
  template <class Visit>
  void for_each_wrong_corner(Visit&& visit) const {
    const auto visit_corners = [&](std::uint32_t t) {
      for (const auto v : surface_.triangles[t]) visit(v);
    };
    for (const auto t : faults_.faces) visit_corners(t);
    for (const auto& [s, t] : faults_.crossings) {
      visit_corners(s);
      visit_corners(t);
    }
  }

  Indices with_rings(Indices vertices, int rings) const {
    for (; rings > 0; --rings) {
      for (const auto t : triangles_around(vertices))
        for (const auto v : surface_.triangles[t]) vertices.push_back(v);
      sort_unique(vertices);
    }
    return vertices;
  }

  /// Splits vertices into patches that share no face; patch_ tells the patch of each.
  std::vector<Indices> find_patches(const Indices& vertices) {
    constexpr std::uint32_t kOpen = kNone - 1;
    for (const auto v : vertices) patch_[v] = kOpen;
    std::vector<Indices> patches;
    for (const auto seed : vertices) {
      if (patch_[seed] != kOpen) continue;
      const auto number = static_cast<std::uint32_t>(patches.size());
      Indices& patch = patches.emplace_back(1, seed);
      patch_[seed] = number;
      for (std::size_t i = 0; i < patch.size(); ++i)
        for (const auto t : surface_.triangles_around(patch[i]))
          for (const auto w : surface_.triangles[t])
            if (patch_[w] == kOpen) {
              patch_[w] = number;
              patch.push_back(w);
            }
      std::sort(patch.begin(), patch.end());
    }
    return patches;
  }

  /// What is wrong in each patch, corner by corner.
  std::vector<std::size_t> faults_by_patch(std::size_t patches) const {
    constexpr std::size_t kMisplaced = 1000000;  // a vertex too far out or on the wrong side: never worth it
    std::vector<std::size_t> faults(patches, 0);
    for_each_wrong_corner([&](std::uint32_t v) {
      if (patch_[v] != kNone) ++faults[patch_[v]];
    });
    for (const auto v : faults_.vertices)
      if (patch_[v] != kNone) faults[patch_[v]] += kMisplaced;
    return faults;
  }

  /// Untangles patches around what is wrong, all at their distance, and keeps those where that makes nothing worse.
  void untangle(int rings, int smoothing) {
    Indices chosen;
    for_each_wrong_corner([&](std::uint32_t v) { chosen.push_back(v); });
    sort_unique(chosen);
    chosen = with_rings(std::move(chosen), rings);
    // What has collided may slide to where there is room.
    std::erase_if(chosen, [&](std::uint32_t v) {
      return paths_.state[v] != VertexState::Reached && paths_.state[v] != VertexState::Collision;
    });
    const std::vector<Indices> patches = find_patches(chosen);
    const std::vector<std::size_t> before = faults_by_patch(patches.size());
    std::vector<Vec3d> old_way(chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i) old_way[i] = whole_way_[chosen[i]];
    const Untangler untangler(query_, options_.distance, smoothing);
    tbb::parallel_for(std::size_t{0}, patches.size(), [&](std::size_t i) { untangler(patches[i], whole_way_); });
    look(chosen);
    const std::vector<std::size_t> after = faults_by_patch(patches.size());
    Indices undone;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const std::uint32_t v = chosen[i];
      if (after[patch_[v]] <= before[patch_[v]]) continue;
      whole_way_[v] = old_way[i];
      undone.push_back(v);
    }
    for (const auto v : chosen) patch_[v] = kNone;
    if (!undone.empty()) look(undone);
  }

  /// The vertices that something is wrong with.
  Indices wrong_vertices() const {
    Indices wrong = faults_.vertices;
    for_each_wrong_corner([&](std::uint32_t v) { wrong.push_back(v); });
    sort_unique(wrong);
    return wrong;
  }

  /// Takes the vertices that something is wrong with a step back. False if there are none that have any way left.
  bool pull_back() {
    Indices wrong = wrong_vertices();
    std::erase_if(wrong, [&](std::uint32_t v) { return share_[v] == 0; });
    if (wrong.empty()) return false;
    for (const auto v : wrong) {
      share_[v] = share_[v] * kKept < kLastShare ? 0 : share_[v] * kKept;
      pulled_.push_back(v);
    }
    sort_unique(pulled_);
    look(wrong);
    ++statistics_.rounds;
    return true;
  }

  /// Lets every pulled vertex out by one step, and takes those back that something is then wrong with. False if none
  /// could be let out.
  bool release() {
    Indices moved = pulled_;
    std::erase_if(moved, [&](std::uint32_t v) { return share_[v] == 0 || share_[v] == 1; });
    std::vector<std::pair<std::uint32_t, double>> before;
    before.reserve(moved.size());
    for (const auto v : moved) {
      before.emplace_back(v, share_[v]);
      share_[v] = std::min(1.0, share_[v] / kKept);
    }
    for (std::size_t out = before.size(); !moved.empty();) {
      look(moved);
      ++statistics_.rounds;
      moved = wrong_vertices();
      std::erase_if(moved, [&](std::uint32_t v) {
        const auto at = std::lower_bound(before.begin(), before.end(), std::pair(v, 0.0));
        if (at == before.end() || at->first != v || at->second == share_[v]) return true;
        share_[v] = at->second;
        return false;
      });
      out -= moved.size();
      if (moved.empty()) return out > 0;
    }
    return false;
  }

  void finish() {
    double lost = 0;
    for (std::size_t v = 0; v < share_.size(); ++v) {
      const bool stayed = paths_.displacement[v] == way(v);
      paths_.displacement[v] = way(v);
      if (stayed) continue;
      lost += std::max(0.0, paths_.achieved[v] - distance_[v]);
      paths_.achieved[v] = distance_[v];
      if (std::abs(distance_[v] - target_) <= kReachedTolerance * target_) {
        paths_.state[v] = VertexState::Reached;  // one that had collided may have slid to where there is room
      } else if (share_[v] != 1) {
        paths_.state[v] = VertexState::Limited;
        ++statistics_.limited_vertices;
      }
    }
    statistics_.thickness_lost = lost / (target_ * static_cast<double>(std::max<std::size_t>(1, share_.size())));
  }

  const ClosestQuery& query_;
  const Surface& surface_;
  std::span<const Vec3d> source_;
  LimitOptions options_;
  double target_;
  int side_;
  Paths& paths_;
  std::vector<Vec3d> whole_way_;
  std::vector<double> share_;  // of the way that a vertex goes
  Indices pulled_;             // vertices that have been pulled back at some time
  std::vector<Vec3d> place_, away_;
  std::vector<double> distance_;
  std::vector<std::uint8_t> right_side_, near_source_;
  std::vector<Fault> fault_;  // of each triangle
  Faults faults_;             // as things stand
  Indices patch_;             // of each vertex while patches are being untangled, else kNone
  CrossingFinder finder_;
  std::vector<TrianglePair> source_crossings_;
  LimitStatistics statistics_;
};

}  // namespace

LimitStatistics limit(const ClosestQuery& query, std::span<const Vec3d> source, const LimitOptions& options,
                      Paths& paths, const ProgressCallback& callback) {
  constexpr std::size_t kExpectedRounds = 32;
  Progress progress(callback, Stage::Limit, kExpectedRounds);
  return Limiter(query, source, options, paths).run(progress);
}

}  // namespace vdb_offset
