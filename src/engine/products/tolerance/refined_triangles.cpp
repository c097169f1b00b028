// SPDX-License-Identifier: Apache-2.0
// Keeps the triangles of a surface while their edges are split at the middles, and makes a mesh with faces of them. A
// triangle with one, two or three split edges becomes two, three or four; with two, the quad that is left is divided
// along its shorter diagonal. Both triangles at an edge see one list of split edges, so that all triangles meet edge to
// edge. Of each added vertex is kept in which shares it lies between vertices of the surface. of_mesh() puts the pieces
// of a face in its place, running as the face does, also for faces that repeat it; a face that is not split keeps its
// corners. Vertices of the source keep their numbers, and added ones follow, one for each set of input vertices that
// they lie between. Which edges are split, and where vertices go, is decided elsewhere (refiner.cpp).
#include "products/tolerance/refined_triangles.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "ground/numbers/index_set.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

/// Adds what an end of an edge is made of to a place, at half of its share.
void add_half(SurfacePlace& place, std::uint32_t vertex, double share) {
  if (vertex == kNone || share == 0) return;
  for (std::size_t k = 0; k < 3; ++k) {
    if (place.vertex[k] != vertex && place.vertex[k] != kNone) continue;
    place.vertex[k] = vertex;
    place.share[k] += share / 2;
    return;
  }
  VDB_OFFSET_ASSERT(false);
}

std::uint32_t other_corner(std::span<const std::uint32_t> face, const std::array<std::uint32_t, 3>& ends) {
  const auto other = std::find_if(face.begin(), face.end(), [&](auto v) { return v != ends[0] && v != ends[1]; });
  return other == face.end() ? ends[0] : *other;
}

}  // namespace

RefinedTriangles::RefinedTriangles(const Surface& surface, std::span<const Vec3d> positions, std::size_t count)
    : surface_(&surface), positions_(positions.begin(), positions.end()) {
  triangles_.reserve(count);
  for (std::uint32_t t = 0; t < count; ++t) triangles_.push_back({surface.triangles[t], t});
  if (surface.repeated.empty()) return;
  Indices repeated;
  for (const RepeatedFace& each : surface.repeated) repeated.push_back(each.of);
  std::sort(repeated.begin(), repeated.end());
  for (std::uint32_t t = 0; t < count; ++t) {
    const auto same = std::equal_range(repeated.begin(), repeated.end(), surface.face[t]);
    copies_.push_back(1 + static_cast<std::uint32_t>(same.second - same.first));
  }
}

SurfacePlace RefinedTriangles::middle(const Edge& edge, std::uint32_t source) const {
  SurfacePlace place{source, {kNone, kNone, kNone}, {0, 0, 0}};
  for (const auto end : {edge.first, edge.second}) {
    if (end < source_vertices()) {
      add_half(place, end, 1);
      continue;
    }
    const SurfacePlace& of_end = added_[end - source_vertices()];
    for (std::size_t k = 0; k < 3; ++k) add_half(place, of_end.vertex[k], of_end.share[k]);
  }
  return place;
}

