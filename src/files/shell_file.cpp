// SPDX-License-Identifier: Apache-2.0
// Writes a shell of a mesh from a file: in the source's own format in the source's own document, if that takes other
// faces, which strips of triangles do not; else as a new file (derived/convert_shell.cpp). What the target cannot hold
// is named. Nothing is put in place if the source's bytes have changed meanwhile. Faces and positions of the shell are
// taken as they are (see products/shell).
#include "vdb_offset/io/derived_file.h"

#include <fmt/format.h>

#include "bytes/nearest_names.h"
#include "derived/convert_shell.h"
#include "derived/derived_mesh.h"
#include "document/document.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

void require_same_mesh(const MeshFile& source, const Shell& shell) {
  const std::size_t faces = source.polygons.face_count();
  if (shell.source_vertices() == source.polygons.positions.size() &&
      (shell.faces.empty() ? shell.skin_faces() == faces : shell.faces.back() < faces))
    return;
  throw InvalidInput(fmt::format("write_shell: expected a shell of {} vertices and {} faces, got one of {} and {}",
                                 source.polygons.positions.size(), faces, shell.source_vertices(), shell.skin_faces()));
}

}  // namespace

WriteResult write_shell(const Target& target, const MeshFile& source, const Shell& shell) {
  require_same_mesh(source, shell);
  WriteResult result;
  WrittenDocument made;
  if (target.format == source.format && source.document->takes_faces()) {
    const auto derived = std::make_shared<const DerivedMesh>(source, shell, target.precision, target.normals);
    made = derive(derived, target.path);
    result.disagreeing_normals = derived->disagreeing_normals();
    result.lost = first_names(made.lost);
  } else {
    made.file = convert(source, target.format, shell, target.precision, target.normals, result);
  }
  write_document(target.path, source, made);
  return result;
}

WriteResult write_shell(const Target& target, const Shell& shell) {
  WriteResult result;
  write_pieces(target.path, convert(target.format, shell, target.precision, result));
  return result;
}

}  // namespace vdb_offset::io
