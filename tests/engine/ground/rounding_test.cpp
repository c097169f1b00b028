// SPDX-License-Identifier: Apache-2.0
#include "ground/numbers/rounding.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <memory>
#include <random>

using namespace vdb_offset;

namespace {

bool is_single(const Vec3d& p) { return p == Vec3d(Rounding(Precision::Kind::Single)(p)); }

Rounding single_in(const std::vector<AffineFrame>& frames, const std::vector<std::uint32_t>& first,
                   const std::vector<Vec3d>& positions) {
  Precision precision{Precision::Kind::Single};
  precision.frames = std::make_shared<const FileFrames>(frames, first, positions);
  return precision;
}

}  // namespace

TEST_CASE("rounding: what the frame of a file keeps of a position, it keeps again", "[rounding]") {
  const double c = std::cos(0.7), s = std::sin(0.7);
  const auto frame = AffineFrame::of({Vec3d(2 * c, 2 * s, 0), Vec3d(-s, c, 0), Vec3d(0, 0, -0.5)}, {5e5, 4e6, 1.0 / 3});
  REQUIRE(frame.has_value());
  CHECK(frame->mirrors());
  std::minstd_rand random(7);
  std::uniform_real_distribution<double> any(-10, 10);
  std::vector<Vec3d> sources;
  for (int i = 0; i < 1000; ++i)
    sources.push_back(frame->to_mesh(Rounding(Precision::Kind::Single)(Vec3d(any(random), any(random), any(random)))));
  const Rounding rounding = single_in({*frame}, {0, 1000}, sources);
  for (const Vec3d& source : sources) {
    CHECK(rounding(source, source) == source);
    const Vec3d moved = source + Vec3d(any(random), any(random), any(random)), kept = rounding(source, moved);
    CHECK((kept - moved).length() < rounding.most_off(moved));
    CHECK(rounding(source, kept) == kept);
    // The numbers that are written, which are those of single precision but for the way to the frame and back.
    const Vec3d written = Rounding(Precision::Kind::Single)(frame->to_file(kept));
    CHECK(frame->to_mesh(written) == kept);
  }
}

TEST_CASE("rounding: vertices of several frames at one position are kept together", "[rounding]") {
  const auto near = AffineFrame::of({Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)}, {1, 0, 0}),
             far = AffineFrame::of({Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)}, {-4096, 0, 0});
  const Vec3d together(0.5, 0, 0), alone(2, 0, 0);
  const Rounding rounding = single_in({*near, *far}, {0, 2, 3}, {together, alone, together});
  const Vec3d kept = rounding(together, Vec3d(0.1, 0.2, 0.3));
  CHECK(is_single(near->to_file(kept)));
  CHECK(is_single(far->to_file(kept)));
  CHECK_FALSE(is_single(far->to_file(rounding(alone, Vec3d(0.1, 0.2, 0.3)))));
  // Of no vertex of the file, nothing is known.
  CHECK(rounding(Vec3d(9, 9, 9), Vec3d(0.1, 0.2, 0.3)) == Vec3d(0.1, 0.2, 0.3));
}

TEST_CASE("rounding: a frame that is flat or not finite is none", "[rounding]") {
  const double infinity = std::numeric_limits<double>::infinity();
  CHECK_FALSE(AffineFrame::of({Vec3d(1, 0, 0), Vec3d(2, 0, 0), Vec3d(0, 0, 1)}, Vec3d(0.0)));
  CHECK_FALSE(AffineFrame::of({Vec3d(1, 0, 0), Vec3d(0, infinity, 0), Vec3d(0, 0, 1)}, Vec3d(0.0)));
  CHECK_FALSE(AffineFrame::of({Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)}, Vec3d(infinity)));
  CHECK(AffineFrame::of({Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)}, Vec3d(0.0))->is_identity());
}
