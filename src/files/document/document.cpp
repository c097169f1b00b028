// SPDX-License-Identifier: Apache-2.0
#include "document/document.h"

#include <fmt/format.h>

#include <utility>

#include "vdb_offset/run.h"

namespace vdb_offset::io {

bool MovedMesh::any_has_moved() const {
  for (std::size_t v = 0; v < positions.size(); ++v)
    if (has_moved(v)) return true;
  return false;
}

WrittenDocument Document::derive(const std::shared_ptr<const DerivedMesh>&, const std::string&) const { return {}; }

void Document::read_attributes(const MeshFile&, Attributes&) const {}

FaceNames Document::face_names() const { return {}; }

Materials Document::read_materials(const MeshFile&) const {
  FaceNames names = face_names();
  return {std::move(names.materials), std::move(names.material_of), {}, std::move(names.colours)};
}

void Document::visit_labels(const MeshFile& source, LabelListener& listener) const {
  const FaceNames names = face_names();
  const auto changes = [](const std::vector<std::uint32_t>& of_face, std::size_t f) {
    return !of_face.empty() && (f == 0 || of_face[f] != of_face[f - 1]);
  };
  for (std::size_t f = 0; f < source.polygons.face_count(); ++f) {
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

std::optional<std::vector<std::uint8_t>> Document::select(const MeshFile&, const Selector&) const { return {}; }

std::vector<double> Document::vertex_numbers(const MeshFile& source, const std::string& name) const {
  throw InvalidInput(
      fmt::format("{}: expected numbers of vertices under the name '{}', got a format without any", source.path, name));
}

}  // namespace vdb_offset::io
