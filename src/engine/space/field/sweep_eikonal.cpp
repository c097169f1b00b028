// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "ground/system/progress_count.h"
#include "space/field/leaf_rounds.h"

namespace vdb_offset {
namespace {

constexpr float kUnset = std::numeric_limits<float>::infinity();

// Least improvement, in voxels: a smaller one is rounding, and sweeping for it would not end.
constexpr float kRounding = 1e-5f;

/// One leaf node and its halo, unpacked; lengths in voxels.
struct EikonalBlock {
  float size[kPaddedVoxels];  // |phi|, kUnset where nothing is known
  std::int8_t sign[kPaddedVoxels];
  std::int32_t closest[kPaddedVoxels];
  bool changed[kPaddedVoxels];

  /// \param first all voxels count as changed, as is right on the first visit to a leaf node of the front
  explicit EikonalBlock(bool first) {
    std::fill(std::begin(size), std::end(size), kUnset);
    std::fill(std::begin(changed), std::end(changed), first);
  }
};

/// Godunov's upwind solution of |grad phi| = 1 at spacing 1 from the neighbours a <= b <= c, which may be infinite
/// (Zhao 2005).
double godunov(double a, double b, double c) {
  const double one = a + 1;
  if (one <= b) return one;
  const double two = 0.5 * (a + b + std::sqrt(2 - (a - b) * (a - b)));
  if (two <= c) return two;
  const double sum = a + b + c;
  return (sum + std::sqrt(std::max(0.0, sum * sum - 3 * (a * a + b * b + c * c - 1)))) / 3;
}

class EikonalSweep {
 public:
  explicit EikonalSweep(DistanceField& field)
      : graph_(field),
        h_(static_cast<float>(field.voxel_size)),
        reach_inside_(static_cast<float>(field.reach.inside / field.voxel_size)),
        reach_outside_(static_cast<float>(field.reach.outside / field.voxel_size)),
        background_(field.phi->background()),
        front_leaves_(graph_.size()),
        visited_(front_leaves_, 0) {
    frozen_.reserve(front_leaves_);
    for (std::size_t i = 0; i < front_leaves_; ++i) frozen_.push_back(graph_[i].phi->getValueMask());
  }

  void run(const ProgressCallback& callback) {
    Progress progress(callback, Stage::Sweep, 16 * front_leaves_);
    LeafRounds(graph_).run(
        progress, [](std::size_t) {}, [&](std::size_t leaf) { return relax(leaf); });
    graph_.prune();
  }

 private:
  /// Solves one leaf node, its neighbours being fixed: sweeps in the eight orders of (+-i, +-j, +-k) in turn, until all
  /// eight have changed nothing. Returns at which distances its neighbours may improve.
  Pending relax(std::size_t leaf) {
    EikonalBlock block(leaf < front_leaves_ && !visited_[leaf]);
    if (leaf < front_leaves_) visited_[leaf] = 1;
    else if (graph_[leaf].phi->buffer().empty()) allocate(leaf);
    load(leaf, block);
    for (int order = 0, idle = 0; idle < 8; order = (order + 1) % 8)
      idle = sweep_once(leaf, block, order) ? 0 : idle + 1;
    store(leaf, block);
    return find_pending(block);
  }

  void allocate(std::size_t leaf) {
    const GraphLeaf& at = graph_[leaf];
    at.phi->allocate(), at.closest->allocate();
    std::fill_n(at.phi->buffer().data(), kLeafVoxels, background_);
    std::fill_n(at.closest->buffer().data(), kLeafVoxels, -1);
  }

  void load(std::size_t leaf, EikonalBlock& block) const {
    for (int n = 0; n < kLeafVoxels; ++n) unpack(leaf, n, block, padded_index(n));
    for (int face = 0; face < kFaces; ++face) {
      const auto neighbour = graph_[leaf].neighbour[static_cast<std::size_t>(face)];
      if (neighbour < 0 || graph_[static_cast<std::size_t>(neighbour)].phi->buffer().empty()) continue;
      for_each_halo_voxel(face,
                          [&](int padded, int n) { unpack(static_cast<std::size_t>(neighbour), n, block, padded); });
    }
  }

