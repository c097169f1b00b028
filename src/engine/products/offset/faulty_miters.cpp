// SPDX-License-Identifier: Apache-2.0
// Takes miters back that come with faults. Those that give way are set aside first. Of each fault's mitered corners,
// the ones with the least area around them go back to their paths, until no fault has a mitered corner. Near a
// remaining fault, which does not come of miters, those are given up for good that are at the distance without. Since
// miters may have been in each other's way alone, the others are tried again in rounds, a third of them at a time, and
// few are tried one by one; whichever comes to be at a fault goes back. Those set aside are tried last. Which ones go
// together follows from a hash of their numbers, and not from threads. Faults that come of no miter are left to
// limit().
#include "products/offset/faulty_miters.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "ground/numbers/hash_mix.h"
#include "ground/numbers/index_set.h"

namespace vdb_offset {
namespace {

// Of a fault's mitered corners, the one with the least area around it loses its miter, and those with up to this many
// times its area: a narrow slot then costs its own miters, and not those at the far corners of the plate around it. Not
// measured.
constexpr double kAlike = 4;
// Miters that have been taken back are tried again in so many rounds, one in kTriedEvery of them at a time, each twice:
// of those that got into each other's way some have room. Not measured.
constexpr std::uint64_t kTrials = 6, kTriedEvery = 3;
// If so few are left then, each is tried by itself. For speed; not measured.
constexpr std::size_t kMostSingly = 100;

// How far around a fault, along edges and in distances, no vertex has a miter that is at the distance without. See
// docs/dev/tuning.md.
constexpr double kAround = 2;

/// Takes back what is faulty of miters, and tries again what may have been taken back for others.
class MiterJudge {
 public:
  MiterJudge(FaultFinder& faults, const Surface& surface, Corners corners, PreparedMesh::Marched& marched)
      : faults_(faults),
        surface_(surface),
        mitered_(marched.mitered),
        paths_(marched.paths),
        miters_(marched.miters),
        gathered_(surface.vertices.size()),
        is_mitered_(surface.vertices.size(), 0),
        area_(surface.vertices.size(), 0.0) {
    for (const Miter& miter : marched.miters) {
      for (const auto t : surface_.triangles_around(miter.vertex)) area_[miter.vertex] += surface_.extent(t);
      if (miter.gives_way) giving_way_.push_back(miter.vertex);
      if (corners == Corners::Miter && miter.state != VertexState::Reached) farther_.push_back(miter.vertex);
    }
  }

  /// Takes the miters back whose vertices are at the distance without, within a length, along edges, of faults that do
  /// not come of miters. They are not tried again.
  void give_up_around_faults(double length) {
    const Indices faulty = faults_.faulty_vertices();
    if (faulty.empty()) return;
    const Indices within = vertices_within(length, faulty);
    std::set_difference(within.begin(), within.end(), farther_.begin(), farther_.end(), std::back_inserter(given_up_));
    faults_.move_to_ends(paths_, mitered_.take_back(given_up_, paths_));
    take_faulty_back();
  }

  void take_faulty_back() {
    for (Indices back = faulty_miters(); !back.empty(); back = faulty_miters())
      faults_.move_to_ends(paths_, mitered_.take_back(back, paths_));
  }

  /// Takes back those that give way, for others to have room first.
  void set_aside() { faults_.move_to_ends(paths_, mitered_.take_back(giving_way_, paths_)); }

  void try_those_set_aside() {
    Indices some;
    std::set_difference(giving_way_.begin(), giving_way_.end(), given_up_.begin(), given_up_.end(),
                        std::back_inserter(some));
    try_again(some);
    mitered_.forget(giving_way_);  // those that have come back: they would take the room of others later
  }

  void try_all_again() {
    const Indices taken_back = to_try_again();
    for (std::uint64_t trial = 0; trial < kTrials && !taken_back.empty(); ++trial) {
      Indices some = taken_back;
      std::erase_if(some, [&](std::uint32_t v) {
        const std::uint64_t turn = trial / kTriedEvery;
        return (mix(turn << 32 | v) + trial) % kTriedEvery != 0;
      });
      try_again(some);
    }
    const Indices left = to_try_again();
    if (left.size() <= kMostSingly)
      for (const auto v : left) try_again({v});
  }

