// SPDX-License-Identifier: Apache-2.0
#include "products/cells/side_planes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "ground/numbers/disjoint_sets.h"
#include "ground/numbers/index_set.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

// The cosine of the angle between neighbouring sides beyond which a plane ends: 10 degrees. Not measured.
constexpr double kSameSide = 0.985;
// How far points may be off their plane, and planes from each other, as a share of the opening's size: files keep seven
// digits. Not measured.
constexpr double kSideOffPlane = 1e-5;

// The most planes of one opening: what is cut out by more is bounded by edges of faces that happen to be flat, as a
// group of faces is. Reasoned: an eighth of a body has three, a piece of a pipe up to six.
constexpr std::size_t kMostOpeningPlanes = 6;

/// Sides in a plane.
struct SidePlane {
  Vec3d normal{0.0};  // of unit length
  double place = 0;   // along it
};

/// The planes of one opening.
class OpeningPlanes {
 public:
  OpeningPlanes(std::span<const BoundarySide> sides, std::span<const Index> of_opening)
      : sides_(sides), of_opening_(of_opening) {}

  /// The number of the plane that each side lies in; all 0 if the opening is not made of planes.
  std::vector<Index> run() {
    std::vector<Index> plane_of(of_opening_.size(), 0);
    const std::vector<Index> chain_of = chains();
    const Index count = 1 + *std::ranges::max_element(chain_of);
    if (count == 1) return plane_of;
    measure();
    std::vector<SidePlane> planes;
    std::vector<Index> number(count);
    for (Index chain = 0; chain < count; ++chain) {
      const SidePlane plane = plane_of_chain(chain_of, chain);
      if (plane.normal.lengthSqr() == 0) continue;  // sides without height, which have no faces
      if (!is_flat(chain_of, chain, plane)) return plane_of;
      const auto known = std::ranges::find_if(planes, [&](const SidePlane& other) {
        return (other.normal - plane.normal).length() < kSideOffPlane &&
               std::abs(other.place - plane.place) < kSideOffPlane * size_;
      });
      number[chain] = static_cast<Index>(known - planes.begin());
      if (known == planes.end()) planes.push_back(plane);
      if (planes.size() > kMostOpeningPlanes) return plane_of;
    }
    for (std::size_t i = 0; i < plane_of.size(); ++i) plane_of[i] = number[chain_of[i]];
    return plane_of;
  }

 private:
  const BoundarySide& side(std::size_t i) const { return sides_[of_opening_[i]]; }

  /// Numbers of chains of neighbouring sides that turn little from one to the next.
  std::vector<Index> chains() const {
    std::map<Index, std::vector<Index>> at_stack;
    for (Index i = 0; i < of_opening_.size(); ++i)
      for (const Index stack : side(i).stacks) at_stack[stack].push_back(i);
    DisjointSets joined(of_opening_.size());
    for (const auto& [stack, around] : at_stack)
      for (std::size_t a = 0; a < around.size(); ++a)
        for (std::size_t b = a + 1; b < around.size(); ++b) {
          const Vec3d n = side(around[a]).area(), m = side(around[b]).area();
          if (n.dot(m) > kSameSide * n.length() * m.length()) joined.join(around[a], around[b]);
        }
    std::vector<Index> number(of_opening_.size(), kNone), chain_of;
    Index count = 0;
    for (Index i = 0; i < of_opening_.size(); ++i) {
      Index& chain = number[joined.first(i)];
      if (chain == kNone) chain = count++;
      chain_of.push_back(chain);
    }
    return chain_of;
  }

  void measure() {
    Vec3d lowest(std::numeric_limits<double>::infinity()), highest(-std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < of_opening_.size(); ++i)
      for (const Vec3d& x : side(i).corners) {
        lowest = openvdb::math::minComponent(lowest, x);
        highest = openvdb::math::maxComponent(highest, x);
      }
    size_ = (highest - lowest).length();
  }

  template <class Visit>
  void for_each_side(const std::vector<Index>& chain_of, Index chain, Visit&& visit) const {
    for (std::size_t i = 0; i < of_opening_.size(); ++i)
      if (chain_of[i] == chain) visit(side(i));
  }

  SidePlane plane_of_chain(const std::vector<Index>& chain_of, Index chain) const {
    SidePlane plane;
    for_each_side(chain_of, chain, [&](const BoundarySide& each) { plane.normal += each.area(); });
    plane.normal.normalize(0.0);
    double sum = 0, count = 0;
    for_each_side(chain_of, chain, [&](const BoundarySide& each) {
      for (const Vec3d& x : each.corners) sum += x.dot(plane.normal), ++count;
    });
    plane.place = sum / count;
    return plane;
  }

  bool is_flat(const std::vector<Index>& chain_of, Index chain, const SidePlane& plane) const {
    double off = 0;
    for_each_side(chain_of, chain, [&](const BoundarySide& each) {
      for (const Vec3d& x : each.corners) off = std::max(off, std::abs(x.dot(plane.normal) - plane.place));
    });
    return off < kSideOffPlane * size_;
  }

  std::span<const BoundarySide> sides_;
  std::span<const Index> of_opening_;
  double size_ = 0;
};

}  // namespace

std::size_t part_by_planes(std::span<BoundarySide> sides) {
  std::map<Index, std::vector<Index>> of_opening;
  for (Index i = 0; i < sides.size(); ++i) of_opening[sides[i].opening].push_back(i);
  std::vector<Index> plane(sides.size(), 0);
  for (const auto& [opening, its_sides] : of_opening) {
    const std::vector<Index> plane_of = OpeningPlanes(sides, its_sides).run();
    for (std::size_t i = 0; i < its_sides.size(); ++i) plane[its_sides[i]] = plane_of[i];
  }
  std::map<std::array<Index, 2>, Index> number;
  for (Index i = 0; i < sides.size(); ++i)
    sides[i].opening =
        number.try_emplace({sides[i].opening, plane[i]}, static_cast<Index>(number.size())).first->second;
  return number.size();
}

}  // namespace vdb_offset
