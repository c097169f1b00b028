#include "vdb_offset/sweep.h"

#include <openvdb/tools/Prune.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "vdb_offset/error.h"
#include "vdb_offset/leaf_graph.h"

namespace vdb_offset {
namespace {

constexpr float kUnset = std::numeric_limits<float>::infinity();
constexpr std::uint8_t kAllFaces = (1 << kFaces) - 1;

// A triangle that cannot be nearer by more than this many voxels is not looked at: a directions field needs no more.
constexpr float kTolerance = 0.01f;

// How much nearer, in voxels, the surface around a neighbour's triangle must promise to be before it is searched.
constexpr float kWorthAWalk = 0.05f;

// A gain of fewer voxels than this is rounding; chasing it would sweep for ever.
constexpr float kRounding = 1e-5f;

// What Block::changed holds before the first pass. A voxel looks at those changed in this pass or the one before.
constexpr std::uint8_t kSeen = 0, kUnseen = 1, kFirstPass = 2;

/// One leaf node and its halo, unpacked for sweeping. Lengths are in voxels, positions relative to voxel (0, 0, 0) of
/// the leaf node: floats of size 10 or so, and a voxel's own position is its indices.
struct Block {
  float size[kPaddedVoxels];      // |phi|, kUnset where nothing is known
  float point[3][kPaddedVoxels];  // closest point on the surface (closest solver only)
  std::int8_t sign[kPaddedVoxels];
  std::int32_t closest[kPaddedVoxels];
  std::uint8_t changed[kPaddedVoxels];  // number of the pass that last changed the voxel

  Block() {
    std::fill(std::begin(size), std::end(size), kUnset);
    std::fill(std::begin(closest), std::end(closest), -1);
    std::fill(std::begin(changed), std::end(changed), kSeen);
  }
};

/// Closest points of a leaf node's voxels, as in Block.
using LeafPoints = std::array<float, 3 * kLeafVoxels>;

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

class Sweeper {
 public:
  Sweeper(DistanceField& field, const Surface& surface, const SweepOptions& options)
      : surface_(surface),
        options_(options),
        graph_(field),
        h_(field.voxel_size),
        per_voxel_(static_cast<float>(1 / h_)),
        reach_inside_(static_cast<float>(options.reach.inside / h_)),
        reach_outside_(static_cast<float>(options.reach.outside / h_)),
        front_leaves_(graph_.size()) {
    frozen_.reserve(front_leaves_);
    for (std::size_t i = 0; i < front_leaves_; ++i) frozen_.push_back(graph_[i].phi->getValueMask());
    pending_.assign(front_leaves_, kAllFaces);
    if (options.solver == Solver::Closest) find_points_of_front();
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
      if (options_.solver == Solver::Closest)
        while (points_.size() < graph_.size()) points_.push_back(std::make_unique<LeafPoints>());
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

  /// The closest points that the rasteriser's triangles stand for.
  void find_points_of_front() {
    for (std::size_t i = 0; i < front_leaves_; ++i) points_.push_back(std::make_unique<LeafPoints>());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, front_leaves_, 8), [&](const auto& range) {
      for (std::size_t i = range.begin(); i != range.end(); ++i)
        for (auto voxel = graph_[i].closest->cbeginValueOn(); voxel; ++voxel) {
          const Vec3d x = voxel.getCoord().asVec3d() * h_;
          const Vec3d p = surface_.closest_on(static_cast<std::uint32_t>(*voxel), x).point;
          for (int k = 0; k < 3; ++k)
            (*points_[i])[static_cast<std::size_t>(k * kLeafVoxels) + voxel.pos()] =
                static_cast<float>(p[k] / h_ - graph_[i].origin()[k]);
        }
    });
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
    if (options_.solver == Solver::Closest) settle(at, block);
    return store(at, block);
  }

