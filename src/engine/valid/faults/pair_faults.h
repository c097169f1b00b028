// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "ground/numbers/index_set.h"
#include "motion/parts/constrained_surface.h"
#include "valid/faults/source_crossings.h"
#include "valid/faults/triangle_crossings.h"
#include "valid/faults/vertex_positions.h"

namespace vdb_offset {

/// The pairs of an offset's triangles that meet anew, as vertices are moved about. Found with exact predicates.
///
/// A pair that meets is a fault unless the source's does, or it is near where sheets of the source cross, which have to
/// slide (see source_crossings.h), or neither triangle has moved, or a face that rests is met by one that slides along
/// it, or a face still only touches an obstacle that it touched from the start.
class PairFaults {
 public:
  class Update;

  /// Keeps references to the constrained surface and the positions, which stand at the source at first.
  PairFaults(const ConstrainedSurface& constrained, const VertexPositions& positions,
             std::optional<SelfCrossings> source_crossings);

  /// Call for triangles whose corners have moved: forgets the pairs that they are part of. These are found again
  /// by exactly one call of the update that is returned. \pre sorted, each once
  [[nodiscard]] Update update(const Indices& moved);

  /// Pairs that are faults; not those left out by find_one_of_each().
  const std::vector<TrianglePair>& faulty() const { return faulty_; }
  const SourceCrossings& source_crossings() const { return source_crossings_; }
  /// Finds any triangles that meet where they stand. \pre update() has been called
  const CrossingFinder& finder() const;
  /// Pairs near crossings of the source that would be faults elsewhere; none if the source has more crossings than are
  /// listed.
  std::vector<TrianglePair> near_source();

 private:
  SelfCrossings find_source_crossings();
  void update_finder(const Indices& moved);
  void forget_updated();
  void add_updated();
  bool is_fault(const TrianglePair& pair) const;
  bool goes_along(std::uint32_t resting, std::uint32_t other) const;
  bool still_touches(const TrianglePair& pair) const;
  /// Whether a triangle is away from where sheets of the source cross.
  bool matters(std::uint32_t triangle) const { return !source_crossings_.is_near(triangle); }

  const ConstrainedSurface& constrained_;
  const VertexPositions& positions_;
  std::optional<CrossingFinder> finder_;  // from the first update on, or earlier if the source's crossings were found
  SourceCrossings source_crossings_;
  std::vector<TrianglePair> faulty_;
};

/// The pairs of some triangles that have moved, yet to be found: in one of three ways.
class [[nodiscard]] PairFaults::Update {
 public:
  /// All pairs that are faults.
  void find_all();
  /// At least one fault of each moved triangle that has any: not of triangles that is_left_out(triangle) is true of.
  template <class LeftOut>
  void find_one_of_each(LeftOut&& is_left_out);
  /// All pairs that are faults, where the moved triangles are back to where they were when `before` were all faults,
  /// except those that is_out(triangle) is true of. `tried` are all triangles that have moved since then, sorted.
  template <class IsOut>
  void restore(const std::vector<TrianglePair>& before, const Indices& tried, IsOut&& is_out);

 private:
  friend class PairFaults;
  Update(PairFaults& pairs, const Indices& moved) : pairs_(pairs), moved_(moved) {}
  void find_from_side_of(const Indices& triangles);

  PairFaults& pairs_;
  const Indices& moved_;
};

template <class LeftOut>
void PairFaults::Update::find_one_of_each(LeftOut&& is_left_out) {
  const auto takes = [&](std::uint32_t t) { return pairs_.matters(t) && !is_left_out(t); };
  for (const TrianglePair& pair :
       pairs_.finder_->one_of_each_updated(takes, [&](const TrianglePair& each) { return pairs_.is_fault(each); }))
    pairs_.faulty_.push_back(pair);
}

/// Pairs of triangles that are back meet again; those of a triangle that is out are looked for, from the side that has
/// fewer triangles.
template <class IsOut>
void PairFaults::Update::restore(const std::vector<TrianglePair>& before, const Indices& tried, IsOut&& is_out) {
  Indices out;
  for (const auto t : tried)
    if (is_out(t)) out.push_back(t);
  if (out.size() >= moved_.size()) {
    pairs_.add_updated();
    return;
  }
  const CrossingFinder& finder = *pairs_.finder_;
  for (const TrianglePair& pair : before)
    if ((finder.is_updated(pair.first) || finder.is_updated(pair.second)) && !is_out(pair.first) &&
        !is_out(pair.second))
      pairs_.faulty_.push_back(pair);
  if (!out.empty()) find_from_side_of(out);
}

}  // namespace vdb_offset
