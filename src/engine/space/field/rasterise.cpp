// SPDX-License-Identifier: Apache-2.0
#include "space/field/rasterise.h"

#include "ground/system/progress_count.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>

namespace vdb_offset {
namespace {

using openvdb::Coord;

constexpr std::int64_t kKeyBias =
    1 << 20;  // added to coordinates of leaf nodes, so that 21 bits hold them without a sign

/// A triangle that may lie within the band of a leaf node.
struct Entry {
  std::uint64_t leaf;
  std::uint32_t triangle;
  bool operator<(const Entry& other) const {
    return leaf != other.leaf ? leaf < other.leaf : triangle < other.triangle;
  }
};

/// The triangles of successive numbers, which lie near each other, sorted by leaf node.
using Chunk = std::vector<std::uint32_t>;
/// The triangles of one chunk that may lie within the band of one leaf node.
struct Run {
  std::uint64_t leaf;
  std::uint32_t chunk, begin, end;
  bool operator<(const Run& other) const { return leaf != other.leaf ? leaf < other.leaf : chunk < other.chunk; }
};

/// A key for a leaf node: its coordinates (voxels / 8), 21 bits each. Keys are ordered by x, then y, then z.
std::uint64_t pack(const Coord& leaf) {
  std::uint64_t key = 0;
  for (int k = 0; k < 3; ++k) key = key << 21 | static_cast<std::uint64_t>(leaf[k] + kKeyBias);
  return key;
}

/// The origin, in voxels, of the leaf node with this key.
Coord unpack(std::uint64_t key) {
  const auto part = [&](int shift) {
    return static_cast<int>(static_cast<std::int64_t>(key >> shift & 0x1fffff) - kKeyBias) * kLeafWidth;
  };
  return {part(42), part(21), part(0)};
}

struct TriangleBounds {
  Vec3d lower, upper;
};

TriangleBounds bounds_of(const Surface& surface, std::uint32_t triangle) {
  const auto& [a, b, c] = surface.triangles[triangle];
  using openvdb::math::maxComponent, openvdb::math::minComponent;
  return {minComponent(minComponent(surface.vertices[a], surface.vertices[b]), surface.vertices[c]),
          maxComponent(maxComponent(surface.vertices[a], surface.vertices[b]), surface.vertices[c])};
}

/// Lists the leaf nodes that hold a voxel within the band of one triangle, by halving the box of leaf nodes around it.
class LeafFinder {
 public:
  LeafFinder(const Surface& surface, const RasteriseOptions& options) : surface_(surface), options_(options) {}

  void find(std::uint32_t triangle, std::vector<Entry>& entries) const {
    const TriangleBounds box = bounds_of(surface_, triangle);
    const double leaf = kLeafWidth * options_.voxel_size;
    Coord lower, upper;
    for (int k = 0; k < 3; ++k) {
      lower[k] = static_cast<int>(std::floor((box.lower[k] - options_.band) / leaf));
      upper[k] = static_cast<int>(std::floor((box.upper[k] + options_.band) / leaf));
    }
    if (options_.slab) lower[2] = upper[2] = 0;
    descend(triangle, lower, upper, entries);
  }

 private:
  void descend(std::uint32_t triangle, const Coord& lower, const Coord& upper, std::vector<Entry>& entries) const {
    // The centres of the voxels in the box of leaf nodes lie between these two points.
    const Vec3d first = Vec3d(lower.asVec3d()) * kLeafWidth, last = Vec3d(upper.asVec3d()) * kLeafWidth + Vec3d(7.0);
    const double reach = (last - first).length() / 2 * options_.voxel_size + options_.band;
    const Vec3d centre = (first + last) * (0.5 * options_.voxel_size);
    if (surface_.closest_on(triangle, centre).squared_distance > reach * reach * (1 + 1e-9)) return;
    if (lower == upper) {
      entries.push_back({pack(lower), triangle});
      return;
    }
    const Coord size = upper - lower;
    const int axis = size[0] >= size[1] && size[0] >= size[2] ? 0 : size[1] >= size[2] ? 1 : 2;
    Coord middle_upper = upper, middle_lower = lower;
    middle_upper[axis] = lower[axis] + size[axis] / 2;
    middle_lower[axis] = middle_upper[axis] + 1;
    descend(triangle, lower, middle_upper, entries);
    descend(triangle, middle_lower, upper, entries);
  }

