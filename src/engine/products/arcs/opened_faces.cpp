// SPDX-License-Identifier: Apache-2.0
// Makes the faces of an opened source. Faces of the mesh take the copies of their corners; then each edge of a ridge
// gets a strip, from the face with the lower number to the one across, and each opened corner its patch. A copy belongs
// to a vertex of the mesh, of which there are several at one place along seams: each of these has copies of its own.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "products/arcs/opened_source.h"

namespace vdb_offset {

/// Makes the faces of an opened source.
class OpenedFaceMaker {
 public:
  explicit OpenedFaceMaker(const OpenedSource& source)
      : source_(source), mesh_(source.mesh_.mesh()), surface_(source.mesh_.surface()) {
    const std::size_t count = mesh_.positions.size();
    made_.refinement.polygons.positions.assign(mesh_.positions.begin(), mesh_.positions.end());
    made_.vertex = surface_.welded;
    made_.is_opened.assign(count, 0);
    made_.targets.displacement.assign(count, Vec3d(0.0));
    made_.targets.state.assign(count, VertexState::Unused);
    own_.assign(count, kNone);
    has_patch_.assign(surface_.vertices.size(), 0);
    for (std::uint32_t v = 0; v < count; ++v) {
      const std::uint32_t w = surface_.welded[v];
      if (w == kNone || source.number_[w] != kNone) continue;
      const bool straight = !source.goes_straight_.empty() && source.goes_straight_[w];
      made_.targets.displacement[v] = straight ? source.straight_[w] : source.plain_.displacement[w];
      made_.targets.state[v] = straight ? VertexState::Reached : source.plain_.state[w];
    }
  }

