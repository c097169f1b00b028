// SPDX-License-Identifier: Apache-2.0
#include "motion/paths/propagate.h"

#include "ground/system/progress_count.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "motion/paths/vertex_march.h"

namespace vdb_offset {
namespace {

// If a fast march got at least this share of the distance, the next one starts from its end. Not measured.
constexpr double kRestartShare = 0.7;

// Share of the largest coordinate by which points of a plane may be off. Reasoned: of points in a file that keeps seven
// digits, by a few of the last.
constexpr double kRoughPlanes = 5e-7;

/// Flags of components; and flags that only go from 1 to 0: a thread that reads a stale 1 does redundant work.
using Components = std::vector<std::uint8_t>;
using FallingFlags = std::vector<std::atomic<std::uint8_t>>;

/// The paths of a run: of all vertices, for all sets of distances. The constructor finds those that need no field;
/// operator() the others, block by block.
template <class Query>
class Marches {
 public:
  Marches(const Query& query, const DirectionField& directions, std::span<const Distances> distances,
          const Obstacles* obstacles, const PathOptions& options, std::vector<Paths>& paths)
      : query_(query),
        surface_(query.surface()),
        directions_(directions),
        distances_(distances),
        obstacles_(obstacles),
        options_(options),
        paths_(paths) {
    const std::size_t count = surface_.vertices.size();
    // Paths along ridges do not end at obstacles, nor do they keep to borders.
    const bool along_ridges = options.ridges == Ridges::Sharp && !obstacles && surface_.conormals.empty();
    if (along_ridges) roughness_ = kRoughPlanes * largest_coordinate();
    for (std::size_t set = 0; set < distances.size(); ++set) {
      paths[set].displacement.resize(count);
      paths[set].achieved.resize(count);
      paths[set].state.resize(count);
      paths[set].closest.resize(count, kNone);
      if (options.keep == KeepPaths::Yes) paths[set].trace.resize(count);
      arrival_.emplace_back(count);
    }
    go_straight();
    for (std::size_t set = 0; set < distances.size(); ++set) {
      for (std::size_t v = 0; v < count; ++v) paths[set].straight += is_known(set, v);
      if (along_ridges) go_along_ridges(set);
    }
  }

  std::size_t block_count() const { return (surface_.vertices.size() + kBlock - 1) / kBlock; }
  static std::size_t begin_of(std::size_t block) { return block * kBlock; }
  std::size_t end_of(std::size_t block) const { return std::min((block + 1) * kBlock, surface_.vertices.size()); }

  /// Moves the vertices of a block: all by a fast march; those that did not arrive march on from its end, now that the
  /// closest triangle there is known, as the end is on the path if the surface is only a little nearer than measured;
  /// twice, as something else may be closest where they arrive then. The rest by an exact march from the start.
  void operator()(std::size_t block) const {
    DirectionSampler sampler(directions_);
    std::vector<StopDistance> stops;
    std::vector<End> ends;
    for (const auto attempt :
         {Attempt::FastFromStart, Attempt::FastFromEnd, Attempt::FastFromEnd, Attempt::ExactFromStart}) {
      ends.clear();
      for (std::size_t v = begin_of(block); v < end_of(block); ++v)
        for (const int side : {1, -1}) {
          stops.clear();
          for (std::size_t set = 0; set < distances_.size(); ++set) add_stop(set, v, side, attempt, stops, ends);
          if (!stops.empty()) march(sampler, v, side, attempt, stops, ends);
        }
      judge(ends);
    }
  }

 private:
  // Vertices of a block, which are measured together. Not measured.
  static constexpr std::size_t kBlock = 128;

  enum class Attempt { FastFromStart, FastFromEnd, ExactFromStart };
  enum class Search { Near, Everywhere };
  /// The end of a vertex's path to a stop distance.
  struct End {
    std::uint32_t vertex;
    StopDistance stop;
    Arrival arrival;
  };

  bool is_known(std::size_t set, std::size_t v) const { return known_[set][surface_.component[v]]; }

  double largest_coordinate() const {
    double largest = 0;
    for (const Vec3d& vertex : surface_.vertices)
      for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(vertex[k] + surface_.origin[k]));
    return largest;
  }

  /// Tries straight paths for all sets. A component of which one vertex has none has none at all in that set. Distances
  /// are measured from the faces around the vertices first, then exactly, for all sets that are left of a component
  /// together.
  void go_straight() {
    const Components all(surface_.facts.components, 1);
    known_.assign(distances_.size(), all);
    for (const auto search : {Search::Near, Search::Everywhere}) {
      std::vector<FallingFlags> straight;
      for (const Components& left : known_) straight.emplace_back(left.begin(), left.end());
      for_each_index(
          block_count(), [&](std::size_t block) { go_straight(block, search, straight); }, 1);
      for (std::size_t set = 0; set < straight.size(); ++set)
        known_[set].assign(straight[set].begin(), straight[set].end());
    }
  }