  const Surface& surface_;
  const RasteriseOptions& options_;
};

/// The triangles of each leaf node: runs in the order of leaf nodes, and of triangles within one.
struct Bins {
  std::vector<Chunk> chunks;
  std::vector<Run> runs;
  std::vector<std::size_t> leaf_begin;  // index of the first run of each leaf node, and the number of runs

  std::span<const std::uint32_t> triangles(const Run& run) const {
    return std::span(chunks[run.chunk]).subspan(run.begin, run.end - run.begin);
  }
};

std::vector<Run> sort_chunk(std::vector<Entry>& entries, std::uint32_t index, Chunk& chunk) {
  std::sort(entries.begin(), entries.end());
  std::vector<Run> runs;
  chunk.reserve(entries.size());
  for (const Entry& entry : entries) {
    const auto at = static_cast<std::uint32_t>(chunk.size());
    if (runs.empty() || runs.back().leaf != entry.leaf) runs.push_back({entry.leaf, index, at, at});
    chunk.push_back(entry.triangle);
    runs.back().end = at + 1;
  }
  return runs;
}

Bins sort_into_leaf_nodes(const Surface& surface, const RasteriseOptions& options, Progress& progress) {
  constexpr std::size_t kChunk = 1024;  // triangles that a thread sorts at a time; not measured beside other numbers
  const std::size_t count = surface.triangles.size(), chunks = (count + kChunk - 1) / kChunk;
  Bins bins;
  bins.chunks.resize(chunks);
  std::vector<std::vector<Run>> runs(chunks);
  const LeafFinder finder(surface, options);
  tbb::parallel_for(std::size_t{0}, chunks, [&](std::size_t chunk) {
    const std::size_t end = std::min(count, (chunk + 1) * kChunk);
    std::vector<Entry> entries;
    for (std::size_t t = chunk * kChunk; t < end; ++t) finder.find(static_cast<std::uint32_t>(t), entries);
    runs[chunk] = sort_chunk(entries, static_cast<std::uint32_t>(chunk), bins.chunks[chunk]);
    progress.advance(end - chunk * kChunk);
  });
  for (const auto& some : runs) bins.runs.insert(bins.runs.end(), some.begin(), some.end());
  tbb::parallel_sort(bins.runs.begin(), bins.runs.end());
  for (std::size_t i = 0; i < bins.runs.size(); ++i)
    if (i == 0 || bins.runs[i].leaf != bins.runs[i - 1].leaf) bins.leaf_begin.push_back(i);
  bins.leaf_begin.push_back(bins.runs.size());
  return bins;
}

/// Distances of one leaf node's voxels while its triangles are drawn into it.
class LeafCanvas {
 public:
  LeafCanvas(const Surface& surface, const RasteriseOptions& options, const Coord& origin)
      : surface_(surface), options_(options), origin_(origin) {
    std::fill(std::begin(squared_), std::end(squared_), std::numeric_limits<double>::infinity());
    std::fill(std::begin(triangle_), std::end(triangle_), kNone);
  }

  void draw(std::uint32_t triangle) {
    const double h = options_.voxel_size, band = options_.band;
    const TriangleBounds box = bounds_of(surface_, triangle);
    int lower[3], upper[3];
    for (int k = 0; k < 3; ++k) {
      lower[k] = std::max(0, static_cast<int>(std::ceil((box.lower[k] - band) / h)) - origin_[k]);
      upper[k] = std::min(kLeafWidth - 1, static_cast<int>(std::floor((box.upper[k] + band) / h)) - origin_[k]);
    }
    const Vec3d& normal = surface_.triangle_normals[triangle];
    const Vec3d& corner = surface_.vertices[surface_.triangles[triangle][0]];
    for (int i = lower[0]; i <= upper[0]; ++i)
      for (int j = lower[1]; j <= upper[1]; ++j)
        for (int k = lower[2]; k <= upper[2]; ++k) {
          const Vec3d x = centre(i, j, k);
          if (std::abs(normal.dot(x - corner)) > band) continue;
          const int n = i << 6 | j << 3 | k;
          const double squared = surface_.closest_on(triangle, x).squared_distance;
          if (!wins(triangle, squared, n)) continue;
          squared_[n] = squared;
          triangle_[n] = triangle;
        }
  }

