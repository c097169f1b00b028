// SPDX-License-Identifier: Apache-2.0
#include "document/document.h"

#include <fmt/format.h>

#include "vdb_offset/error.h"

namespace vdb_offset::io {

bool MovedMesh::any_has_moved() const {
  for (std::size_t v = 0; v < positions.size(); ++v)
    if (has_moved(v)) return true;
  return false;
}

void Document::read_attributes(const MeshFile&, Attributes&) const {}

FaceNames Document::face_names() const { return {}; }

std::vector<std::uint8_t> Document::select(const MeshFile& source, const Selector& selector) const {
  throw InvalidOption(
      fmt::format("{}: expected a CAD model to choose '{}' of, got another file", source.path, selector.name));
}

std::vector<double> Document::vertex_numbers(const MeshFile& source, const std::string& name) const {
  throw InvalidInput(
      fmt::format("{}: expected numbers of vertices under the name '{}', got a format without any", source.path, name));
}

}  // namespace vdb_offset::io
