#include "vdb_offset/limit.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "vdb_offset/crossings.h"
#include "vdb_offset/parallel.h"
#include "vdb_offset/untangle.h"

namespace vdb_offset {
namespace {

// How much of its way a vertex of a wrong face keeps in a round; below the last share it keeps none.
constexpr double kKept = 0.85, kLastShare = 0.02;

// Rounds in which patches are relaxed, in turn the whole way to their neighbours' mean and a share of it; rounds in
// which pulled vertices are let out again, each by one step.
constexpr int kUntanglings = 12, kReleases = 12;
constexpr double kGently = 0.3;

// What the states mean by "reached" and no farther.
constexpr double kReachedTolerance = 1e-6;

enum class Fault : std::uint8_t { None, Inverted, Collapsed };

/// What is wrong with a state of the surface.
struct Faults {
  std::vector<std::uint8_t> face;       // Fault of each triangle
  std::vector<TrianglePair> crossings;  // new ones, away from those of the source
  std::vector<std::uint8_t> vertex;     // 1: too far from the surface, or on the wrong side of it
  std::size_t near_source = 0;
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
        fault_(surface_.triangles.size(), 0) {
    statistics_.source_crossings = (source_crossings_ = find_crossings(surface_, source)).size();
    mark_near_source();
  }

