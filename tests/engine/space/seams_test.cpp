// SPDX-License-Identifier: Apache-2.0
#include "space/surface/seams.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "ground/numbers/rounding.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/report.h"
#include "vdb_offset/shapes.h"
#include "vdb_offset/shell.h"

using namespace vdb_offset;

// Names of its own, as tests are compiled several files at once.
namespace seams {
namespace {

constexpr WeldOptions kExact{};

/// The mesh in two pieces, one for faces whose centre has x > `at`, with vertices of their own where they meet.
Polygons cut(const Polygons& mesh, double at) {
  Polygons pieces = mesh;
  std::vector<std::uint32_t> copy(mesh.positions.size(), kNone), used(mesh.positions.size(), 0);
  const auto is_behind = [&](std::size_t f) {
    double sum = 0;
    for (const auto v : mesh.view().face(f)) sum += mesh.positions[v][0] - at;
    return sum > 0;
  };
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    if (!is_behind(f))
      for (const auto v : mesh.view().face(f)) used[v] = 1;
  for (std::size_t f = 0; f < mesh.face_count(); ++f)
    for (std::uint32_t c = mesh.face_begin[f]; is_behind(f) && c < mesh.face_begin[f + 1]; ++c) {
      const std::uint32_t v = mesh.corners[c];
      if (!used[v]) continue;
      if (copy[v] == kNone) {
        copy[v] = static_cast<std::uint32_t>(pieces.positions.size());
        pieces.positions.push_back(mesh.positions[v]);
      }
      pieces.corners[c] = copy[v];
    }
  return pieces;
}

/// A mesh that is cut as by cut(), with each copied vertex moved by `gap` in some direction. The copies stand behind
/// the mesh's own vertices.
Polygons cracked(const Polygons& mesh, double gap, double at = 0) {
  Polygons pieces = cut(mesh, at);
  std::mt19937 random(7);
  for (std::size_t v = mesh.positions.size(); v < pieces.positions.size(); ++v) {
    Vec3d way;
    for (int k = 0; k < 3; ++k) way[k] = static_cast<double>(random()) / 4294967296.0 - 0.5;
    pieces.positions[v] += way * (gap / way.length());
  }
  return pieces;
}

Polygons rounded(Polygons mesh, const Precision& precision) {
  for (Vec3d& p : mesh.positions) p = Rounding(precision)(p);
  return mesh;
}

/// Nothing round about it.
Polygons lump() { return shapes::bumpy_sphere(10, 0.2, 1.5, 3, 3); }

MeshFacts facts_of(const Polygons& mesh, const WeldOptions& weld = WeldOptions::automatic()) {
  return build_surface(mesh.view(), weld).facts;
}

void check_as_exact(const Polygons& mesh) {
  const MeshFacts exact = facts_of(mesh, kExact), found = facts_of(mesh);
  CHECK(found.seams.vertices == 0);
  CHECK(found.welded_vertices == exact.welded_vertices);
  CHECK(found.boundary_edges == exact.boundary_edges);
  CHECK(find_welding(mesh.view(), WeldOptions::automatic()).first == find_welding(mesh.view(), kExact).first);
}

}  // namespace

TEST_CASE("seams: cracks of nothing are closed, and told", "[seams]") {
  const Polygons whole = lump();
  for (const double gap : {1e-30, 1e-13, 1e-10, 1e-9}) {
    const Polygons mesh = cracked(whole, gap);
    const std::size_t copies = mesh.positions.size() - whole.positions.size();
    const std::size_t apart = facts_of(mesh, kExact).welded_vertices - whole.positions.size();
    const MeshFacts found = facts_of(mesh);
    CAPTURE(gap);
    if (gap > 1e-20) CHECK(apart == copies);  // 1 + 1e-30 is 1
    CHECK(found.closed());
    CHECK(found.components == 1);
    CHECK(found.seams.vertices == apart);
    CHECK(found.seams.widest <= 1.1 * gap);
    CHECK(found.seams.near_vertices == 0);
  }
  // Zeros as a computation leaves them.
  Polygons zeros = cut(shapes::box(Vec3d(2), 4, true), 0.1);
  for (std::size_t v = 0; v < zeros.positions.size(); ++v)
    for (int k = 0; k < 3; ++k)
      if (zeros.positions[v][k] == 0) zeros.positions[v][k] = std::pow(10.0, -16.0 - static_cast<double>(v % 18));
  CHECK_FALSE(facts_of(zeros, kExact).closed());
  CHECK(facts_of(zeros).closed());
}

TEST_CASE("seams: the file's precision tells what is one position", "[seams]") {
  const Polygons whole = lump();
  const auto largest = [](const Polygons& mesh) {
    double most = 0;
    for (const Vec3d& p : mesh.positions) most = std::max({most, std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
    return most;
  };
  const Precision single{Precision::Kind::Single}, six{Precision::Kind::Digits, 6};
  const double float_unit = std::ldexp(1.0, std::ilogb(largest(whole)) - 23);
  const double decimal_unit = std::pow(10.0, std::floor(std::log10(largest(whole))) - 5);
  for (const auto& [precision, unit] : {std::pair{single, float_unit}, {six, decimal_unit}}) {
    CAPTURE(unit);
    for (const double units : {0.6, precision.kind == Precision::Kind::Single ? 2.0 : 0.7}) {
      const Polygons mesh = rounded(cracked(whole, units * unit), precision);
      CHECK_FALSE(facts_of(mesh, kExact).closed());
      CHECK(facts_of(mesh).closed());
    }
    // What is clearly more is told alone.
    const MeshFacts apart = facts_of(rounded(cracked(whole, 12 * unit), precision));
    CHECK(apart.seams.vertices == 0);
    CHECK(apart.seams.near_vertices > 0);
    CHECK(apart.seams.widest_near == Approx(12 * unit).epsilon(0.3));
    const double tolerance = MeshFacts::tolerance_above(apart.seams.widest_near);
    CHECK(facts_of(rounded(cracked(whole, 12 * unit), precision), {true, tolerance}).closed());
  }
  // A crack of 1e-4, with coordinates that are as precise as they look, is no rounding.
  CHECK(facts_of(cracked(whole, 1e-4)).seams.vertices == 0);
  WeldOptions told = WeldOptions::automatic();
  told.precision = 1e-5;
  CHECK(facts_of(cracked(whole, 1e-4), told).closed());
}

TEST_CASE("seams: units in the last place, by what numbers look like", "[seams]") {
  CHECK(unit_in_last_place({0.1f, 9.3f, -7.77f}, 9.3f) == std::ldexp(1.0, 3 - 23));
  CHECK(unit_in_last_place({1.23456, 9.87654, 3.14159, 1e-17}, 9.87654) == Approx(5e-6));
  CHECK(unit_in_last_place({12.3456, 9.87654, 3.14159, 1}, 12.3456) == Approx(5e-5));
  CHECK(unit_in_last_place({1, 1, 0.123456, 0.314159, 0.271828}, 1) == Approx(5e-7));
  CHECK(unit_in_last_place({123.456789, 0.000123, 987.654321}, 987.654321) == Approx(5e-7));
  CHECK(unit_in_last_place({1.0 / 3, 9.0 / 7}, 9.0 / 7) == Approx(std::ldexp(1.0, -52)).margin(1e-16));
  // Round numbers, one of which is not: nothing was rounded.
  CHECK(unit_in_last_place({1, 2, 3, 4, 5, 6, 7, 2.00001}, 7) == std::ldexp(1.0, 2 - 23));
  CHECK(unit_in_last_place({1, 2, 3, 400, 500}, 500) == std::ldexp(1.0, 8 - 23));
}

TEST_CASE("seams: nothing is welded that could be meant", "[seams]") {
  SECTION("sheets with a gap") {
    for (const double gap : {1e-3, 1e-5, 1e-7}) {
      Polygons sheets = shapes::patch(1, 0.1, 6);
      const auto count = static_cast<std::uint32_t>(sheets.positions.size());
      const Polygons one = sheets;
      for (const Vec3d& p : one.positions) sheets.positions.push_back(p + Vec3d(0, 0, gap));
      for (std::size_t f = 0; f < one.face_count(); ++f) {
        for (const auto v : one.view().face(f)) sheets.corners.push_back(count + v);
        sheets.close_face();
      }
      check_as_exact(sheets);
    }
  }
  SECTION("sheets on a grid of integers") {
    Polygons sheets;
    for (int z = 0; z < 3; ++z)
      for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 5; ++x) sheets.positions.emplace_back(10 * x, 10 * y, 100 + z);
    for (std::uint32_t z = 0; z < 3; ++z)
      for (std::uint32_t y = 0; y < 4; ++y)
        for (std::uint32_t x = 0; x < 4; ++x) {
          const std::uint32_t v = 25 * z + 5 * y + x;
          sheets.add_face({v, v + 1, v + 6, v + 5});
        }
    check_as_exact(sheets);
  }
  SECTION("bodies that touch at a corner, and sheets that do") {
    Polygons boxes = shapes::box(Vec3d(1), 2, true);
    const Polygons one = boxes;
    const auto count = static_cast<std::uint32_t>(boxes.positions.size());
    for (const Vec3d& p : one.positions) boxes.positions.push_back(p + Vec3d(1 + 1e-16, 1, 1 - 1e-16));
    for (std::size_t f = 0; f < one.face_count(); ++f) {
      for (const auto v : one.view().face(f)) boxes.corners.push_back(count + v);
      boxes.close_face();
    }
    check_as_exact(boxes);
    Polygons leaves;
    leaves.positions = {{0, 0, 0}, {1, 0.3, 0}, {0.3, 1, 0.1}, {1e-15, 0, 0}, {-1, 0.2, 0}, {-0.4, -1, 0.7}};
    leaves.add_face({0, 1, 2});
    leaves.add_face({3, 4, 5});
    check_as_exact(leaves);
  }
  SECTION("a thin slit") {
    const Polygons whole = shapes::patch(1, 0.1, 6);
    check_as_exact(cracked(whole, 1e-6));
  }
  SECTION("whatever is closed") {
    Polygons body = lump();
    check_as_exact(body);
  }
}

TEST_CASE("seams: an offset moves both sides as one, each from its own position", "[seams]") {
  const Polygons whole = lump(), mesh = cracked(whole, 1e-11);
  OffsetOptions options;
  options.distance = 0.3;
  const OffsetResult joined = offset(mesh.view(), options), of_whole = offset(whole.view(), options);
  CHECK(summarise(joined).share_reached == Approx(summarise(of_whole).share_reached).margin(1e-3));
  // Copies stand behind what they are copies of, which they end with.
  for (std::size_t v = 0; v < whole.positions.size(); ++v)
    CHECK((joined.positions[v] - of_whole.positions[v]).length() < 1e-9);
  CHECK(facts_of({joined.positions, mesh.corners, mesh.face_begin}, kExact).closed());
  const CheckResult check = check_offset(mesh.view(), joined.positions, {});
  CHECK(check.valid());
  CHECK(check.torn == 0);
  CHECK(check.facts.seams.vertices > 0);
  CHECK(check_offset(mesh.view(), mesh.positions, {}).torn == 0);  // nothing has moved

  const vdb_offset::Shell shell = shell_of(mesh.view(), joined, options);
  CHECK(shell.facts.closed);
  CHECK(shell.rim.empty());
  CHECK(shell.facts.non_manifold_edges == 0);
  CHECK(shell.facts.source_crossings + shell.facts.crossings_near_source + shell.facts.crossings == 0);

  options.weld = kExact;
  CHECK_FALSE(offset(mesh.view(), options).statistics.facts.closed());
}

TEST_CASE("seams: where a part ends the rest goes on, across a seam or not", "[seams]") {
  const Polygons whole = lump(), mesh = cracked(whole, 1e-11);
  OffsetOptions options;
  options.distance = 0.2;
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    double sum = 0;
    for (const auto v : mesh.view().face(f)) sum += mesh.positions[v][1];
    options.only.push_back(sum > 0);
  }
  const OffsetResult joined = offset(mesh.view(), options), of_whole = offset(whole.view(), options);
  for (std::size_t v = 0; v < whole.positions.size(); ++v)
    CHECK((joined.positions[v] - of_whole.positions[v]).length() < 1e-9);
  CHECK(facts_of({joined.positions, mesh.corners, mesh.face_begin}).closed());
}

TEST_CASE("seams: a captured surface of a cracked body has an inside", "[seams][capture]") {
  IsoOptions options;
  options.distance = 0.5;
  options.grid.voxel_size = 0.6;
  const IsoResult captured = make_iso_surface(cracked(lump(), 1e-10).view(), options);
  CHECK(captured.statistics.is_signed);
  CHECK(captured.statistics.components == 1);
  CHECK(captured.statistics.source.seams.vertices > 0);
}

TEST_CASE("surface: slivers are counted", "[surface]") {
  Polygons mesh = shapes::patch(1, 0.1, 6);
  CHECK(facts_of(mesh).sliver_edges == 0);
  mesh.positions[mesh.corners[1]] = mesh.positions[mesh.corners[0]] + Vec3d(1e-6, 0, 0);
  const MeshFacts facts = facts_of(mesh);
  CHECK(facts.sliver_edges == 1);
  CHECK(facts.longest_sliver == Approx(1e-6));
  CHECK(MeshFacts::tolerance_above(facts.longest_sliver) == Approx(1e-5));
}

TEST_CASE("seams: ends of edges that single precision could not hold are one vertex", "[seams]") {
  Polygons needle;  // its short edge is at the border
  needle.positions = {{0, 0, 0}, {0, 1e-11, 0}, {1, 0, 0.1}, {1, 1, 0}, {0, 1, 0}};
  needle.add_face({0, 2, 1});
  needle.add_face({1, 2, 3, 4});
  CHECK(find_welding(needle.view(), WeldOptions::automatic()).first == std::vector<std::uint32_t>{0, 0, 2, 3, 4});
  Polygons mesh = shapes::icosphere(1, 3);
  const std::size_t count = mesh.positions.size();
  const auto with_edge_of = [&](double length) {
    Polygons changed = mesh;
    const std::uint32_t a = mesh.corners[0], b = mesh.corners[1];
    changed.positions[b] = mesh.positions[a] + (mesh.positions[b] - mesh.positions[a]).unit() * length;
    return facts_of(changed);
  };
  const double longest = 0x1p-24 * facts_of(mesh).diagonal;
  const MeshFacts sliver = with_edge_of(0.9 * longest), edge = with_edge_of(1.1 * longest);
  CHECK(sliver.seams.slivers == 1);
  CHECK(sliver.seams.widest_sliver == Approx(0.9 * longest));
  CHECK(sliver.welded_vertices == count - 1);
  CHECK(sliver.closed());
  CHECK(sliver.sliver_edges == 0);
  CHECK(edge.seams.slivers == 0);
  CHECK(edge.welded_vertices == count);
  // A ball that small beside it has nothing but such edges: it stays a ball.
  for (const Vec3d& p : shapes::icosphere(0.5 * longest, 0).positions) mesh.positions.push_back(p + Vec3d(3, 0, 0));
  const Polygons ball = shapes::icosphere(1, 0);
  for (std::size_t f = 0; f < ball.face_count(); ++f) {
    for (const auto v : ball.view().face(f)) mesh.corners.push_back(static_cast<std::uint32_t>(count + v));
    mesh.close_face();
  }
  CHECK(facts_of(mesh).seams.slivers == 0);
  CHECK(facts_of(mesh).closed_components == 2);
}

}  // namespace seams
