// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "threemf/model.h"
#include "threemf/zip_archive.h"

namespace vdb_offset::io {

/// A part of a package that holds models, as it is read.
struct ThreeMfPart {
  const ZipEntry* entry;
  std::string label, text;
  ThreeMfModel model;
};

/// A mesh where it is placed first.
struct PlacedMesh {
  std::size_t part, object;                               // whose
  std::size_t first_vertex, vertices, first_face, faces;  // in the scene
  std::size_t first_in_part, first_triangle;              // of the part
  ThreeMfTransform transform;
  std::uint32_t group;  // its name's index

  bool is_mirrored() const { return transform.determinant() < 0; }
  /// Which of a triangle's corners one of its face is: those of a mirrored mesh are in the other order.
  std::size_t corner(std::size_t k) const { return is_mirrored() ? 2 - k : k; }
};

/// Faces of the scene that have another name than the mesh that they are in.
struct NamedFaces {
  std::size_t first, count;
  std::uint32_t group;
};

/// All that a package places, as it is to be printed.
struct ThreeMfScene {
  std::vector<ThreeMfPart> parts;  ///< The first is that which the package begins with.
  std::vector<PlacedMesh> meshes;
  std::vector<std::string> groups;  ///< Names of objects.
  std::vector<NamedFaces> volumes;
  std::vector<std::string> remarks;
  std::size_t repeated = 0, unplaced = 0, left = 0, sliced = 0;
};

/// The part that a package begins with. \throw InvalidInput if it names none that it has
const ZipEntry& first_part(const std::string& path, const ZipArchive& archive);

/// Reads what the items of a package place, and what they are made of.
ThreeMfScene read_scene(const std::string& path, const ZipArchive& archive);

}  // namespace vdb_offset::io
