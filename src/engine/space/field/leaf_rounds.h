// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "ground/system/assert.h"
#include "ground/system/progress_count.h"
#include "space/field/leaf_graph.h"
#include "space/surface/surface.h"

namespace vdb_offset {

// The two ways to extend a front, each in a file of its own, and the order of leaf nodes that they share. Both take
// a field whose active voxels are those of the front, and set the others within field.reach.
void sweep_closest(DistanceField& field, const Surface& surface, const ProgressCallback& callback);
void sweep_eikonal(DistanceField& field, const ProgressCallback& callback);

/// Pending distances of one leaf node: for each face, how far from the surface the nearest voxel of the neighbour is
/// that would improve by what this one knows, in voxels; kNonePending if none would.
inline constexpr float kNonePending = std::numeric_limits<float>::infinity();
using Pending = std::array<float, kFaces>;

/// The leaf nodes that have something to learn from a neighbour, in work lists: those nearest to the surface are
/// visited first, as what they find out is for the others; and in two colours like a chequerboard's. Those of one
/// colour share no face, so that all of them can be at work together without one reading what another writes.
class LeafRounds {
 public:
  /// Begins with every leaf node of the graph.
  explicit LeafRounds(LeafGraph& graph) : graph_(graph), pending_(graph.size(), 0.0f) {
    for (std::size_t i = 0; i < graph.size(); ++i) enqueue(static_cast<std::int32_t>(i));
  }

  /// Calls visit(leaf) -> Pending until nothing is pending. Leaf nodes across a face with a pending distance are made
  /// if need be; grow(number of leaf nodes) is called before they are visited.
  template <class Grow, class Visit>
  void run(Progress& progress, Grow&& grow, Visit&& visit) {
    constexpr float kStep =
        1;  // voxels that a level grows by: what one visit improves reaches about as far; not measured
    int idle = 0;
    for (float level = 0; !work_list_[0].empty() || !work_list_[1].empty(); idle = 0, level += kStep)
      for (int colour = 0; idle < 2; colour ^= 1) {
        const std::vector<std::int32_t> round = take(colour, level);
        idle = round.empty() ? idle + 1 : 0;
        std::vector<Pending> found(round.size());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, round.size(), 2), [&](const auto& range) {
          for (std::size_t i = range.begin(); i != range.end(); ++i)
            found[i] = visit(static_cast<std::size_t>(round[i]));
          progress.advance(range.size());
        });
        for (std::size_t i = 0; i < round.size(); ++i) report_neighbours(round[i], found[i]);
        graph_.link_new_leaves();
        grow(graph_.size());
      }
  }

 private:
  /// Takes the waiting leaf nodes of a colour that have a pending distance up to the level; the others go on waiting.
  std::vector<std::int32_t> take(int colour, float level) {
    auto& list = work_list_[static_cast<std::size_t>(colour)];
    std::vector<std::int32_t> round;
    std::size_t kept = 0;
    for (const auto leaf : list)
      if (float& pending = pending_[static_cast<std::size_t>(leaf)]; pending <= level) {
        round.push_back(leaf);
        pending = kNonePending;
      } else {
        list[kept++] = leaf;
      }
    list.resize(kept);
    return round;
  }
  void report_neighbours(std::int32_t leaf, const Pending& found) {
    for (int face = 0; face < graph_.open_faces(); ++face) {
      VDB_OFFSET_ASSERT(found[static_cast<std::size_t>(face)] >= 0);
      if (found[static_cast<std::size_t>(face)] == kNonePending) continue;
      const auto neighbour = graph_.touch_neighbour(leaf, face);
      pending_.resize(graph_.size(), kNonePending);
      float& pending = pending_[static_cast<std::size_t>(neighbour)];
      if (pending == kNonePending) enqueue(neighbour);
      pending = std::min(pending, found[static_cast<std::size_t>(face)]);
    }
  }
  void enqueue(std::int32_t leaf) {
    work_list_[static_cast<std::size_t>(graph_[static_cast<std::size_t>(leaf)].colour())].push_back(leaf);
  }

  LeafGraph& graph_;
  std::vector<float> pending_;  // of each leaf node, the least that its neighbours have sent
  std::array<std::vector<std::int32_t>, 2> work_list_;
};

}  // namespace vdb_offset
