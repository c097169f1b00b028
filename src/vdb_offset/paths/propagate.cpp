#include "vdb_offset/paths/propagate.h"

#include "vdb_offset/base/progress_count.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "vdb_offset/base/parallel.h"
#include "vdb_offset/paths/vertex_march.h"

namespace vdb_offset {
namespace {

// Who has come so near to a stop in haste, as a share of its distance, goes on from there.
constexpr double kOnTheWay = 0.7;

// Planes through points of which a file has kept seven digits are off by a few of the last, by these shares of the
// largest coordinate.
constexpr double kRoughPlanes = 5e-7;

/// Components, as flags; and some that only ever fall, so that who sees one late does work that is not used.
using Components = std::vector<std::uint8_t>;
using FallingFlags = std::vector<std::atomic<std::uint8_t>>;

/// The marches of a run: all vertices, for all sets of distances.
template <class Query>
class Marches {
 public:
  Marches(const Query& query, const DirectionField& directions, std::span<const Distances> distances,
          const Obstacles* obstacles, const WayOptions& options, std::vector<Paths>& paths)
      : query_(query),
        surface_(query.surface()),
        directions_(directions),
        distances_(distances),
        obstacles_(obstacles),
        options_(options),
        paths_(paths) {
    const std::size_t count = surface_.vertices.size();
    // What bends is not followed to obstacles, nor along borders.
    const bool along_ridges = options.ridges == Ridges::Sharp && !obstacles && surface_.conormals.empty();
    if (along_ridges) roughness_ = kRoughPlanes * largest_coordinate();
    for (std::size_t set = 0; set < distances.size(); ++set) {
      paths[set].displacement.resize(count);
      paths[set].achieved.resize(count);
      paths[set].state.resize(count);
      paths[set].closest.resize(count, kNone);
      if (options.traces == Traces::Keep) paths[set].trace.resize(count);
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

  /// Moves the vertices of a block: all in haste; those that did not arrive by that go on from there, now that is known
  /// what is closest, as it is a place on the way if the surface is only a little nearer than believed; twice, as
  /// something else may be closest where they arrive. Then carefully from the start.
  void operator()(std::size_t block) const {
    DirectionSampler sampler(directions_);
    std::vector<Stop> stops;
    std::vector<End> ends;
    for (const auto attempt :
         {UntangleSetting::InHaste, UntangleSetting::FromThere, UntangleSetting::FromThere, UntangleSetting::Anew}) {
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
  // Vertices are moved in blocks of so many.
  static constexpr std::size_t kBlock = 128;

  enum class UntangleSetting { InHaste, FromThere, Anew };
  enum class Look { Near, Everywhere };
  /// Where a vertex ended up on its way to a stop.
  struct End {
    std::uint32_t vertex;
    Stop stop;
    Arrival arrival;
  };

  bool is_known(std::size_t set, std::size_t v) const { return known_[set][surface_.component[v]]; }

  double largest_coordinate() const {
    double largest = 0;
    for (const Vec3d& vertex : surface_.vertices)
      for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(vertex[k] + surface_.origin[k]));
    return largest;
  }

  /// Tries straight ways for all sets; a component of which one vertex has none has none at all in that set. That is
  /// looked for among neighbours first, and then everywhere, for all sets that are left of a component together.
  void go_straight() {
    const Components all(surface_.facts.components, 1);
    known_.assign(distances_.size(), all);
    for (const auto look : {Look::Near, Look::Everywhere}) {
      std::vector<FallingFlags> straight;
      for (const Components& left : known_) straight.emplace_back(left.begin(), left.end());
      for_each_index(
          block_count(), [&](std::size_t block) { go_straight(block, look, straight); }, 1);
      for (std::size_t set = 0; set < straight.size(); ++set)
        known_[set].assign(straight[set].begin(), straight[set].end());
    }
  }

  /// One component at a time. A set that has fallen is of no more use, but changes what those find that it is looked
  /// for with: it stays with them.
  void go_straight(std::size_t block, Look look, std::vector<FallingFlags>& straight) {
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
        if (look == Look::Near && !is_up(set)) continue;
        sets.push_back(set);
        any_up = any_up || is_up(set);
      }
      if (!any_up) continue;
      for (const auto set : look == Look::Near ? without_near_ends(sets, some) : without_ends(sets, some))
        straight[set][component].store(0, std::memory_order_relaxed);
    }
  }

  void add_try(std::size_t set, std::uint32_t v, std::vector<StraightTry>& tries) const {
    const double distance = distances_[set][v];
    if (distance != 0) tries.push_back({v, distance < 0 ? -1 : 1, std::abs(distance)});
  }

  /// Those of the sets for which one of the vertices has no straight way, as its neighbours tell.
  std::vector<std::size_t> without_near_ends(std::vector<std::size_t> sets, std::span<const std::uint32_t> vertices) {
    std::erase_if(sets, [&](std::size_t set) {
      std::vector<StraightTry> tries;
      for (const auto v : vertices) add_try(set, v, tries);
      return StraightPaths<Query>(query_, tries).may_all_end();
    });
    return sets;
  }

  /// Those for which one has none. Notes the others' ends.
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

  /// Those of the components that have no straight ways; again all of their vertices, or none.
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
      VertexMarch<Query> traveller(query_, directions_, sampler, distance < 0 ? -1 : 1, static_cast<std::uint32_t>(v),
                                   Pace::Careful);
      if (options_.traces == Traces::Keep) traveller.keep_trace({});
      const auto end = traveller.go_along_ridges(std::abs(distance), roughness_);
      if (options_.traces == Traces::Keep) paths_[set].trace[v] = traveller.trace();
      if (end) arrival_[set][v] = *end;
      else flag.store(0, std::memory_order_relaxed);
    }
  }