  /// Lets the voxels that changed walk over the mesh to the closest triangle: neighbours handed on one close to it.
  void settle(std::size_t at, Block& block) const {
    const openvdb::Coord origin = graph_[at].origin();
    for (int i = 0; i < kLeafWidth; ++i)
      for (int j = 0; j < kLeafWidth; ++j)
        for (int k = 0; k < kLeafWidth; ++k) {
          const int n = padded_index(i, j, k);
          if (block.changed[n] < kFirstPass) continue;
          auto triangle = static_cast<std::uint32_t>(block.closest[n]);
          const auto from = triangle;
          const TrianglePoint nearest =
              surface_.walk_to_closest((origin + openvdb::Coord(i, j, k)).asVec3d() * h_, triangle);
          if (triangle != from) set_closest(block, n, triangle, nearest, origin);
        }
  }

  void set_closest(Block& block, int n, std::uint32_t triangle, const TrianglePoint& nearest,
                   const openvdb::Coord& origin) const {
    block.size[n] = static_cast<float>(std::sqrt(nearest.squared_distance) / h_);
    block.closest[n] = static_cast<std::int32_t>(triangle);
    for (int k = 0; k < 3; ++k) block.point[k][n] = static_cast<float>(nearest.point[k] / h_ - origin[k]);
  }

  /// Unpacks voxel n of a leaf node whose voxels stand `shift` voxels farther along `axis` than those of the block.
  void unpack(std::size_t leaf, int n, int axis, float shift, Block& block, int padded) const {
    const std::int32_t triangle = graph_[leaf].closest->buffer().data()[n];
    if (triangle < 0) return;
    const float phi = graph_[leaf].phi->buffer().data()[n];
    block.size[padded] = std::abs(phi) * per_voxel_;
    block.sign[padded] = std::signbit(phi) ? -1 : 1;
    block.closest[padded] = triangle;
    if (options_.solver != Solver::Closest) return;
    for (int k = 0; k < 3; ++k)
      block.point[k][padded] =
          (*points_[leaf])[static_cast<std::size_t>(k * kLeafVoxels + n)] + (k == axis ? shift : 0.0f);
  }

