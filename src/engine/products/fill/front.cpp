// SPDX-License-Identifier: Apache-2.0
// What layers leave open is bounded by their outermost faces, by faces of the wall that carry no cells, and, where only
// a part of the wall carries layers, by the sides of these. All of them become triangles of the volume mesh's points
// that run counter-clockwise seen from outside of what is left. Where a face of a cell has more than three corners,
// either a pyramid is put on it, whose own sides are in the front then, or the face itself is parted, with the cell
// behind it.
#include "products/fill/front.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "ground/mesh/triangulate.h"
#include "products/fill/check_front.h"
#include "products/fill/put_pyramids.h"
#include "products/volume/cell_faces.h"
#include "products/volume/foam_measures.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

/// The points of a wall by their positions, and those that are added to a mesh where there is none yet.
class WallPoints {
 public:
  WallPoints(const LayersResult& layers, VolumeMesh& volume) : layers_(layers), volume_(volume) {
    for (Index p = 0; p < volume.points.size(); ++p)
      if (volume.point_fields[0].values[p] == 0) known_.try_emplace(key(volume.points[p]), p);
  }

  Index of(Index vertex) {
    const Index first = layers_.welded_to.empty() ? vertex : layers_.welded_to[vertex];
    const Vec3d position = layers_.stacks.of(first == kNone ? vertex : first)[0];
    const auto [found, is_new] = known_.try_emplace(key(position), static_cast<Index>(volume_.points.size()));
    if (is_new) {
      volume_.points.push_back(position);
      for (VolumeField& field : volume_.point_fields) field.values.push_back(0);
    }
    return found->second;
  }

 private:
  using Key = std::array<double, 3>;
  static Key key(const Vec3d& x) { return {x[0], x[1], x[2]}; }

  const LayersResult& layers_;
  VolumeMesh& volume_;
  std::map<Key, Index> known_;
};

/// How faces of the layers are parted: as the wall's own faces are, which the outermost surface is valid with.
class Parting {
 public:
  Parting(PolygonView mesh, const LayersResult& layers, const VolumeMesh& volume)
      : mesh_(mesh), layers_(layers), volume_(volume) {}

  /// The triangles of a face of a cell of the last layer.
  std::vector<std::array<Index, 3>> of(std::span<const Index> face, Index cell) const {
    std::vector<std::array<Index, 3>> of_wall, parts;
    append_triangles(mesh_, static_cast<std::size_t>(volume_.cell_fields[1].values[cell]), of_wall);
    for (const auto& triangle : of_wall) {
      std::array<Index, 3> part;
      for (std::size_t k = 0; k < 3; ++k) part[k] = corner_over(triangle[k], face);
      if (std::ranges::find(part, kNone) != part.end()) break;
      parts.push_back(part);
    }
    if (parts.size() + 2 == face.size()) return along(face, std::move(parts));
    parts.clear();
    triangulate(volume_.points, face, parts);
    return parts;
  }

 private:
  /// The corner of a face that lies over a vertex of the wall; kNone if there is none.
  Index corner_over(Index vertex, std::span<const Index> face) const {
    const Vec3d& top = layers_.stacks.of(vertex).back();
    const auto found = std::ranges::find_if(face, [&](Index p) { return volume_.points[p] == top; });
    return found == face.end() ? kNone : *found;
  }
  /// The triangles as the face runs, which may be against the wall's.
  static std::vector<std::array<Index, 3>> along(std::span<const Index> face, std::vector<std::array<Index, 3>> parts) {
    const auto at = [&](Index p) { return std::ranges::find(face, p) - face.begin(); };
    for (auto& [a, b, c] : parts) {
      const auto i = at(a), j = at(b), k = at(c);
      if (!((i < j && j < k) || (j < k && k < i) || (k < i && i < j))) std::swap(b, c);
    }
    return parts;
  }

  PolygonView mesh_;
  const LayersResult& layers_;
  const VolumeMesh& volume_;
};

class FrontTaker {
 public:
  FrontTaker(FillQuads quads, const Parting& parting, VolumeMesh& volume)
      : quads_(quads), parting_(parting), volume_(volume) {}

  /// Takes all faces of a patch, which then has none.
  void take(BoundaryPatch& patch) {
    for (std::size_t f = 0; f < patch.face_count(); ++f) take(patch.face(f), patch.cell[f]);
    patch.corners.clear();
    patch.face_begin = {0};
    patch.cell.clear();
  }

