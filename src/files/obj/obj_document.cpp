// SPDX-License-Identifier: Apache-2.0
#include "obj/obj_document.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <unordered_map>

#include "bytes/obj_lines.h"
#include "document/columns.h"

namespace vdb_offset::io {
namespace {

std::vector<std::string> words_of_line(Scanner scanner) {
  std::vector<std::string> words;
  while (!scanner.at_line_end()) words.emplace_back(scanner.token());
  return words;
}

/// Finds which texture coordinates a corner v/vt.. names, kNoNormal for none. Negative numbers count back from the
/// `so_far` ones that have been read. Returns false for a word that is no index.
bool texture_of(std::string_view corner, std::size_t so_far, std::uint32_t& texture) {
  texture = kNoNormal;
  const std::size_t slash =
      std::min(corner.find('/'), corner.size() - 1);  // without a slash: the last character, so that no digits follow
  const std::string_view digits = corner.substr(slash + 1, corner.find('/', slash + 1) - slash - 1);
  if (digits.empty()) return true;
  std::int64_t index = 0;
  if (!parse_integer(digits, index)) return false;
  if (index < 0) index += static_cast<std::int64_t>(so_far) + 1;
  if (index < 1 || index >= kNoNormal) return false;
  texture = static_cast<std::uint32_t>(index - 1);
  return true;
}

/// Reads `vt` lines, and which of them the corners of faces name. Returns false if one of them is malformed.
bool read_obj_texture(const MeshFile& source, CornerValues<Vec2d>& texture, bool& has_depth) {
  bool are_indices = true;
  for_each_obj_line(source.path, source.text(), [&](const ObjLine& line) {
    if (line.is("vt")) {
      double uvw[3] = {std::numeric_limits<double>::quiet_NaN(), 0, 0};
      Scanner words = line.words();
      for (double* number = uvw; number != std::end(uvw) && !words.at_line_end(); ++number)
        *number = number_or_nan(words.token());
      texture.value.emplace_back(uvw[0], uvw[1]);
      has_depth |= uvw[2] != 0;
    } else if (line.is("f") && are_indices) {
      for (Scanner words = line.words(); are_indices && !words.at_line_end();)
        are_indices = texture_of(words.token(), texture.value.size(), texture.of_corner.emplace_back());
    }
  });
  if (!are_indices) return false;
  return all_finite(texture.value) && texture.of_corner.size() == source.polygons.corners.size() &&
         any_named(texture.of_corner) && std::all_of(texture.of_corner.begin(), texture.of_corner.end(), [&](auto t) {
           return t == kNoNormal || t < texture.value.size();
         });
}

}  // namespace

void ObjRows::read_attributes(const MeshFile& source, Attributes& attributes) const {
  read_normals_of_rows(source, attributes);
  constexpr const char *kVertexData = "vertex weights or colours", *kTexture = "texture coordinates";
  if (has_extra(source, kVertexData))
    if (const auto tails = read_tails(source, position_at); tails && take_colours(*tails, tails->width, 1, attributes))
      is_kept(attributes, kVertexData);
  CornerValues<Vec2d> texture;
  bool has_depth = false;
  if (!has_extra(source, kTexture) || !read_obj_texture(source, texture, has_depth)) return;
  attributes.texture = std::move(texture);
  is_kept(attributes, kTexture);
  if (has_depth) attributes.lost.emplace_back("third texture coordinates");
}

Materials ObjRows::read_materials(const MeshFile& source) const {
  Materials materials;
  if (!has_extra(source, "materials")) return materials;
  std::unordered_map<std::string, std::uint32_t> index_of;
  std::string name;
  for_each_obj_line(source.path, source.text(), [&](const ObjLine& line) {
    if (line.is("usemtl")) name = rest_of_line(line);
    else if (line.is("mtllib")) materials.libraries.push_back(rest_of_line(line));
    if (!line.is("f")) return;
    const auto [known, is_new] = index_of.try_emplace(name, static_cast<std::uint32_t>(materials.names.size()));
    if (is_new) materials.names.push_back(name);
    materials.of_face.push_back(known->second);
  });
  const bool any = materials.names.size() > 1 || (materials.names.size() == 1 && !materials.names[0].empty());
  if (!any || materials.of_face.size() != source.polygons.face_count()) return {};
  return materials;
}

void ObjRows::visit_labels(const MeshFile& source, LabelListener& listener) const {
  for_each_obj_line(source.path, source.text(), [&](const ObjLine& line) {
    if (line.is("f")) listener.add_face();
    else if (line.is("g")) listener.set_groups(words_of_line(line.words()));
    else if (line.is("o")) listener.set_object(rest_of_line(line));
    else if (line.is("usemtl")) listener.set_material(rest_of_line(line));
  });
}

}  // namespace vdb_offset::io
