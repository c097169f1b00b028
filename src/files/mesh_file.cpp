// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/mesh_file.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <utility>

#include "bytes/chunked_output.h"
#include "bytes/compression.h"
#include "bytes/nearest_names.h"
#include "bytes/scanner.h"
#include "document/convert.h"
#include "document/document.h"
#include "document/encode.h"
#include "document/format_readers.h"
#include "document/format_table.h"
#include "document/new_normals.h"
#include "document/require_format.h"
#include "ground/numbers/rounding.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

MeshFile parse(std::string name, Format format, FileBytes bytes, const ReadOptions& how = {}) {
  MeshFile file;
  file.path = std::move(name);
  file.format = format;
  file.bytes = std::move(bytes);
  if (file.text().empty()) throw InvalidInput(file.path + ", byte 0: expected a mesh, got an empty file");
  row_of(format).parse(file, how);
  return file;
}

}  // namespace

bool has_rows(const MeshFile& file) { return file.document && file.document->rows(); }

Format require_format(const std::string& path, const std::optional<Format>& given) {
  const auto format = given ? given : format_of(path);
  if (!format)
    throw InvalidInput(path +
                       ": expected a name that ends in .obj, .off, .ply, .stl, .3mf, .gltf, .glb, .vtp, .vtk or .vtu "
                       "(or one of these and .gz or .zst)");
  return *format;
}

Format require_written_format(const std::string& path, const std::optional<Format>& given) {
  const Format format = require_format(path, given);
  if (!is_written(format))
    throw InvalidInput(path +
                       ": expected a format that can be written, got one that is read only (.glb has a place for "
                       "what such files hold)");
  return format;
}

bool is_cad(Format format) { return format == Format::Step || format == Format::Iges || format == Format::Brep; }

MeshFile read_mesh(const std::string& path, std::optional<Format> format) {
  return read_mesh(path, ReadOptions{format, {}});
}

MeshFile read_mesh(const std::string& path, const ReadOptions& options) {
  const Format known = require_format(path, options.format);
  return parse(path, known, FileBytes::open(path), options);
}

MeshFile parse_mesh(const std::string& name, Format format, std::string bytes) {
  return parse(name, format, FileBytes(std::move(bytes)));
}

std::optional<double> unit_micrometres(const std::string& path, std::optional<Format> format) {
  const Format known = require_format(path, format);
  if (is_gltf(known)) return kMetre;
  if (known == Format::Assimp || is_cad(known)) return read_mesh(path, known).unit_micrometres;
  return known == Format::ThreeMf ? unit_of_3mf(path) : std::nullopt;
}

namespace {

Target make_target(const std::string& path, const WriteOptions& options, const MeshFile* rows_of) {
  const Format format = require_written_format(path, options.format);
  const bool text = rows_of ? rows_of->encoding == Encoding::Ascii : is_text(format);
  Precision precision = rows_of ? rows_of->precision : Precision{};
  if (is_single(format) && !rows_of) precision = {Rounding::Kind::Single};
  else if (text && options.digits > 0) precision = {Rounding::Kind::Digits, options.digits};
  precision.rounds_all = !rows_of;
  return {path, format, options.normals, precision};
}

}  // namespace

Target target_of(const std::string& path, const MeshFile& source, const WriteOptions& options, Faces faces) {
  // A document whose faces are others may become a new file.
  const bool keeps_rows =
      require_written_format(path, options.format) == source.format &&
      (faces == Faces::Same || has_rows(source) || (faces == Faces::Shell && source.document->takes_faces()));
  return make_target(path, options, keeps_rows ? &source : nullptr);
}

Target target_of(const std::string& path, const WriteOptions& options) { return make_target(path, options, nullptr); }

void write_document(const std::string& path, const MeshFile& source, const WrittenDocument& made) {
  OutputFiles together;
  for (const WrittenDocument::Beside& beside : made.beside) {
    together.add_folders(std::filesystem::path(beside.path).parent_path());
    write_file(beside.path, beside.bytes);
  }
  write_pieces_of(source.path, source.bytes, path, made.file);
  together.commit();
}

WriteResult write_mesh(const Target& target, const MeshFile& source, std::span<const Vec3d> positions) {
  const auto& [path, format, how_normals, kept] = target;
  const Rounding precision = kept;
  WriteResult result;
  WrittenDocument made;
  if (format == source.format) {
    auto normals = std::make_shared<NewNormals>();
    if (how_normals == Normals::Recompute) *normals = new_normals(source, positions, precision);
    result.disagreeing_normals = normals->disagreeing;
    made = source.document->rewrite({source, positions, precision, std::move(normals), path});
    result.lost = first_names(made.lost);
  } else {
    made.file = convert(source, format, positions, precision, how_normals, result);
  }
  write_document(path, source, made);
  return result;
}

std::string patched_bytes(const MeshFile& source, std::span<const Vec3d> positions) {
  const auto normals = std::make_shared<NewNormals>(new_normals(source, positions, source.precision));
  return join(source.document->rewrite({source, positions, source.precision, normals, source.path}).file);
}

void write_mesh(const Target& target, PolygonView polygons) {
  write_pieces(target.path,
               encode(target.format, std::make_shared<Content>(Content{polygons, target.precision, {}, {}, {}})));
}

void write_mesh(const Target& target, PolygonView source, std::span<const Vec3d> positions) {
  const auto triangles = split_polygons(source);
  write_mesh(target, {positions, source.corners, source.face_begin, triangles});
}

}  // namespace vdb_offset::io
