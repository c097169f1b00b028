// SPDX-License-Identifier: Apache-2.0
#include "valid/faults/pair_faults.h"

#include <algorithm>
#include <utility>

#include "ground/system/assert.h"

namespace vdb_offset {

PairFaults::PairFaults(const ConstrainedSurface& constrained, const VertexPositions& positions,
                       std::optional<SelfCrossings> source_crossings)
    : constrained_(constrained),
      positions_(positions),
      source_crossings_(constrained.surface,
                        source_crossings ? std::move(*source_crossings) : find_source_crossings()) {}

SelfCrossings PairFaults::find_source_crossings() {
  finder_.emplace(constrained_.surface, positions_.in_file());
  return finder_->listed();
}

PairFaults::Update PairFaults::update(const Indices& moved) {
  VDB_OFFSET_ASSERT(is_index_set(moved, constrained_.surface.triangles.size()));
  update_finder(moved);
  forget_updated();
  return {*this, moved};
}

void PairFaults::update_finder(const Indices& moved) {
  const bool knows_all = !finder_ && moved.size() == constrained_.surface.triangles.size();
  if (!finder_) finder_.emplace(constrained_.surface, positions_.in_file());
  if (!knows_all) finder_->update(moved);
}

void PairFaults::forget_updated() {
  std::erase_if(faulty_, [&](const TrianglePair& pair) {
    return finder_->is_updated(pair.first) || finder_->is_updated(pair.second);
  });
}

void PairFaults::add_updated() {
  for (const TrianglePair& pair : finder_->of_updated([&](std::uint32_t t) { return matters(t); }))
    if (is_fault(pair)) faulty_.push_back(pair);
}

void PairFaults::Update::find_all() {
  if (moved_.size() < pairs_.constrained_.surface.triangles.size()) {
    pairs_.add_updated();
    return;
  }
  for (const TrianglePair& pair : pairs_.finder_->all([&](std::uint32_t t) { return pairs_.matters(t); }))
    if (pairs_.is_fault(pair)) pairs_.faulty_.push_back(pair);
}

void PairFaults::Update::find_from_side_of(const Indices& triangles) {
  pairs_.finder_->update(triangles);
  pairs_.forget_updated();
  pairs_.add_updated();
}

const CrossingFinder& PairFaults::finder() const {
  VDB_OFFSET_ASSERT(finder_.has_value());
  return *finder_;
}

/// Whether a pair that meets is a fault. Triangles that have not moved are as they were, even if a coarser format makes
/// them meet.
bool PairFaults::is_fault(const TrianglePair& pair) const {
  return !goes_along(pair.first, pair.second) && !goes_along(pair.second, pair.first) &&
         !std::binary_search(source_crossings_.pairs().begin(), source_crossings_.pairs().end(), pair) &&
         !still_touches(pair) && (positions_.has_moved_corner(pair.first) || positions_.has_moved_corner(pair.second));
}

/// Whether one of two faces rests and the other may touch it: its border slides along resting faces, or the edge that
/// both share has moved, so that the resting face is not where it seems to be.
bool PairFaults::goes_along(std::uint32_t resting, std::uint32_t other) const {
  return constrained_.rests(resting) &&
         (constrained_.has_bound_corner(resting) || constrained_.has_bound_corner(other));
}

/// Whether a face that met an obstacle from the start does no more than touch one.
bool PairFaults::still_touches(const TrianglePair& pair) const {
  return constrained_.is_obstacle(pair.second) && constrained_.obstacles->start &&
         !constrained_.is_obstacle(pair.first) && constrained_.obstacles->start->touches[pair.first] &&
         !finder_->go_through(pair);
}

std::vector<TrianglePair> PairFaults::near_source() {
  if (source_crossings_.has_more()) return {};
  Indices near;
  for (std::uint32_t t = 0; t < constrained_.surface.triangles.size(); ++t)
    if (!matters(t)) near.push_back(t);
  if (near.empty()) return {};
  update_finder(near);
  std::vector<TrianglePair> pairs = finder_->of_updated();
  std::erase_if(pairs, [&](const TrianglePair& pair) { return !is_fault(pair); });
  return pairs;
}

}  // namespace vdb_offset
