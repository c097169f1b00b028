// SPDX-License-Identifier: Apache-2.0
// Reads what is to be offset.
#include "source.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "messages.h"
#include "request/units.h"
#include "vdb_offset/io/derived_file.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

constexpr double kMicrometresInMm = 1000;

/// Appends a mesh to another one.
void add(Polygons& to, const Polygons& from) {
  const auto first = static_cast<std::uint32_t>(to.positions.size());
  to.positions.insert(to.positions.end(), from.positions.begin(), from.positions.end());
  for (std::size_t f = 0; f < from.face_count(); ++f) {
    for (const auto v : from.view().face(f)) to.corners.push_back(first + v);
    to.close_face();
  }
}

/// Closes the curves with ends near each other. \throw InvalidInput if all curves stay open
void close_curves(const Request& request, Source& source) {
  Curves curves = source.curves->file.polygons;
  try {
    source.closed = vdb_offset::close_curves(curves);
  } catch (const InvalidInput& error) {
    throw InvalidInput(fmt::format("{}: --close: {}", request.input, error.what()));
  }
  if (!source.closed.empty()) source.as_closed = std::move(curves);
}

}  // namespace

bool holds_curves(const std::string& path) {
  try {
    return io::holds_curves(path);
  } catch (const Error&) {
    return false;
  }
}

io::CurveReading curve_reading(const Request& request) {
  io::CurveReading how;
  if (!request.flatten) return how;
  how.flatten_share = request.flatten->percent ? request.flatten->value / 100 : 0;
  how.flatten_length = request.flatten->percent ? 0 : request.flatten->value;
  return how;
}

io::CadReading cad_reading(const Request& request) {
  // Of the distance, and of one for a CAD model, which takes triangles where exact faces fail alone: of 10 public
  // models at 0.5 % these have a tenth of the triangles, which OpenCASCADE takes as much less time to write and to
  // check. And shares of the diagonal that this is not to pass, so that a tiny distance does not make millions of
  // triangles, nor a large one a coarse shape. The bounds are not measured.
  constexpr double kShare = 0.01, kShareForModel = 0.05, kLeast = 2e-5, kMost = 5e-3;
  io::CadReading how;
  how.angle_degrees = request.angle;
  how.seconds = request.cad_seconds;
  how.fuses_bodies = request.fuses_bodies;
  const auto take = [&how](const GivenDistance& length, double factor) {
    const double value = std::abs(length.value) * factor;
    how.deflection = length.percent ? 0 : value;
    if (length.percent) how.deflection_share = value / 100;
  };
  if (request.deflection) {
    take(*request.deflection, 1);
    return how;
  }
  how.least_share = kLeast;
  how.most_share = kMost;
  std::vector<const DistanceRequest*> asked;
  for (const DistanceRequest& each : request.distances) asked.push_back(&each);
  for (const PartDistance& each : request.distances_of) asked.push_back(&each.distance);
  if (request.inner) asked.push_back(&*request.inner);
  if (request.layers)
    for (const LayerLength& each : request.layers->lengths()) asked.push_back(each.asked);
  const GivenDistance* least = nullptr;
  for (const DistanceRequest* each : asked) {
    const GivenDistance& one = each->distance;
    if (!each->from.empty() || one.expression || one.value == 0) continue;
    // A length and a percentage are not compared: the first of them counts.
    if (!least || (one.percent == least->percent && std::abs(one.value) < std::abs(least->value))) least = &one;
  }
  if (least) take(*least, is_cad_output(request.output, request) ? kShareForModel : kShare);
  return how;
}

void write_curves(const std::string& path, const Source& source, std::span<const Vec3d> positions,
                  const io::WriteOptions& options) {
  if (source.as_closed && io::curve_format_of(path) != source.curves->format)
    io::write_curves(path, CurvesView{positions, source.as_closed->corners, source.as_closed->face_begin}, options);
  else io::write_curves(path, *source.curves, positions, options);
}

