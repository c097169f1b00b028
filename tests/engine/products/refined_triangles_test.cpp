// SPDX-License-Identifier: Apache-2.0
#include "products/tolerance/refined_triangles.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "ground/mesh/triangulate.h"
#include "space/sheets/sheet_sides.h"
#include "support/oracles.h"
#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

using Corners3 = std::array<std::uint32_t, 3>;

/// A mesh whose triangles are split.
struct SplitMesh {
  explicit SplitMesh(Polygons polygons, const WeldOptions& weld = {})
      : mesh(std::move(polygons)),
        surface(build_surface(mesh.view(), weld)),
        triangles(surface, source_positions(mesh, surface), surface.triangles.size()) {}
  SplitMesh(const SplitMesh&) = delete;

  static std::vector<Vec3d> source_positions(const Polygons& mesh, const Surface& surface) {
    std::vector<Vec3d> positions;
    for (const auto v : surface.representative) positions.push_back(mesh.positions[v]);
    return positions;
  }

  /// Edges with the triangles that they are in, by number.
  std::map<Edge, std::vector<std::uint32_t>> edges() const {
    std::map<Edge, std::vector<std::uint32_t>> result;
    for (std::uint32_t t = 0; t < triangles.triangles().size(); ++t) {
      const Corners3& v = triangles.triangles()[t].vertex;
      for (std::size_t k = 0; k < 3; ++k) result[edge_between(v[k], v[(k + 1) % 3])].push_back(t);
    }
    return result;
  }
  /// Splits the edges that a function of the ends' positions chooses. \returns what split() does
  template <class Choose>
  std::vector<std::uint32_t> split(Choose&& choose) {
    std::vector<Edge> chosen;
    std::vector<SurfacePlace> places;
    std::vector<Vec3d> middles;
    for (const auto& [edge, in] : edges()) {
      const Vec3d &a = triangles.positions()[edge.first], &b = triangles.positions()[edge.second];
      if (!choose(a, b)) continue;
      chosen.push_back(edge);
      places.push_back(triangles.middle(edge, triangles.triangles()[in.back()].source));
      middles.push_back((a + b) / 2.0);
    }
    return triangles.split(chosen, places, middles);
  }
  std::vector<std::uint32_t> split_at_random(double share, std::mt19937& random) {
    return split([&](const Vec3d&, const Vec3d&) { return static_cast<double>(random()) < share * 4294967296.0; });
  }
  Refinement refinement() { return triangles.of_mesh(mesh.view(), numbers); }

  Polygons mesh;
  Surface surface;
  RefinedTriangles triangles;
  RefinedTriangles::Numbers numbers;
};

/// The corners of the surface that a vertex is made of; of one of the source, itself.
std::set<std::uint32_t> made_of(const RefinedTriangles& triangles, std::uint32_t v) {
  if (v < triangles.source_vertices()) return {v};
  std::set<std::uint32_t> corners;
  const SurfacePlace& place = triangles.added()[v - triangles.source_vertices()];
  for (std::size_t k = 0; k < 3; ++k)
    if (place.vertex[k] != kNone) corners.insert(place.vertex[k]);
  return corners;
}

Vec3d twice_area_of(const RefinedTriangles& triangles, const Corners3& v) {
  const auto& at = triangles.positions();
  return (at[v[1]] - at[v[0]]).cross(at[v[2]] - at[v[0]]);
}

/// Pieces lie in their triangle, run the same way round, and cover it.
void require_covered(const SplitMesh& split) {
  const RefinedTriangles& all = split.triangles;
  std::vector<double> area(split.surface.triangles.size(), 0);
  std::size_t outside = 0, turned = 0;
  for (const auto& [vertex, source] : all.triangles()) {
    const Corners3& corners = split.surface.triangles[source];
    for (const auto v : vertex)
      for (const auto w : made_of(all, v)) outside += std::find(corners.begin(), corners.end(), w) == corners.end();
    const Vec3d whole = twice_area_of(all, corners), piece = twice_area_of(all, vertex);
    turned += piece.dot(whole) <= 0;
    area[source] += piece.length();
  }
  CHECK(outside == 0);
  CHECK(turned == 0);
  double worst = 0;
  for (std::size_t t = 0; t < area.size(); ++t)
    worst = std::max(worst, std::abs(area[t] / twice_area_of(all, split.surface.triangles[t]).length() - 1));
  CHECK(worst < 1e-12);
}