  /// Where vertex v has to march to for one set, if it goes to this side at all and has not arrived.
  void add_stop(std::size_t set, std::size_t v, int side, UntangleSetting attempt, std::vector<Stop>& stops,
                std::vector<End>& ends) const {
    const bool again = attempt != UntangleSetting::InHaste;
    const double distance = distances_[set][v];
    const Stop stop{std::abs(distance), set};
    if (distance == 0) paths_[set].state[v] = VertexState::Reached;
    if (distance * side <= 0 || (again && (is_known(set, v) || paths_[set].state[v] == VertexState::Reached))) return;
    if (!is_known(set, v)) stops.push_back(stop);
    else if (!end_known(stop, v))
      ends.push_back({static_cast<std::uint32_t>(v), stop, {known_end(set, v), arrival_[set][v].triangle}});
  }

  static VertexState state_at(double distance, const Stop& stop) {
    return std::abs(distance - stop.distance) <= kReachedTolerance * stop.distance ? VertexState::Reached
                                                                                   : VertexState::Collision;
  }

  Vec3d known_end(std::size_t set, std::size_t v) const {
    const Vec3d& end = arrival_[set][v].position;
    if (!obstacles_) return end;
    const Vec3d& start = surface_.vertices[v];
    return ObstacleGuard(*obstacles_, start, distances_[set][v] < 0 ? -1 : 1).stop(start, end);
  }

  /// At the end of a known way nothing is left to judge, but where rounding moves it.
  bool end_known(const Stop& stop, std::size_t v) const {
    const KnownEnd& end = arrival_[stop.set][v];
    const Vec3d& start = surface_.vertices[v];
    const double rounding = (start + surface_.origin).length() * std::numeric_limits<double>::epsilon();
    if (rounding > kStopTolerance * stop.distance || known_end(stop.set, v) != end.position) return false;
    Paths& paths = paths_[stop.set];
    paths.displacement[v] = round_way(end.position - start, stop.distance);
    paths.achieved[v] = end.distance;
    paths.closest[v] = end.triangle;
    paths.state[v] = state_at(end.distance, stop);
    return true;
  }

  void march(DirectionSampler& sampler, std::size_t v, int side, UntangleSetting attempt, std::vector<Stop>& stops,
             std::vector<End>& ends) const {
    std::stable_sort(stops.begin(), stops.end(), [](const Stop& a, const Stop& b) { return a.distance < b.distance; });
    const auto vertex = static_cast<std::uint32_t>(v);
    const auto pace = attempt == UntangleSetting::Anew ? Pace::Careful : Pace::Hasty;
    VertexMarch<Query> traveller(query_, directions_, sampler, side, vertex, pace, obstacles_);
    const bool keep = options_.traces == Traces::Keep;
    const auto tell = [&](const Stop& stop, const Arrival& end) {
      ends.push_back({vertex, stop, end});
      if (keep) paths_[stop.set].trace[v] = traveller.trace();
    };
    if (attempt != UntangleSetting::FromThere) {
      if (keep) traveller.keep_trace({});
      traveller.march(stops, tell);
      return;
    }
    for (const Stop& stop : stops) {
      const Paths& paths = paths_[stop.set];
      if (!(paths.achieved[v] > kOnTheWay * stop.distance)) continue;
      if (keep) traveller.keep_trace(paths.trace[v]);
      traveller.march_from(surface_.vertices[v] + paths.displacement[v], paths.closest[v], stop, tell);
    }
  }

