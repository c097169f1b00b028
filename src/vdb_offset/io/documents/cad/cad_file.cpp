// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/cad_file.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>

#include "vdb_offset/error.h"
#include "vdb_offset/io/base/chunked_output.h"
#include "vdb_offset/io/documents/cad/cad_surface.h"
#include "vdb_offset/output_files.h"

namespace vdb_offset::io {
namespace {

constexpr double kFitShare = 1e-4;  // of the distance

/// The distance of each face of the model, of which some stay. \throw InvalidInput if only a part of one does
std::vector<double> distances_of_faces(const std::string& path, const CadMesh& mesh, double distance,
                                       std::span<const std::uint8_t> only) {
  std::vector<std::optional<double>> found(mesh.faces.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const double here = only[t] ? distance : 0;
    std::optional<double>& of_face = found[mesh.face_of[t]];
    if (of_face && *of_face != here)
      throw InvalidInput(fmt::format("{}: expected whole faces of a CAD model to be offset, got a part of face {}",
                                     path, mesh.face_of[t] + 1));
    of_face = here;
  }
  std::vector<double> of_face;
  of_face.reserve(found.size());
  for (const std::optional<double>& each : found) of_face.push_back(each.value_or(0));
  return of_face;
}

CadFileFacts facts_of(CadWritten&& written) {
  CadFileFacts facts;
  facts.made = written.made == CadMade::Solid    ? CadFileFacts::Made::Solid
               : written.made == CadMade::Shells ? CadFileFacts::Made::Shells
               : written.made == CadMade::Facets ? CadFileFacts::Made::Facets
                                                 : CadFileFacts::Made::Faces;
  facts.kept = written.kept;
  facts.fitted = written.fitted;
  facts.swallowed = written.swallowed;
  facts.missing = written.missing;
  facts.fit_error = written.fit_error;
  facts.samples = written.samples;
  facts.least = written.least;
  facts.most = written.most;
  facts.volume = written.volume;
  facts.gaps = std::move(written.gaps);
  return facts;
}

}  // namespace

bool is_cad_output(const std::string& path) {
  const auto format = format_of(path);
  return format == Format::Step || format == Format::Brep;
}

CadFileFacts write_cad(const std::string& path, const MeshFile& source, double distance,
                       std::span<const Vec3d> positions, const CadWriting& how) {
  const auto* const model = dynamic_cast<const CadSurface*>(source.exact.get());
  if (!model)
    throw InvalidInput(
        fmt::format("{}: expected an input that is a CAD model, for an output that is one, got {}", path, source.path));
  WriteCad write;
  write.format = name(*format_of(path));
  write.distance = distance;
  if (!how.only.empty()) write.of_face = distances_of_faces(path, model->mesh(), distance, how.only);
  write.fit_tolerance = how.fit_tolerance > 0 ? how.fit_tolerance : kFitShare * std::abs(write.distance);
  write.faceted = how.faceted;
  if (how.faceted) {
    write.positions.assign(positions.begin(), positions.end());
    write.triangles = model->mesh().triangles;
  }
  CadWritten written = model->write(write);
  if (written.made == CadMade::Nothing)
    throw Error(
        fmt::format("{}: expected faces of a CAD model that can be offset, got none{}{} (--faceted writes "
                    "triangles)",
                    path, written.gaps.empty() ? "" : ": ", written.gaps.empty() ? "" : written.gaps.front()));
  write_pieces(path, {1, [bytes = std::move(written.bytes)](std::size_t) { return bytes; }});
  return facts_of(std::move(written));
}

}  // namespace vdb_offset::io
