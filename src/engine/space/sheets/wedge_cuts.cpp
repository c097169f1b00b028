// SPDX-License-Identifier: Apache-2.0
#include "space/sheets/wedge_cuts.h"
#include "ground/mesh/triangulate.h"

#include <algorithm>
#include <map>

namespace vdb_offset {
namespace {

// The least cosine of the angle between the normals of two faces that count as one side: 0.8 degrees. Not measured.
constexpr double kOneSide = 0.9999;

class WedgeWalk {
 public:
  WedgeWalk(PolygonView mesh, std::span<const WedgeLink> links) : mesh_(mesh), links_(links) {
    for (std::size_t i = 0; i < links.size(); ++i)
      for (const auto corner : links[i].corners) at_[corner].push_back(i);
  }

  std::vector<WedgeCut> cuts() {
    if (!walk()) return {};
    const std::vector<std::size_t> visits = repeated_visits();
    std::vector<WedgeCut> found;
    for (std::size_t i = 0; i < visits.size(); ++i) {
      const bool last = i + 1 == visits.size();
      if (last && !is_ring_) break;
      const std::size_t from = visits[i], to = last ? visits[0] + steps_.size() : visits[i + 1];
      if (link(from).edge == link(to).edge && to - from > 1) found.push_back(cut_between(from, to));
    }
    return found;
  }

 private:
  const WedgeLink& link(std::size_t step) const { return links_[steps_[step % steps_.size()]]; }
  /// The corner between a step and the step before.
  std::uint32_t corner(std::size_t step) const { return corners_[is_ring_ ? step % steps_.size() : step]; }

  /// Goes through the wedge from side to side, once around or from end to end. Returns false if it branches.
  bool walk() {
    std::uint32_t at = links_[0].corners[0];
    for (const auto& [own, links] : at_) {
      if (links.size() > 2) return false;
      if (links.size() == 1 && is_ring_) {
        at = own;
        is_ring_ = false;
      }
    }
    std::vector<std::uint8_t> gone(links_.size(), 0);
    for (bool any = true; any;) {
      corners_.push_back(at);
      any = false;
      for (const auto i : at_[at]) {
        if (gone[i]) continue;
        gone[i] = any = true;
        steps_.push_back(i);
        at = links_[i].corners[0] == at ? links_[i].corners[1] : links_[i].corners[0];
        break;
      }
    }
    return steps_.size() == links_.size();
  }

  std::vector<std::size_t> repeated_visits() const {
    std::map<std::uint32_t, std::size_t> count;
    for (const WedgeLink& l : links_) ++count[l.edge];
    std::vector<std::size_t> visits;
    for (std::size_t step = 0; step < steps_.size(); ++step)
      if (link(step).edge != kNone && count[link(step).edge] > 1) visits.push_back(step);
    return visits;
  }

  std::uint32_t face_of(std::uint32_t corner) const {
    const auto next = std::upper_bound(mesh_.face_begin.begin(), mesh_.face_begin.end(), corner / 2);
    return static_cast<std::uint32_t>(next - mesh_.face_begin.begin()) - 1;
  }
  bool is_one_side(std::uint32_t a, std::uint32_t b) const {
    Vec3d at_a = area_vector(mesh_, face_of(a)), at_b = area_vector(mesh_, face_of(b));
    if (!(at_a.normalize() && at_b.normalize())) return true;
    return at_a.dot(at_b) * (a % 2 == b % 2 ? 1 : -1) > kOneSide;
  }

  /// The cut between two visits of one edge. Between them are the side at the first, the side at the second, and the
  /// sides in between, which belong to both pieces.
  WedgeCut cut_between(std::size_t from, std::size_t to) const {
    std::size_t first = from + 1, last = to;  // the corners of those two sides that are farthest from the edge
    while (first + 1 < last && is_one_side(corner(first), corner(first + 1))) ++first;
    while (last > first + 1 && is_one_side(corner(last), corner(last - 1))) --last;
    WedgeCut cut{steps_[first % steps_.size()], {}};
    for (std::size_t step = first + 1; step < last; ++step) cut.shared.push_back({corner(step), corner(first)});
    return cut;
  }

  PolygonView mesh_;
  std::span<const WedgeLink> links_;
  std::map<std::uint32_t, std::vector<std::size_t>> at_;  // by corner
  std::vector<std::size_t> steps_;                        // the links in the order in which they are gone through
  std::vector<std::uint32_t> corners_;                    // before each of these, and behind the last
  bool is_ring_ = true;
};

}  // namespace

std::vector<WedgeCut> find_cuts(PolygonView mesh, std::span<const WedgeLink> links) {
  return links.empty() ? std::vector<WedgeCut>() : WedgeWalk(mesh, links).cuts();
}

}  // namespace vdb_offset