  /// Takes faces of the wall without cells, whose normals point to what is left if they are not `turned`.
  void take_bare(PolygonView mesh, bool turned, const LayersResult& layers, const LayerCellFacts& facts,
                 const WallNames& names) {
    std::optional<WallPoints> points;
    std::vector<std::array<Index, 3>> triangles;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      if (facts.role[f] != FaceRole::Bare && facts.role[f] != FaceRole::Flat) continue;
      if (!points) points.emplace(layers, volume_);
      triangles.clear();
      append_triangles(mesh, f, triangles);
      for (const auto& [a, b, c] : triangles) {
        std::array<Index, 3> corners = {points->of(a), points->of(c), points->of(b)};
        if (turned) std::swap(corners[1], corners[2]);
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
        front_.triangles.push_back({corners, kNone, names.of_face.empty() ? 0 : names.of_face[f]});
      }
    }
  }

  void put_pyramids() {
    if (!quads_on_.empty()) put_pyramids_on(quads_on_, front_, volume_);
  }

  const std::vector<FrontTriangle>& triangles() const { return front_.triangles; }
  FillFront result() { return std::move(front_); }

 private:
  void take(std::span<const Index> face, Index cell) {
    if (face.size() == 3) return add(face[0], face[1], face[2], cell);
    if (face.size() == 4 && quads_ == FillQuads::Pyramids) {
      quads_on_.push_back({{face[0], face[1], face[2], face[3]}, static_cast<Index>(front_.triangles.size())});
      // Stand for the pyramid until all of the front is known.
      add(face[0], face[1], face[2], cell), add(face[0], face[2], face[3], cell);
      return;
    }
    PartedFace parted{cell, {face.begin(), face.end()}, parting_.of(face, cell)};
    if (face.size() == 4) part_well(parted);
    for (const auto& [a, b, c] : parted.triangles) add(a, b, c, cell);
    front_.parted.push_back(std::move(parted));
  }

  /// Parts a quad along that diagonal beside which the smaller one of both pyramids on the cell's middle is larger.
  /// Along the other one of a bent quad lies a valley: it dents the cell, and fillers put a flat tetrahedron into it.
  void part_well(PartedFace& parted) const {
    constexpr double kEqual = 1 + 1e-9;  // then the wall's own diagonal is taken
    const Vec3d middle = foam_centre(volume_, parted.cell);
    const auto least = [&](const std::vector<std::array<Index, 3>>& triangles) {
      double volume = std::numeric_limits<double>::infinity();
      for (const auto& [a, b, c] : triangles) {
        const Vec3d x = volume_.points[a] - middle, y = volume_.points[b] - middle, z = volume_.points[c] - middle;
        volume = std::min(volume, x.cross(y).dot(z) / 6);
      }
      return volume;
    };
    const auto& q = parted.corners;
    const bool from_first = std::ranges::all_of(
        parted.triangles, [&](const auto& triangle) { return std::ranges::find(triangle, q[0]) != triangle.end(); });
    std::vector<std::array<Index, 3>> others{{q[0], q[1], q[2]}, {q[0], q[2], q[3]}};
    if (from_first) others = {{q[1], q[2], q[3]}, {q[1], q[3], q[0]}};
    if (const double own = least(parted.triangles); least(others) > std::max(own, own * kEqual))
      parted.triangles = std::move(others);
  }

  /// Adds a triangle of the layers' boundary: seen from what is left, it runs the other way round.
  void add(Index a, Index b, Index c, Index cell) { front_.triangles.push_back({{a, c, b}, cell, kNone}); }

  FillQuads quads_;
  const Parting& parting_;
  VolumeMesh& volume_;
  FillFront front_;
  std::vector<QuadOfFront> quads_on_;
};

/// Whether faces of a patch of sides rise from where faces of the wall without layers begin.
bool is_beside_bare(const BoundaryPatch& patch, const std::set<std::array<Index, 2>>& bare) {
  for (std::size_t f = 0; f < patch.face_count(); ++f) {
    const auto face = patch.face(f);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Index a = face[k], b = face[(k + 1) % face.size()];
      if (bare.contains({a, b}) || bare.contains({b, a})) return true;
    }
  }
  return false;
}

}  // namespace

FillFront take_front(PolygonView mesh, const LayersResult& layers, const LayerCellFacts& facts, const WallNames& names,
                     FillQuads quads, VolumeMesh& volume) {
  const Parting parting(mesh, layers, volume);
  FrontTaker taker(quads, parting, volume);
  for (BoundaryPatch& patch : volume.patches)
    if (patch.kind == BoundaryPatch::Kind::Outer) taker.take(patch);
  const std::size_t of_layers = taker.triangles().size();
  taker.take_bare(mesh, layers.heights.back().farthest() < 0, layers, facts, names);
  std::set<std::array<Index, 2>> bare;
  for (const auto& edge : open_edges(std::span(taker.triangles()).subspan(of_layers))) bare.insert(edge);
  for (BoundaryPatch& patch : volume.patches)
    if (patch.kind == BoundaryPatch::Kind::Side && is_beside_bare(patch, bare)) taker.take(patch);
  taker.put_pyramids();
  std::erase_if(volume.patches, [](const BoundaryPatch& patch) {
    return patch.kind != BoundaryPatch::Kind::Wall && patch.face_count() == 0;
  });
  return taker.result();
}

void part_cells(const std::vector<PartedFace>& parted, VolumeMesh& volume) {
  if (parted.empty()) return;
  std::multimap<Index, const PartedFace*> of_cell;
  for (const PartedFace& face : parted) of_cell.emplace(face.cell, &face);
  std::vector<Index> corners;
  std::vector<std::uint64_t> begin{0};
  corners.reserve(volume.corners.size() + 30 * parted.size());
  begin.reserve(volume.cell_begin.size());
  for (std::size_t c = 0; c < volume.cell_count(); ++c) {
    const auto cell = volume.cell(c);
    const auto range = of_cell.equal_range(static_cast<Index>(c));
    const auto first = range.first, last = range.second;
    if (first == last) {
      corners.insert(corners.end(), cell.begin(), cell.end());
    } else {
      const std::size_t at = corners.size();
      corners.push_back(0);
      const auto add = [&](std::span<const Index> face) {
        ++corners[at];
        corners.push_back(static_cast<Index>(face.size()));
        corners.insert(corners.end(), face.begin(), face.end());
      };
      for_each_cell_face(volume.cell_types[c], cell, [&](std::span<const Index> face) {
        const auto is_it = [&](const auto& entry) { return std::ranges::is_permutation(face, entry.second->corners); };
        const auto found = std::find_if(first, last, is_it);
        if (found == last) return add(face);
        for (const auto& triangle : found->second->triangles) add(triangle);
      });
      volume.cell_types[c] = CellType::Polyhedron;
    }
    begin.push_back(corners.size());
  }
  volume.corners = std::move(corners);
  volume.cell_begin = std::move(begin);
}

}  // namespace vdb_offset