  /// Sets the voxels of both leaf nodes that lie in the band. Returns false if none does.
  bool store(PhiLeaf& phi, ClosestLeaf& closest) const {
    bool any = false;
    for (int n = 0; n < kLeafVoxels; ++n) {
      if (triangle_[n] == kNone || squared_[n] > options_.band * options_.band) continue;
      any = true;
      const Vec3d x = centre(n >> 6, n >> 3 & 7, n & 7);
      const TrianglePoint at = surface_.closest_on(triangle_[n], x);
      const bool inside = surface_.pseudonormal(triangle_[n], at.feature).dot(x - at.point) < 0;
      const auto distance = static_cast<float>(std::sqrt(squared_[n]));
      phi.setValueOn(static_cast<openvdb::Index>(n), inside ? -distance : distance);
      closest.setValueOn(static_cast<openvdb::Index>(n), static_cast<std::int32_t>(triangle_[n]));
    }
    return any;
  }

 private:
  /// Whether a triangle replaces the one known at a voxel: if it is nearer or, within rounding, as near and of an
  /// earlier face of the input. Where sheets lie back to back, one of them so decides everywhere which side is outside.
  bool wins(std::uint32_t triangle, double squared, int n) const {
    constexpr double kTie = 1e-12;  // relative, of squared distances: far above their rounding; not measured
    if (squared < squared_[n] * (1 - kTie)) return true;
    return squared <= squared_[n] * (1 + kTie) && surface_.face[triangle] < surface_.face[triangle_[n]];
  }
  Vec3d centre(int i, int j, int k) const {
    return Vec3d(origin_[0] + i, origin_[1] + j, origin_[2] + k) * options_.voxel_size;
  }

  const Surface& surface_;
  const RasteriseOptions& options_;
  Coord origin_;
  double squared_[kLeafVoxels];
  std::uint32_t triangle_[kLeafVoxels];
};

}  // namespace

Front rasterise(const Surface& surface, const RasteriseOptions& options, const ProgressCallback& callback) {
  Progress progress(callback, Stage::Rasterise, 2 * surface.triangles.size());
  const Bins bins = sort_into_leaf_nodes(surface, options, progress);
  Front front;
  static_cast<FieldGrids&>(front) = make_field_grids(options.voxel_size, options.band, surface.origin);
  front.band = options.band;
  front.slab = options.slab;
  const std::size_t leaves = bins.leaf_begin.size() - 1;
  std::vector<std::unique_ptr<PhiLeaf>> phi(leaves);
  std::vector<std::unique_ptr<ClosestLeaf>> closest(leaves);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves, 4), [&](const auto& range) {
    for (std::size_t leaf = range.begin(); leaf != range.end(); ++leaf) {
      const Coord origin = unpack(bins.runs[bins.leaf_begin[leaf]].leaf);
      LeafCanvas canvas(surface, options, origin);
      for (std::size_t run = bins.leaf_begin[leaf]; run < bins.leaf_begin[leaf + 1]; ++run)
        for (const auto triangle : bins.triangles(bins.runs[run])) canvas.draw(triangle);
      auto phi_leaf = std::make_unique<PhiLeaf>(origin, front.phi->background());
      auto closest_leaf = std::make_unique<ClosestLeaf>(origin, -1);
      if (canvas.store(*phi_leaf, *closest_leaf)) {
        phi[leaf] = std::move(phi_leaf);
        closest[leaf] = std::move(closest_leaf);
      }
    }
    progress.advance((range.end() - range.begin()) * surface.triangles.size() / std::max<std::size_t>(leaves, 1));
  });
  for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
    if (!phi[leaf]) continue;
    front.phi->tree().addLeaf(phi[leaf].release());
    front.closest->tree().addLeaf(closest[leaf].release());
  }
  return front;
}

}  // namespace vdb_offset
