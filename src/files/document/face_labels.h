// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bytes/obj_lines.h"
#include "bytes/scanner.h"
#include "document/document.h"
#include "vdb_offset/io/mesh_file.h"

namespace vdb_offset::io {

inline std::vector<std::string> words_of_line(Scanner scanner) {
  std::vector<std::string> words;
  while (!scanner.at_line_end()) words.emplace_back(scanner.token());
  return words;
}

/// Tells a listener what a document calls its faces; see visit_labels().
template <class Listener>
void visit_names(const FaceNames& names, std::size_t faces, Listener& listener) {
  const auto changes = [](const std::vector<std::uint32_t>& of_face, std::size_t f) {
    return !of_face.empty() && (f == 0 || of_face[f] != of_face[f - 1]);
  };
  for (std::size_t f = 0; f < faces; ++f) {
    if (changes(names.group_of, f)) {
      const std::uint32_t number = names.group_of[f];
      std::vector<std::string> groups;
      if (!names.groups[number].empty()) groups.push_back(names.groups[number]);
      if (!names.layers.empty() && !names.layers[number].empty()) groups.push_back(names.layers[number]);
      listener.set_groups(std::move(groups));
    }
    if (changes(names.material_of, f)) listener.set_material(names.materials[names.material_of[f]]);
    listener.add_face();
  }
}

/// Tells a listener the names of faces, in the order of the file: set_groups(names), set_object(name) and
/// set_material(name) hold for the faces after them; add_face() is called for each face. Only OBJ, ASCII STL (in
/// which solids are groups) and documents have names; for other files nothing is called.
template <class Listener>
void visit_labels(const MeshFile& mesh, Listener& listener) {
  if (mesh.document) {
    visit_names(mesh.document->face_names(), mesh.polygons.face_count(), listener);
  } else if (mesh.format == Format::Obj) {
    for_each_obj_line(mesh.path, mesh.text(), [&](const ObjLine& line) {
      if (line.is("f")) listener.add_face();
      else if (line.is("g")) listener.set_groups(words_of_line(line.words()));
      else if (line.is("o")) listener.set_object(rest_of_line(line));
      else if (line.is("usemtl")) listener.set_material(rest_of_line(line));
    });
  } else if (mesh.format == Format::Stl && mesh.encoding == Encoding::Ascii) {
    Scanner scanner(mesh.path, mesh.text());
    for (; !scanner.at_text_end(); scanner.next_line()) {
      const std::string_view keyword = scanner.token();
      if (is_word(keyword, "solid")) listener.set_groups({rest_of_line(scanner)});
      else if (is_word(keyword, "facet")) listener.add_face();
    }
  }
}

}  // namespace vdb_offset::io
