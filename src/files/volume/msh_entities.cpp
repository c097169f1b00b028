// SPDX-License-Identifier: Apache-2.0
// Finds the entities of a volume mesh that Gmsh asks for: corners, curves, patches and the inside, each point in the
// one of the lowest dimension. Edges of patches whose ends both lie on several patches are sorted; an edge that two
// patches or more have belongs to a curve, of the group of these patches. A point on several patches is a corner unless
// just two such edges of one group meet there. Curves are walked from corner to corner; edges that are left are of
// closed curves, which begin at their lowest point. Each patch knows its curves and in which direction its faces run
// along them. All follows from patches and numbers: positions are not looked at.
#include "volume/msh_entities.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace vdb_offset::io {
namespace {

using Index = std::uint32_t;
// Instead of a patch: of points that lie on no patch, and of points that lie on several.
constexpr Index kNoPatch = 0xffffffff, kPatches = 0xfffffffe;

/// Of each point the patch that it lies on; kNoPatch or kPatches if that is not one.
std::vector<Index> patch_of_points(const VolumeMesh& mesh) {
  std::vector<Index> patch_of(mesh.points.size(), kNoPatch);
  for (Index i = 0; i < mesh.patches.size(); ++i)
    for (const Index p : mesh.patches[i].corners)
      patch_of[p] = patch_of[p] == kNoPatch || patch_of[p] == i ? i : kPatches;
  return patch_of;
}

/// An edge of a patch's face.
struct FaceEdge {
  Index low, high, patch;
  bool upwards;  // the face runs from `low` to `high`
  bool same_edge(const FaceEdge& other) const { return low == other.low && high == other.high; }
  bool operator<(const FaceEdge& other) const {
    return std::tie(low, high, patch, upwards) < std::tie(other.low, other.high, other.patch, other.upwards);
  }
};

/// The edges of patches that may belong to several patches, sorted: both ends lie on several.
std::vector<FaceEdge> shared_edges(const VolumeMesh& mesh, const std::vector<Index>& patch_of) {
  std::vector<FaceEdge> edges;
  for (Index i = 0; i < mesh.patches.size(); ++i)
    for (std::size_t f = 0; f < mesh.patches[i].face_count(); ++f) {
      const auto face = mesh.patches[i].face(f);
      for (std::size_t k = 0; k < face.size(); ++k) {
        const Index a = face[k], b = face[(k + 1) % face.size()];
        if (patch_of[a] == kPatches && patch_of[b] == kPatches)
          edges.push_back({std::min(a, b), std::max(a, b), i, a < b});
      }
    }
  std::sort(edges.begin(), edges.end());
  return edges;
}

class EntityFinder {
 public:
  explicit EntityFinder(const VolumeMesh& mesh)
      : mesh_(mesh), patch_of_(patch_of_points(mesh)), face_edges_(shared_edges(mesh, patch_of_)) {}

  MshEntities find() {
    found_.around.resize(mesh_.patches.size());
    found_.on_patch.resize(mesh_.patches.size());
    find_edges();
    find_corners();
    for (std::size_t c = 0; c < found_.corners.size(); ++c) walk_from(found_.corners[c]);
    for (Index e = 0; e < edges_.size(); ++e)
      if (!walked_[e]) {  // part of a closed curve; edges are sorted, so that `low` is its lowest point
        found_.corners.push_back(edges_[e].low);
        walk(edges_[e].low, e);
      }
    find_sides();
    sort_points();
    return std::move(found_);
  }

 private:
  /// An edge on which patches meet. `group` says which ones.
  struct Edge {
    Index low, high, group;
    Index other(Index p) const { return p == low ? high : low; }
  };

  void find_edges() {
    std::map<std::vector<Index>, std::vector<Index>> by_patches;  // edges by the patches that meet there
    for (std::size_t begin = 0, end = 0; begin < face_edges_.size(); begin = end) {
      std::vector<Index> patches;
      for (; end < face_edges_.size() && face_edges_[end].same_edge(face_edges_[begin]); ++end)
        if (patches.empty() || patches.back() != face_edges_[end].patch) patches.push_back(face_edges_[end].patch);
      if (patches.size() < 2) continue;
      by_patches[patches].push_back(static_cast<Index>(edges_.size()));
      edges_.push_back({face_edges_[begin].low, face_edges_[begin].high, 0});
    }
    for (const auto& [patches, edges] : by_patches) {
      for (const Index e : edges) edges_[e].group = static_cast<Index>(found_.groups.size());
      found_.groups.push_back(patches);
    }
    walked_.assign(edges_.size(), false);
    for (Index e = 0; e < edges_.size(); ++e)
      for (const Index p : {edges_[e].low, edges_[e].high}) at_point_.emplace_back(p, e);
    std::sort(at_point_.begin(), at_point_.end());
  }

  /// A point, and an edge that ends there.
  using AtPoint = std::pair<Index, Index>;
  std::pair<std::vector<AtPoint>::const_iterator, std::vector<AtPoint>::const_iterator> edges_at(Index p) const {
    return {std::lower_bound(at_point_.begin(), at_point_.end(), AtPoint(p, 0)),
            std::lower_bound(at_point_.begin(), at_point_.end(), AtPoint(p + 1, 0))};
  }
  bool is_corner(Index p) const {
    const auto [begin, end] = edges_at(p);
    return end - begin != 2 || edges_[begin->second].group != edges_[(begin + 1)->second].group;
  }
  void find_corners() {
    for (Index p = 0; p < patch_of_.size(); ++p)
      if (patch_of_[p] == kPatches && is_corner(p)) found_.corners.push_back(p);
  }

  void walk_from(Index corner) {
    const auto [begin, end] = edges_at(corner);
    for (auto at = begin; at != end; ++at)
      if (!walked_[at->second]) walk(corner, at->second);
  }
  /// Adds the curve that begins at a corner with an edge, up to the next corner.
  void walk(Index start, Index edge) {
    MshEntities::Curve curve{{start}, edges_[edge].group};
    for (Index at = start;;) {
      walked_[edge] = true;
      at = edges_[edge].other(at);
      curve.points.push_back(at);
      if (at == start || is_corner(at)) break;
      const auto next = edges_at(at).first;
      edge = next->second == edge ? (next + 1)->second : next->second;
    }
    found_.curves.push_back(std::move(curve));
  }

  void find_sides() {
    for (Index c = 0; c < found_.curves.size(); ++c) {
      const MshEntities::Curve& curve = found_.curves[c];
      const Index a = curve.points[0], b = curve.points[1];
      for (const Index patch : found_.groups[curve.group])
        found_.around[patch].push_back({c, std::binary_search(face_edges_.begin(), face_edges_.end(),
                                                              FaceEdge{std::min(a, b), std::max(a, b), patch, a < b})});
    }
  }

  void sort_points() {
    for (Index p = 0; p < patch_of_.size(); ++p) {
      if (patch_of_[p] == kNoPatch) found_.inside.push_back(p);
      else if (patch_of_[p] != kPatches) found_.on_patch[patch_of_[p]].push_back(p);
    }
  }

  const VolumeMesh& mesh_;
  std::vector<Index> patch_of_;
  std::vector<FaceEdge> face_edges_;
  std::vector<Edge> edges_;
  std::vector<AtPoint> at_point_;
  std::vector<bool> walked_;
  MshEntities found_;
};

}  // namespace

MshEntities find_entities(const VolumeMesh& mesh) { return EntityFinder(mesh).find(); }

}  // namespace vdb_offset::io