  /// Tells how far the ends are from the surface, and what that makes of their vertices.
  void judge(const std::vector<End>& ends) const {
    std::vector<Vec3d> points;
    for (const auto& [v, stop, end] : ends) {
      const Vec3d way = round_way(end.position - surface_.vertices[v], stop.distance);
      paths_[stop.set].displacement[v] = way;
      // Judged where the vertex will be: far from the origin its coordinates are rounded.
      points.push_back((surface_.vertices[v] + surface_.origin) + way - surface_.origin);
    }
    const std::vector<Closest> closest = look(ends, points);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const auto& [v, stop, end] = ends[i];
      paths_[stop.set].achieved[v] = closest[i].distance;
      paths_[stop.set].closest[v] = closest[i].triangle;
      const VertexState state = state_at(closest[i].distance, stop);
      const bool left = end.outside_field && state == VertexState::Collision;
      paths_[stop.set].state[v] = left ? VertexState::OutsideField : state;
    }
  }

  /// What is closest to the ends. Those of a vertex on one side stand next to each other.
  std::vector<Closest> look(const std::vector<End>& ends, std::span<const Vec3d> points) const {
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
    else query_.answer_along_ways(points, begin, hints, closest);
    return closest;
  }

  const Query& query_;
  const ShapeOf<Query>& surface_;
  const DirectionField& directions_;
  std::span<const Distances> distances_;
  const Obstacles* obstacles_;
  WayOptions options_;
  double roughness_ = 0;  // of planes
  std::vector<Paths>& paths_;
  std::vector<std::vector<KnownEnd>> arrival_;  // of each set, on ways that need no field
  std::vector<Components> known_;               // of each set, those that have such ways
};

template <class Query>
std::vector<Paths> march_all(const Query& query, const DirectionField& directions, std::span<const Distances> distances,
                             const Obstacles* obstacles, const ProgressCallback& callback, const WayOptions& options) {
  const std::size_t count = query.surface().vertices.size();
  Progress progress(callback, Stage::Propagate, count);
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
  constexpr const char* kNames[kVertexStateCount] = {"reached", "collision", "limited", "outside_field", "unused"};
  return kNames[static_cast<std::size_t>(state)];
}

Vec3d start_direction(const Surface& surface, std::uint32_t vertex) { return start_of(surface, vertex).direction; }

Vec3d start_direction(const Polyline& line, std::uint32_t vertex) { return start_of(line, vertex).direction; }

bool is_folded(const Surface& surface, std::uint32_t vertex) { return start_of(surface, vertex).slope <= 0; }

Vec3d round_way(const Vec3d& way, double target) {
  const int exponent = std::ilogb(target) - 36;
  const double quantum = std::ldexp(1.0, exponent), per_quantum = std::ldexp(1.0, -exponent);
  // To the nearest whole number: what is larger has no fraction left to lose.
  const auto whole = [](double x) { return std::abs(x) < 0x1p51 ? (x + 0x1.8p52) - 0x1.8p52 : x; };
  return {whole(way[0] * per_quantum) * quantum, whole(way[1] * per_quantum) * quantum,
          whole(way[2] * per_quantum) * quantum};
}

void end_traces(Paths& paths) {
  for (std::size_t v = 0; v < paths.trace.size(); ++v) paths.trace[v].push_back(paths.displacement[v]);
}

std::vector<Vec3d> places_on_path(const Vec3d& start, std::span<const Vec3d> trace, const Vec3d& end) {
  std::vector<Vec3d> places{start};
  const auto come_by = [&](const Vec3d& way) {
    if (places.back() != start + way) places.push_back(start + way);
  };
  for (const Vec3d& way : trace) come_by(way);
  come_by(end);
  return places;
}

std::vector<Paths> propagate(const ClosestQuery& query, const DirectionField& directions,
                             std::span<const Distances> distances, const Obstacles* obstacles,
                             const ProgressCallback& progress, const WayOptions& options) {
  return march_all(query, directions, distances, obstacles, progress, options);
}

std::vector<Paths> propagate(const CurveQuery& query, const DirectionField& directions,
                             std::span<const Distances> distances, const ProgressCallback& progress,
                             const WayOptions& options) {
  return march_all(query, directions, distances, nullptr, progress, options);
}

}  // namespace vdb_offset