RefinedSource refined_source(const Source& source, Refinement refinement) {
  RefinedSource refined;
  refined.source.scene = source.scene;
  if (source.file) {
    io::RefinedFile file = io::refine_file(*source.file, refinement);
    refined.source.file = std::move(file.file);
    refined.vertex = std::move(file.vertex);
    refined.lost = std::move(file.lost);
  } else {
    refined.source.scene->shape = refinement.polygons;
  }
  refined.refinement = std::move(refinement);
  return refined;
}

void report_remarks(const io::MeshFile& file) {
  for (const std::string& remark : file.remarks) report_problem(fmt::format("{}: {}", file.path, remark));
}

namespace {

io::ReadOptions reading_of(const std::string& path, const Request& request, const ProgressCallback& progress = {}) {
  io::ReadOptions how{format_of(path, request), cad_reading(request), request.level_set};
  how.cad.progress = progress;
  return how;
}

/// Refuses a mesh beside the source whose file says that its numbers are something else.
void require_same_unit(const Source& source, const std::string& option, const io::MeshFile& file) {
  const std::optional<double> own = source.file ? source.file->unit_micrometres : std::nullopt;
  if (own && file.unit_micrometres && *own != *file.unit_micrometres)
    throw InvalidInput(fmt::format("{}: {}: expected the unit of INPUT ({:g} mm), got another one ({:g} mm)", file.path,
                                   option, *own / kMicrometresInMm, *file.unit_micrometres / kMicrometresInMm));
}

/// Takes the unit that the user says, which counts more than that of the file, and remarks where they differ.
void use_unit(const Request& request, io::MeshFile& file) {
  if (request.unit.empty()) return;
  const double given = *micrometres_of(request.unit);
  if (file.unit_micrometres && *file.unit_micrometres != given)
    file.remarks.push_back(fmt::format("its own unit is {:.6g} mm, and --unit takes it for {:g} mm",
                                       *file.unit_micrometres / kMicrometresInMm, given / kMicrometresInMm));
  file.unit_micrometres = given;
}

/// Adds the files that one which was read names.
void list_named(const io::MeshFile& file, Source& source) {
  for (const auto* const files : {&file.files_beside, &file.files_named})
    source.files_named.insert(source.files_named.end(), files->begin(), files->end());
}

}  // namespace

Source read_source(const Request& request, bool curves, const ProgressCallback& progress) {
  set_memory_limit(request.max_memory);
  Source source;
  if (curves) {
    source.curves = io::read_curves(request.input, curve_reading(request));
    use_unit(request, source.curves->file);
    if (!request.quiet) report_remarks(source.curves->file);
    if (request.close) close_curves(request, source);
    return source;
  }
  if (scene::is_scene(request.input)) source.scene = scene::read_scene(request.input);
  if (!source.scene) source.file = io::read_mesh(request.input, reading_of(request.input, request, progress));
  else if (!source.scene->mesh_path.empty()) {
    source.files_named.push_back(source.scene->mesh_path);
    source.file = io::read_mesh(source.scene->mesh_path, {{}, cad_reading(request), request.level_set});
  }
  if (source.file) {
    use_unit(request, *source.file);
    list_named(*source.file, source);
  }
  if (source.file && !request.quiet) report_remarks(*source.file);
  const auto read_beside = [&](const char* option, const std::string& path) {
    const io::MeshFile beside = io::read_mesh(path, reading_of(path, request));
    require_same_unit(source, option, beside);
    if (!request.quiet) report_remarks(beside);
    list_named(beside, source);
    return beside.polygons;
  };
  for (const std::string& path : request.obstacles) add(source.obstacles, read_beside("--obstacle", path));
  if (!request.fit.empty()) source.to_fit = read_beside("--fit", request.fit);
  if (request.fill && !request.fill->farfield_file.empty())
    source.farfield = read_beside("--farfield", request.fill->farfield_file);
  return source;
}

}  // namespace vdb_offset::tool
