#include "vdb_offset/repeated_faces.h"

#include <bit>
#include <cstddef>

#include "vdb_offset/mix.h"

namespace vdb_offset {
namespace {

using Corners = std::span<const std::uint32_t>;

/// The same for any order of the corners.
std::uint64_t hash(Corners face) {
  std::uint64_t sum = face.size();
  for (const auto v : face) sum += mix(v + 1);
  return mix(sum);
}

bool same_cycle(Corners a, Corners b) {
  const std::size_t n = a.size();
  if (b.size() != n) return false;
  for (std::size_t start = 0; start < n; ++start) {
    if (b[start] != a[0]) continue;
    bool forwards = true, backwards = true;
    for (std::size_t k = 1; k < n && (forwards || backwards); ++k) {
      forwards = forwards && b[(start + k) % n] == a[k];
      backwards = backwards && b[(start + n - k) % n] == a[k];
    }
    if (forwards || backwards) return true;
  }
  return false;
}

}  // namespace

std::vector<std::uint8_t> find_repeated_faces(std::span<const std::uint32_t> corners,
                                              std::span<const std::uint32_t> begin) {
  const std::size_t count = begin.size() - 1;
  const auto face = [&](std::size_t f) { return corners.subspan(begin[f], begin[f + 1] - begin[f]); };
  std::vector<std::uint8_t> repeated(count, 0);
  // Open addressing; a slot holds a face's number plus one.
  std::vector<std::uint32_t> slots(std::bit_ceil(2 * count + 16), 0);
  for (std::size_t f = 0; f < count; ++f) {
    std::size_t slot = hash(face(f)) & (slots.size() - 1);
    while (slots[slot] != 0 && !same_cycle(face(slots[slot] - 1), face(f))) slot = (slot + 1) & (slots.size() - 1);
    if (slots[slot] != 0) repeated[f] = 1;
    else slots[slot] = static_cast<std::uint32_t>(f + 1);
  }
  return repeated;
}

}  // namespace vdb_offset