  OpenedSource::Faces make() {
    triangle_of_face_.assign(mesh_.face_count(), kNone);
    for (std::uint32_t t = 0; t < surface_.triangles.size(); ++t)
      if (surface_.face[t] < triangle_of_face_.size() && on_mesh(t)) triangle_of_face_[surface_.face[t]] = t;
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) add_face_of_mesh(f);
    add_triangles_of_mesh();
    Refinement& refinement = made_.refinement;
    const std::size_t strips = refinement.parent.size();
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) add_strips(f);
    const std::size_t patches = refinement.parent.size();
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) add_patches(f);
    refinement.over_ridges = refinement.parent.size() - strips;
    refinement.over_corners = refinement.parent.size() - patches;
    return std::move(made_);
  }

 private:
  bool on_mesh(std::uint32_t t) const { return surface_.representative[surface_.triangles[t][0]] != kNone; }
  bool is_turned(std::uint32_t face) const {
    return triangle_of_face_[face] != kNone && surface_.is_turned(triangle_of_face_[face]);
  }
  const OpenedVertex* opened(std::uint32_t w) const {
    return w == kNone || source_.number_[w] == kNone ? nullptr : &source_.opened_[source_.number_[w]];
  }

  /// The vertex that a copy of one of the mesh's is; the first that is asked for is that itself.
  std::uint32_t number(std::uint32_t copy, std::uint32_t v, std::uint32_t face) {
    if (own_[v] == kNone) {
      own_[v] = copy;
      set(v, copy);
    }
    if (own_[v] == copy) return v;
    const auto next = static_cast<std::uint32_t>(made_.vertex.size());
    const auto [at, is_new] = number_.try_emplace((std::uint64_t{copy} << 32) | v, next);
    if (is_new) {
      made_.refinement.polygons.positions.push_back(mesh_.positions[v]);
      made_.refinement.added.push_back({face, {v, v, v}, {1, 0, 0}});
      made_.vertex.push_back(surface_.welded[v]);
      made_.is_opened.push_back(0);
      made_.targets.displacement.emplace_back(0.0);
      made_.targets.state.push_back(VertexState::Unused);
      set(next, copy);
    }
    return at->second;
  }
  void set(std::uint32_t number, std::uint32_t copy) {
    made_.is_opened[number] = 1;
    made_.targets.displacement[number] = source_.copies_[copy].displacement;
    made_.targets.state[number] = source_.copies_[copy].state;
  }

  std::uint32_t corner_number(std::uint32_t face, std::uint32_t v) {
    const OpenedVertex* const at = opened(surface_.welded[v]);
    if (!at) return v;
    const RidgeFan& fan = at->fan;
    for (std::size_t i = 0; i < fan.triangles.size(); ++i)
      if (surface_.face[fan.triangles[i]] == face) return number(copy_of(*at, fan.sector[i]), v, face);
    return v;
  }

  void add_face_of_mesh(std::uint32_t f) {
    Polygons& polygons = made_.refinement.polygons;
    for (const std::uint32_t v : mesh_.face(f)) polygons.corners.push_back(corner_number(f, v));
    polygons.close_face();
    made_.refinement.parent.push_back(f);
  }

  void add_triangles_of_mesh() {
    const std::vector<std::uint8_t>& off_part = source_.mesh_.parts().off_part;
    for (std::uint32_t t = 0; t < surface_.triangles.size(); ++t) {
      const std::uint32_t f = surface_.face[t];
      if (!on_mesh(t) || (!off_part.empty() && off_part[t])) continue;
      OffsetFace face{{}, t};
      const auto before = mesh_.face(f), now = made_.refinement.polygons.view().face(f);
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t c = 0; c < before.size(); ++c)
          if (surface_.welded[before[c]] == surface_.triangles[t][k]) face.vertex[k] = now[c];
      made_.triangles.push_back(face);
    }
  }

  void add(std::vector<std::uint32_t> corners, std::uint32_t parent, std::uint32_t triangle) {
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
      made_.triangles.push_back({{corners[0], corners[k], corners[k + 1]}, triangle});
    if (is_turned(parent)) std::reverse(corners.begin() + 1, corners.end());
    Polygons& polygons = made_.refinement.polygons;
    polygons.corners.insert(polygons.corners.end(), corners.begin(), corners.end());
    polygons.close_face();
    made_.refinement.parent.push_back(parent);
  }

  /// The edge of a fan between a triangle of one face and the next one, to another vertex; kNone if it is not open.
  std::size_t edge_of(const OpenedVertex* at, std::uint32_t face, std::uint32_t to, bool is_before) const {
    if (!at) return kNone;
    const RidgeFan& fan = at->fan;
    for (std::size_t i = 0; i < fan.triangles.size(); ++i) {
      const std::uint32_t t = fan.triangles[is_before ? i : fan.next(i)];
      if (fan.is_open[i] && fan.across[i] == to && surface_.face[t] == face) return i;
    }
    return kNone;
  }

  void add_strips(std::uint32_t f) {
    const auto face = mesh_.face(f);
    for (std::size_t c = 0; c < face.size(); ++c) {
      std::uint32_t from = face[c], to = face[(c + 1) % face.size()];
      if (is_turned(f)) std::swap(from, to);
      const std::uint32_t b = surface_.welded[from], w = surface_.welded[to];
      const OpenedVertex *const at_w = opened(w), *const at_b = opened(b);
      const std::size_t i = edge_of(at_w, f, b, true), k = edge_of(at_b, f, w, false);
      if (i == kNone && k == kNone) continue;
      const std::uint32_t t = i != kNone ? at_w->fan.triangles[at_w->fan.next(i)] : at_b->fan.triangles[k];
      if (surface_.face[t] < f) continue;  // the strip stands on the first of its two faces
      std::vector<std::uint32_t> near{to}, far{from};
      if (i != kNone) near = numbers(*at_w, at_w->arc[i], to, f);
      if (k != kNone) {
        far = numbers(*at_b, at_b->arc[k], from, f);
        std::reverse(far.begin(), far.end());
      }
      add_strip(near, far, f, t);
    }
  }
  /// The number of a vertex's copy among all.
  std::uint32_t copy_of(const OpenedVertex& at, std::uint32_t copy) const {
    return source_.first_[source_.number_[at.fan.vertex]] + copy;
  }
  std::vector<std::uint32_t> numbers(const OpenedVertex& at, std::span<const std::uint32_t> copies, std::uint32_t v,
                                     std::uint32_t face) {
    std::vector<std::uint32_t> result;
    for (const std::uint32_t copy : copies) result.push_back(number(copy_of(at, copy), v, face));
    return result;
  }

  /// Faces between the copies at both ends of an edge, from the face that the strip stands on to the one across.
  void add_strip(const std::vector<std::uint32_t>& near, const std::vector<std::uint32_t>& far, std::uint32_t f,
                 std::uint32_t across) {
    const std::size_t n = near.size() - 1, m = far.size() - 1;
    const bool as_quads = n == m && (source_.opening_.quads ||
                                     (mesh_.face(f).size() > 3 && mesh_.face(surface_.face[across]).size() > 3));
    for (std::size_t i = 0, k = 0; i < n || k < m;) {
      if (as_quads) {
        add({near[i], far[i], far[i + 1], near[i + 1]}, f, across);
        ++i, ++k;
      } else if (k < m && (i == n || (k + 1) * n <= (i + 1) * m)) {
        add({near[i], far[k], far[k + 1]}, f, across);
        ++k;
      } else {
        add({near[i], far[k], near[i + 1]}, f, across);
        ++i;
      }
    }
  }

  void add_patches(std::uint32_t f) {
    for (const std::uint32_t v : mesh_.face(f)) {
      const OpenedVertex* const at = opened(surface_.welded[v]);
      if (!at || at->patch.empty() || std::exchange(has_patch_[at->fan.vertex], 1)) continue;
      for (const auto& triangle : at->patch) add(numbers(*at, triangle, v, f), f, at->fan.triangles[0]);
    }
  }

  const OpenedSource& source_;
  PolygonView mesh_;
  const Surface& surface_;
  OpenedSource::Faces made_;
  std::vector<std::uint32_t> own_;  // of each vertex of the mesh: the copy that it is
  std::unordered_map<std::uint64_t, std::uint32_t> number_;
  std::vector<std::uint8_t> has_patch_;  // of each vertex of the surface
  std::vector<std::uint32_t> triangle_of_face_;
};

OpenedSource::Faces OpenedSource::faces() const { return OpenedFaceMaker(*this).make(); }

}  // namespace vdb_offset
