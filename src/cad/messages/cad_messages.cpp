// SPDX-License-Identifier: Apache-2.0
#include "messages/cad_messages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace vdb_offset::io {
namespace {

using Numbers = std::array<double, 3>;

void put_texts(Packer& packer, const std::vector<std::string>& texts) {
  packer.value(std::uint64_t{texts.size()});
  for (const std::string& text : texts) packer.text(text);
}

std::vector<std::string> take_texts(Unpacker& unpacker) {
  std::vector<std::string> texts(unpacker.count(sizeof(std::uint64_t)));
  for (std::string& text : texts) text = unpacker.text();
  return texts;
}

void put_distances(Packer& packer, const std::vector<CadFaceDistance>& distances) {
  packer.value(std::uint64_t{distances.size()});
  for (const CadFaceDistance& each : distances) packer.value(each.number).text(each.expression);
}

std::vector<CadFaceDistance> take_distances(Unpacker& unpacker) {
  std::vector<CadFaceDistance> distances(unpacker.count(sizeof(double) + sizeof(std::uint64_t)));
  for (CadFaceDistance& each : distances) {
    each.number = unpacker.value<double>();
    each.expression = unpacker.text();
  }
  return distances;
}

void put_face(Packer& packer, const CadFaceFacts& face) {
  packer.text(face.name).text(face.layer).text(face.solid).text(face.kind).text(face.instance);
  put_texts(packer, face.within);
  packer.value(std::uint8_t{face.colour.has_value()}).value(face.colour.value_or(Numbers{}));
  packer.value(face.u).value(face.v).value(face.body);
}

CadFaceFacts take_face(Unpacker& unpacker) {
  CadFaceFacts face;
  for (std::string* text : {&face.name, &face.layer, &face.solid, &face.kind, &face.instance}) *text = unpacker.text();
  face.within = take_texts(unpacker);
  const bool has_colour = unpacker.value<std::uint8_t>() != 0;
  const auto colour = unpacker.value<Numbers>();
  if (has_colour) face.colour = colour;
  face.u = unpacker.value<std::array<double, 2>>();
  face.v = unpacker.value<std::array<double, 2>>();
  face.body = unpacker.value<std::uint32_t>();
  return face;
}

void require(bool holds, const char* otherwise) {
  if (!holds) throw BadMessage(otherwise);
}

bool is_finite(const Vec3d& v) { return std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z()); }

void require_corners(const std::vector<std::array<std::uint32_t, 3>>& triangles, std::size_t vertices) {
  for (const auto& triangle : triangles)
    for (const std::uint32_t vertex : triangle) require(vertex < vertices, "a triangle of no vertices");
}

void require_edges(const CadMesh& mesh) {
  require(mesh.edge_kinds.size() == mesh.edges.size(), "edges without a kind");
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const auto& edge = mesh.edges[e];
    require(edge[0] < edge[1] && edge[1] < mesh.positions.size(), "an edge of no vertices");
    require(e == 0 || mesh.edges[e - 1] < edge, "edges out of order");
    require(mesh.edge_kinds[e] <= CadEdge::Sharp, "an edge of no kind");
  }
}

void require_whole(const CadMesh& mesh) {
  const std::size_t triangles = mesh.triangles.size();
  require(mesh.positions.size() < kNone && triangles < kNone, "more than can be numbered");
  require(mesh.face_of.size() == triangles && mesh.corner_parameters.size() == 3 * triangles &&
              mesh.corner_normals.size() == 3 * triangles,
          "triangles without all that belongs to them");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) require(vertex < mesh.positions.size(), "a triangle of no vertices");
  for (const std::uint32_t face : mesh.face_of) require(face < mesh.faces.size(), "a triangle of no face");
  require(std::all_of(mesh.positions.begin(), mesh.positions.end(), is_finite) &&
              std::all_of(mesh.corner_normals.begin(), mesh.corner_normals.end(), is_finite),
          "a number that is none");
  for (const auto& uv : mesh.corner_parameters)
    require(std::isfinite(uv[0]) && std::isfinite(uv[1]), "a parameter that is no number");
  require(mesh.deflection > 0 && std::isfinite(mesh.deflection), "a deflection that is no length");
  require(mesh.unit_micrometres > 0 && std::isfinite(mesh.unit_micrometres), "a unit without a length");
  require_edges(mesh);
}

}  // namespace

std::string pack(const ReadCad& read) {
  Packer packer;
  packer.text(read.path).text(read.format).value<CadFineness>(read.meshing);
  packer.value(std::uint64_t{read.meshing.fuses_bodies}).value(read.most_memory);
  return packer.take();
}

ReadCad unpack_read(std::string_view bytes) {
  Unpacker unpacker(bytes);
  ReadCad read;
  read.path = unpacker.text();
  read.format = unpacker.text();
  static_cast<CadFineness&>(read.meshing) = unpacker.value<CadFineness>();
  read.meshing.fuses_bodies = unpacker.value<std::uint64_t>() != 0;
  read.most_memory = unpacker.value<std::uint64_t>();
  unpacker.end();
  return read;
}