  LimitStatistics run(Progress& progress) {
    std::vector<std::uint8_t> moved(source_.size(), 1);
    Faults faults = look(moved);
    statistics_.crossings_near_source = faults.near_source;
    statistics_.before = count(faults);
    constexpr int kRings[] = {1, 2, 3, 4, 6, 8};
    for (int i = 0; i < 2 * 6 && untangle(faults, kRings[i % 6]); ++i) {
      if (getenv("DBG")) { auto c = count(faults); fprintf(stderr, "untangle %d: %zu %zu %zu\n", i, c.inverted, c.collapsed, c.crossings); }
      progress.advance(1);
    }
    while (pull_back(faults, moved)) {
      ++statistics_.rounds;
      progress.advance(1);
      faults = look(moved);
    }
    statistics_.left = count(faults);
    for (int i = 0; i < kReleases && release(progress); ++i) {
    }
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

  /// Puts the moved vertices where their share of the way leads, and finds what is wrong around them.
  Faults look(const std::vector<std::uint8_t>& moved) {
    for_each_index(source_.size(), [&](std::size_t v) {
      if (moved[v]) measure(v);
    });
    std::vector<std::uint8_t> triangle_moved(surface_.triangles.size());
    for_each_index(surface_.triangles.size(), [&](std::size_t t) {
      const auto& [a, b, c] = surface_.triangles[t];
      triangle_moved[t] = moved[a] || moved[b] || moved[c];
      if (triangle_moved[t]) fault_[t] = static_cast<std::uint8_t>(judge(static_cast<std::uint32_t>(t)));
    });
    Faults faults;
    faults.face = fault_;
    faults.vertex.resize(source_.size());
    for_each_index(source_.size(), [&](std::size_t v) {
      faults.vertex[v] = !right_side_[v] || distance_[v] > target_ * (1 + kReachedTolerance) + rounding(v);
    });
    // Pairs that have not moved meet as before.
    std::erase_if(crossings_,
                  [&](const TrianglePair& pair) { return triangle_moved[pair.first] || triangle_moved[pair.second]; });
    for (const TrianglePair& pair : find_crossings(surface_, place_, triangle_moved)) {
      if (std::binary_search(source_crossings_.begin(), source_crossings_.end(), pair)) continue;
      if (is_near_source(pair.first) || is_near_source(pair.second)) ++faults.near_source;
      else crossings_.push_back(pair);
    }
    faults.crossings = crossings_;
    return faults;
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

  static FaultCounts count(const Faults& faults) {
    FaultCounts counts;
    for (const auto fault : faults.face) {
      counts.inverted += fault == static_cast<std::uint8_t>(Fault::Inverted);
      counts.collapsed += fault == static_cast<std::uint8_t>(Fault::Collapsed);
    }
    counts.crossings = faults.crossings.size();
    return counts;
  }

  /// The vertices that something is wrong with.
  std::vector<std::uint8_t> wrong_vertices(const Faults& faults) const {
    std::vector<std::uint8_t> wrong = faults.vertex;
    const auto mark = [&](std::uint32_t t) {
      for (const auto v : surface_.triangles[t]) wrong[v] = 1;
    };
    for (std::uint32_t t = 0; t < faults.face.size(); ++t)
      if (faults.face[t]) mark(t);
    for (const auto& [s, t] : faults.crossings) {
      mark(s);
      mark(t);
    }
    return wrong;
  }

  /// What is wrong at each vertex: faces around it and crossings of those.
  std::vector<std::uint32_t> faults_around(const Faults& faults) const {
    std::vector<std::uint32_t> around(source_.size(), 0);
    const auto add = [&](std::uint32_t t) {
      for (const auto v : surface_.triangles[t]) ++around[v];
    };
    for (std::uint32_t t = 0; t < faults.face.size(); ++t)
      if (faults.face[t]) add(t);
    for (const auto& [s, t] : faults.crossings) {
      add(s);
      add(t);
    }
    return around;
  }

  /// Numbers the patches that hang together among the chosen vertices; kNone for the others.
  std::vector<std::uint32_t> find_patches(const std::vector<std::uint8_t>& chosen, std::uint32_t& count) const {
    std::vector<std::uint32_t> patch(chosen.size(), kNone), open;
    count = 0;
    for (std::uint32_t seed = 0; seed < chosen.size(); ++seed) {
      if (!chosen[seed] || patch[seed] != kNone) continue;
      patch[seed] = count;
      for (open.assign(1, seed); !open.empty();) {
        const std::uint32_t v = open.back();
        open.pop_back();
        for (const auto t : surface_.triangles_around(v))
          for (const auto w : surface_.triangles[t])
            if (chosen[w] && patch[w] == kNone) {
              patch[w] = count;
              open.push_back(w);
            }
      }
      ++count;
    }
    return patch;
  }

  std::vector<std::uint8_t> with_ring(const std::vector<std::uint8_t>& chosen) const {
    std::vector<std::uint8_t> wider = chosen;
    for (const auto& [a, b, c] : surface_.triangles)
      if (chosen[a] || chosen[b] || chosen[c]) wider[a] = wider[b] = wider[c] = 1;
    return wider;
  }

  /// The way of a vertex that goes by `weight` the mean way of its neighbours, then to the target's distance, if it
  /// settles there.
  std::optional<Vec3d> relaxed_way(std::uint32_t v, double weight) const {
    Vec3d sum(0.0);
    std::size_t count = 0;
    for (const auto t : surface_.triangles_around(v))
      for (const auto w : surface_.triangles[t])
        if (w != v) {
          sum += whole_way_[w];
          ++count;
        }
    const Vec3d start = source_[v] - surface_.origin;
    Vec3d x = start + whole_way_[v] * (1 - weight) + sum * (weight / static_cast<double>(count));
    std::uint32_t hint = surface_.triangles_around(v).front();
    constexpr int kMostSteps = 20;
    constexpr double kSettled = 1e-9;
    for (int i = 0; i < kMostSteps; ++i) {
      const Closest closest = query_(x, hint);
      hint = closest.triangle;
      if (std::abs(closest.distance - target_) <= kSettled * target_) return round_way(x - start, target_);
      if (!(closest.distance > 1e-3 * target_)) return std::nullopt;
      x = closest.point + (x - closest.point) * (target_ / closest.distance);
    }
    return std::nullopt;
  }

  /// Untangles the patches of so many rings around what is wrong, all at their distance, and keeps those where that
  /// makes nothing worse. False if nothing is wrong.
  bool untangle(Faults& faults, int rings) {
    const std::vector<std::uint32_t> before = faults_around(faults);
    std::vector<std::uint8_t> chosen(source_.size());
    bool any = false;
    for (std::size_t v = 0; v < chosen.size(); ++v) {
      chosen[v] = before[v] > 0;
      any |= before[v] > 0;
    }
    if (!any) return false;
    for (int ring = 0; ring < rings; ++ring) chosen = with_ring(chosen);
    for (std::size_t v = 0; v < chosen.size(); ++v) chosen[v] = chosen[v] && paths_.state[v] == VertexState::Reached;
    const std::vector<Vec3d> old_way = whole_way_;
    std::uint32_t count = 0;
    const std::vector<std::uint32_t> patch = find_patches(chosen, count);
    std::vector<std::vector<std::uint32_t>> patches(count);
    for (std::uint32_t v = 0; v < patch.size(); ++v)
      if (patch[v] != kNone) patches[patch[v]].push_back(v);
    const Untangler untangler(query_, options_.distance);
    tbb::parallel_for(std::size_t{0}, patches.size(), [&](std::size_t i) { untangler(patches[i], whole_way_); });
    std::vector<std::uint8_t> moved = chosen;
    faults = look(moved);
    if (undo_worse_patches(faults, before, chosen, old_way, moved)) faults = look(moved);
    return true;
  }

  /// Takes back the patches with more faults than before, and marks their vertices as moved. False if there are none.
  bool undo_worse_patches(const Faults& faults, const std::vector<std::uint32_t>& before,
                          const std::vector<std::uint8_t>& chosen, const std::vector<Vec3d>& old_way,
                          std::vector<std::uint8_t>& moved) {
    constexpr std::int64_t kMisplaced = 1000;  // a vertex too far out or on the wrong side: never worth it
    std::uint32_t count = 0;
    const std::vector<std::uint32_t> patch = find_patches(chosen, count), after = faults_around(faults);
    std::vector<std::int64_t> gain(count, 0);
    for (std::size_t v = 0; v < patch.size(); ++v)
      if (patch[v] != kNone)
        gain[patch[v]] += std::int64_t{before[v]} - std::int64_t{after[v]} - kMisplaced * faults.vertex[v];
    bool undone = false;
    for (std::size_t v = 0; v < patch.size(); ++v) {
      moved[v] = moved[v] && gain[patch[v]] < 0;
      if (!moved[v]) continue;
      whole_way_[v] = old_way[v];
      undone = true;
    }
    return undone;
  }

  /// Takes the vertices that something is wrong with a step back. False if there are none that have any way left.
  bool pull_back(const Faults& faults, std::vector<std::uint8_t>& moved) {
    moved = wrong_vertices(faults);
    bool any = false;
    for (std::size_t v = 0; v < moved.size(); ++v) {
      moved[v] = moved[v] && share_[v] > 0;
      if (!moved[v]) continue;
      share_[v] = share_[v] * kKept < kLastShare ? 0 : share_[v] * kKept;
      any = true;
    }
    return any;
  }

  /// Lets every pulled vertex out by one step, and takes those back that something is then wrong with. False if none
  /// could be let out.
  bool release(Progress& progress) {
    const std::vector<double> before = share_;
    std::vector<std::uint8_t> moved(source_.size(), 0);
    for (std::size_t v = 0; v < share_.size(); ++v)
      if (share_[v] < 1 && share_[v] > 0) {
        share_[v] = std::min(1.0, share_[v] / kKept);
        moved[v] = 1;
      }
    for (;;) {
      const Faults faults = look(moved);
      ++statistics_.rounds;
      progress.advance(1);
      moved = wrong_vertices(faults);
      bool any = false;
      for (std::size_t v = 0; v < moved.size(); ++v) {
        moved[v] = moved[v] && share_[v] != before[v];
        if (!moved[v]) continue;
        share_[v] = before[v];
        any = true;
      }
      if (!any) break;
    }
    return share_ != before;
  }

  void finish() {
    double lost = 0;
    for (std::size_t v = 0; v < share_.size(); ++v) {
      paths_.displacement[v] = way(v);
      if (share_[v] == 1) continue;
      lost += std::max(0.0, paths_.achieved[v] - distance_[v]);
      paths_.achieved[v] = distance_[v];
      if (std::abs(distance_[v] - target_) <= kReachedTolerance * target_) continue;
      paths_.state[v] = VertexState::Limited;
      ++statistics_.limited_vertices;
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
  std::vector<Vec3d> place_, away_;
  std::vector<double> distance_;
  std::vector<std::uint8_t> right_side_, fault_, near_source_;
  std::vector<TrianglePair> source_crossings_, crossings_;  // of the source; new ones, as things stand
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