/// Edges inside of a triangle have a piece on either side; those along an edge of the source as many as there are
/// triangles at that edge. At a vertex in the middle of a piece's edge neither would hold.
void require_no_gaps(const SplitMesh& split) {
  std::map<Edge, std::size_t> at_edge;
  for (const auto& v : split.surface.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++at_edge[edge_between(v[k], v[(k + 1) % 3])];
  std::size_t gaps = 0;
  for (const auto& [edge, in] : split.edges()) {
    std::set<std::uint32_t> corners = made_of(split.triangles, edge.first);
    corners.merge(made_of(split.triangles, edge.second));
    const bool on_edge = corners.size() == 2;
    gaps += in.size() != (on_edge ? at_edge.at({*corners.begin(), *corners.rbegin()}) : 2);
    for (const auto t : in)
      gaps += !on_edge && split.triangles.triangles()[t].source != split.triangles.triangles()[in[0]].source;
  }
  CHECK(gaps == 0);
}

/// Shares are multiples of a power of two, and tell the position to the last bit, if sums of coordinates are exact.
void require_exact_places(const SplitMesh& split) {
  const RefinedTriangles& all = split.triangles;
  std::size_t wrong = 0, off = 0;
  for (std::size_t i = 0; i < all.added().size(); ++i) {
    const auto& [triangle, vertex, share] = all.added()[i];
    Vec3d position(0.0);
    const Corners3& corners = split.surface.triangles[triangle];
    for (std::size_t k = 0; k < 3; ++k) {
      wrong += std::ldexp(share[k], 20) != std::floor(std::ldexp(share[k], 20)) || share[k] < 0;
      if (vertex[k] == kNone) {
        wrong += k < 2 || share[k] != 0;
        continue;
      }
      wrong += !(share[k] > 0) || std::find(corners.begin(), corners.end(), vertex[k]) == corners.end();
      position += split.triangles.positions()[vertex[k]] * share[k];
    }
    wrong += share[0] + share[1] + share[2] != 1;
    off += position != all.positions()[all.source_vertices() + i];
  }
  CHECK(wrong == 0);
  CHECK(off == 0);
}

/// Three squares that meet at one edge, like pages.
Polygons book() {
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 8}, {8, 0, 0}, {8, 0, 8}, {-8, 4, 0}, {-8, 4, 8}, {-8, -4, 0}, {-8, -4, 8}};
  for (const std::uint32_t page : {2, 4, 6}) mesh.add_face({0, page, page + 1, 1});
  return mesh;
}

/// Whole numbers as coordinates, so that the middle of the middle and so on is exact.
Polygons on_grid(Polygons mesh, double scale) {
  for (Vec3d& p : mesh.positions)
    for (int k = 0; k < 3; ++k) p[k] = std::round(p[k] * scale);
  return mesh;
}

/// A house: a floor of five corners, walls of four, a roof of triangles.
Polygons house() {
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {8, 0, 0}, {12, 8, 0}, {4, 12, 0}, {-4, 8, 0}};
  for (int i = 0; i < 5; ++i) mesh.positions.push_back(mesh.positions[static_cast<std::size_t>(i)] + Vec3d(0, 0, 8));
  mesh.positions.emplace_back(4, 6, 16);
  mesh.positions.emplace_back(100, 100, 100);  // in no face
  mesh.add_face({4, 3, 2, 1, 0});
  for (std::uint32_t i = 0; i < 5; ++i) mesh.add_face({i, (i + 1) % 5, 5 + (i + 1) % 5, 5 + i});
  for (std::uint32_t i = 0; i < 5; ++i) mesh.add_face({5 + i, 5 + (i + 1) % 5, 10});
  return mesh;
}

