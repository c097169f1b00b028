// SPDX-License-Identifier: Apache-2.0
#include "valid/proof/certified_faces.h"

#include <tbb/task_arena.h>

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "vdb_offset/shapes.h"

using namespace vdb_offset;

namespace {

constexpr double kAsked = 0.1;

/// Faces over a plane, each of them with three vertices of its own.
class FacesOverPlane {
 public:
  FacesOverPlane() : surface_(plane()), query_(surface_) {}

  struct Corner {
    double height;  ///< In distances.
    double asked = kAsked;
    VertexState state = VertexState::Reached;
  };
  /// A face whose area is half of `width`; `left` is where it begins.
  FacesOverPlane& add(double left, double width, const std::array<Corner, 3>& corners, std::uint32_t source = 0) {
    const auto first = static_cast<std::uint32_t>(source_.size());
    for (const Vec3d& p : {Vec3d(left, 0, 0), Vec3d(left + width, 0, 0), Vec3d(left, 1, 0)}) {
      const Corner& corner = corners[source_.size() - first];
      source_.push_back(p);
      positions_.push_back(p + Vec3d(0, 0, corner.height * kAsked));
      asked_.push_back(corner.asked);
      states_.push_back(corner.state);
    }
    faces_.push_back({{first, first + 1, first + 2}, source});
    return *this;
  }
  CertifiedFaces certified(double tolerance, Corners corners = Corners::Round) const {
    const std::vector<double> tolerances(source_.size(), tolerance * kAsked);
    return certify({query_, surface_, faces_, source_, positions_, asked_, tolerances, states_, corners});
  }

 private:
  /// 0 <= x <= 100, |y| <= 10, seen from above.
  static Surface plane() {
    Polygons mesh;
    mesh.positions = {{0, -10, 0}, {100, -10, 0}, {100, 10, 0}, {0, 10, 0}};
    mesh.add_face({0, 1, 2, 3});
    Surface surface = build_surface(mesh.view(), {});
    to_local_frame(surface, 1);
    return surface;
  }

  Surface surface_;
  ClosestQuery query_;
  std::vector<OffsetFace> faces_;
  std::vector<Vec3d> source_, positions_;
  std::vector<double> asked_;
  std::vector<VertexState> states_;
};

}  // namespace

TEST_CASE("certified: shares are of the area of the faces that move", "[certified]") {
  for (const double side : {1.0, -1.0}) {
    CAPTURE(side);
    const FacesOverPlane::Corner there{side, side * kAsked}, off{1.3 * side, side * kAsked},
        short_of{side, side * kAsked, VertexState::Limited}, mitered{side, side * kAsked, VertexState::Mitered},
        stays{0, 0}, other_side{-side, -side * kAsked};
    FacesOverPlane faces;
    faces.add(1, 1, {there, there, there});
    faces.add(2, 2, {off, off, off});
    faces.add(4, 4, {there, short_of, there});
    faces.add(8, 8, {there, mitered, there});
    faces.add(16, 16, {stays, stays, stays});  // of no area, as it does not move
    const CertifiedFaces result = faces.certified(0.05);
    CHECK(result.there == Approx(11 / 15.0).epsilon(1e-12));
    CHECK(result.certified == Approx(9 / 15.0).epsilon(1e-12));
    CHECK(result.worst_left == Approx(0.3).epsilon(1e-12));
    CHECK(result.worst == result.worst_left);
    const CertifiedFaces loose = faces.certified(0.301);
    CHECK(loose.certified == loose.there);
    CHECK(loose.worst_left == 0);
    // Where the side changes, no tolerance is told: there, and never certified. It is as large as all others together.
    faces.add(40, 15, {there, there, other_side});
    const CertifiedFaces mixed = faces.certified(0.301);
    CHECK(mixed.there == Approx(26 / 30.0).epsilon(1e-12));
    CHECK(mixed.certified == Approx(11 / 30.0).epsilon(1e-12));
    CHECK(mixed.worst_left == 0);
    CHECK(mixed.worst == 0);
    // The worst of all is that of a face that is short, or of one that the surface has not, however small it is.
    const FacesOverPlane::Corner half_way{0.5 * side, side * kAsked, VertexState::Limited},
        far_off{1.7 * side, side * kAsked};
    faces.add(60, 0.001, {there, half_way, there});
    CHECK(faces.certified(0.301).worst == Approx(0.5).epsilon(1e-12));
    faces.add(61, 0.001, {there, far_off, there}, kNone);
    CHECK(faces.certified(0.301).worst == Approx(0.7).epsilon(1e-12));
    CHECK(faces.certified(0.301).worst_left == Approx(0.7).epsilon(1e-12));
  }
}

TEST_CASE("certified: nothing of no faces, and of faces that stay", "[certified]") {
  FacesOverPlane faces;
  for (int i = 0; i < 2; ++i) {
    const CertifiedFaces none = faces.certified(0.1);
    CHECK(none.certified == 0);
    CHECK(none.there == 0);
    CHECK(none.worst_left == 0);
    faces.add(1, 1, {{{0, 0}, {0, 0}, {0, 0}}});
  }
}

TEST_CASE("certified: only miters may be farther, where they keep to their plane", "[certified]") {
  FacesOverPlane faces;
  faces.add(-0.1, 0.1, {{{1}, {1}, {1}}});  // beyond the border of the plane
  CHECK(faces.certified(0.01).certified == 0);
  CHECK(faces.certified(0.01).worst_left > 0.01);
  CHECK(faces.certified(0.01).there == 1);
  CHECK(faces.certified(0.01, Corners::Miter).certified == 1);
  faces.add(-0.1, 0.1, {{{1}, {1.02}, {1}}});
  CHECK(faces.certified(0.01, Corners::Miter).certified < 0.6);
  CHECK(faces.certified(0.021, Corners::Miter).certified == 1);
}

TEST_CASE("certified: the same for any number of threads", "[certified]") {
  const Polygons mesh = shapes::bumpy_sphere(1, 0.2, 1, 3, 4);
  Surface surface = build_surface(mesh.view(), {});
  to_local_frame(surface, 0.05);
  const ClosestQuery query(surface);
  std::vector<Vec3d> source, positions;
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) {
    source.push_back(surface.vertices[v] + surface.origin);
    positions.push_back(source.back() + surface.vertex_normals[v].unit() * kAsked);
  }
  std::vector<OffsetFace> faces;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) faces.push_back({surface.triangles[t], t});
  const std::vector<double> asked(source.size(), kAsked), tolerance(source.size(), 0.001 * kAsked);
  std::vector<VertexState> states(source.size(), VertexState::Reached);
  for (std::size_t v = 0; v < states.size(); v += 50) states[v] = VertexState::Collision;
  std::vector<CertifiedFaces> results;
  for (const int threads : {1, 2, 5})
    tbb::task_arena(threads).execute([&] {
      results.push_back(certify({query, surface, faces, source, positions, asked, tolerance, states, Corners::Round}));
    });
  CAPTURE(results[0].certified, results[0].there);
  CHECK((results[0].certified > 0.1 && results[0].certified < results[0].there && results[0].there < 1));
  for (const CertifiedFaces& result : results) {
    CHECK(result.certified == results[0].certified);
    CHECK(result.there == results[0].there);
    CHECK(result.worst_left == results[0].worst_left);
  }
}
