// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/io/derived_file.h"

#include <fmt/format.h>

#include "bytes/chunked_output.h"
#include "derived/convert_iso.h"
#include "document/encode.h"
#include "document/require_format.h"
#include "ground/numbers/rounding.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {

Transported read_transported(const MeshFile& source, const TransportRequest& request, Format target) {
  Transported transported{read_attributes(source), read_materials(source)};
  auto& [attributes, materials] = transported;
  const auto settle = [&](bool wanted, auto& what, bool is_there, bool has_place, const char* in_words) {
    if (wanted && request.is_required && !is_there)
      throw InvalidOption(
          fmt::format("{}: expected {}, which are to be transported, found none", source.path, in_words));
    if (wanted && request.is_required && !has_place)
      throw InvalidOption(
          fmt::format("transport: expected a format that has a place for {}, got .{}", in_words, name(target)));
    if (!wanted) what = {};
  };
  settle(request.texture, attributes.texture, !attributes.texture.empty(), holds_texture(target),
         "texture coordinates");
  settle(request.colours, attributes.colours, !attributes.colours.empty(), holds_colours(target),
         "colours of vertices");
  settle(request.materials, materials, !materials.of_face.empty(), target == Format::Obj, "materials");
  if (!request.colours) attributes.has_alpha = false;
  attributes.normals = {};
  return transported;
}

WriteResult write_iso_surface(const Target& target, const MeshFile& source, const Transported& transported,
                              const IsoResult& iso) {
  WriteResult result;
  const Pieces pieces = convert(source, target.format, iso, transported, target.precision, result);
  write_pieces_of(source.path, source.bytes, target.path, pieces);
  return result;
}

void write_iso_surface(const Target& target, const IsoResult& iso) {
  write_pieces(target.path, convert(target.format, iso, target.precision));
}

WriteResult write_hollow(const Target& target, const MeshFile* source, const Hollow& hollow, const IsoResult& iso) {
  const bool is_skin = source != nullptr && hollow.source != Hollow::Source::Neither;
  WriteResult result;
  const Pieces pieces = is_skin
                            ? convert(*source, target.format, hollow, iso, result)
                            : convert(target.format, hollow, source ? source->unit_micrometres : std::nullopt, result);
  if (source) write_pieces_of(source->path, source->bytes, target.path, pieces);
  else write_pieces(target.path, pieces);
  return result;
}

}  // namespace vdb_offset::io
