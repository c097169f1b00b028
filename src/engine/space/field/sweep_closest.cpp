// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>

#include "ground/numbers/float_lanes.h"
#include "ground/system/parallel.h"
#include "ground/system/progress_count.h"
#include "space/field/closest_block.h"
#include "space/field/leaf_rounds.h"

namespace vdb_offset {
namespace {

// How many voxels too far away a point that was handed on may be, as such points are samples of the surface about a
// voxel apart. Not measured.
constexpr float kSampling = 0.25f;

// Voxels up to this many voxels beyond reach also walk to their closest triangle: some turn out to be within reach, and
// neighbours may use what they find. Not measured.
constexpr float kWalkBeyond = 1;

// A leaf node is visited again only if a squared distance falls below this share of the known one. Not measured.
constexpr float kWorthAVisit = 0.999f;

// How much nearer, in voxels, a neighbour's closest point must be for the neighbour's triangle to be tried. Not
// measured.
constexpr double kTolerance = 0.002;

// Leaf nodes whose closest points are allocated together; not measured beside other numbers.
constexpr std::size_t kPool = 16;

class ClosestSweep {
 public:
  ClosestSweep(DistanceField& field, const Surface& surface)
      : surface_(surface),
        graph_(field),
        h_(field.voxel_size),
        voxels_per_unit_(1 / h_),
        per_voxel_(static_cast<float>(1 / h_)),
        reach_(field.reach),
        background_(field.phi->background()),
        front_leaves_(graph_.size()) {
    const auto squared_voxels = [&](double length, float more) {
      const auto voxels = static_cast<float>(length / h_) + kSampling + more;
      return voxels * voxels;
    };
    reach_inside_ = squared_voxels(reach_.inside, 0);
    reach_outside_ = squared_voxels(reach_.outside, 0);
    walk_inside_ = squared_voxels(reach_.inside, kWalkBeyond);
    walk_outside_ = squared_voxels(reach_.outside, kWalkBeyond);
    grow(front_leaves_);
    frozen_.reserve(front_leaves_);
    for (std::size_t i = 0; i < front_leaves_; ++i) frozen_.push_back(graph_[i].phi->getValueMask());
  }

  void run(const ProgressCallback& callback) {
    Progress progress(callback, Stage::Sweep, 16 * front_leaves_);
    for_each_leaf(progress, [&](std::size_t leaf) { find_points_of_front(leaf); });
    LeafRounds(graph_).run(
        progress, [&](std::size_t leaves) { grow(leaves); }, [&](std::size_t leaf) { return relax(leaf); });
    for_each_leaf(progress, [&](std::size_t leaf) { settle(leaf); });
    for (int colour = 0; colour < 2; ++colour)
      for_each_leaf(progress, [&](std::size_t leaf) {
        if (graph_[leaf].colour() == colour) compare_with_neighbours(leaf);
      });
    for_each_index(
        pools_.size(), [&](std::size_t i) { pools_[i].reset(); }, 16);
    graph_.prune();
  }

