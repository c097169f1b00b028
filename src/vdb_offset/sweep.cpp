#include "vdb_offset/sweep.h"

#include <openvdb/tools/Prune.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "vdb_offset/error.h"
#include "vdb_offset/leaf_graph.h"

namespace vdb_offset {
namespace {

constexpr float kUnset = std::numeric_limits<float>::infinity();
constexpr std::uint8_t kAllFaces = (1 << kFaces) - 1;

// What Block::changed holds before the first pass. A voxel looks at those changed in this pass or the one before.
constexpr std::uint8_t kSeen = 0, kUnseen = 1, kFirstPass = 2;

/// One leaf node and its halo, unpacked for sweeping. Sizes of phi and signs are kept apart.
struct Block {
  float size[kPaddedVoxels];  // |phi|, kUnset where nothing is known
  std::int8_t sign[kPaddedVoxels];
  std::int32_t closest[kPaddedVoxels];
  std::uint8_t changed[kPaddedVoxels];  // number of the pass that last changed the voxel

  void set(int padded, float phi, std::int32_t triangle) {
    size[padded] = triangle < 0 ? kUnset : std::abs(phi);
    sign[padded] = std::signbit(phi) ? -1 : 1;
    closest[padded] = triangle;
  }
};

/// The smaller |phi| of the two neighbours along each axis.
struct Upwind {
  float size[3];
  int from[3];
};

Upwind upwind(const Block& block, int n) {
  Upwind up;
  for (int axis = 0; axis < 3; ++axis) {
    const int lower = n - kPaddedStride[axis], upper = n + kPaddedStride[axis];
    up.from[axis] = block.size[lower] <= block.size[upper] ? lower : upper;
    up.size[axis] = block.size[up.from[axis]];
  }
  return up;
}

/// Godunov's upwind solution of |grad phi| = 1 from the neighbours a <= b <= c, which may be infinite (Zhao 2005).
double godunov(double a, double b, double c, double h) {
  const double one = a + h;
  if (one <= b) return one;
  const double two = 0.5 * (a + b + std::sqrt(2 * h * h - (a - b) * (a - b)));
  if (two <= c) return two;
  const double sum = a + b + c;
  return (sum + std::sqrt(std::max(0.0, sum * sum - 3 * (a * a + b * b + c * c - h * h)))) / 3;
}

class Sweeper {
 public:
  Sweeper(DistanceField& field, const Surface& surface, const SweepOptions& options)
      : field_(field), surface_(surface), options_(options), graph_(field), h_(field.voxel_size) {
    front_leaves_ = graph_.size();
    frozen_.reserve(front_leaves_);
    for (std::size_t i = 0; i < front_leaves_; ++i) frozen_.push_back(graph_[i].phi->getValueMask());
    pending_.assign(front_leaves_, kAllFaces);
  }

