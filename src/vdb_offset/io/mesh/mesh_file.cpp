// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/mesh_file.h"

#include <algorithm>
#include <utility>

#include "vdb_offset/base/rounding.h"
#include "vdb_offset/error.h"
#include "vdb_offset/io/base/chunked_output.h"
#include "vdb_offset/io/base/compression.h"
#include "vdb_offset/io/base/scanner.h"
#include "vdb_offset/io/mesh/convert.h"
#include "vdb_offset/io/mesh/encode.h"
#include "vdb_offset/io/mesh/new_normals.h"
#include "vdb_offset/io/mesh/read/mesh_readers.h"
#include "vdb_offset/io/mesh/rewrite_in_place.h"

namespace vdb_offset::io {
namespace {

MeshFile parse(std::string name, Format format, FileBytes bytes) {
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
  }
  return file;
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
                       ": expected a name that ends in .obj, .off, .ply or .stl (or one of these and .gz or .zst)");
  return *format;
}

std::optional<Format> format_of(std::string_view path) {
  path = without_compression(path);
  const std::size_t dot = path.rfind('.');
  if (dot == std::string_view::npos) return std::nullopt;
  for (const Format format : {Format::Obj, Format::Off, Format::Ply, Format::Stl})
    if (is_word(path.substr(dot + 1), name(format))) return format;
  return std::nullopt;
}

const char* name(Format format) {
  constexpr const char* kNames[] = {"obj", "off", "ply", "stl"};
  return kNames[static_cast<std::size_t>(format)];
}

MeshFile read_mesh(const std::string& path, std::optional<Format> format) {
  const Format known = require_format(path, format);
  return parse(path, known, FileBytes::open(path));
}

MeshFile parse_mesh(const std::string& name, Format format, std::string bytes) {
  return parse(name, format, FileBytes(std::move(bytes)));
}

Precision precision_of(const std::string& path, const MeshFile& source, const WriteOptions& options) {
  const Format format = require_format(path, options.format);
  const bool same = format == source.format;
  const bool text = same ? source.encoding == Encoding::Ascii : format != Format::Ply;
  Precision precision = same ? source.precision : Precision{};
  if (format == Format::Stl && !same) precision = {Rounding::Kind::Single};
  else if (text && options.digits > 0) precision = {Rounding::Kind::Digits, options.digits};
  precision.rounds_all = !same;
  return precision;
}

WriteResult write_mesh(const std::string& path, const MeshFile& source, std::span<const Vec3d> positions,
                       const WriteOptions& options) {
  const Format format = require_format(path, options.format);
  const Rounding precision = precision_of(path, source, options);
  WriteResult result;
  Pieces pieces;
  if (format == source.format) {
    NewNormals normals;
    if (options.normals == Normals::Recompute) normals = new_normals(source, positions, precision);
    result.disagreeing_normals = normals.disagreeing;
    pieces = rewrite_in_place(source, positions, precision, std::move(normals));
  } else {
    pieces = convert(source, format, positions, precision, options.normals, result);
  }
  write_pieces_of(source.path, source.bytes, path, pieces);
  return result;
}

std::string patched_bytes(const MeshFile& source, std::span<const Vec3d> positions) {
  return join(rewrite_in_place(source, positions, source.precision, new_normals(source, positions, source.precision)));
}

void write_mesh(const std::string& path, PolygonView polygons, const WriteOptions& options) {
  const Format format = require_format(path, options.format);
  const Rounding precision = options.digits > 0 ? Rounding{Rounding::Kind::Digits, options.digits} : Rounding{};
  write_pieces(path, encode(format, std::make_shared<Content>(Content{polygons, precision, {}, {}, {}})));
}

}  // namespace vdb_offset::io
