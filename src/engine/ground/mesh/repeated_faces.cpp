// SPDX-License-Identifier: Apache-2.0
#include "ground/mesh/repeated_faces.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstddef>
#include <tuple>

#include "ground/numbers/bucket_sort.h"
#include "ground/numbers/hash_mix.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

using FaceCorners = std::span<const std::uint32_t>;

/// A hash of a face's corners that does not depend on their order.
std::uint32_t hash(FaceCorners face) {
  std::uint64_t sum = face.size();
  for (const auto v : face) sum += mix(v + 1);
  return static_cast<std::uint32_t>(mix(sum));
}

enum class Cycle : std::uint8_t { Other, Same, Reversed };

/// How the corners of b run that are those of a.
Cycle compare_cycles(FaceCorners a, FaceCorners b) {
  const std::size_t n = a.size();
  if (b.size() != n) return Cycle::Other;
  for (std::size_t start = 0; start < n; ++start) {
    if (b[start] != a[0]) continue;
    bool forwards = true, backwards = true;
    for (std::size_t k = 1; k < n && (forwards || backwards); ++k) {
      forwards = forwards && b[(start + k) % n] == a[k];
      backwards = backwards && b[(start + n - k) % n] == a[k];
    }
    if (forwards || backwards) return forwards ? Cycle::Same : Cycle::Reversed;
  }
  return Cycle::Other;
}

/// Sorted by the hash; faces with the same hash by their number.
struct HashedFace {
  std::uint32_t hash, face;
  bool operator<(const HashedFace& o) const { return std::tie(hash, face) < std::tie(o.hash, o.face); }
};

std::uint32_t greatest(FaceCorners corners) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, corners.size()), std::uint32_t{0},
      [&](const auto& range, std::uint32_t most) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) most = std::max(most, corners[i]);
        return most;
      },
      [](std::uint32_t a, std::uint32_t b) { return std::max(a, b); });
}

}  // namespace

std::vector<RepeatedFace> find_repeated_faces(std::span<const std::uint32_t> corners,
                                              std::span<const std::uint32_t> begin) {
  VDB_OFFSET_ASSERT(!begin.empty() && begin.back() <= corners.size());
  const std::size_t count = begin.size() - 1;
  const auto face = [&](std::size_t f) { return corners.subspan(begin[f], begin[f + 1] - begin[f]); };
  // Faces that repeat each other have the same smallest corner: only faces of one bucket have to be compared.
  const auto smallest = [&](std::size_t f) { return *std::min_element(face(f).begin(), face(f).end()); };
  const auto has_corners = [&](std::size_t f) { return begin[f + 1] > begin[f]; };
  Buckets buckets(corners.empty() ? 0 : greatest(corners) + std::size_t{1});
  for_each_index(count, [&](std::size_t f) {
    if (has_corners(f)) buckets.count(smallest(f));
  });
  std::vector<HashedFace> faces(buckets.close());
  for_each_index(count, [&](std::size_t f) {
    if (has_corners(f)) faces[buckets.next(smallest(f))] = {hash(face(f)), static_cast<std::uint32_t>(f)};
  });
  const std::vector<std::uint32_t> bucket_begin = buckets.take();
  std::vector<std::uint32_t> first(count);  // of those that repeat it
  std::vector<Cycle> cycle(count, Cycle::Other);
  for_each_index(bucket_begin.size() - 1, [&](std::size_t v) {
    const auto around = std::span(faces).subspan(bucket_begin[v], bucket_begin[v + 1] - bucket_begin[v]);
    std::sort(around.begin(), around.end());
    for (std::size_t i = 1; i < around.size(); ++i) {
      const std::uint32_t f = around[i].face;
      for (std::size_t j = i; j-- > 0 && around[j].hash == around[i].hash && cycle[f] == Cycle::Other;) {
        const std::uint32_t earlier = around[j].face;
        first[f] = cycle[earlier] == Cycle::Other ? earlier : first[earlier];
        cycle[f] = compare_cycles(face(first[f]), face(f));
      }
    }
  });
  std::vector<RepeatedFace> repeated;
  for (std::uint32_t f = 0; f < count; ++f)
    if (cycle[f] != Cycle::Other) repeated.push_back({f, first[f], cycle[f] == Cycle::Reversed});
  return repeated;
}

}  // namespace vdb_offset
