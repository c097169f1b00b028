// SPDX-License-Identifier: Apache-2.0
#include "gltf/mesh_builder.h"

#include <array>
#include <cmath>
#include <optional>

namespace vdb_offset::io::gltf {
namespace {

/// The transform of a node: three columns and an origin.
struct Transform {
  std::array<Vec3d, 3> axes{Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)};
  Vec3d origin{0.0};

  Vec3d turned(const Vec3d& v) const { return axes[0] * v[0] + axes[1] * v[1] + axes[2] * v[2]; }
  /// First `inner`, then this.
  Transform after(const Transform& inner) const {
    return {{turned(inner.axes[0]), turned(inner.axes[1]), turned(inner.axes[2])}, turned(inner.origin) + origin};
  }
};

template <std::size_t kCount>
std::array<double, kCount> numbers_of(const JsonValue& list) {
  if (list.size() != kCount) list.fail("an array of " + std::to_string(kCount));
  std::array<double, kCount> numbers;
  for (std::size_t k = 0; k < kCount; ++k) numbers[k] = list[k].number();
  return numbers;
}

Transform of_matrix(const JsonValue& matrix) {
  const std::array<double, 16> m = numbers_of<16>(matrix);
  if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) matrix.fail("a last row of 0, 0, 0, 1", "another");
  return {{Vec3d(m[0], m[1], m[2]), Vec3d(m[4], m[5], m[6]), Vec3d(m[8], m[9], m[10])}, Vec3d(m[12], m[13], m[14])};
}

/// The columns of a rotation by a quaternion x, y, z, w, which need not have length 1 to the last digit.
std::array<Vec3d, 3> of_rotation(const JsonValue& rotation) {
  auto q = numbers_of<4>(rotation);
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(length > 0) || !std::isfinite(length)) rotation.fail("a quaternion of length 1", "one of length 0");
  for (double& number : q) number /= length;
  const auto& [x, y, z, w] = q;
  return {Vec3d(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)),
          Vec3d(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)),
          Vec3d(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y))};
}

Transform transform_of(const JsonValue& node) {
  if (const auto matrix = node.find("matrix")) return of_matrix(*matrix);
  Transform transform;
  if (const auto rotation = node.find("rotation")) transform.axes = of_rotation(*rotation);
  if (const auto scale = node.find("scale")) {
    const auto factor = numbers_of<3>(*scale);
    for (std::size_t k = 0; k < 3; ++k) transform.axes[k] *= factor[k];
  }
  if (const auto translation = node.find("translation")) {
    const auto t = numbers_of<3>(*translation);
    transform.origin = Vec3d(t[0], t[1], t[2]);
  }
  return transform;
}

class Walk {
 public:
  explicit Walk(const JsonValue& root)
      : nodes_(root, "nodes"), meshes_(root, "meshes"), seen_(nodes_.size(), 0), placements_(meshes_.size()) {}

  /// Visits a node and those below it, in the file's order.
  void visit(const JsonValue& index) { visit(nodes_.index_of(index), index); }
  void visit(std::size_t number, const JsonValue& where) {
    push(number, where, {});
    while (!waiting_.empty()) {
      const Waiting next = waiting_.back();
      waiting_.pop_back();
      const JsonValue node = nodes_[next.node];
      const Transform transform = next.parent.after(transform_of(node));
      place(node, transform);
      const auto children = node.find("children");
      for (std::size_t i = children ? children->size() : 0; i-- > 0;)
        push(nodes_.index_of((*children)[i]), (*children)[i], transform);
    }
  }

  void visit_roots() {
    std::vector<std::uint8_t> is_child(nodes_.size(), 0);
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      if (const auto children = nodes_[n].find("children"))
        for (std::size_t i = 0; i < children->size(); ++i) is_child[nodes_.index_of((*children)[i])] = 1;
    for (std::size_t n = 0; n < nodes_.size(); ++n)
      if (!is_child[n]) visit(n, nodes_[n]);
  }

  std::vector<Placement> take() { return std::move(placements_); }

 private:
  struct Waiting {
    std::size_t node;
    Transform parent;
  };

  void push(std::size_t n, const JsonValue& where, const Transform& parent) {
    if (seen_[n]) where.fail("nodes that form trees", "node " + std::to_string(n) + " a second time");
    seen_[n] = 1;
    waiting_.push_back({n, parent});
  }

  void place(const JsonValue& node, const Transform& transform) {
    const auto mesh = node.find("mesh");
    if (!mesh) return;
    if (const auto extensions = node.find("extensions"); extensions && extensions->find("EXT_mesh_gpu_instancing"))
      node.fail("nodes that place a mesh by themselves", "EXT_mesh_gpu_instancing, which is not supported");
    Placement& placement = placements_[meshes_.index_of(*mesh)];
    if (placement.nodes++ > 0) return;
    placement.node_name = node.text_of("name");
    placement.is_skinned = node.find("skin").has_value();
    if (placement.is_skinned) return;
    const std::optional<AffineFrame> frame = AffineFrame::of(transform.axes, transform.origin);
    if (!frame) node.fail("a transform that can be undone", "one that is flat, or not finite");
    placement.frame = *frame;
  }

  JsonList nodes_, meshes_;
  std::vector<std::uint8_t> seen_;
  std::vector<Waiting> waiting_;
  std::vector<Placement> placements_;
};

}  // namespace

std::vector<Placement> read_placements(const JsonValue& root) {
  Walk walk(root);
  const JsonList scenes(root, "scenes");
  const auto shown = root.find("scene");
  if (!shown && scenes.size() == 0) {
    walk.visit_roots();
    return walk.take();
  }
  // Programs show the first scene if none is named.
  const JsonValue scene = shown ? scenes.at(*shown) : scenes[0];
  if (const auto nodes = scene.find("nodes"))
    for (std::size_t i = 0; i < nodes->size(); ++i) walk.visit((*nodes)[i]);
  return walk.take();
}

}  // namespace vdb_offset::io::gltf