  void run(const ProgressCallback& callback, std::size_t expected_leaves) {
    Progress progress(callback, Stage::Sweep, 4 * expected_leaves);
    for (int colour = 0, idle = 0; idle < 2; colour ^= 1) {
      std::vector<std::int32_t> queue;
      for (std::size_t i = 0; i < graph_.size(); ++i)
        if (pending_[i] && graph_[i].colour() == colour) queue.push_back(static_cast<std::int32_t>(i));
      idle = queue.empty() ? idle + 1 : 0;
      std::vector<std::uint8_t> improved(queue.size());
      visited_.resize(graph_.size(), 0);
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, queue.size(), 1), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) improved[i] = relax(queue[i]);
        progress.advance(range.size());
      });
      for (const auto leaf : queue) pending_[static_cast<std::size_t>(leaf)] = 0;
      for (std::size_t i = 0; i < queue.size(); ++i) wake_neighbours(queue[i], improved[i]);
    }
  }

 private:
  void wake_neighbours(std::int32_t leaf, std::uint8_t improved) {
    for (int face = 0; face < kFaces; ++face) {
      if (!(improved >> face & 1)) continue;
      const auto neighbour = static_cast<std::size_t>(graph_.touch_neighbour(leaf, face));
      pending_.resize(graph_.size(), 0);
      pending_[neighbour] |= static_cast<std::uint8_t>(1 << opposite(face));
    }
  }

  /// Brings one leaf node up to date with its neighbours. Returns the faces across which others may now improve.
  std::uint8_t relax(std::int32_t index) {
    const auto at = static_cast<std::size_t>(index);
    Block block;
    load(at, block);
    visited_[at] = 1;
    // Passes in the eight orders of (+-i, +-j, +-k) in turn, until one changes nothing.
    for (std::uint8_t pass = kFirstPass; pass < 255; ++pass)
      if (!sweep_once(at, block, pass)) break;
    return store(at, block);
  }

  /// Marks as changed what this leaf node has not seen: everything at its first visit, else the faces that woke it.
  void load(std::size_t at, Block& block) const {
    const GraphLeaf& leaf = graph_[at];
    std::fill(std::begin(block.size), std::end(block.size), kUnset);
    std::fill(std::begin(block.closest), std::end(block.closest), -1);
    std::fill(std::begin(block.changed), std::end(block.changed), kSeen);
    const float* phi = leaf.phi->buffer().data();
    const std::int32_t* closest = leaf.closest->buffer().data();
    for (int i = 0, n = 0; i < kLeafWidth; ++i)
      for (int j = 0; j < kLeafWidth; ++j)
        for (int k = 0; k < kLeafWidth; ++k, ++n) {
          const int padded = padded_index(i, j, k);
          block.set(padded, phi[n], closest[n]);
          block.changed[padded] = visited_[at] ? kSeen : kUnseen;
        }
    for (int face = 0; face < kFaces; ++face) {
      const auto neighbour = leaf.neighbour[static_cast<std::size_t>(face)];
      if (neighbour < 0) continue;
      const GraphLeaf& other = graph_[static_cast<std::size_t>(neighbour)];
      const float* other_phi = other.phi->buffer().data();
      const std::int32_t* other_closest = other.closest->buffer().data();
      const std::uint8_t changed = pending_[at] >> face & 1 ? kUnseen : kSeen;
      for_each_halo_voxel(face, [&](int padded, int n) {
        block.set(padded, other_phi[n], other_closest[n]);
        block.changed[padded] = changed;
      });
    }
  }

  bool sweep_once(std::size_t at, Block& block, std::uint8_t pass) const {
    bool any = false;
    const openvdb::Coord origin = graph_[at].origin();
    const bool front = at < front_leaves_;
    for (int a = 0; a < kLeafWidth; ++a)
      for (int b = 0; b < kLeafWidth; ++b)
        for (int c = 0; c < kLeafWidth; ++c) {
          const int i = pass & 4 ? 7 - a : a, j = pass & 2 ? 7 - b : b, k = pass & 1 ? 7 - c : c;
          if (front && frozen_[at].isOn(static_cast<openvdb::Index>(i << 6 | j << 3 | k))) continue;
          const int n = padded_index(i, j, k);
          const bool improved =
              options_.solver == Solver::Closest
                  ? improve_closest(block, n, pass, Vec3d(origin[0] + i, origin[1] + j, origin[2] + k) * h_)
                  : improve_eikonal(block, n, pass);
          if (improved) {
            block.changed[n] = pass;
            any = true;
          }
        }
    return any;
  }

  float reach(std::int8_t sign) const {
    return static_cast<float>(sign < 0 ? options_.reach.inside : options_.reach.outside);
  }

  /// Tries the triangles of the neighbours that changed since the voxel last looked.
  bool improve_closest(Block& block, int n, std::uint8_t pass, const Vec3d& x) const {
    bool improved = false;
    for (int axis = 0; axis < 3; ++axis)
      for (const int m : {n - kPaddedStride[axis], n + kPaddedStride[axis]}) {
        const std::int32_t triangle = block.closest[m];
        if (triangle < 0 || block.changed[m] + 1 < pass || triangle == block.closest[n]) continue;
        // phi changes by at most h from voxel to voxel, so that triangle cannot be nearer than this.
        if (block.size[m] - static_cast<float>(h_) * 1.0001f >= block.size[n]) continue;
        // The neighbour's triangle is near the closest one, which a walk over the mesh then finds.
        auto closest = static_cast<std::uint32_t>(triangle);
        const auto distance = static_cast<float>(std::sqrt(surface_.walk_to_closest(x, closest).squared_distance));
        if (distance >= block.size[n] || distance > reach(block.sign[m])) continue;
        block.size[n] = distance;
        block.sign[n] = block.sign[m];
        block.closest[n] = static_cast<std::int32_t>(closest);
        improved = true;
      }
    return improved;
  }

  bool improve_eikonal(Block& block, int n, std::uint8_t pass) const {
    bool fresh = false;
    for (const int stride : kPaddedStride)
      fresh |= block.changed[n - stride] + 1 >= pass || block.changed[n + stride] + 1 >= pass;
    if (!fresh) return false;
    const Upwind up = upwind(block, n);
    const int nearest =
        up.size[0] <= up.size[1] ? (up.size[0] <= up.size[2] ? 0 : 2) : (up.size[1] <= up.size[2] ? 1 : 2);
    if (up.size[nearest] == kUnset) return false;
    float sorted[3] = {up.size[0], up.size[1], up.size[2]};
    std::sort(std::begin(sorted), std::end(sorted));
    const auto distance = static_cast<float>(godunov(sorted[0], sorted[1], sorted[2], h_));
    const int from = up.from[nearest];
    // Below a millionth of a voxel a gain is rounding; chasing it would sweep for ever.
    if (!(distance < block.size[n] - static_cast<float>(h_) * 1e-6f) || distance > reach(block.sign[from]))
      return false;
    block.size[n] = distance;
    block.sign[n] = block.sign[from];
    block.closest[n] = block.closest[from];
    return true;
  }

  std::uint8_t store(std::size_t at, const Block& block) {
    const GraphLeaf& leaf = graph_[at];
    std::uint8_t improved = 0;
    for (int i = 0, n = 0; i < kLeafWidth; ++i)
      for (int j = 0; j < kLeafWidth; ++j)
        for (int k = 0; k < kLeafWidth; ++k, ++n) {
          const int padded = padded_index(i, j, k);
          if (block.changed[padded] == kSeen || block.closest[padded] < 0) continue;
          if (at >= front_leaves_ || !frozen_[at].isOn(static_cast<openvdb::Index>(n))) {
            leaf.phi->setValueOn(static_cast<openvdb::Index>(n),
                                 block.sign[padded] < 0 ? -block.size[padded] : block.size[padded]);
            leaf.closest->setValueOn(static_cast<openvdb::Index>(n), block.closest[padded]);
          }
          if (block.size[padded] >= reach(block.sign[padded])) continue;
          const int ijk[3] = {i, j, k};
          for (int axis = 0; axis < 3; ++axis) {
            if (ijk[axis] == 0) improved |= static_cast<std::uint8_t>(1 << (2 * axis));
            if (ijk[axis] == kLeafWidth - 1) improved |= static_cast<std::uint8_t>(1 << (2 * axis + 1));
          }
        }
    return improved;
  }

  DistanceField& field_;
  const Surface& surface_;
  const SweepOptions& options_;
  LeafGraph graph_;
  double h_;
  std::size_t front_leaves_;
  std::vector<openvdb::util::NodeMask<3>> frozen_;  // voxels of the front, for its leaf nodes
  std::vector<std::uint8_t> pending_;               // faces with news, by leaf node; 0 if it need not be visited
  std::vector<std::uint8_t> visited_;
};

void remove_empty_leaves(FieldGrids& grids) {
  openvdb::tools::pruneInactive(grids.phi->tree());
  openvdb::tools::pruneInactive(grids.closest->tree());
}

}  // namespace

DistanceField sweep(Front front, const Surface& surface, const SweepOptions& options,
                    const ProgressCallback& progress) {
  if (front.phi->activeVoxelCount() == 0)
    throw InvalidInput("sweep: expected a front with active voxels, got none (was it rasterised?)");
  if (!(options.reach.inside >= front.band) || !(options.reach.outside >= front.band))
    throw InvalidInput("sweep: expected a reach of at least the front's band on both sides");
  DistanceField field;
  static_cast<FieldGrids&>(field) = std::move(static_cast<FieldGrids&>(front));
  field.reach = options.reach;
  Sweeper sweeper(field, surface, options);
  sweeper.run(progress, field.phi->tree().leafCount() * 2);
  remove_empty_leaves(field);
  return field;
}

}  // namespace vdb_offset