/// What holds of each refinement of a mesh.
void require_refinement(const Polygons& mesh, const Refinement& refined) {
  const Polygons& polygons = refined.polygons;
  REQUIRE(refined.source_vertices() == mesh.positions.size());
  REQUIRE(refined.parent.size() == polygons.face_count());
  CHECK(std::equal(mesh.positions.begin(), mesh.positions.end(), polygons.positions.begin()));
  CHECK(std::is_sorted(refined.parent.begin(), refined.parent.end()));
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < refined.added.size(); ++i) {
    const VertexOrigin& origin = refined.added[i];
    const auto face = mesh.view().face(origin.face);
    Vec3d position(0.0);
    for (std::size_t k = 0; k < 3; ++k) {
      wrong += std::find(face.begin(), face.end(), origin.vertex[k]) == face.end();
      position += mesh.positions[origin.vertex[k]] * origin.share[k];
    }
    wrong += position != polygons.positions[mesh.positions.size() + i];
    wrong += origin.share[0] + origin.share[1] + origin.share[2] != 1 || !(origin.share[1] > 0);
    wrong += std::set(origin.vertex.begin(), origin.vertex.end()).size() != 3;
  }
  CHECK(wrong == 0);
  // Pieces are their face, or triangles that face the same way and have its area.
  std::vector<Vec3d> area(mesh.face_count(), Vec3d(0.0));
  std::size_t wrong_pieces = 0;
  for (std::size_t f = 0; f < polygons.face_count(); ++f) {
    const auto piece = polygons.view().face(f), whole = mesh.view().face(refined.parent[f]);
    const bool is_whole = std::equal(piece.begin(), piece.end(), whole.begin(), whole.end());
    const Vec3d normal = area_vector(polygons.view(), f);
    wrong_pieces += !is_whole && (piece.size() != 3 || normal.dot(area_vector(mesh.view(), refined.parent[f])) <= 0);
    area[refined.parent[f]] += normal;
    const auto on_face = [&](std::uint32_t v) { return std::find(whole.begin(), whole.end(), v) != whole.end(); };
    for (const auto v : piece) {
      if (v < mesh.positions.size()) {
        wrong_pieces += !on_face(v);
        continue;
      }
      const VertexOrigin& origin = refined.added[v - mesh.positions.size()];
      for (std::size_t k = 0; k < 3; ++k) wrong_pieces += origin.share[k] > 0 && !on_face(origin.vertex[k]);
    }
  }
  CHECK(wrong_pieces == 0);
  double worst = 0;
  for (std::size_t f = 0; f < area.size(); ++f) {
    const Vec3d whole = area_vector(mesh.view(), f);
    worst = std::max(worst, (area[f] - whole).length() / whole.length());
  }
  CHECK(worst < 1e-12);
}

/// Whether each directed edge has one that runs the other way, and none occurs twice.
bool is_closed_and_oriented(const Polygons& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> count;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    for (std::size_t k = 0; k < face.size(); ++k) ++count[{face[k], face[(k + 1) % face.size()]}];
  }
  return std::all_of(count.begin(), count.end(), [&](const auto& one) {
    const auto back = count.find({one.first.second, one.first.first});
    return one.second == 1 && back != count.end();
  });
}

}  // namespace

TEST_CASE("refined triangles: splits keep the surface, without gaps, however edges are chosen", "[refined_triangles]") {
  const std::vector<std::pair<const char*, Polygons>> kMeshes = {
      {"cube", shapes::box(Vec3d(16), 2, true)},
      {"ball", on_grid(shapes::icosphere(1, 1), 1e5)},
      {"open", on_grid(shapes::patch(1, 0.2, 3), 1e5)},
      {"book", book()},
      {"torn", test::torn(shapes::box(Vec3d(16), 1, false))}};
  for (const auto& [name, mesh] : kMeshes)
    for (const double share : {0.02, 0.3, 0.7, 1.0}) {
      CAPTURE(name, share);
      SplitMesh split(mesh);
      std::mt19937 random(1);
      for (int round = 0; round < (share == 1 ? 3 : 5); ++round) {
        const auto before = split.triangles.triangles();
        const auto edges = split.edges().size(), added = split.triangles.added().size();
        const std::vector<std::uint32_t> pieces = split.split_at_random(share, random);
        const auto& after = split.triangles.triangles();
        CHECK(std::is_sorted(pieces.begin(), pieces.end()));
        CHECK(std::adjacent_find(pieces.begin(), pieces.end()) == pieces.end());
        std::size_t wrong = 0;
        for (std::uint32_t t = 0; t < after.size(); ++t) {
          const bool is_piece = std::binary_search(pieces.begin(), pieces.end(), t);
          if (t >= before.size()) wrong += !is_piece;
          else wrong += after[t].source != before[t].source || is_piece == (after[t].vertex == before[t].vertex);
        }
        CHECK(wrong == 0);
        if (share == 1) {
          CHECK(after.size() == 4 * before.size());
          CHECK(split.triangles.added().size() == added + edges);
        }
        require_covered(split);
        require_no_gaps(split);
        require_exact_places(split);
      }
      CHECK(split.triangles.added().size() > 1);
    }
}