  void unpack(std::size_t leaf, int n, EikonalBlock& block, int padded) const {
    if (!graph_[leaf].phi->isValueOn(static_cast<openvdb::Index>(n))) return;
    const float phi = graph_[leaf].phi->buffer().data()[n];
    block.size[padded] = std::abs(phi) / h_;
    block.sign[padded] = std::signbit(phi) ? -1 : 1;
    block.closest[padded] = graph_[leaf].closest->buffer().data()[n];
  }

  bool is_frozen(std::size_t leaf, int n) const {
    return leaf < front_leaves_ && frozen_[leaf].isOn(static_cast<openvdb::Index>(n));
  }
  float reach(std::int8_t sign) const { return sign < 0 ? reach_inside_ : reach_outside_; }

  bool sweep_once(std::size_t leaf, EikonalBlock& block, int order) const {
    bool any = false;
    for (int a = 0; a < kLeafWidth; ++a)
      for (int b = 0; b < kLeafWidth; ++b)
        for (int c = 0; c < kLeafWidth; ++c) {
          const int i = order & 4 ? 7 - a : a, j = order & 2 ? 7 - b : b, k = order & 1 ? 7 - c : c;
          if (!is_frozen(leaf, i << 6 | j << 3 | k)) any |= improve(block, padded_index(i, j, k));
        }
    return any;
  }

  bool improve(EikonalBlock& block, int n) const {
    float size[3];
    int nearest = n;
    for (int axis = 0; axis < 3; ++axis) {
      const int stride = kPaddedStride[static_cast<std::size_t>(axis)];
      const int from = block.size[n - stride] <= block.size[n + stride] ? n - stride : n + stride;
      size[axis] = block.size[from];
      if (size[axis] < block.size[nearest] || nearest == n) nearest = from;
    }
    if (!(block.size[nearest] < block.size[n])) return false;
    std::sort(std::begin(size), std::end(size));
    const auto solution = static_cast<float>(godunov(size[0], size[1], size[2]));
    if (!(solution < block.size[n] - kRounding) || solution > reach(block.sign[nearest])) return false;
    block.size[n] = solution;
    block.sign[n] = block.sign[nearest];
    block.closest[n] = block.closest[nearest];
    block.changed[n] = true;
    return true;
  }

  void store(std::size_t leaf, const EikonalBlock& block) {
    for (int n = 0; n < kLeafVoxels; ++n) {
      const int padded = padded_index(n);
      if (is_frozen(leaf, n) || block.size[padded] == kUnset) continue;
      const float phi = block.size[padded] * h_;
      graph_[leaf].phi->setValueOn(static_cast<openvdb::Index>(n), block.sign[padded] < 0 ? -phi : phi);
      graph_[leaf].closest->setValueOn(static_cast<openvdb::Index>(n), block.closest[padded]);
    }
  }

  /// For each face, the least distance of a changed voxel from which the neighbour may improve: the voxel across the
  /// face is farther from the surface, or is not set yet and the least step, 1 / sqrt(3) of a voxel, does not lead out
  /// of reach.
  Pending find_pending(const EikonalBlock& block) const {
    constexpr float kLeastStep = 0.57f;  // voxels; a little below 1 / sqrt(3)
    Pending pending;
    for (int face = 0; face < kFaces; ++face) {
      float nearest = kNonePending;
      for_each_halo_voxel(face, [&](int padded, int) {
        const int mine = across(face, padded);
        if (!block.changed[mine] || block.size[mine] == kUnset) return;
        const bool improves = block.size[padded] == kUnset ? block.size[mine] + kLeastStep < reach(block.sign[mine])
                                                           : block.size[mine] < block.size[padded];
        if (improves) nearest = std::min(nearest, block.size[mine]);
      });
      pending[static_cast<std::size_t>(face)] = nearest;
    }
    return pending;
  }

  LeafGraph graph_;
  float h_;
  float reach_inside_, reach_outside_;  // in voxels
  float background_;
  std::size_t front_leaves_;
  std::vector<std::uint8_t> visited_;               // of each leaf node of the front: 1 once it has been visited
  std::vector<openvdb::util::NodeMask<3>> frozen_;  // voxels of the front, for its leaf nodes
};

}  // namespace

void sweep_eikonal(DistanceField& field, const ProgressCallback& callback) { EikonalSweep(field).run(callback); }

}  // namespace vdb_offset