  /// Tries straight paths for the vertices of a block, one component at a time. A set that has failed stays with the
  /// others: without it, their searches would begin elsewhere, and their bits would differ.
  void go_straight(std::size_t block, Search search, std::vector<FallingFlags>& straight) {
    std::vector<std::uint32_t> vertices(end_of(block) - begin_of(block));
    std::iota(vertices.begin(), vertices.end(), static_cast<std::uint32_t>(begin_of(block)));
    const auto component_of = [&](std::uint32_t v) { return surface_.component[v]; };
    std::stable_sort(vertices.begin(), vertices.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return component_of(a) < component_of(b); });
    for (std::size_t first = 0, last = 0; first < vertices.size(); first = last) {
      const std::uint32_t component = component_of(vertices[first]);
      while (last < vertices.size() && component_of(vertices[last]) == component) ++last;
      const auto some = std::span(vertices).subspan(first, last - first);
      const auto is_up = [&](std::size_t set) { return straight[set][component].load(std::memory_order_relaxed) != 0; };
      std::vector<std::size_t> sets;
      bool any_up = false;
      for (std::size_t set = 0; set < distances_.size(); ++set) {
        if (!known_[set][component]) continue;
        if (search == Search::Near && !is_up(set)) continue;
        sets.push_back(set);
        any_up = any_up || is_up(set);
      }
      if (!any_up) continue;
      for (const auto set : search == Search::Near ? without_near_ends(sets, some) : without_ends(sets, some))
        straight[set][component].store(0, std::memory_order_relaxed);
    }
  }

  void add_try(std::size_t set, std::uint32_t v, std::vector<StraightTry>& tries) const {
    const double distance = distances_[set][v];
    if (distance != 0) tries.push_back({v, distance < 0 ? -1 : 1, std::abs(distance)});
  }

  /// The sets for which one of the vertices has no straight path, as the faces around it show.
  std::vector<std::size_t> without_near_ends(std::vector<std::size_t> sets, std::span<const std::uint32_t> vertices) {
    std::erase_if(sets, [&](std::size_t set) {
      std::vector<StraightTry> tries;
      for (const auto v : vertices) add_try(set, v, tries);
      return StraightPaths<Query>(query_, tries).may_all_end();
    });
    return sets;
  }

  /// The sets for which one of the vertices has no straight path. Notes the ends of the others.
  std::vector<std::size_t> without_ends(const std::vector<std::size_t>& sets, std::span<const std::uint32_t> vertices) {
    std::vector<StraightTry> tries;
    std::vector<std::size_t> set_of;
    for (const auto v : vertices)
      for (const auto set : sets) {
        add_try(set, v, tries);
        set_of.resize(tries.size(), set);
      }
    const auto ends = StraightPaths<Query>(query_, tries)();
    std::vector<std::size_t> without;
    for (std::size_t i = 0; i < tries.size(); ++i)
      if (ends[i]) arrival_[set_of[i]][tries[i].vertex] = *ends[i];
      else without.push_back(set_of[i]);
    return without;
  }

  /// Follows ridges from the vertices of the components that have no straight paths: again of all of their vertices, or
  /// of none.
  void go_along_ridges(std::size_t set) {
    Components& known = known_[set];
    FallingFlags found(known.size());
    for (std::size_t c = 0; c < known.size(); ++c) found[c] = !known[c];
    for_each_index(
        block_count(), [&](std::size_t block) { go_along_ridges(block, set, found); }, 1);
    for (std::size_t c = 0; c < known.size(); ++c) known[c] |= found[c];
  }

  void go_along_ridges(std::size_t block, std::size_t set, FallingFlags& found) {
    DirectionSampler sampler(directions_);
    for (std::size_t v = begin_of(block); v < end_of(block); ++v) {
      auto& flag = found[surface_.component[v]];
      const double distance = distances_[set][v];
      if (!flag.load(std::memory_order_relaxed) || distance == 0) continue;
      VertexMarch<Query> vertex_march(query_, directions_, sampler, distance < 0 ? -1 : 1,
                                      static_cast<std::uint32_t>(v), March::Exact);
      if (options_.keep == KeepPaths::Yes) vertex_march.keep_trace({});
      const auto end = vertex_march.go_along_ridges(std::abs(distance), roughness_);
      if (options_.keep == KeepPaths::Yes) paths_[set].trace[v] = vertex_march.trace();
      if (end) arrival_[set][v] = *end;
      else flag.store(0, std::memory_order_relaxed);
    }
  }