 private:
  template <class Work>
  void for_each_leaf(Progress& progress, Work&& work) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, graph_.size(), 8), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i) work(i);
      progress.advance(range.size());
    });
  }

  /// Bits that show which of the eight voxels from n on are voxels of the front, which keep their values.
  unsigned frozen_row(std::size_t leaf, int n) const {
    return leaf < front_leaves_ ? frozen_[leaf].getWord<std::uint8_t>(static_cast<openvdb::Index>(n / 8)) : 0u;
  }
  float reach_squared(std::int32_t id) const { return id < 0 ? reach_inside_ : reach_outside_; }

  void grow(std::size_t leaves) {
    if (leaves > points_.capacity()) points_.reserve(2 * leaves);
    for (std::size_t i = points_.size(); i < leaves; ++i) {
      if (i % kPool == 0) pools_.push_back(std::make_unique_for_overwrite<ClosestPoints[]>(kPool));
      points_.push_back({&pools_.back()[i % kPool]});
    }
  }

  void set_point(std::size_t leaf, int n, const Vec3d& point) {
    for (int k = 0; k < 3; ++k)
      points_[leaf].points->p[k][n] = static_cast<float>(point[k] * voxels_per_unit_ - graph_[leaf].origin[k]);
  }

  Vec3d centre(std::size_t leaf, int n) const {
    return (graph_[leaf].origin + openvdb::Coord(n >> 6, n >> 3 & 7, n & 7)).asVec3d() * h_;
  }

  /// Finds the closest points of the front's voxels, on the triangles that the rasteriser has found.
  void find_points_of_front(std::size_t leaf) {
    std::int32_t* id = points_[leaf].id = graph_[leaf].closest->buffer().data();
    for (auto& axis : points_[leaf].points->p) std::fill(std::begin(axis), std::end(axis), kFarPoint);
    for (auto voxel = frozen_[leaf].beginOn(); voxel; ++voxel) {
      const auto n = static_cast<int>(voxel.pos());
      const auto triangle = static_cast<std::uint32_t>(id[n]);
      set_point(leaf, n, surface_.closest_on(triangle, centre(leaf, n)).point);
      id[n] = with_side(triangle, std::signbit(graph_[leaf].phi->buffer().data()[n]));
    }
  }

  /// Hands closest points on within one leaf node. Returns at which distances its neighbours would improve.
  Pending relax(std::size_t leaf) {
    ClosestBlock block;
    prefetch(leaf);
    if (points_[leaf].id == nullptr) {
      graph_[leaf].closest->allocate();
      points_[leaf].id = graph_[leaf].closest->buffer().data();
      block.forget();
    } else {
      load_own(leaf, block);
    }
    load_halo(leaf, block);
    const float farthest = std::max(reach_inside_, reach_outside_);
    for_each_row([&](int i, int j, int padded, int n) {
      for (int k = 0; k < kLeafWidth; k += kLanes) {
        const Lanes known = block.squared_lanes(i, j, k, padded + k);
        store_lanes(block.limit + padded + k, known < farthest ? known : farthest + Lanes{});
      }
      for (unsigned frozen = frozen_row(leaf, n); frozen != 0; frozen &= frozen - 1)
        block.limit[padded + std::countr_zero(frozen)] = -1;
    });
    sweep(block);
    store(leaf, block);
    return find_pending(block);
  }

  /// By row of a block: the last pass in which the row has changed.
  using RowChanges = std::array<int, kPaddedWidth * kPaddedWidth>;

  /// From row to row in the four directions along i and j, and along each row both ways whenever it learns something.
  static void sweep(ClosestBlock& block) {
    RowChanges changed{};
    for (int pass = 0; pass < 4; ++pass)
      for (int a = 0; a < kLeafWidth; ++a)
        for (int b = 0; b < kLeafWidth; ++b) sweep_row(block, pass, a, b, changed);
  }

  /// Offers to one row, the a-th along i and b-th along j in the direction of a pass, what the two rows before it have,
  /// unless they have offered that already.
  static void sweep_row(ClosestBlock& block, int pass, int a, int b, RowChanges& changed) {
    const bool down_i = pass & 2, down_j = pass & 1;
    const int i = down_i ? 7 - a : a, j = down_j ? 7 - b : b, n = padded_index(i, j, 0), row = n / kPaddedWidth;
    const int before_i = down_i ? kPaddedWidth : -kPaddedWidth, before_j = down_j ? 1 : -1;
    const auto last_change = [&](int of) { return changed[static_cast<std::size_t>(of)]; };
    bool learned = pass == 0 && block.any_known(n);
    // The row before it along i has offered in the last pass, the one along j in the last pass but one.
    if (!down_j || last_change(row + before_i) >= pass)
      learned |= block.offer_row(i, j, n, n + kPaddedWidth * before_i);
    if (!down_i || last_change(row + before_j) >= pass - 1)
      learned |= block.offer_row(i, j, n, n + kPaddedWidth * before_j);
    if (!learned) return;
    block.offer_along_row(i, j, n);
    changed[static_cast<std::size_t>(row)] = pass;
  }

  /// Prefetches what load_halo() will read of the leaf nodes above and below: a few bytes of every cache line.
  void prefetch(std::size_t leaf) const {
    for (const std::size_t face : {4, 5}) {
      const auto neighbour = graph_[leaf].neighbour[face];
      if (neighbour < 0 || points_[static_cast<std::size_t>(neighbour)].id == nullptr) continue;
      const auto& [points, id] = points_[static_cast<std::size_t>(neighbour)];
      constexpr int kLine = 16;  // values of four bytes in a cache line
      for (int n = 0; n < kLeafVoxels; n += kLine) {
        for (const auto& axis : points->p) __builtin_prefetch(axis + n);
        __builtin_prefetch(id + n);
      }
    }
  }

  void load_own(std::size_t leaf, ClosestBlock& block) const {
    const LeafPoints& own = points_[leaf];
    for_each_row([&](int, int, int padded, int n) {
      for (int axis = 0; axis < 3; ++axis) copy_row(own.points->p[axis] + n, block.p[axis] + padded);
      copy_row(own.id + n, block.id + padded);
    });
  }

  void load_halo(std::size_t leaf, ClosestBlock& block) const {
    for (int face = 0; face < kFaces; ++face) {
      const auto neighbour = graph_[leaf].neighbour[static_cast<std::size_t>(face)];
      if (neighbour < 0 || points_[static_cast<std::size_t>(neighbour)].id == nullptr) {
        for_each_halo_voxel(face, [&](int padded, int) {
          for (auto& axis : block.p) axis[padded] = kFarPoint;
          block.id[padded] = -1;
        });
        continue;
      }
      const auto& theirs = points_[static_cast<std::size_t>(neighbour)];
      float shift[3] = {0, 0, 0};
      shift[face / 2] = face % 2 ? kLeafWidth : -kLeafWidth;
      for_each_halo_voxel(face, [&](int padded, int n) {
        for (int axis = 0; axis < 3; ++axis) block.p[axis][padded] = theirs.points->p[axis][n] + shift[axis];
        block.id[padded] = theirs.id[n];
      });
    }
  }

  void store(std::size_t leaf, const ClosestBlock& block) {
    std::int32_t* id = points_[leaf].id;
    for_each_row([&](int, int, int padded, int n) {
      for (int axis = 0; axis < 3; ++axis) copy_row(block.p[axis] + padded, points_[leaf].points->p[axis] + n);
      copy_row(block.id + padded, id + n);
    });
  }

  /// For each face, the least distance at which a voxel across it would take over a closest point of this leaf node.
  Pending find_pending(const ClosestBlock& block) const {
    Pending pending;
    for (int face = 0; face < kFaces; ++face) {
      const float squared = face < 4 ? nearest_across_rows(block, face) : nearest_across_ends(block, face);
      pending[static_cast<std::size_t>(face)] = std::sqrt(squared);  // infinity stays infinity
    }
    return pending;
  }

  /// The least squared distance at which a voxel across a face along i or j would improve. Rows lie within such faces.
  float nearest_across_rows(const ClosestBlock& block, int face) const {
    const int axis = face / 2, out = face % 2 ? kLeafWidth : -1;
    Lanes nearest = kNonePending + Lanes{};
    for (int a = 0; a < kLeafWidth; ++a)
      for (int k = 0; k < kLeafWidth; k += kLanes) {
        const int i = axis == 0 ? out : a, j = axis == 0 ? a : out, theirs = padded_index(i, j, k),
                  mine = across(face, theirs);
        const Lanes offered = block.squared_lanes(i, j, k, mine), known = block.squared_lanes(i, j, k, theirs);
        const Lanes reach = load_lanes(block.id + mine) < 0 ? reach_inside_ + Lanes{} : reach_outside_ + Lanes{};
        const IntLanes improves = (offered < kWorthAVisit * known) & (offered <= reach) & (offered < nearest);
        nearest = improves ? offered : nearest;
      }
    return std::min(std::min(nearest[0], nearest[1]), std::min(nearest[2], nearest[3]));
  }

  /// The least squared distance at which a voxel across a face along k, where rows end, would improve.
  float nearest_across_ends(const ClosestBlock& block, int face) const {
    const int k = face % 2 ? kLeafWidth : -1;
    float nearest = kNonePending;
    for_each_row([&](int i, int j, int, int) {
      const int theirs = padded_index(i, j, k), mine = across(face, theirs);
      const float offered = block.squared(i, j, k, mine);
      if (offered < kWorthAVisit * block.squared(i, j, k, theirs) && offered <= reach_squared(block.id[mine]))
        nearest = std::min(nearest, offered);
    });
    return nearest;
  }

  /// Finds the closest triangle of every voxel by a walk over the mesh. The walk starts at the triangle that was handed
  /// on or, if that is nearer, at the closest triangle of a neighbour.
  void settle(std::size_t leaf) {
    const GraphLeaf& at = graph_[leaf];
    at.phi->allocate();
    float* phi = at.phi->buffer().data();
    if (leaf >= front_leaves_) std::fill_n(phi, kLeafVoxels, background_);
    std::int32_t* id = points_[leaf].id;
    auto& p = points_[leaf].points->p;
    openvdb::util::NodeMask<3> active = at.phi->getValueMask();
    for_each_row([&](int i, int j, int, int row) {
      const unsigned frozen = frozen_row(leaf, row);
      for (int k = 0; k < kLeafWidth; ++k) {
        const int n = row + k;
        if (frozen >> k & 1) {
          id[n] = static_cast<std::int32_t>(triangle_of(id[n]));
          continue;
        }
        const bool inside = id[n] < 0;
        if (squared_to(p, i, j, k, n) <= (inside ? walk_inside_ : walk_outside_)) {
          std::uint32_t triangle = best_start(p, id, i, j, k);
          const TrianglePoint nearest = surface_.walk_to_closest(centre(leaf, n), triangle);
          const double distance = std::sqrt(nearest.squared_distance);
          if (distance <= (inside ? reach_.inside : reach_.outside)) {
            set_point(leaf, n, nearest.point);
            phi[n] = static_cast<float>(inside ? -distance : distance);
            id[n] = static_cast<std::int32_t>(triangle);
            active.setOn(static_cast<openvdb::Index>(n));
            continue;
          }
        }
        id[n] = -1;
        p[0][n] = kFarPoint;
      }
    });
    at.phi->setValueMask(active);
    at.closest->setValueMask(active);
  }

  /// Squared distance from voxel (i, j, k) to the closest point of voxel n.
  static float squared_to(const float (&p)[3][kLeafVoxels], int i, int j, int k, int n) {
    const float x = static_cast<float>(i) - p[0][n], y = static_cast<float>(j) - p[1][n],
                z = static_cast<float>(k) - p[2][n];
    return x * x + y * y + z * z;
  }

  /// The triangle to start from: that of voxel (i, j, k) itself, or of one of the three neighbours that were settled
  /// before it, if the closest point of that one is nearer.
  static std::uint32_t best_start(const float (&p)[3][kLeafVoxels], const std::int32_t* id, int i, int j, int k) {
    const int n = i << 6 | j << 3 | k, ijk[3] = {i, j, k};
    std::uint32_t triangle = triangle_of(id[n]);
    float nearest = squared_to(p, i, j, k, n);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int before = n - kLeafStride[axis];
      if (ijk[axis] == 0 || id[before] < 0) continue;
      const float squared = squared_to(p, i, j, k, before);
      if (!(squared < nearest)) continue;
      nearest = squared;
      triangle = static_cast<std::uint32_t>(id[before]);
    }
    return triangle;
  }

  /// A last look at the neighbours' closest points: where surfaces compete, the samples may have chosen the wrong one.
  void compare_with_neighbours(std::size_t leaf) {
    if (graph_[leaf].phi->isEmpty()) return;
    ClosestBlock block;
    prefetch(leaf);
    load_own(leaf, block);
    load_halo(leaf, block);
    for_each_row([&](int i, int j, int padded, int n) {
      float limit[kLeafWidth];
      if (!find_limits(leaf, n, limit)) return;
      for (const int stride : kPaddedStride)
        for (const int m : {padded - stride, padded + stride})
          for (int k = 0; k < kLeafWidth; k += kLanes) {
            const IntLanes nearer = (block.squared_lanes(i, j, k, m + k) < load_lanes(limit + k)) &
                                    (load_lanes(block.id + m + k) != load_lanes(block.id + padded + k));
            if (any(nearer)) try_out(leaf, n + k, nearer, block.id + m + k);
          }
    });
  }

  /// The squared distances, in voxels, below which a neighbour's closest point is worth a try by the voxels of the row
  /// from n on; below 0 for those that have nothing to gain. False if that is so of all of them.
  bool find_limits(std::size_t leaf, int n, float (&limit)[kLeafWidth]) const {
    const auto tolerance = static_cast<float>(kTolerance);
    const float* phi = graph_[leaf].phi->buffer().data() + n;
    const unsigned on = graph_[leaf].phi->getValueMask().getWord<std::uint8_t>(static_cast<openvdb::Index>(n / 8));
    const unsigned open = on & ~frozen_row(leaf, n);
    if (open == 0) return false;
    for (int k = 0; k < kLeafWidth; ++k) {
      const float size = std::max(std::abs(phi[k]) * per_voxel_ - tolerance, 0.0f);
      limit[k] = open >> k & 1 ? size * size : -1;
    }
    return true;
  }

  /// Lets some of the four voxels from n on try the triangles of as many others.
  void try_out(std::size_t leaf, int n, const IntLanes& some, const std::int32_t* ids) {
    for (int lane = 0; lane < kLanes; ++lane)
      if (some[lane]) try_out(leaf, n + lane, ids[lane]);
  }

  void try_out(std::size_t leaf, int n, std::int32_t id) {
    auto triangle = static_cast<std::uint32_t>(id);
    const TrianglePoint nearest = surface_.walk_to_closest(centre(leaf, n), triangle);
    const double distance = std::sqrt(nearest.squared_distance);
    float& phi = graph_[leaf].phi->buffer().data()[n];
    if (distance >= std::abs(phi)) return;
    phi = std::copysign(static_cast<float>(distance), phi);
    points_[leaf].id[n] = static_cast<std::int32_t>(triangle);
    set_point(leaf, n, nearest.point);
  }

  const Surface& surface_;
  LeafGraph graph_;
  double h_, voxels_per_unit_;
  float per_voxel_;
  Reach reach_;
  float background_;
  float reach_inside_, reach_outside_;  // squared, in voxels, with kSampling added
  float walk_inside_, walk_outside_;    // squared, in voxels: voxels within it walk to their closest triangle
  std::size_t front_leaves_;
  std::vector<openvdb::util::NodeMask<3>> frozen_;  // voxels of the front, for its leaf nodes
  std::vector<LeafPoints> points_;
  std::vector<std::unique_ptr<ClosestPoints[]>> pools_;
};

}  // namespace

void sweep_closest(DistanceField& field, const Surface& surface, const ProgressCallback& callback) {
  ClosestSweep(field, surface).run(callback);
}

}  // namespace vdb_offset