  /// Marks as changed what this leaf node has not seen: everything at its first visit, else the faces that woke it.
  void load(std::size_t at, Block& block) const {
    const GraphLeaf& leaf = graph_[at];
    for (int i = 0, n = 0; i < kLeafWidth; ++i)
      for (int j = 0; j < kLeafWidth; ++j)
        for (int k = 0; k < kLeafWidth; ++k, ++n) {
          const int padded = padded_index(i, j, k);
          unpack(at, n, 0, 0.0f, block, padded);
          block.changed[padded] = visited_[at] ? kSeen : kUnseen;
        }
    for (int face = 0; face < kFaces; ++face) {
      const auto neighbour = leaf.neighbour[static_cast<std::size_t>(face)];
      if (neighbour < 0) continue;
      const std::uint8_t changed = pending_[at] >> face & 1 ? kUnseen : kSeen;
      const float shift = face % 2 ? kLeafWidth : -kLeafWidth;
      for_each_halo_voxel(face, [&](int padded, int n) {
        unpack(static_cast<std::size_t>(neighbour), n, face / 2, shift, block, padded);
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
          const bool improved = options_.solver == Solver::Closest
                                    ? improve_closest(block, n, pass, openvdb::Coord(i, j, k), origin)
                                    : improve_eikonal(block, n, pass);
          if (improved) {
            block.changed[n] = pass;
            any = true;
          }
        }
    return any;
  }

  float reach(std::int8_t sign) const { return sign < 0 ? reach_inside_ : reach_outside_; }

  /// A neighbour that may know a nearer triangle.
  struct Candidate {
    float squared;  // to its closest point
    float lower;    // no point of its triangle is nearer than this
    int from;
  };

  /// Lists the neighbours that changed since the voxel last looked and whose triangles may be nearer by more than the
  /// tolerance. A triangle lies behind the plane through its closest point p to y, normal to y - p: from x it is no
  /// nearer than that plane.
  int find_candidates(const Block& block, int n, std::uint8_t pass, const float x[3], Candidate candidates[6]) const {
    int count = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        const int m = n + side * kPaddedStride[static_cast<std::size_t>(axis)];
        if (block.closest[m] < 0 || block.changed[m] + 1 < pass || block.closest[m] == block.closest[n]) continue;
        const float away[3] = {x[0] - block.point[0][m], x[1] - block.point[1][m], x[2] - block.point[2][m]};
        const float squared = away[0] * away[0] + away[1] * away[1] + away[2] * away[2];
        const float lower = (squared + static_cast<float>(side) * away[axis]) / std::max(block.size[m], 1e-6f);
        if (lower < block.size[n] - kTolerance) candidates[count++] = {squared, lower, m};
      }
    // The nearest point first: its triangle is likely to settle the others.
    for (int i = 1; i < count; ++i)
      for (int j = i; j > 0 && candidates[j].squared < candidates[j - 1].squared; --j)
        std::swap(candidates[j], candidates[j - 1]);
    return count;
  }

  bool improve_closest(Block& block, int n, std::uint8_t pass, const openvdb::Coord& ijk,
                       const openvdb::Coord& origin) const {
    const float x[3] = {static_cast<float>(ijk[0]), static_cast<float>(ijk[1]), static_cast<float>(ijk[2])};
    Candidate candidates[6];
    const int count = find_candidates(block, n, pass, x, candidates);
    bool improved = false;
    for (int i = 0; i < count; ++i) {
      const auto& [squared, lower, m] = candidates[i];
      if (lower >= block.size[n] - kTolerance || block.closest[m] == block.closest[n]) continue;
      auto triangle = static_cast<std::uint32_t>(block.closest[m]);
      const Vec3d centre = (origin + ijk).asVec3d() * h_;
      TrianglePoint nearest = surface_.closest_on(triangle, centre);
      float distance = static_cast<float>(std::sqrt(nearest.squared_distance) / h_);
      // Triangles much smaller than a voxel: the closest one is far along the surface, and worth the walk.
      if (std::min(distance, block.size[n]) > lower + kWorthAWalk) {
        nearest = surface_.walk_to_closest(centre, triangle);
        distance = static_cast<float>(std::sqrt(nearest.squared_distance) / h_);
      }
      if (!(distance < block.size[n] - kRounding) || distance > reach(block.sign[m])) continue;
      block.sign[n] = block.sign[m];
      set_closest(block, n, triangle, nearest, origin);
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
    const auto distance = static_cast<float>(godunov(sorted[0], sorted[1], sorted[2]));
    const int from = up.from[nearest];
    if (!(distance < block.size[n] - kRounding) || distance > reach(block.sign[from])) return false;
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
            const auto phi = static_cast<float>(block.size[padded] * h_);
            leaf.phi->setValueOn(static_cast<openvdb::Index>(n), block.sign[padded] < 0 ? -phi : phi);
            leaf.closest->setValueOn(static_cast<openvdb::Index>(n), block.closest[padded]);
            if (options_.solver == Solver::Closest)
              for (int axis = 0; axis < 3; ++axis)
                (*points_[at])[static_cast<std::size_t>(axis * kLeafVoxels + n)] = block.point[axis][padded];
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

  const Surface& surface_;
  const SweepOptions& options_;
  LeafGraph graph_;
  double h_;
  float per_voxel_, reach_inside_, reach_outside_;  // the reach in voxels
  std::size_t front_leaves_;
  std::vector<openvdb::util::NodeMask<3>> frozen_;  // voxels of the front, for its leaf nodes
  std::vector<std::uint8_t> pending_;               // faces with news, by leaf node; 0 if it need not be visited
  std::vector<std::uint8_t> visited_;
  std::vector<std::unique_ptr<LeafPoints>> points_;  // closest solver only
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
