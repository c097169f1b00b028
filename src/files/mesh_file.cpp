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
#include "document/documents.h"
#include "document/encode.h"
#include "document/mesh_readers.h"
#include "document/new_normals.h"
#include "document/rewrite_in_place.h"
#include "ground/numbers/rounding.h"
#include "vdb_offset/error.h"
#include "vdb_offset/output_files.h"

namespace vdb_offset::io {
namespace {

MeshFile parse(std::string name, Format format, FileBytes bytes, const ReadOptions& how = {}) {
  MeshFile file;
  file.path = std::move(name);
  file.format = format;
  file.bytes = std::move(bytes);
  if (file.text().empty()) throw InvalidInput(file.path + ", byte 0: expected a mesh, got an empty file");
  switch (format) {
    case Format::Obj:
      parse_obj(file);
      break;
    case Format::Off:
      parse_off(file);
      break;
    case Format::Ply:
      parse_ply(file);
      break;
    case Format::Stl:
      parse_stl(file);
      break;
    case Format::ThreeMf:
      parse_3mf(file);
      break;
    case Format::Gltf:
    case Format::Glb:
      parse_gltf(file);
      break;
    case Format::Vtp:
    case Format::Vtk:
    case Format::Vtu:
      parse_vtk(file);
      break;
    case Format::Assimp:
      parse_by_assimp(file);
      break;
    case Format::Step:
    case Format::Iges:
    case Format::Brep:
      parse_cad(file, how.cad);
      break;
    case Format::Vdb:
      parse_vdb(file, how.vdb);
      break;
  }
  return file;
}

/// A format by the ending of its files; the first of each is its name.
struct Ending {
  std::string_view text;
  Format format;
};
constexpr Ending kFormatEndings[] = {
    {"obj", Format::Obj},     {"off", Format::Off},   {"ply", Format::Ply},    {"stl", Format::Stl},
    {"3mf", Format::ThreeMf}, {"gltf", Format::Gltf}, {"glb", Format::Glb},    {"vtp", Format::Vtp},
    {"vtk", Format::Vtk},     {"vtu", Format::Vtu},   {"fbx", Format::Assimp}, {"dae", Format::Assimp},
    {"3ds", Format::Assimp},  {"step", Format::Step}, {"stp", Format::Step},   {"iges", Format::Iges},
    {"igs", Format::Iges},    {"brep", Format::Brep}, {"vdb", Format::Vdb}};

/// The source's own document over other positions.
WrittenDocument rewritten(const MeshFile& source, std::span<const Vec3d> positions, const Rounding& precision,
                          NewNormals normals, const std::string& path) {
  return source.document->rewrite({source, positions, precision, std::move(normals), path});
}

}  // namespace

void use_line_feeds(MeshFile& file) {
  const std::string_view text = file.text();
  if (text.find('\n') != std::string_view::npos || text.find('\r') == std::string_view::npos) return;
  std::string lines(text);
  std::replace(lines.begin(), lines.end(), '\r', '\n');
  file.bytes.show(std::move(lines));
  file.has_carriage_returns = true;
}

Format require_format(const std::string& path, const std::optional<Format>& told) {
  const auto format = told ? told : format_of(path);
  if (!format)
    throw InvalidInput(path +
                       ": expected a name that ends in .obj, .off, .ply, .stl, .3mf, .gltf, .glb, .vtp, .vtk or .vtu "
                       "(or one of these and .gz or .zst)");
  return *format;
}

Format require_written_format(const std::string& path, const std::optional<Format>& told) {
  const Format format = require_format(path, told);
  if (!is_written(format))
    throw InvalidInput(path +
                       ": expected a format that can be written, got one that is read only (.glb has a place for "
                       "what such files hold)");
  return format;
}

std::optional<Format> format_of(std::string_view path) {
  path = without_compression(path);
  const std::size_t dot = path.rfind('.');
  if (dot == std::string_view::npos) return std::nullopt;
  for (const Ending& ending : kFormatEndings)
    if (is_word(path.substr(dot + 1), ending.text)) return ending.format;
  return std::nullopt;
}

const char* name(Format format) {
  return std::find_if(std::begin(kFormatEndings), std::end(kFormatEndings),
                      [&](const Ending& ending) { return ending.format == format; })
      ->text.data();
}

bool is_written(Format format) { return format != Format::Assimp && format != Format::Vdb && !is_cad(format); }

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
  // A document whose faces are others becomes a new file.
  const bool has_rows =
      require_written_format(path, options.format) == source.format && (faces == Faces::Same || !source.document);
  return make_target(path, options, has_rows ? &source : nullptr);
}

Target target_of(const std::string& path, const WriteOptions& options) { return make_target(path, options, nullptr); }

WriteResult write_mesh(const Target& target, const MeshFile& source, std::span<const Vec3d> positions) {
  const auto& [path, format, how_normals, kept] = target;
  const Rounding precision = kept;
  WriteResult result;
  WrittenDocument made;
  if (format == source.format) {
    NewNormals normals;
    if (how_normals == Normals::Recompute) normals = new_normals(source, positions, precision);
    result.disagreeing_normals = normals.disagreeing;
    if (source.document) made = rewritten(source, positions, precision, std::move(normals), path);
    else made.file = rewrite_in_place(source, positions, precision, std::move(normals));
    result.lost = first_names(made.lost);
  } else {
    made.file = convert(source, format, positions, precision, how_normals, result);
  }
  OutputFiles together;
  for (const WrittenDocument::Beside& beside : made.beside) {
    together.add_folders(std::filesystem::path(beside.path).parent_path());
    write_file(beside.path, beside.bytes);
  }
  write_pieces_of(source.path, source.bytes, path, made.file);
  together.commit();
  return result;
}

std::string patched_bytes(const MeshFile& source, std::span<const Vec3d> positions) {
  NewNormals normals = new_normals(source, positions, source.precision);
  if (source.document)
    return join(rewritten(source, positions, source.precision, std::move(normals), source.path).file);
  return join(rewrite_in_place(source, positions, source.precision, std::move(normals)));
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
