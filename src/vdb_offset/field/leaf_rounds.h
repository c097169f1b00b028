#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "vdb_offset/base/progress_count.h"
#include "vdb_offset/field/leaf_graph.h"
#include "vdb_offset/surface/surface.h"

namespace vdb_offset {

// The two ways to extend a front, each in a file of its own, and the order of leaf nodes that they share. Both take
// a field whose active voxels are those of the front, and set the others within field.reach.
void sweep_closest(DistanceField& field, const Surface& surface, const ProgressCallback& callback);
void sweep_eikonal(DistanceField& field, const ProgressCallback& callback);

/// What one leaf node has for those across its faces: how far from the surface the nearest voxel is that would improve
/// there, in voxels; kNoNews if none would.
inline constexpr float kNoNews = std::numeric_limits<float>::infinity();
using News = std::array<float, kFaces>;

/// Leaf nodes that have news to look at: those nearest to the surface first, as what they find out is for the others;
/// and in two colours like a chequerboard's. Those of one colour share no face, so that all of them can be at work
/// together without one reading what another writes.
class LeafRounds {
 public:
  /// Begins with every leaf node of the graph.
  explicit LeafRounds(LeafGraph& graph) : graph_(graph), news_(graph.size(), 0.0f) {
    for (std::size_t i = 0; i < graph.size(); ++i) enqueue(static_cast<std::int32_t>(i));
  }

  /// Calls visit(leaf) -> News until nobody has any. Leaf nodes that lie across a face with news are made if need be,
  /// grow(number of leaf nodes) being told before they are visited.
  template <class Grow, class Visit>
  void run(Progress& progress, Grow&& grow, Visit&& visit) {
    constexpr float kStep = 1;  // voxels
    int idle = 0;
    for (float level = 0; !queue_[0].empty() || !queue_[1].empty(); idle = 0, level += kStep)
      for (int colour = 0; idle < 2; colour ^= 1) {
        const std::vector<std::int32_t> round = take(colour, level);
        idle = round.empty() ? idle + 1 : 0;
        std::vector<News> found(round.size());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, round.size(), 2), [&](const auto& range) {
          for (std::size_t i = range.begin(); i != range.end(); ++i)
            found[i] = visit(static_cast<std::size_t>(round[i]));
          progress.advance(range.size());
        });
        for (std::size_t i = 0; i < round.size(); ++i) tell_neighbours(round[i], found[i]);
        graph_.make_new_leaves();
        grow(graph_.size());
      }
  }

 private:
  /// The waiting leaf nodes of a colour whose news is no farther out than the level; the others go on waiting.
  std::vector<std::int32_t> take(int colour, float level) {
    auto& queue = queue_[static_cast<std::size_t>(colour)];
    std::vector<std::int32_t> round;
    std::size_t kept = 0;
    for (const auto leaf : queue)
      if (float& news = news_[static_cast<std::size_t>(leaf)]; news <= level) {
        round.push_back(leaf);
        news = kNoNews;
      } else {
        queue[kept++] = leaf;
      }
    queue.resize(kept);
    return round;
  }
  void tell_neighbours(std::int32_t leaf, const News& found) {
    for (int face = 0; face < graph_.open_faces(); ++face) {
      if (found[static_cast<std::size_t>(face)] == kNoNews) continue;
      const auto neighbour = graph_.touch_neighbour(leaf, face);
      news_.resize(graph_.size(), kNoNews);
      float& news = news_[static_cast<std::size_t>(neighbour)];
      if (news == kNoNews) enqueue(neighbour);
      news = std::min(news, found[static_cast<std::size_t>(face)]);
    }
  }
  void enqueue(std::int32_t leaf) {
    queue_[static_cast<std::size_t>(graph_[static_cast<std::size_t>(leaf)].colour())].push_back(leaf);
  }

  LeafGraph& graph_;
  std::vector<float> news_;  // the nearest that a leaf node has to look at
  std::array<std::vector<std::int32_t>, 2> queue_;
};

}  // namespace vdb_offset