std::vector<std::uint32_t> RefinedTriangles::split(std::span<const Edge> edges, std::span<const SurfacePlace> places,
                                                   std::span<const Vec3d> positions,
                                                   std::vector<std::uint32_t>* split_from) {
  VDB_OFFSET_ASSERT(std::is_sorted(edges.begin(), edges.end()));
  const auto first = static_cast<std::uint32_t>(positions_.size());
  positions_.insert(positions_.end(), positions.begin(), positions.end());
  added_.insert(added_.end(), places.begin(), places.end());
  const std::size_t count = triangles_.size();
  std::vector<std::array<std::uint32_t, 3>> middles(count);  // of the edges behind each corner
  for_each_index(count, [&](std::size_t t) {
    const auto& v = triangles_[t].vertex;
    for (std::size_t k = 0; k < 3; ++k) {
      const Edge edge = edge_between(v[k], v[(k + 1) % 3]);
      const auto at = std::lower_bound(edges.begin(), edges.end(), edge);
      middles[t][k] = at != edges.end() && *at == edge ? first + static_cast<std::uint32_t>(at - edges.begin()) : kNone;
    }
  });
  std::vector<std::uint32_t> pieces;
  const auto put = [&](std::size_t t, std::initializer_list<std::array<std::uint32_t, 3>> some) {
    const std::uint32_t source = triangles_[t].source;
    auto one = some.begin();
    triangles_[t].vertex = *one;
    pieces.push_back(static_cast<std::uint32_t>(t));
    for (++one; one != some.end(); ++one) {
      triangles_.push_back({*one, source});
      if (split_from) split_from->push_back(static_cast<std::uint32_t>(t));
    }
  };
  for (std::size_t t = 0; t < count; ++t) {
    const auto marked = 3 - std::count(middles[t].begin(), middles[t].end(), kNone);
    if (marked == 0) continue;
    // Turned so that the edge behind the first corner has a middle, and of two the one behind the last corner has none.
    std::size_t k = 0;
    while (middles[t][k] == kNone || (marked == 2 && middles[t][(k + 2) % 3] != kNone)) ++k;
    const std::uint32_t a = triangles_[t].vertex[k], b = triangles_[t].vertex[(k + 1) % 3],
                        c = triangles_[t].vertex[(k + 2) % 3], ab = middles[t][k], bc = middles[t][(k + 1) % 3],
                        ca = middles[t][(k + 2) % 3];
    const auto squared = [&](std::uint32_t v, std::uint32_t w) { return (positions_[v] - positions_[w]).lengthSqr(); };
    if (marked == 3) put(t, {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    else if (marked == 1) put(t, {{a, ab, c}, {ab, b, c}});
    else if (squared(a, bc) < squared(ab, c)) put(t, {{ab, b, bc}, {a, ab, bc}, {a, bc, c}});
    else put(t, {{ab, b, bc}, {a, ab, c}, {ab, bc, c}});
  }
  for (std::size_t t = count; t < triangles_.size(); ++t) pieces.push_back(static_cast<std::uint32_t>(t));
  return pieces;
}

/// The first corner of a face of the input that is a vertex of the surface; kNone for one that hangs on its sides.
std::uint32_t RefinedTriangles::corner_of(PolygonView mesh, std::size_t face, std::uint32_t vertex) const {
  for (const auto v : mesh.face(face))
    if (surface_->welded[v] == vertex) return v;
  return kNone;
}

/// Shares of a triangle's corners in a vertex that hangs on one of its sides, the nearest one.
std::array<double, 3> RefinedTriangles::shares_on_side(const std::array<std::uint32_t, 3>& corners,
                                                       std::uint32_t hanging) const {
  std::array<double, 3> shares{0, 0, 0};
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d &from = positions_[corners[k]], along = positions_[corners[(k + 1) % 3]] - from;
    const double share = std::clamp(along.dot(positions_[hanging] - from) / along.lengthSqr(), 0.0, 1.0);
    const double off = (from + along * share - positions_[hanging]).lengthSqr();
    if (!(off < nearest)) continue;
    nearest = off;
    shares = {0, 0, 0};
    shares[k] = 1 - share;
    shares[(k + 1) % 3] = share;
  }
  return shares;
}

/// Where a vertex of a piece lies in the face that it is a piece of: where vertices hang on that face's sides, the
/// surface's triangles have corners that the face has not.
SurfacePlace RefinedTriangles::place_in_face(std::uint32_t vertex, std::uint32_t source) const {
  const SurfacePlace place = vertex < source_vertices() ? SurfacePlace{source, {vertex, kNone, kNone}, {1, 0, 0}}
                                                        : added_[vertex - source_vertices()];
  const SplitTriangle* const whole = surface_->whole_of(source);
  if (!whole) return place;
  const auto corner = [&](std::uint32_t v) { return std::find(whole->corners.begin(), whole->corners.end(), v); };
  const auto hangs = [&](std::uint32_t v) { return v != kNone && corner(v) == whole->corners.end(); };
  if (std::none_of(place.vertex.begin(), place.vertex.end(), hangs)) return place;
  std::array<std::pair<double, std::uint32_t>, 3> shares;
  for (std::size_t j = 0; j < 3; ++j) shares[j] = {0, whole->corners[j]};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t v = place.vertex[k];
    if (v == kNone) continue;
    std::array<double, 3> in_whole{0, 0, 0};
    if (hangs(v)) in_whole = shares_on_side(whole->corners, v);
    else in_whole[static_cast<std::size_t>(corner(v) - whole->corners.begin())] = 1;
    for (std::size_t j = 0; j < 3; ++j) shares[j].first += place.share[k] * in_whole[j];
  }
  // The largest share comes last, as what the others leave of 1: so their sum is 1 exactly.
  std::sort(shares.begin(), shares.end());
  SurfacePlace in_face{source, {kNone, kNone, kNone}, {0, 0, 0}};
  std::size_t count = 0;
  for (const auto& [share, v] : shares) {
    if (!(share > 0)) continue;
    in_face.vertex[count] = v;
    in_face.share[count++] = v == shares[2].second ? 1 - (shares[0].first + shares[1].first) : share;
  }
  return in_face;
}