  /// Adds the distance that vertex v has to march to for one set, if it goes to this side at all and has not arrived;
  /// or its end, if that is known without a march.
  void add_stop(std::size_t set, std::size_t v, int side, Attempt attempt, std::vector<StopDistance>& stops,
                std::vector<End>& ends) const {
    const bool again = attempt != Attempt::FastFromStart;
    const double distance = distances_[set][v];
    const StopDistance stop{std::abs(distance), set};
    if (distance == 0) paths_[set].state[v] = VertexState::Reached;
    if (distance * side <= 0 || (again && (is_known(set, v) || paths_[set].state[v] == VertexState::Reached))) return;
    if (!is_known(set, v)) stops.push_back(stop);
    else if (!end_known(stop, v))
      ends.push_back({static_cast<std::uint32_t>(v), stop, {known_end(set, v), arrival_[set][v].triangle}});
  }

  /// How far off the vertex may be because its coordinates are rounded.
  double rounding(std::size_t v) const {
    return (surface_.vertices[v] + surface_.origin).length() * std::numeric_limits<double>::epsilon();
  }

  VertexState state_at(double distance, const StopDistance& stop, std::size_t v) const {
    const double off = std::abs(distance - stop.distance);
    return off <= kReachedTolerance * stop.distance + rounding(v) ? VertexState::Reached : VertexState::Collision;
  }

  Vec3d known_end(std::size_t set, std::size_t v) const {
    const Vec3d& end = arrival_[set][v].position;
    if (!obstacles_) return end;
    const Vec3d& start = surface_.vertices[v];
    return ObstacleGuard(*obstacles_, start, distances_[set][v] < 0 ? -1 : 1).stop(start, end);
  }

  /// Writes the end of a path that is known without a march. False if it has to be judged as others are, as rounding or
  /// an obstacle moves it.
  bool end_known(const StopDistance& stop, std::size_t v) const {
    const KnownEnd& end = arrival_[stop.set][v];
    const Vec3d& start = surface_.vertices[v];
    if (rounding(v) > kStopTolerance * stop.distance || known_end(stop.set, v) != end.position) return false;
    Paths& paths = paths_[stop.set];
    paths.displacement[v] = round_displacement(end.position - start, stop.distance);
    paths.achieved[v] = end.distance;
    paths.closest[v] = end.triangle;
    paths.state[v] = state_at(end.distance, stop, v);
    return true;
  }

  void march(DirectionSampler& sampler, std::size_t v, int side, Attempt attempt, std::vector<StopDistance>& stops,
             std::vector<End>& ends) const {
    std::stable_sort(stops.begin(), stops.end(),
                     [](const StopDistance& a, const StopDistance& b) { return a.distance < b.distance; });
    const auto vertex = static_cast<std::uint32_t>(v);
    const auto pace = attempt == Attempt::ExactFromStart ? March::Exact : March::Fast;
    VertexMarch<Query> vertex_march(query_, directions_, sampler, side, vertex, pace, obstacles_);
    const bool keep = options_.keep == KeepPaths::Yes;
    const auto tell = [&](const StopDistance& stop, const Arrival& end) {
      ends.push_back({vertex, stop, end});
      if (keep) paths_[stop.set].trace[v] = vertex_march.trace();
    };
    if (attempt != Attempt::FastFromEnd) {
      if (keep) vertex_march.keep_trace({});
      vertex_march.march(stops, tell);
      return;
    }
    for (const StopDistance& stop : stops) {
      const Paths& paths = paths_[stop.set];
      if (!(paths.achieved[v] > kRestartShare * stop.distance)) continue;
      if (keep) vertex_march.keep_trace(paths.trace[v]);
      vertex_march.march_from(surface_.vertices[v] + paths.displacement[v], paths.closest[v], stop, tell);
    }
  }

