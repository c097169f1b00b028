// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "bytes/chunked_output.h"
#include "derived/derived_mesh.h"
#include "threemf/package.h"
#include "threemf/slicer_names.h"

namespace vdb_offset::io {

/// A mesh of a package, with the vertices and faces of one that is made of the file's.
struct DerivedObject {
  struct Triangle {
    std::array<std::uint32_t, 3> corners;
    std::uint32_t face;
  };
  /// Triangles of the mesh that follow each other, and the ones that come behind them.
  struct Run {
    std::size_t first, count;
    std::size_t first_other = 0, others = 0;
    std::size_t number = 0, numbers = 0;  ///< The first of all these in the file, and how many they are.
  };

  PlacedMesh placed;
  std::vector<std::uint32_t> added;  ///< Vertices that follow its own, ascending.
  std::vector<Triangle> others;      ///< Triangles that are in the place of none.
  std::vector<Run> runs;
  bool keeps_numbers = true;  ///< All triangles of the mesh have the numbers that they had.
  bool names_parts = false;   ///< Its triangles have no property of their own, but one for the part of a shell.

  /// The number that a vertex has in the object.
  std::size_t number_of(std::uint32_t v) const;
};

/// The objects that have faces of the mesh. Objects without any stay as they are. A triangle whose vertices are of
/// several objects belongs to that of its parent, which gets copies of those vertices.
std::vector<DerivedObject> split_by_objects(const DerivedMesh& derived, const std::vector<PlacedMesh>& meshes);

/// Puts triangles of a slicer's volumes, if there are any, behind the mesh's own that are of the same one. The model
/// has the properties of triangles.
void order_triangles(const DerivedMesh& derived, const ThreeMfModel& model, DerivedObject& object,
                     const std::vector<SlicerNames::Volume>* volumes);

/// A model part over its objects' vertices and faces, with all else that it holds. A new triangle has the property of
/// its parent. In a shell of an object without any, triangles have a base material for the part that they are of. The
/// pieces refer to all but the path.
Pieces derived_part(std::string_view text, const ThreeMfModel& model, const DerivedMesh& derived,
                    const std::vector<DerivedObject>& objects, const MovedMesh& moved);

/// A slicer's settings with the numbers that volumes' triangles have now; volumes that lost all of them are left out.
std::string with_volumes(std::string_view settings, const SlicerNames& names, const ThreeMfModel& model,
                         const std::vector<DerivedObject>& objects);

}  // namespace vdb_offset::io
