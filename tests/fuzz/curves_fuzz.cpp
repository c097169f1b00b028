// SPDX-License-Identifier: Apache-2.0
// A libFuzzer target for files of curves: the first byte chooses the format; whatever the others are, they are refused
// with InvalidInput or are curves that keep the promises of io/curve_file.h. What else is thrown ends the process.

#include <tbb/global_control.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dxf/dxf.h"
#include "fuzz/promise.h"
#include "ground/numbers/rounding.h"
#include "svg/svg.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;

namespace {

std::optional<io::CurveFile> parsed(io::CurveFormat format, const std::string& bytes, const io::CurveReading& how) {
  try {
    return io::parse_curves("fuzz", format, bytes, how);
  } catch (const InvalidInput&) {
    return std::nullopt;
  }
}

constexpr double kCoarse = 0.01;  // share of the diagonal within which curves are flattened

void check_curves(const io::CurveFile& file) {
  const Polygons& curves = file.file.polygons;
  require(!curves.face_begin.empty() && curves.face_begin.front() == 0, "face_begin starts with 0");
  require(curves.face_begin.back() == curves.corners.size(), "face_begin ends with the number of corners");
  require(curves.face_count() > 0, "a file has a curve");
  for (std::size_t f = 0; f < curves.face_count(); ++f)
    require(curves.face_begin[f] < curves.face_begin[f + 1], "a curve has a point");
  for (const auto v : curves.corners) require(v < curves.positions.size(), "corners are indices of points");
  for (const Vec3d& p : curves.positions)
    for (int k = 0; k < 3; ++k)
      require(std::isfinite(p[k]) && (k < 2 || !file.planar || p[k] == 0), "points are finite");
}

std::optional<std::string> rewritten(const io::CurveFile& file, const std::vector<Vec3d>& positions) {
  try {
    return io::rewrite_dxf(file, positions, {});
  } catch (const InvalidInput&) {
    return std::nullopt;  // an INSERT shows something else as well
  }
}

/// Ends that have come near each other are one when they are read again. So points need not be those that were written
/// to the last bit.
void check_dxf(const io::CurveFile& file) {
  std::vector<Vec3d> positions = file.file.polygons.positions;
  require(rewritten(file, positions) == std::string(file.file.text()), "curves that stay keep every byte");
  for (Vec3d& p : positions) p = Vec3d(p[1] / 4, -p[0] / 4, p[2]);
  const std::optional<std::string> moved = rewritten(file, positions);
  if (!moved) return;
  const std::optional<io::CurveFile> back = parsed(io::CurveFormat::Dxf, *moved, {kCoarse, 0});
  require(back.has_value(), "what was written can be read");
  check_curves(*back);
  require(back->file.polygons.positions.size() == positions.size(), "points stay");
  require(back->file.polygons.corners == file.file.polygons.corners, "curves stay");
  Vec3d lower = positions.front(), upper = lower;
  for (const Vec3d& p : positions) {
    lower = openvdb::math::minComponent(lower, p);
    upper = openvdb::math::maxComponent(upper, p);
  }
  const double apart = 2e-6 * std::hypot(upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]);
  for (std::size_t p = 0; p < positions.size(); ++p) {
    const Vec3d off = back->file.polygons.positions[p] - positions[p];
    require(std::hypot(off[0], off[1], off[2]) <= apart, "points are those that were written");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  if (size == 0) return 0;
  constexpr io::CurveFormat kFormats[] = {io::CurveFormat::Obj, io::CurveFormat::Svg, io::CurveFormat::Text,
                                          io::CurveFormat::Dxf};
  const io::CurveFormat format = kFormats[data[0] % 4];
  const std::string bytes(reinterpret_cast<const char*>(data + 1), size - 1);
  // Coarse, so that hostile curves are as quick as others.
  const std::optional<io::CurveFile> file = parsed(format, bytes, {kCoarse, 0});
  if (!file) return 0;
  check_curves(*file);
  if (format == io::CurveFormat::Dxf) {
    check_dxf(*file);
    return 0;
  }
  std::vector<Vec3d> positions = file->file.polygons.positions;
  const auto patched = [&] {
    if (format != io::CurveFormat::Svg) return io::patched_bytes(file->file, positions);
    return io::rewrite_svg(bytes, *file->svg, file->file.polygons.view(), positions, {});
  };
  require(patched() == bytes, "curves that stay keep every byte");
  if (file->svg)
    for (const auto& shape : file->svg->shapes)
      if (shape.to_drawing != io::kSvgIdentity) return 0;  // transforms are undone, which rounds once more
  for (Vec3d& p : positions) p = Vec3d(p[1] / 3, -p[0] / 7, p[2]);
  const std::string moved = patched();
  // Shapes that did not move are as curved as they were.
  const io::CurveReading as_before =
      file->flattened_shapes > 0 ? io::CurveReading{0, file->flattened_to} : io::CurveReading{};
  const std::optional<io::CurveFile> back = parsed(format, moved, as_before);
  require(back.has_value(), "what was written can be read");
  check_curves(*back);
  require(back->file.polygons.corners == file->file.polygons.corners, "curves stay");
  for (std::size_t p = 0; p < positions.size(); ++p)
    require(back->file.polygons.positions[p] == Rounding(file->file.precision)(positions[p]),
            "points are those that were written");
  return 0;
}