std::string pack(const CadMesh& mesh) {
  Packer packer;
  packer.list(mesh.positions).list(mesh.triangles).list(mesh.face_of);
  packer.list(mesh.corner_parameters).list(mesh.corner_normals);
  packer.value(std::uint64_t{mesh.faces.size()});
  for (const CadFaceFacts& face : mesh.faces) put_face(packer, face);
  packer.list(mesh.edges).list(mesh.edge_kinds);
  packer.value(mesh.deflection);
  packer.value(mesh.unit_micrometres).value(std::uint8_t{mesh.has_unit});
  put_texts(packer, mesh.extras);
  put_texts(packer, mesh.remarks);
  return packer.take();
}

CadMesh unpack_mesh(std::string_view bytes) {
  Unpacker unpacker(bytes);
  CadMesh mesh;
  mesh.positions = unpacker.list<Vec3d>();
  mesh.triangles = unpacker.list<std::array<std::uint32_t, 3>>();
  mesh.face_of = unpacker.list<std::uint32_t>();
  mesh.corner_parameters = unpacker.list<std::array<double, 2>>();
  mesh.corner_normals = unpacker.list<Vec3d>();
  constexpr std::size_t kLeastOfFace = 6 * sizeof(std::uint64_t);
  mesh.faces.resize(unpacker.count(kLeastOfFace));
  for (CadFaceFacts& face : mesh.faces) face = take_face(unpacker);
  mesh.edges = unpacker.list<std::array<std::uint32_t, 2>>();
  mesh.edge_kinds = unpacker.list<CadEdge>();
  mesh.deflection = unpacker.value<double>();
  mesh.unit_micrometres = unpacker.value<double>();
  mesh.has_unit = unpacker.value<std::uint8_t>() != 0;
  mesh.extras = take_texts(unpacker);
  mesh.remarks = take_texts(unpacker);
  unpacker.end();
  require_whole(mesh);
  return mesh;
}

std::string pack(const WriteCad& write) {
  Packer packer;
  packer.text(write.format);
  put_distances(packer, write.of_face);
  packer.value(write.distance).value(write.diagonal).value(write.blend).value(write.fit_tolerance);
  packer.value(std::uint8_t{write.thick}).list(write.positions);
  packer.value(std::uint8_t{write.held}).value(write.clearance);
  packer.list(write.obstacle_positions).list(write.obstacle_triangles).value(write.seconds);
  return packer.take();
}

WriteCad unpack_write(std::string_view bytes) {
  Unpacker unpacker(bytes);
  WriteCad write;
  write.format = unpacker.text();
  write.of_face = take_distances(unpacker);
  write.distance = unpacker.value<double>();
  write.diagonal = unpacker.value<double>();
  write.blend = unpacker.value<double>();
  write.fit_tolerance = unpacker.value<double>();
  write.thick = unpacker.value<std::uint8_t>() != 0;
  write.positions = unpacker.list<Vec3d>();
  write.held = unpacker.value<std::uint8_t>() != 0;
  write.clearance = unpacker.value<double>();
  write.obstacle_positions = unpacker.list<Vec3d>();
  write.obstacle_triangles = unpacker.list<std::array<std::uint32_t, 3>>();
  write.seconds = unpacker.value<double>();
  unpacker.end();
  require_corners(write.obstacle_triangles, write.obstacle_positions.size());
  return write;
}

namespace {

/// Its numbers, as they are packed; of one that is constant or not.
template <class Written>
auto counts_of(Written& written) {
  return std::array{&written.kept,    &written.fitted,    &written.swallowed, &written.faceted, &written.missing,
                    &written.samples, &written.triangles, &written.vanished,  &written.held};
}
template <class Written>
auto values_of(Written& written) {
  return std::array{&written.obstacle_gap, &written.least_held, &written.fit_error,  &written.least,
                    &written.most,         &written.volume,     &written.exact_area, &written.flat_area};
}

}  // namespace

std::string pack(const CadWritten& written) {
  Packer packer;
  packer.text(written.bytes).value(written.made);
  for (const std::uint64_t* count : counts_of(written)) packer.value(*count);
  for (const double* value : values_of(written)) packer.value(*value);
  put_texts(packer, written.gaps);
  return packer.take();
}

CadWritten unpack_written(std::string_view bytes) {
  Unpacker unpacker(bytes);
  CadWritten written;
  written.bytes = unpacker.text();
  written.made = unpacker.value<CadMade>();
  require(written.made <= CadMade::Doubtful, "a file of no kind");
  for (std::uint64_t* count : counts_of(written)) *count = unpacker.value<std::uint64_t>();
  for (double* value : values_of(written)) *value = unpacker.value<double>();
  written.gaps = take_texts(unpacker);
  unpacker.end();
  return written;
}

}  // namespace vdb_offset::io