  /// Measures how far the ends are from the surface, and writes distances and states of their vertices.
  void judge(const std::vector<End>& ends) const {
    std::vector<Vec3d> points;
    for (const auto& [v, stop, end] : ends) {
      const Vec3d displacement = round_displacement(end.position - surface_.vertices[v], stop.distance);
      paths_[stop.set].displacement[v] = displacement;
      // Judged where the vertex will be: far from the origin its coordinates are rounded.
      points.push_back((surface_.vertices[v] + surface_.origin) + displacement - surface_.origin);
    }
    const std::vector<Closest> closest = closest_to(ends, points);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const auto& [v, stop, end] = ends[i];
      paths_[stop.set].achieved[v] = closest[i].distance;
      paths_[stop.set].closest[v] = closest[i].triangle;
      const VertexState state = state_at(closest[i].distance, stop, v);
      const bool left = end.outside_field && state == VertexState::Collision;
      paths_[stop.set].state[v] = left ? VertexState::OutsideField : state;
    }
  }

  /// The closest triangles to the ends, of which those of a vertex on one side stand next to each other.
  std::vector<Closest> closest_to(const std::vector<End>& ends, std::span<const Vec3d> points) const {
    std::vector<Closest> closest(ends.size());
    std::vector<std::uint32_t> hints;
    std::vector<std::size_t> begin;
    const auto is_inward = [&](const End& end) { return distances_[end.stop.set][end.vertex] < 0; };
    for (std::size_t i = 0; i < ends.size(); ++i) {
      hints.push_back(ends[i].arrival.triangle);
      if (i == 0 || ends[i].vertex != ends[i - 1].vertex || is_inward(ends[i]) != is_inward(ends[i - 1]))
        begin.push_back(i);
    }
    const bool one_each = begin.size() == ends.size();
    begin.push_back(ends.size());
    if (one_each) query_.answer_together(points, hints, closest);
    else query_.answer_along_paths(points, begin, hints, closest);
    return closest;
  }

  const Query& query_;
  const ShapeOf<Query>& surface_;
  const DirectionField& directions_;
  std::span<const Distances> distances_;
  const Obstacles* obstacles_;
  PathOptions options_;
  double roughness_ = 0;  // of planes, world units
  std::vector<Paths>& paths_;
  std::vector<std::vector<KnownEnd>> arrival_;  // of each set and vertex: the ends of paths that need no field
  std::vector<Components> known_;               // of each set: the components that have such paths
};

template <class Query>
std::vector<Paths> march_all(const Query& query, const DirectionField& directions, std::span<const Distances> distances,
                             const Obstacles* obstacles, const ProgressCallback& callback, const PathOptions& options) {
  const std::size_t count = query.surface().vertices.size();
  Progress progress(callback, Stage::Propagate, count);
  for ([[maybe_unused]] const Distances& each : distances) VDB_OFFSET_ASSERT(each.uniform() || each.count() == count);
  std::vector<Paths> paths(distances.size());
  using All = Marches<Query>;
  const All marches(query, directions, distances, obstacles, options, paths);
  for_each_index(
      marches.block_count(),
      [&](std::size_t block) {
        marches(block);
        progress.advance(marches.end_of(block) - marches.begin_of(block));
      },
      1);
  return paths;
}

}  // namespace

const char* name(VertexState state) {
  constexpr const char* kNames[kVertexStateCount] = {"reached", "collision", "limited", "outside_field",
                                                     "unused",  "mitered",   "cut"};
  return kNames[static_cast<std::size_t>(state)];
}

Vec3d start_direction(const Surface& surface, std::uint32_t vertex) { return start_of(surface, vertex).direction; }

Vec3d start_direction(const Polyline& line, std::uint32_t vertex) { return start_of(line, vertex).direction; }

bool is_folded(const Surface& surface, std::uint32_t vertex) { return start_of(surface, vertex).slope <= 0; }

Vec3d round_displacement(const Vec3d& displacement, double target) {
  VDB_OFFSET_ASSERT(target > 0);
  const int exponent = std::ilogb(target) - 36;
  const double quantum = std::ldexp(1.0, exponent), per_quantum = std::ldexp(1.0, -exponent);
  // To the nearest whole number: a larger number has no fraction left to lose.
  const auto whole = [](double x) { return std::abs(x) < 0x1p51 ? (x + 0x1.8p52) - 0x1.8p52 : x; };
  return {whole(displacement[0] * per_quantum) * quantum, whole(displacement[1] * per_quantum) * quantum,
          whole(displacement[2] * per_quantum) * quantum};
}

void end_traces(Paths& paths) {
  VDB_OFFSET_ASSERT(paths.trace.empty() || paths.trace.size() == paths.displacement.size());
  for (std::size_t v = 0; v < paths.trace.size(); ++v) paths.trace[v].push_back(paths.displacement[v]);
}

std::vector<Vec3d> positions_on_path(const Vec3d& start, std::span<const Vec3d> trace, const Vec3d& end) {
  std::vector<Vec3d> positions{start};
  const auto add = [&](const Vec3d& displacement) {
    if (positions.back() != start + displacement) positions.push_back(start + displacement);
  };
  for (const Vec3d& corner : trace) add(corner);
  add(end);
  return positions;
}

std::vector<Paths> propagate(const ClosestQuery& query, const DirectionField& directions,
                             std::span<const Distances> distances, const Obstacles* obstacles,
                             const ProgressCallback& progress, const PathOptions& options) {
  return march_all(query, directions, distances, obstacles, progress, options);
}

std::vector<Paths> propagate(const CurveQuery& query, const DirectionField& directions,
                             std::span<const Distances> distances, const ProgressCallback& progress,
                             const PathOptions& options) {
  return march_all(query, directions, distances, nullptr, progress, options);
}

}  // namespace vdb_offset
