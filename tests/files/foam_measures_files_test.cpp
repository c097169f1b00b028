// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <catch2/catch.hpp>
#include <numbers>
#include "products/volume/foam_measures.h"
#include "support/cell_rows.h"
#include "support/volume_meshes.h"
#include "vdb_offset/io/volume_file.h"

using namespace vdb_offset;
using namespace vdb_offset::test;

namespace foam_measures_files {
using namespace vdb_offset::test::cell_rows;
namespace {

/// The number behind a text.
double number_after(const std::string& output, const std::string& text) {
  const std::size_t at = output.find(text);
  REQUIRE(at != std::string::npos);
  return std::atof(output.c_str() + at + text.size());
}

}  // namespace

TEST_CASE("foam cells: non-orthogonality and skewness, by closed forms and by checkMesh", "[foam_cells]") {
  const FoamQuality straight = quality_of(row_of_cells({0, 0, 0}));
  CHECK(straight.wrong_faces == 0);
  CHECK(straight.non_orthogonality == 0);
  CHECK(straight.skewness == Approx(0).margin(1e-14));
  // The far end of the second cell is moved by 2 s: the way between the centres is (1, s, 0), and passes the middle of
  // the face between at s / 2 from it, where the face reaches 1/2 that way.
  const FoamQuality sheared = quality_of(row_of_cells({0, 0, 2}));
  CHECK(sheared.non_orthogonality == Approx(45));
  CHECK(sheared.mean_non_orthogonality == Approx(45));
  CHECK(sheared.non_orthogonal_faces == 0);
  CHECK(sheared.wrong_faces == 0);
  // Worst is the boundary: the far end is 1 wide, and the centre lies 1/2 before it and 1 beside it.
  CHECK(sheared.skewness == Approx(1 / 0.5));
  CHECK(sheared.skew_faces == 0);
  const VolumeMesh steep = row_of_cells({0, 0, 2, 12});
  const FoamQuality beyond = quality_of(steep);
  CHECK(beyond.non_orthogonality == Approx(std::atan(6) * 180 / std::numbers::pi));
  CHECK(beyond.mean_non_orthogonality ==
        Approx(std::acos((std::sqrt(0.5) + 1 / std::sqrt(37)) / 2) * 180 / std::numbers::pi));
  CHECK(beyond.non_orthogonal_faces == 1);
  CHECK(beyond.skewness == Approx(5 / 0.5));
  CHECK(beyond.skew_faces == 1);

  if (!installed("checkMesh")) return;
  const Folder folder;
  const FoamQuality written = *io::write_volume(folder.file("polyMesh"), steep).foam;
  CHECK(written.skewness == beyond.skewness);
  const std::string output = check_mesh_of(folder, "polyMesh");
  INFO(output);
  CHECK(number_after(output, "non-orthogonality Max:") == Approx(beyond.non_orthogonality).epsilon(1e-4));
  CHECK(number_after(output, "average:") == Approx(beyond.mean_non_orthogonality).epsilon(1e-4));
  CHECK(number_after(output, "Max skewness =") == Approx(beyond.skewness).epsilon(1e-4));
}

}  // namespace foam_measures_files