TEST_CASE("refined triangles: the middle of an edge is half of what its ends are", "[refined_triangles]") {
  Polygons mesh;
  mesh.positions = {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}};
  mesh.add_face({0, 1, 2});
  SplitMesh split(mesh);
  const auto number = [&](const Vec3d& p) {
    const auto& all = split.triangles.positions();
    return static_cast<std::uint32_t>(std::find(all.begin(), all.end(), p) - all.begin());
  };
  split.split([](const Vec3d&, const Vec3d&) { return true; });
  const std::uint32_t a = number({0, 0, 0}), b = number({8, 0, 0}), c = number({0, 8, 0});
  // From a corner to a middle, along the edge; and from middle to middle, inside.
  const SurfacePlace along = split.triangles.middle(edge_between(a, number({4, 0, 0})), 0);
  CHECK(along.on_edge());
  const SurfacePlace across = split.triangles.middle(edge_between(number({4, 0, 0}), number({4, 4, 0})), 0);
  CHECK(!across.on_edge());
  const auto share = [](const SurfacePlace& place, std::uint32_t v) {
    for (std::size_t k = 0; k < 3; ++k)
      if (place.vertex[k] == v) return place.share[k];
    return 0.0;
  };
  CHECK((share(along, a) == 0.75 && share(along, b) == 0.25));
  CHECK((share(across, a) == 0.25 && share(across, b) == 0.5 && share(across, c) == 0.25));
}

TEST_CASE("refined triangles: a mesh that is not split is itself", "[refined_triangles]") {
  SplitMesh split(house());
  const Refinement refined = split.refinement();
  CHECK(refined.polygons.positions == split.mesh.positions);
  CHECK(refined.polygons.corners == split.mesh.corners);
  CHECK(refined.polygons.face_begin == split.mesh.face_begin);
  CHECK(refined.added.empty());
  require_refinement(split.mesh, refined);
}

TEST_CASE("refined triangles: polygons become triangles in place, and only where they are split",
          "[refined_triangles]") {
  const auto is_on_roof = [](const Vec3d& a, const Vec3d& b) { return std::max(a[2], b[2]) > 8; };
  SplitMesh split(house());
  split.split(is_on_roof);
  split.split(is_on_roof);
  const Refinement roof = split.refinement();
  require_refinement(split.mesh, roof);
  // Floor and walls are as they were, and stand in front.
  for (std::uint32_t f = 0; f < 6; ++f) {
    const auto piece = roof.polygons.view().face(f), face = split.mesh.view().face(f);
    CHECK((roof.parent[f] == f && std::equal(piece.begin(), piece.end(), face.begin(), face.end())));
  }
  CHECK(roof.parent[6] == 6);
  CHECK(roof.polygons.face_count() > 6 + 5 * 4);
  CHECK(is_closed_and_oriented(roof.polygons));
  for (const VertexOrigin& origin : roof.added) CHECK(origin.face >= 6);
  // All that is around a corner of the floor: the faces there are split, and no others.
  SplitMesh corner(house());
  corner.split([](const Vec3d& a, const Vec3d& b) { return a == Vec3d(0.0) || b == Vec3d(0.0); });
  const Refinement around = corner.refinement();
  require_refinement(corner.mesh, around);
  CHECK(is_closed_and_oriented(around.polygons));
  std::vector<int> pieces(corner.mesh.face_count(), 0);
  for (const auto parent : around.parent) ++pieces[parent];
  for (std::size_t f = 0; f < pieces.size(); ++f) {
    const auto face = corner.mesh.view().face(f);
    CHECK((pieces[f] > 1) == (std::find(face.begin(), face.end(), 0U) != face.end()));
  }
}

