#include "vdb_offset/winding.h"

#include <algorithm>

namespace vdb_offset {

RayTree::RayTree(const Surface& surface, const std::function<bool(std::size_t)>& is_in) : surface_(surface) {
  tree_.build(surface.triangles.size(), [&](std::size_t t) { return is_in(t) ? box_of(t) : FloatBox{}; });
}

FloatBox RayTree::box_of(std::size_t t) const {
  FloatBox box;
  for (const auto v : surface_.triangles[t]) {
    const Vec3d p = leaned(surface_.vertices[v]);
    for (std::size_t k = 0; k < 3; ++k) {
      box.lower[k] = std::min(box.lower[k], below(p[static_cast<int>(k)]));
      box.upper[k] = std::max(box.upper[k], above(p[static_cast<int>(k)]));
    }
  }
  return box;
}

int RayTree::pass(std::size_t t, const Vec3d& start) const {
  const auto& corner = surface_.triangles[t];
  Vec3d p[3];
  for (std::size_t k = 0; k < 3; ++k) p[k] = leaned(surface_.vertices[corner[k]]) - start;
  int left = 0;
  double weight[3], total = 0, height = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const bool ordered = corner[i] < corner[j];
    const Vec3d &from = ordered ? p[i] : p[j], &to = ordered ? p[j] : p[i];
    const double side = from[0] * to[1] - to[0] * from[1];
    left += (side >= 0) == ordered;
    weight[k] = ordered ? side : -side;
    total += weight[k];
    height += weight[k] * p[k][2];
  }
  if ((left != 0 && left != 3) || total == 0 || !(height / total > 0)) return 0;
  return left == 3 ? 1 : -1;
}

Inside::Inside(const Surface& surface, Orient orient) : rays_(surface), sense_(0) {
  const MeshFacts& facts = surface.facts;
  if (!facts.closed() || !facts.oriented()) return;
  const bool all_wrong =
      orient == Orient::Keep && facts.closed_components > 0 && facts.inside_out_components == facts.closed_components;
  sense_ = all_wrong ? -1 : 1;
}

bool Inside::operator()(const Vec3d& x) const {
  if (sense_ == 0) return false;
  int winding = 0;
  rays_.cast(x, [&](std::size_t, int turn) { winding += turn; });
  return winding * sense_ > 0;
}

}  // namespace vdb_offset
