// SPDX-License-Identifier: Apache-2.0
// What is done with miters once they are found.
#include <algorithm>
#include <utility>

#include "motion/paths/miters.h"

namespace vdb_offset {

const Miter* find_miter(std::span<const Miter> miters, std::uint32_t vertex) {
  const auto at = std::lower_bound(miters.begin(), miters.end(), vertex,
                                   [](const Miter& miter, std::uint32_t v) { return miter.vertex < v; });
  return at != miters.end() && at->vertex == vertex ? &*at : nullptr;
}

void count_miters(std::span<const Miter> miters, std::span<const VertexState> states, MiterFacts& facts) {
  for (const Miter& miter : miters) {
    const VertexState state = states[miter.vertex];
    facts.mitered += state == VertexState::Mitered;
    facts.cut += state == VertexState::Cut;
    facts.taken_back += state != miter.state;
    if (state == VertexState::Mitered) facts.excess = std::max(facts.excess, miter.excess);
  }
}

MiteredPaths::MiteredPaths(std::span<const Miter> miters, Paths& paths) {
  if (miters.empty()) return;
  farther_.assign(paths.displacement.size(), 0.0);
  nearer_ = farther_;
  Indices all;
  for (const Miter& miter : miters) {
    all.push_back(miter.vertex);
    others_.push_back({miter.vertex,
                       miter.displacement,
                       miter.distance,
                       miter.state,
                       miter.closest,
                       {},
                       miter.distance,
                       miter.nearer,
                       miter.displacement,
                       false});
  }
  exchange(all, paths, false);
}

std::vector<MiteredPaths::Other>::const_iterator MiteredPaths::find(std::uint32_t vertex) const {
  const auto at = std::lower_bound(others_.begin(), others_.end(), vertex,
                                   [](const Other& other, std::uint32_t v) { return other.vertex < v; });
  return at != others_.end() && at->vertex == vertex ? at : others_.end();
}

bool MiteredPaths::is_mitered(std::uint32_t vertex) const {
  const auto at = find(vertex);
  return at != others_.end() && at->is_mitered;
}

const Vec3d* MiteredPaths::miter_of(std::uint32_t vertex) const {
  const auto at = find(vertex);
  return at != others_.end() ? &at->miter : nullptr;
}

bool MiteredPaths::is_miter(std::uint32_t vertex, const Vec3d& displacement) const {
  const auto at = find(vertex);
  return at != others_.end() && at->miter == displacement;
}

Indices MiteredPaths::taken_back() const {
  Indices vertices;
  for (const Other& other : others_)
    if (!other.is_mitered) vertices.push_back(other.vertex);
  return vertices;
}

void MiteredPaths::forget(const Indices& vertices) {
  std::erase_if(others_, [&](const Other& other) {
    return !other.is_mitered && std::binary_search(vertices.begin(), vertices.end(), other.vertex);
  });
}

Indices MiteredPaths::exchange(const Indices& vertices, Paths& paths, bool are_mitered) {
  Indices exchanged;
  for (const auto v : vertices) {
    const auto at = find(v);
    if (at == others_.end() || at->is_mitered != are_mitered) continue;
    Other& other = others_[static_cast<std::size_t>(at - others_.begin())];
    std::swap(paths.displacement[v], other.displacement);
    std::swap(paths.achieved[v], other.achieved);
    std::swap(paths.state[v], other.state);
    std::swap(paths.closest[v], other.closest);
    if (!paths.trace.empty()) std::swap(paths.trace[v], other.trace);
    other.is_mitered = !are_mitered;
    farther_[v] = are_mitered ? 0 : other.farther;
    nearer_[v] = are_mitered ? 0 : other.nearer;
    exchanged.push_back(v);
  }
  return exchanged;
}

}  // namespace vdb_offset