 private:
  /// The vertices no farther than a length from some, along edges.
  Indices vertices_within(double length, const Indices& from) const {
    std::vector<double> left(surface_.vertices.size(), -1.0);  // of the length, at each vertex that has been reached
    std::priority_queue<std::pair<double, std::uint32_t>> queue;
    const auto reach = [&](std::uint32_t v, double rest) {
      if (!(rest > left[v])) return;
      left[v] = rest;
      queue.emplace(rest, v);
    };
    for (const auto v : from) reach(v, length);
    while (!queue.empty()) {
      const auto [rest, v] = queue.top();
      queue.pop();
      if (rest < left[v]) continue;
      for (const auto t : surface_.triangles_around(v))
        for (const auto w : surface_.triangles[t])
          reach(w, rest - (surface_.vertices[w] - surface_.vertices[v]).length());
    }
    Indices within;
    for (std::uint32_t v = 0; v < left.size(); ++v)
      if (left[v] >= 0) within.push_back(v);
    return within;
  }

  bool gives_way(std::uint32_t v) const { return std::binary_search(giving_way_.begin(), giving_way_.end(), v); }

  /// Notes which vertices are mitered now. False if none is.
  bool note_mitered() {
    bool any = false;
    for (const Miter& miter : miters_) any |= is_mitered_[miter.vertex] = mitered_.is_mitered(miter.vertex);
    return any;
  }

  /// The mitered vertices that a fault comes of: misplaced ones, and of each other fault those with the least area.
  /// Gathered by marks, as there may be millions of faults.
  Indices faulty_miters() {
    if (!note_mitered()) return {};
    const auto gather = [&](std::uint32_t v) {
      if (is_mitered_[v]) gathered_.add(v);
    };
    for (const auto v : faults_.misplaced()) gather(v);
    faults_.for_each_fault([&](std::uint32_t s, std::uint32_t t) {
      double least = std::numeric_limits<double>::infinity();
      for (const auto triangle : {s, t})
        for (const auto v : surface_.triangles[triangle])
          if (is_mitered_[v]) least = std::min(least, area_[v]);
      for (const auto triangle : {s, t})
        for (const auto v : surface_.triangles[triangle])
          if (is_mitered_[v] && area_[v] <= kAlike * least) gathered_.add(v);
    });
    // What the rim of a shell meets is told by its corners alone.
    faults_.for_each_faulty_corner(gather, [](std::uint32_t) { return true; });
    return gathered_.take();
  }

  Indices to_try_again() const {
    const Indices taken_back = mitered_.taken_back();
    Indices some;
    std::set_difference(taken_back.begin(), taken_back.end(), given_up_.begin(), given_up_.end(),
                        std::back_inserter(some));
    std::erase_if(some, [&](std::uint32_t v) { return gives_way(v); });
    return some;
  }

  /// Miters vertices again, and takes those back that come to be at faults.
  void try_again(const Indices& vertices) {
    const Indices tried = mitered_.miter_again(vertices, paths_);
    if (tried.empty()) return;
    FaultFinder::Trial trial = faults_.try_ends(paths_, tried);
    for (Indices back = tried; !back.empty();) {
      const Indices faulty = faults_.faulty_vertices();
      back.clear();
      std::set_intersection(tried.begin(), tried.end(), faulty.begin(), faulty.end(), std::back_inserter(back));
      back = mitered_.take_back(back, paths_);
      trial.take_back(back);
    }
  }

  FaultFinder& faults_;
  const Surface& surface_;
  MiteredPaths& mitered_;
  Paths& paths_;
  std::span<const Miter> miters_;
  IndexGatherer gathered_;                // of vertices; empty between uses
  std::vector<std::uint8_t> is_mitered_;  // of each vertex, as note_mitered() has found it
  std::vector<double> area_;              // of the faces around each vertex that has a miter; 0 of the others
  Indices given_up_;                      // vertices that are not to be mitered again; sorted
  Indices giving_way_;                    // mitered vertices that do; sorted
  Indices farther_;                       // vertices whose miters end farther away than the distance; sorted
};

}  // namespace

void take_faulty_miters_back(FaultFinder& faults, const Surface& surface, Corners corners, double distance,
                             PreparedMesh::Marched& marched) {
  if (marched.mitered.empty()) return;
  MiterJudge judge(faults, surface, corners, marched);
  judge.set_aside();
  judge.take_faulty_back();
  judge.give_up_around_faults(kAround * distance);
  judge.try_all_again();
  judge.try_those_set_aside();
}

}  // namespace vdb_offset
