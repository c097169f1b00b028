// SPDX-License-Identifier: Apache-2.0
// The table of all formats of meshes: to add one, give it a folder with a reader that sets MeshFile::document, and a
// row.
#include <algorithm>
#include <iterator>

#include "bytes/compression.h"
#include "bytes/scanner.h"
#include "document/format_readers.h"
#include "document/format_table.h"

namespace vdb_offset::io {
namespace {

template <void (*kParse)(MeshFile&)>
void parse(MeshFile& file, const ReadOptions&) {
  kParse(file);
}
template <Pieces (*kEncode)(const SharedContent&)>
Pieces encode(Format, const SharedContent& content) {
  return kEncode(content);
}
void parse_model(MeshFile& file, const ReadOptions& how) { parse_cad(file, how.cad); }
void parse_grid(MeshFile& file, const ReadOptions& how) { parse_vdb(file, how.vdb); }

const FormatRow kFormats[] = {
    {.endings = {"obj"},
     .format = Format::Obj,
     .parse = parse<parse_obj>,
     .encode = encode<to_obj>,
     .is_text = true,
     .holds_colours = true,
     .holds_texture = true,
     .holds_corners = true},
    {.endings = {"off"},
     .format = Format::Off,
     .parse = parse<parse_off>,
     .encode = encode<to_off>,
     .is_text = true,
     .holds_colours = true,
     .holds_texture = true},
    {.endings = {"ply"},
     .format = Format::Ply,
     .parse = parse<parse_ply>,
     .encode = encode<to_ply>,
     .holds_colours = true,
     .holds_texture = true},
    {.endings = {"stl"},
     .format = Format::Stl,
     .parse = parse<parse_stl>,
     .encode = encode<to_stl>,
     .is_single = true,
     .is_of_triangles = true},
    {.endings = {"3mf"},
     .format = Format::ThreeMf,
     .parse = parse<parse_3mf>,
     .encode = encode<to_3mf>,
     .is_text = true,
     .is_of_triangles = true,
     .holds_colours = true},
    {.endings = {"gltf"},
     .format = Format::Gltf,
     .parse = parse<parse_gltf>,
     .encode = encode<to_gltf>,
     .is_single = true,
     .is_of_triangles = true,
     .holds_colours = true,
     .holds_texture = true,
     .holds_corners = true},
    {.endings = {"glb"},
     .format = Format::Glb,
     .parse = parse<parse_gltf>,
     .encode = encode<to_glb>,
     .is_single = true,
     .is_of_triangles = true,
     .holds_colours = true,
     .holds_texture = true,
     .holds_corners = true},
    {.endings = {"vtp"},
     .format = Format::Vtp,
     .parse = parse<parse_vtk>,
     .encode = to_vtk,
     .holds_colours = true,
     .holds_texture = true},
    {.endings = {"vtk"},
     .format = Format::Vtk,
     .parse = parse<parse_vtk>,
     .encode = to_vtk,
     .holds_colours = true,
     .holds_texture = true},
    {.endings = {"vtu"},
     .format = Format::Vtu,
     .parse = parse<parse_vtk>,
     .encode = to_vtk,
     .holds_colours = true,
     .holds_texture = true},
    {.endings = {"fbx", "dae", "3ds"}, .format = Format::Assimp, .parse = parse<parse_by_assimp>},
    {.endings = {"step", "stp"}, .format = Format::Step, .parse = parse_model},
    {.endings = {"iges", "igs"}, .format = Format::Iges, .parse = parse_model},
    {.endings = {"brep"}, .format = Format::Brep, .parse = parse_model},
    {.endings = {"vdb"}, .format = Format::Vdb, .parse = parse_grid}};

}  // namespace

const FormatRow& row_of(Format format) {
  return *std::find_if(std::begin(kFormats), std::end(kFormats),
                       [&](const FormatRow& row) { return row.format == format; });
}

std::optional<Format> format_of(std::string_view path) {
  path = without_compression(path);
  const std::size_t dot = path.rfind('.');
  if (dot == std::string_view::npos) return std::nullopt;
  for (const FormatRow& row : kFormats)
    for (const std::string_view ending : row.endings)
      if (!ending.empty() && is_word(path.substr(dot + 1), ending)) return row.format;
  return std::nullopt;
}

const char* name(Format format) { return row_of(format).endings.front().data(); }

bool is_written(Format format) { return row_of(format).encode != nullptr; }

}  // namespace vdb_offset::io
