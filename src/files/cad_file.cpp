// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/cad_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "bytes/chunked_output.h"
#include "cad/cad_surface.h"
#include "ground/mesh/triangulate.h"
#include "ground/system/assert.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

constexpr double kFitShare = 1e-4;  // of the distance

/// Which of the distances each face of the model has; one that stays has none. One that is no wider than a line, and
/// has no triangles, has what the others have, if they have all the same. \throw InvalidInput if a part of one has
/// another than the rest of it
std::vector<std::optional<std::size_t>> rules_of_faces(const std::string& path, const CadMesh& mesh,
                                                       const CadDistances& distances,
                                                       std::span<const std::uint8_t> only) {
  std::vector<std::optional<std::size_t>> rules(mesh.faces.size());
  std::vector<std::uint8_t> is_known(mesh.faces.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::optional<std::size_t> here = distances.of_face.empty() ? 0 : distances.of_face[t];
    if (!only.empty() && !only[t]) here.reset();
    const std::uint32_t face = mesh.face_of[t];
    if (is_known[face] && rules[face] != here)
      throw InvalidInput(fmt::format(
          "{}: expected whole faces of a CAD model to be offset alike, got a part of face {}", path, face + 1));
    rules[face] = here;
    is_known[face] = 1;
  }
  const auto first = static_cast<std::size_t>(std::find(is_known.begin(), is_known.end(), 1) - is_known.begin());
  bool are_alike = first < rules.size();
  for (std::size_t f = 0; f < rules.size(); ++f) are_alike = are_alike && (!is_known[f] || rules[f] == rules[first]);
  if (are_alike) std::fill(rules.begin(), rules.end(), rules[first]);
  return rules;
}

/// The distances as the worker takes them: none of their own where all faces have one number.
std::vector<CadFaceDistance> distances_of_faces(const CadDistances& distances,
                                                std::span<const std::optional<std::size_t>> rules) {
  std::vector<CadFaceDistance> of_faces;
  for (const std::optional<std::size_t>& rule : rules) {
    CadFaceDistance& own = of_faces.emplace_back();
    if (!rule) continue;
    const CadDistance& each = distances.each[*rule];
    own.number = each.number;
    if (each.expression) own.expression = each.expression->text();
  }
  const auto is_first = [&](const CadFaceDistance& own) {
    return own.expression.empty() && own.number == of_faces.front().number;
  };
  if (std::all_of(of_faces.begin(), of_faces.end(), is_first)) of_faces.resize(1);
  return of_faces;
}

CadFileFacts facts_of(CadWritten&& written) {
  CadFileFacts facts;
  facts.made = written.made == CadMade::Solid    ? CadFileFacts::Made::Solid
               : written.made == CadMade::Shells ? CadFileFacts::Made::Shells
               : written.made == CadMade::Hybrid ? CadFileFacts::Made::Hybrid
                                                 : CadFileFacts::Made::Doubtful;
  facts.kept = written.kept;
  facts.fitted = written.fitted;
  facts.swallowed = written.swallowed;
  facts.faceted = written.faceted;
  facts.missing = written.missing;
  facts.triangles = written.triangles;
  const double area = written.exact_area + written.flat_area;
  if (area > 0) facts.exact_share = written.exact_area / area;
  facts.vanished = written.vanished;
  facts.held = written.held;
  facts.least_held = written.least_held;
  if (written.obstacle_gap >= 0) facts.obstacle_gap = written.obstacle_gap;
  facts.fit_error = written.fit_error;
  facts.samples = written.samples;
  facts.least = written.least;
  facts.most = written.most;
  facts.volume = written.volume;
  facts.gaps = std::move(written.gaps);
  return facts;
}

}  // namespace

bool is_cad_output(Format format) { return format == Format::Step || format == Format::Brep; }

CadDistances::CadDistances(double number) : scale(std::abs(number)) { each.push_back({number, {}}); }

std::span<const std::uint32_t> cad_face_of(const MeshFile& source) {
  const auto* const model = dynamic_cast<const CadSurface*>(source.exact.get());
  if (!model) return {};
  return model->mesh().face_of;
}

std::vector<std::uint32_t> cad_body_of(const MeshFile& source) {
  const auto* const model = dynamic_cast<const CadSurface*>(source.exact.get());
  std::vector<std::uint32_t> bodies;
  if (!model) return bodies;
  bodies.reserve(model->mesh().face_of.size());
  for (const std::uint32_t face : model->mesh().face_of) bodies.push_back(model->mesh().faces[face].body);
  return bodies;
}

CadFileFacts write_cad(const std::string& path, const MeshFile& source, const CadDistances& distances,
                       std::span<const Vec3d> positions, const CadWriting& how) {
  const auto* const model = dynamic_cast<const CadSurface*>(source.exact.get());
  if (!model)
    throw InvalidInput(
        fmt::format("{}: expected an input that is a CAD model, for an output that is one, got {}", path, source.path));
  VDB_OFFSET_ASSERT(distances.scale > 0 && !distances.each.empty());
  WriteCad write;
  const std::optional<Format> format = format_of(path) ? format_of(path) : how.format;
  if (!format || !is_cad_output(*format))
    throw InvalidInput(path + ": expected a name that ends in .step, .stp or .brep");
  write.format = name(*format);
  write.of_face = distances_of_faces(distances, rules_of_faces(path, model->mesh(), distances, how.only));
  write.distance = write.is_even() ? write.of_face.front().number : distances.scale;
  write.diagonal = distances.diagonal;
  write.blend = distances.blend;
  write.fit_tolerance = how.fit_tolerance > 0 ? how.fit_tolerance : kFitShare * distances.scale;
  write.thick = how.thick;
  write.held = how.holds_back;
  if (write.held && how.obstacles.face_count() > 0) {
    write.clearance = how.clearance;
    write.obstacle_positions.assign(how.obstacles.positions.begin(), how.obstacles.positions.end());
    for (std::size_t f = 0; f < how.obstacles.face_count(); ++f)
      triangulate(how.obstacles.positions, how.obstacles.face(f), write.obstacle_triangles);
  }
  if (!how.exact) write.positions.assign(positions.begin(), positions.end());
  CadWritten written = model->write(write, how.progress);
  if (written.made == CadMade::Nothing || (how.exact && written.missing > 0))
    throw NoCadModel(fmt::format("{}: expected a CAD model that can be offset{}, got one that cannot: {}", path,
                                 how.exact ? " exactly" : "", fmt::join(written.gaps, "; ")));
  write_pieces(path, {1, [bytes = std::move(written.bytes)](std::size_t) { return bytes; }});
  return facts_of(std::move(written));
}

}  // namespace vdb_offset::io