/// A corner of a piece at a vertex that is no corner of the piece's face: which vertices of the input it is made of
/// there. Several have one position where the input's vertices are welded.
struct RefinedTriangles::AddedCorner {
  std::uint32_t at;                     // the vertex here
  std::array<std::uint32_t, 3> vertex;  // of the input
  std::uint32_t face, source;
  std::size_t corner;

  auto key() const { return std::tie(at, vertex); }
  bool operator<(const AddedCorner& other) const {
    return std::tie(at, vertex, corner) < std::tie(other.at, other.vertex, other.corner);
  }
};

/// The triangles of each face of the mesh; those of the face that it repeats, if it has none of its own for that.
struct RefinedTriangles::ByFace {
  std::vector<std::uint32_t> begin;   // of each face: where its triangles begin in `order`
  std::vector<std::uint32_t> order;   // the triangles, face by face, as they were made
  std::vector<std::uint32_t> before;  // of each face: how many triangles it had before any was split
  std::span<const RepeatedFace> repeated;

  const RepeatedFace* repeats(std::uint32_t face) const {
    const auto at = std::lower_bound(repeated.begin(), repeated.end(), face,
                                     [](const RepeatedFace& each, std::uint32_t f) { return each.face < f; });
    return at != repeated.end() && at->face == face ? &*at : nullptr;
  }
  std::span<const std::uint32_t> of(std::uint32_t face) const {
    const std::uint32_t own = with_triangles(face);
    return std::span(order).subspan(begin[own], begin[own + 1] - begin[own]);
  }
  bool is_split(std::uint32_t face) const { return of(face).size() != before[with_triangles(face)]; }

 private:
  std::uint32_t with_triangles(std::uint32_t face) const {
    const RepeatedFace* const repeated_face = repeats(face);
    return repeated_face ? repeated_face->of : face;
  }
};

RefinedTriangles::ByFace RefinedTriangles::by_face(std::size_t mesh_faces) const {
  ByFace faces{std::vector<std::uint32_t>(mesh_faces + 1, 0), std::vector<std::uint32_t>(triangles_.size()),
               std::vector<std::uint32_t>(mesh_faces, 0), surface_->repeated};
  for (const Triangle& triangle : triangles_) ++faces.begin[face_of(triangle) + 1];
  for (std::size_t f = 0; f < mesh_faces; ++f) faces.begin[f + 1] += faces.begin[f];
  std::vector<std::uint32_t> next(faces.begin.begin(), faces.begin.end() - 1);
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    const std::uint32_t face = face_of(triangles_[t]);
    faces.order[next[face]++] = t;
    // The first piece stands where the triangle stood; what is split at hanging vertices was one triangle, too.
    const SplitTriangle* const whole = surface_->whole_of(triangles_[t].source);
    faces.before[face] += triangles_[t].source == t && (!whole || whole->pieces.front() == t);
  }
  return faces;
}

