// SPDX-License-Identifier: Apache-2.0
#include "worker/requests.h"

#include <algorithm>
#include <cmath>
#include <new>

#include "ground/process/memory_limit.h"
#include "ground/process/progress.h"
#include "read/fuse_bodies.h"
#include "tessellate/tessellate.h"
#include "write/write_offset.h"

namespace vdb_offset::cad {
namespace {

/// Whether each face has triangles.
bool is_whole(const io::CadMesh& mesh) {
  std::vector<std::uint8_t> has_triangles(mesh.faces.size(), 0);
  for (const std::uint32_t face : mesh.face_of) has_triangles[face] = 1;
  return std::find(has_triangles.begin(), has_triangles.end(), 0) == has_triangles.end();
}

/// \throw std::bad_alloc if OpenCASCADE takes the file for a broken one, and had no memory for it
CadModel read_within_memory(const io::ReadCad& read) {
  try {
    return read_model(read.path, read.format);
  } catch (const InvalidCad&) {
    if (!is_memory_used_up(read.most_memory)) throw;
  }
  throw std::bad_alloc();
}

/// \throw std::bad_alloc if faces have no triangles as there was no memory for them
Tessellation tessellate_within_memory(CadModel& model, const io::CadFineness& fineness) {
  try {
    Tessellation made = tessellate(model, fineness);
    if (is_whole(made.mesh) || !is_memory_short()) return made;
  } catch (const InvalidCad&) {
    if (!is_memory_short()) throw;
  }
  throw std::bad_alloc();
}

}  // namespace

std::string Requests::mesh(const io::ReadCad& read) {
  // Shares that are shown as done. Not measured.
  constexpr double kRead = 0.4, kTessellated = 0.95;
  limit_memory(read.most_memory);
  model_ = read_within_memory(read);
  if (read.meshing.fuses_bodies) fuse_bodies(*model_);
  report_progress(kRead);
  Tessellation tessellation = tessellate_within_memory(*model_, read.meshing);
  const io::CadMesh& mesh = tessellation.mesh;
  meshes_ = std::move(tessellation.bodies);
  report_progress(kTessellated);
  surfaces_.clear();
  for (const Body& body : model_->bodies)
    for (const BodyFace& face : body.faces) surfaces_.push_back({FaceSurface(face.face), 1});
  // Faces may have been turned: the triangles know which side is outward.
  for (std::size_t c = 0; c < mesh.corner_normals.size(); ++c) {
    SidedSurface& face = surfaces_[mesh.face_of[c / 3]];
    const Vec3d& outward = mesh.corner_normals[c];
    const auto normal = face.surface.normal(mesh.corner_parameters[c][0], mesh.corner_parameters[c][1]);
    if (normal) face.side = normal->Dot(gp_Vec(outward.x(), outward.y(), outward.z())) < 0 ? -1 : 1;
  }
  return io::pack(mesh);
}

std::string Requests::distances(std::string_view payload) const {
  Unpacker unpacker(payload);
  const auto points = unpacker.list<io::CadPoint>();
  unpacker.end();
  std::vector<double> errors;
  errors.reserve(points.size());
  for (const io::CadPoint& at : points) {
    if (at.face >= surfaces_.size())
      throw InvalidCad("expected points of " + std::to_string(surfaces_.size()) + " faces, got one of face " +
                       std::to_string(at.face + 1));
    const Foot foot = surfaces_[at.face].surface.foot(gp_Pnt(at.x, at.y, at.z), at.u, at.v);
    errors.push_back(std::abs(std::abs(foot.distance) - std::abs(at.distance)));
  }
  Packer packer;
  packer.list(errors);
  return packer.take();
}

std::string Requests::offset(std::string_view payload) const {
  Unpacker unpacker(payload);
  const auto aims = unpacker.list<io::CadAim>();
  const auto places = unpacker.list<io::CadPlace>();
  unpacker.end();
  std::uint64_t count = 0;
  for (const io::CadAim& aim : aims)
    if ((count += aim.places) > places.size() || aim.places > places.size())
      throw BadMessage("expected a place for each face of a point, got fewer");
  for (const io::CadPlace& place : places)
    if (place.face >= surfaces_.size())
      throw InvalidCad("expected points of " + std::to_string(surfaces_.size()) + " faces, got one of face " +
                       std::to_string(place.face + 1));
  Packer packer;
  packer.list(offset_points(surfaces_, aims, places));
  return packer.take();
}

std::string Requests::answer(io::CadRequest kind, std::string_view payload) {
  if (kind == io::CadRequest::Mesh) return mesh(io::unpack_read(payload));
  if (!model_) throw BadMessage("expected a model first, got another request");
  if (kind == io::CadRequest::Distances) return distances(payload);
  if (kind == io::CadRequest::Offset) return offset(payload);
  if (kind == io::CadRequest::Write) return io::pack(write_offset(*model_, meshes_, io::unpack_write(payload)));
  throw BadMessage("expected a request that is known, got number " + std::to_string(static_cast<std::uint32_t>(kind)));
}

}  // namespace vdb_offset::cad
