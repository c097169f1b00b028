#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cstdint>
#include <vector>

#include "vdb_offset/leaf_graph.h"
#include "vdb_offset/progress.h"
#include "vdb_offset/surface.h"

namespace vdb_offset {

// The two ways to extend a front, each in a file of its own, and the order of leaf nodes that they share. Both take
// a field whose active voxels are those of the front, and set the others within field.reach.
void sweep_closest(DistanceField& field, const Surface& surface, const ProgressCallback& callback);
void sweep_eikonal(DistanceField& field, const ProgressCallback& callback);

/// Leaf nodes that have news to look at, in two colours like a chequerboard's: those of one colour share no face, so
/// that all of them can be at work together without one reading what another writes.
class LeafRounds {
 public:
  /// Begins with every leaf node of the graph.
  explicit LeafRounds(LeafGraph& graph) : graph_(graph), pending_(graph.size(), 1) {
    for (std::size_t i = 0; i < graph.size(); ++i) enqueue(static_cast<std::int32_t>(i));
  }

  /// Calls visit(leaf) -> faces across which a voxel would improve, as bits, until nobody has news. Leaf nodes that
  /// lie across such a face are made if need be, grow(number of leaf nodes) being told before they are visited.
  template <class Grow, class Visit>
  void run(Progress& progress, Grow&& grow, Visit&& visit) {
    for (int colour = 0; !queue_[0].empty() || !queue_[1].empty(); colour ^= 1) {
      std::vector<std::int32_t> round;
      round.swap(queue_[static_cast<std::size_t>(colour)]);
      std::vector<std::uint8_t> news(round.size());
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, round.size(), 2), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) news[i] = visit(static_cast<std::size_t>(round[i]));
        progress.advance(range.size());
      });
      for (const auto leaf : round) pending_[static_cast<std::size_t>(leaf)] = 0;
      for (std::size_t i = 0; i < round.size(); ++i) wake_neighbours(round[i], news[i]);
      grow(graph_.size());
    }
  }

 private:
  void wake_neighbours(std::int32_t leaf, std::uint8_t faces) {
    for (int face = 0; face < kFaces; ++face) {
      if (!(faces >> face & 1)) continue;
      const auto neighbour = graph_.touch_neighbour(leaf, face);
      pending_.resize(graph_.size(), 0);
      if (pending_[static_cast<std::size_t>(neighbour)]++ == 0) enqueue(neighbour);
    }
  }
  void enqueue(std::int32_t leaf) {
    queue_[static_cast<std::size_t>(graph_[static_cast<std::size_t>(leaf)].colour())].push_back(leaf);
  }

  LeafGraph& graph_;
  std::vector<std::uint8_t> pending_;  // at most one count for each face
  std::array<std::vector<std::int32_t>, 2> queue_;
};

}  // namespace vdb_offset