RefinedTriangles::FaceCount RefinedTriangles::face_count(std::size_t mesh_faces) const {
  const ByFace faces = by_face(mesh_faces);
  FaceCount count{0, std::vector<std::uint32_t>(mesh_faces, 1)};
  for (std::uint32_t f = 0; f < mesh_faces; ++f) {
    const auto triangles = static_cast<std::uint32_t>(faces.of(f).size());
    if (!faces.is_split(f)) count.whole[f] = triangles;
    count.all += faces.is_split(f) ? triangles : 1;
  }
  return count;
}

Refinement RefinedTriangles::of_mesh(PolygonView mesh, Numbers& numbers,
                                     std::vector<std::uint32_t>* triangle_of_face) const {
  const ByFace faces = by_face(mesh.face_count());
  Refinement refinement;
  Polygons& polygons = refinement.polygons;
  polygons.positions.assign(mesh.positions.begin(), mesh.positions.end());
  std::vector<AddedCorner> added;
  const auto close_face = [&](std::uint32_t face, std::uint32_t triangle) {
    polygons.close_face();
    refinement.parent.push_back(face);
    if (triangle_of_face) triangle_of_face->push_back(triangle);
  };
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    if (!faces.is_split(f)) {
      const auto face = mesh.face(f);
      polygons.corners.insert(polygons.corners.end(), face.begin(), face.end());
      close_face(f, kNone);
      continue;
    }
    const RepeatedFace* const repeats = faces.repeats(f);
    for (const std::uint32_t t : faces.of(f)) {
      Triangle piece = triangles_[t];
      if (surface_->is_turned(piece.source) != (repeats && repeats->is_reversed))
        std::swap(piece.vertex[1], piece.vertex[2]);
      add_piece(mesh, f, piece, polygons, added);
      close_face(f, t);
    }
  }
  number_added(mesh, added, refinement, numbers);
  return refinement;
}

/// Adds the corners of a piece of a face, in the face's direction; those that are no corners of the face have no number
/// yet.
void RefinedTriangles::add_piece(PolygonView mesh, std::uint32_t face, Triangle piece, Polygons& polygons,
                                 std::vector<AddedCorner>& added) const {
  for (const auto v : piece.vertex) {
    const std::uint32_t own = v < source_vertices() ? corner_of(mesh, face, v) : kNone;
    if (own == kNone) {
      AddedCorner corner{v, place_in_face(v, piece.source).vertex, face, piece.source, polygons.corners.size()};
      for (std::uint32_t& of : corner.vertex)
        if (of != kNone) of = corner_of(mesh, face, of);
      added.push_back(corner);
    }
    polygons.corners.push_back(own);
  }
}

/// Makes vertices of the refinement of corners that have none: one for each set of the input's vertices that such a
/// corner lies between.
void RefinedTriangles::number_added(PolygonView mesh, std::vector<AddedCorner>& added, Refinement& refinement,
                                    Numbers& numbers) const {
  Polygons& polygons = refinement.polygons;
  tbb::parallel_sort(added.begin(), added.end());
  numbers = {std::vector<std::uint32_t>(positions_.size(), kNone), {}};
  for (std::size_t w = 0; w < source_vertices(); ++w)
    if (w < surface_->representative.size()) numbers.of_vertex[w] = surface_->representative[w];
  for (std::size_t i = 0; i < added.size(); ++i) {
    if (i == 0 || added[i - 1].key() != added[i].key()) {
      const SurfacePlace place = place_in_face(added[i].at, added[i].source);
      VertexOrigin origin{added[i].face, added[i].vertex, place.share};
      // On an edge the third corner counts for nothing; any of the face's will do.
      if (place.on_edge()) origin.vertex[2] = other_corner(mesh.face(origin.face), origin.vertex);
      refinement.added.push_back(origin);
      polygons.positions.push_back(positions_[added[i].at]);
      numbers.of_added.push_back(added[i].at);
    }
    const auto last = static_cast<std::uint32_t>(polygons.positions.size() - 1);
    std::uint32_t& first = numbers.of_vertex[added[i].at];
    if (first == kNone) first = last;
    polygons.corners[added[i].corner] = last;
  }
}

}  // namespace vdb_offset