TEST_CASE("refined triangles: random splits of polygons keep them closed and oriented", "[refined_triangles]") {
  for (const double share : {0.05, 0.3, 0.8}) {
    SplitMesh split(house());
    std::mt19937 random(2);
    for (int round = 0; round < 4; ++round) split.split_at_random(share, random);
    const Refinement refined = split.refinement();
    require_refinement(split.mesh, refined);
    CHECK(refined.added.size() == split.triangles.added().size());
    CHECK(is_closed_and_oriented(refined.polygons));
    std::size_t wrong = 0;
    for (std::size_t v = 0; v < split.numbers.of_vertex.size(); ++v)
      wrong += split.numbers.of_vertex[v] >= refined.polygons.positions.size() ||
               refined.polygons.positions[split.numbers.of_vertex[v]] != split.triangles.positions()[v];
    CHECK(wrong == 0);
  }
}

TEST_CASE("refined triangles: pieces of turned faces run as their face does", "[refined_triangles]") {
  Polygons mesh = shapes::box(Vec3d(16), 1, false);
  std::reverse(mesh.corners.begin() + 4, mesh.corners.begin() + 8);  // the second face
  SplitMesh split(mesh);
  REQUIRE(std::count(split.surface.turned.begin(), split.surface.turned.end(), 1) == 2);
  std::mt19937 random(3);
  for (int round = 0; round < 3; ++round) split.split_at_random(0.5, random);
  require_covered(split);
  const Refinement refined = split.refinement();
  require_refinement(mesh, refined);
  CHECK(std::count(refined.parent.begin(), refined.parent.end(), 1U) > 2);
}

TEST_CASE("refined triangles: faces that repeat one are split as it is, in their own direction",
          "[refined_triangles]") {
  // Every face of a box again: in reverse, and with vertices of its own from another corner on.
  Polygons mesh = shapes::box(Vec3d(16), 1, false);
  const auto count = static_cast<std::uint32_t>(mesh.face_count()),
             own = static_cast<std::uint32_t>(mesh.positions.size());
  for (std::uint32_t f = 0; f < count; ++f) {
    const std::array<std::uint32_t, 4> at{mesh.corners[4 * f], mesh.corners[4 * f + 1], mesh.corners[4 * f + 2],
                                          mesh.corners[4 * f + 3]};
    mesh.add_face({at[3], at[2], at[1], at[0]});
  }
  mesh.positions.insert(mesh.positions.end(), mesh.positions.begin(), mesh.positions.begin() + own);
  for (std::uint32_t f = 0; f < count; ++f)
    mesh.add_face({mesh.corners[4 * f + 1] + own, mesh.corners[4 * f + 2] + own, mesh.corners[4 * f + 3] + own,
                   mesh.corners[4 * f] + own});
  SplitMesh split(mesh);
  REQUIRE(split.surface.repeated.size() == 2 * count);
  for (const auto& triangle : split.triangles.triangles()) CHECK(split.triangles.copies(triangle) == 3);
  std::mt19937 random(5);
  for (int round = 0; round < 3; ++round) split.split_at_random(0.4, random);
  const Refinement refined = split.refinement();
  require_refinement(mesh, refined);
  CHECK(split.triangles.face_count(mesh.face_count()).all == refined.polygons.face_count());
  // The pieces by the positions of their corners, from the least one on, for each copy of a face.
  const auto pieces_of = [&](std::uint32_t face, bool is_reversed) {
    std::set<std::array<Vec3d, 3>> pieces;
    for (std::uint32_t f = 0; f < refined.parent.size(); ++f) {
      if (refined.parent[f] != face) continue;
      const auto corners = refined.polygons.view().face(f);
      REQUIRE(corners.size() == 3);
      std::array<Vec3d, 3> piece;
      for (std::size_t k = 0; k < 3; ++k) piece[k] = refined.polygons.positions[corners[is_reversed ? 2 - k : k]];
      std::rotate(piece.begin(), std::min_element(piece.begin(), piece.end()), piece.end());
      pieces.insert(piece);
    }
    return pieces;
  };
  for (std::uint32_t f = 0; f < count; ++f) {
    const auto pieces = pieces_of(f, false);
    CHECK(pieces.size() > 4);
    CHECK(pieces == pieces_of(count + f, true));
    CHECK(pieces == pieces_of(2 * count + f, false));
  }
  for (std::uint32_t f = 0; f < refined.parent.size(); ++f)
    for (const auto v : refined.polygons.view().face(f))
      if (v < 2 * own) CHECK((v >= own) == (refined.parent[f] >= 2 * count));
}

