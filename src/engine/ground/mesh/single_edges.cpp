// SPDX-License-Identifier: Apache-2.0
#include "ground/mesh/single_edges.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <utility>

#include "ground/mesh/edge_sides.h"
#include "ground/numbers/hash_mix.h"

namespace vdb_offset {
namespace {

/// Sums over the sides of all faces, in buckets by the hash of their edge. The two sides of an edge with two faces
/// cancel out, so that only edges in a bucket with a sum other than zero can be borders. A closed surface has none.
class EdgeSums {
 public:
  EdgeSums(PolygonView polygons, std::span<const std::uint32_t> position) : sums_(kBuckets, 0) {
    tbb::enumerable_thread_specific<std::vector<std::uint64_t>> parts(kBuckets, 0);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, polygons.face_count(), kRun), [&](const auto& range) {
      std::vector<std::uint64_t>& part = parts.local();
      for (std::size_t f = range.begin(); f != range.end(); ++f)
        visit_sides(polygons, position, f, [&](auto, std::uint32_t from, std::uint32_t to) {
          const std::uint64_t hash = mix(key(from, to)), value = mix(hash + 1);
          part[hash % kBuckets] += from < to ? value : -value;
        });
    });
    for (const std::vector<std::uint64_t>& part : parts)
      for (std::size_t i = 0; i < kBuckets; ++i) sums_[i] += part[i];
  }
  bool all_cancel() const {
    return std::all_of(sums_.begin(), sums_.end(), [](std::uint64_t sum) { return sum == 0; });
  }
  bool cancels(std::uint32_t from, std::uint32_t to) const { return sums_[mix(key(from, to)) % kBuckets] == 0; }

  static std::uint64_t key(std::uint32_t from, std::uint32_t to) {
    return std::uint64_t{std::min(from, to)} << 32 | std::max(from, to);
  }

 private:
  // kBuckets: sums that stay in a core's cache, 256 KiB. kRun: faces that a thread takes at a time. Not measured beside
  // other sizes.
  static constexpr std::size_t kBuckets = 1 << 15, kRun = 1 << 14;

  std::vector<std::uint64_t> sums_;
};

}  // namespace

std::vector<SingleEdge> find_single_edges(PolygonView polygons, std::span<const std::uint32_t> position) {
  const EdgeSums sums(polygons, position);
  if (sums.all_cancel()) return {};
  std::atomic<std::size_t> count = 0;
  const auto for_each_doubtful = [&](auto&& visit) {
    for_each_side(polygons, position, [&](std::uint32_t corner, std::uint32_t from, std::uint32_t to) {
      if (!sums.cancels(from, to)) visit(EdgeSums::key(from, to), corner);
    });
  };
  for_each_doubtful([&](std::uint64_t, std::uint32_t) { count.fetch_add(1, std::memory_order_relaxed); });
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sides(count);
  count = 0;
  for_each_doubtful([&](std::uint64_t key, std::uint32_t corner) {
    sides[count.fetch_add(1, std::memory_order_relaxed)] = {key, corner};
  });
  std::sort(sides.begin(), sides.end());
  std::vector<SingleEdge> single;
  for (std::size_t i = 0; i < sides.size();) {
    const auto [key, corner] = sides[i];
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].first == key) ++end;
    if (end == i + 1)
      single.push_back({static_cast<std::uint32_t>(key >> 32), static_cast<std::uint32_t>(key), corner});
    i = end;
  }
  return single;
}

}  // namespace vdb_offset
