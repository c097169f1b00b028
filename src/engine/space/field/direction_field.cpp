// SPDX-License-Identifier: Apache-2.0
#include "space/field/direction_field.h"

#include <openvdb/tree/LeafManager.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <memory>

#include "space/field/leaf_graph.h"

namespace vdb_offset {
namespace {

using GradientLeaf = openvdb::Vec3STree::LeafNodeType;
using PhiAccessor = openvdb::tree::ValueAccessor<const openvdb::FloatTree, false>;

/// phi of a leaf node and its halo; NaN where inactive.
struct PhiBlock {
  float phi[kPaddedVoxels];

  PhiBlock(const PhiAccessor& tree, const openvdb::Coord& origin) {
    std::fill(std::begin(phi), std::end(phi), std::nanf(""));
    const PhiLeaf& leaf = *tree.probeConstLeaf(origin);
    for (int n = 0; n < kLeafVoxels; ++n) copy(leaf, n, padded_index(n));
    for (int face = 0; face < kFaces; ++face)
      if (const PhiLeaf* const neighbour = tree.probeConstLeaf(origin_across(origin, face)))
        for_each_halo_voxel(face, [&](int padded, int n) { copy(*neighbour, n, padded); });
  }

 private:
  void copy(const PhiLeaf& leaf, int n, int padded) {
    if (leaf.isValueOn(static_cast<openvdb::Index>(n))) phi[padded] = leaf.buffer().data()[n];
  }
};

/// phi of a neighbour as seen from a voxel. If the sign differs, the surface lies between the two only if it fits
/// there: |centre| + |other| <= h, but for rounding. Otherwise both lie beyond a border, where the sign means nothing,
/// and the neighbour gets the sign of the voxel.
float seen_from(float centre, float other, float h) {
  const bool jump = std::signbit(centre) != std::signbit(other) && std::abs(centre) + std::abs(other) > 1.001f * h;
  return jump ? -other : other;
}

openvdb::Vec3s gradient_at(const PhiBlock& block, int n, float h) {
  openvdb::Vec3s gradient(0.0f);
  const float centre = block.phi[n];
  for (int axis = 0; axis < 3; ++axis) {
    const float lower = seen_from(centre, block.phi[n - kPaddedStride[static_cast<std::size_t>(axis)]], h),
                upper = seen_from(centre, block.phi[n + kPaddedStride[static_cast<std::size_t>(axis)]], h);
    const bool has_lower = !std::isnan(lower), has_upper = !std::isnan(upper);
    if (has_lower && has_upper) gradient[axis] = (upper - lower) / (2 * h);
    else if (has_upper) gradient[axis] = (upper - centre) / h;
    else if (has_lower) gradient[axis] = (centre - lower) / h;
  }
  return gradient;
}

}  // namespace

DirectionField make_directions(const DistanceField& field, bool open_surface) {
  const openvdb::FloatTree& phi = field.phi->tree();
  const auto h = static_cast<float>(field.voxel_size);
  DirectionField directions;
  directions.gradient = std::make_shared<openvdb::Vec3SGrid>(
      std::make_shared<openvdb::Vec3STree>(phi, openvdb::Vec3s(0.0f), openvdb::TopologyCopy()));
  directions.gradient->setName("direction");
  directions.gradient->setVectorType(openvdb::VEC_COVARIANT);
  directions.gradient->setTransform(field.phi->transformPtr());
  const openvdb::tree::LeafManager<openvdb::Vec3STree> leaves(directions.gradient->tree());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.leafCount(), 4), [&](const auto& range) {
    const PhiAccessor accessor(phi);
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      GradientLeaf& leaf = leaves.leaf(i);
      const PhiBlock block(accessor, leaf.origin());
      openvdb::Vec3s* const gradient = leaf.buffer().data();
      for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel)
        gradient[voxel.pos()] = gradient_at(block, padded_index(static_cast<int>(voxel.pos())), h);
    }
  });
  directions.phi = field.phi;
  directions.voxel_size = field.voxel_size;
  directions.open_surface = open_surface;
  return directions;
}

DirectionSampler::DirectionSampler(const DirectionField& field)
    : field_(field), gradient_(field.gradient->getConstAccessor()), phi_(field.phi->getConstAccessor()) {}

void DirectionSampler::look_up(const openvdb::Coord& lowest) {
  nodes_.lowest = lowest;
  // A fast path: two times in three, all eight nodes lie in one leaf node.
  const bool together = (lowest[0] & 7) != 7 && (lowest[1] & 7) != 7 && (lowest[2] & 7) != 7;
  const GradientLeaf* leaf = together ? gradient_.probeConstLeaf(lowest) : nullptr;
  const openvdb::Index first = GradientLeaf::coordToOffset(lowest);
  for (openvdb::Index node = 0; node < 8; ++node) {
    const openvdb::Index i = node >> 2, j = node >> 1 & 1, k = node & 1, n = first + (i << 6 | j << 3 | k);
    const auto at = lowest.offsetBy(static_cast<int>(i), static_cast<int>(j), static_cast<int>(k));
    openvdb::Vec3s g(0.0f);
    if (!together) nodes_.active[node] = gradient_.probeValue(at, g);
    else if ((nodes_.active[node] = leaf && leaf->isValueOn(n))) g = leaf->getValue(n);
    nodes_.gradient[node] = Gradient{g[0], g[1], g[2], 0};
    if (field_.open_surface && nodes_.active[node]) nodes_.phi[node] = phi_.getValue(at);
  }
}

double DirectionSampler::turn(std::size_t node, const Vec3d& index, int side, double distance) const {
  const double phi = nodes_.phi[node];
  const auto at = nodes_.lowest.offsetBy(node >> 2 & 1, node >> 1 & 1, node & 1);
  // The surface lies between x and the node only if both of their distances to it fit between them, but for rounding.
  const double apart = (at.asVec3d() - index).length() * field_.voxel_size;
  return std::signbit(phi) != (side < 0) && std::abs(phi) + distance > 1.001 * apart ? -1 : 1;
}

bool DirectionSampler::operator()(const Vec3d& x, int side, double distance, Vec3d& gradient) {
  const double per_unit = 1 / field_.voxel_size;
  const Vec3d index(x[0] * per_unit, x[1] * per_unit, x[2] * per_unit);
  const openvdb::Coord lowest = openvdb::Coord::floor(index);
  if (lowest != nodes_.lowest) look_up(lowest);
  double share[3][2];  // weight of the lower and the upper node along each axis
  for (int k = 0; k < 3; ++k) {
    share[k][1] = index[k] - lowest[k];
    share[k][0] = 1 - share[k][1];
  }
  double total = 0;
  Gradient sum{};
  for (std::size_t node = 0; node < 8; ++node) {
    const double weight = share[0][node >> 2] * share[1][node >> 1 & 1] * share[2][node & 1];
    total += nodes_.active[node] ? weight : 0;
    const double turned =
        field_.open_surface && nodes_.active[node] ? weight * turn(node, index, side, distance) : weight;
    sum += nodes_.gradient[node] * turned;
  }
  if (!(total > 0)) return false;
  gradient = Vec3d(sum[0] / total, sum[1] / total, sum[2] / total);
  return true;
}

}  // namespace vdb_offset