TEST_CASE("refined triangles: pieces have corners of their own where vertices hang on their face",
          "[refined_triangles]") {
  // A box whose top has two vertices on an edge that the front has not, and the front one that the top has not.
  Polygons mesh = shapes::box(Vec3d(16), 1, false);
  const auto at = [&](const Vec3d& position) {
    const auto found = std::find(mesh.positions.begin(), mesh.positions.end(), position);
    const auto number = static_cast<std::uint32_t>(found - mesh.positions.begin());
    if (number == mesh.positions.size()) mesh.positions.push_back(position);
    return number;
  };
  const double low = mesh.positions[0][0], high = low + 16;
  Polygons hanging;
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.view().face(f);
    const Vec3d normal = area_vector(mesh.view(), f);
    std::vector<std::uint32_t> corners;
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Vec3d from = mesh.positions[face[k]], to = mesh.positions[face[(k + 1) % face.size()]];
      corners.push_back(face[k]);
      if (from[1] != low || to[1] != low || from[2] != high || to[2] != high) continue;
      std::vector<double> shares = normal[2] > 0 ? std::vector<double>{0.25, 0.75} : std::vector<double>{0.5};
      if (from[0] > to[0]) std::reverse(shares.begin(), shares.end());
      for (const double share : shares) corners.push_back(at(Vec3d(low + 16 * share, low, high)));
    }
    hanging.corners.insert(hanging.corners.end(), corners.begin(), corners.end());
    hanging.close_face();
  }
  hanging.positions = mesh.positions;
  SplitMesh split(hanging, WeldOptions::automatic());
  REQUIRE(split.surface.facts.seams.hanging == 3);
  REQUIRE(split.surface.facts.closed());
  std::mt19937 random(6);
  for (int round = 0; round < 4; ++round) {
    const Refinement refined = split.refinement();
    require_refinement(hanging, refined);
    CHECK(split.triangles.face_count(hanging.face_count()).all == refined.polygons.face_count());
    // Welded again, it is closed, edge to edge.
    Polygons welded = refined.polygons;
    const std::vector<std::uint32_t> first = weld_by_position(welded.view(), {});
    for (auto& v : welded.corners) v = first[v];
    CHECK(is_closed_and_oriented(welded));
    // Faces that nothing hangs on are whole at first.
    if (round == 0) CHECK(std::count(refined.parent.begin(), refined.parent.end(), 0U) == 1);
    split.split_at_random(0.5, random);
  }
}

TEST_CASE("refined triangles: at seams each side has vertices of its own, at the same positions",
          "[refined_triangles]") {
  // Every face has corners of its own.
  SplitMesh split(test::torn(shapes::box(Vec3d(16), 1, false)));
  std::mt19937 random(4);
  for (int round = 0; round < 3; ++round) split.split_at_random(0.5, random);
  const Refinement refined = split.refinement();
  require_refinement(split.mesh, refined);
  CHECK(refined.added.size() > split.triangles.added().size());
  std::map<std::uint32_t, std::set<std::uint32_t>> faces_at;
  for (std::size_t f = 0; f < refined.polygons.face_count(); ++f)
    for (const auto v : refined.polygons.view().face(f)) faces_at[v].insert(refined.parent[f]);
  CHECK(std::all_of(faces_at.begin(), faces_at.end(), [](const auto& one) { return one.second.size() == 1; }));
  CHECK(faces_at.size() == refined.polygons.positions.size());
  // Welded again, it is closed.
  Polygons welded = refined.polygons;
  const std::vector<std::uint32_t> first = weld_by_position(welded.view(), {});
  for (auto& v : welded.corners) v = first[v];
  CHECK(is_closed_and_oriented(welded));

  // Two squares that share one end of their edge, and have the other each on its own.
  Polygons squares;
  squares.positions = {{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0}, {16, 0, 0}, {16, 8, 0}, {8, 8, 0}};
  squares.add_face({0, 1, 2, 3});
  squares.add_face({1, 4, 5, 6});
  SplitMesh both(squares);
  both.split([](const Vec3d& a, const Vec3d& b) { return a[0] == 8 && b[0] == 8; });
  const Refinement two = both.refinement();
  require_refinement(squares, two);
  REQUIRE(two.added.size() == 2);
  CHECK(two.polygons.positions[7] == two.polygons.positions[8]);
  CHECK((two.added[0].face == 0 && two.added[1].face == 1));
}
