// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "vdb_offset/api.h"
#include "vdb_offset/cells.h"

namespace vdb_offset::io {

enum class VolumeFormat : std::uint8_t { Vtu, Msh, Cgns, Su2, Foam };

/// The format that a path stands for: by the ending .vtu, .msh, .cgns or .su2, in any case; a path with the last
/// component `polyMesh` is a folder of OpenFOAM's.
VDB_OFFSET_API std::optional<VolumeFormat> volume_format_of(std::string_view path);

/// What is written into a polyMesh.
inline constexpr std::array<const char*, 5> kFoamFiles = {"points", "faces", "owner", "neighbour", "boundary"};

/// What writing found.
struct VolumeWriteResult {
  std::optional<FoamQuality> foam;  ///< Of a polyMesh.
};

/// Writes the mesh in the path's format. Files are made under temporary names and renamed when they are complete. (By
/// value, as VTK's order of corners takes the place of ours: move what is not needed again.)
/// - .vtu: VTK's XML, raw appended, compressed; a prism's first triangle faces away from the second. Points in double,
/// fields in single precision; patches are left out, but
///   for their names and numbers of faces (field data `patch_names` and `patch_faces`).
/// - .msh: Gmsh 4.1, binary. A physical surface for each patch, a physical curve, of lines, where some patches meet, by
///   their names with - between, the physical volume `layers`, fields as post-processing views. Points belong to what
///   they lie on: corner, curve, surface or volume. No polyhedra.
/// - .cgns: an unstructured zone with a section for each type of cell, boundary faces and conditions by the patches'
///   names (BCWall for walls, BCGeneral else), fields in single precision. With polyhedra, NGON_n and NFACE_n sections.
/// - .su2: text; a marker for each patch. No fields, no polyhedra.
/// - polyMesh: text; points, faces, owner, neighbour and boundary (`wall` for walls, `patch` else). No fields. The
///   folder is made if it is not there, and its other files stay.
/// Plane meshes: .vtu, and .su2 in two dimensions if they lie in a plane of constant z.
/// Patches without faces are left out, but for .vtu's names. Patches' names become words without blanks and quotes,
/// .cgns: of 32 bytes. Fields without values are left out. \throw InvalidInput for an unknown ending, polyhedra where
/// the format has none, a patch that is not the boundary (polyMesh, .cgns with polyhedra), no cells, or arrays that do
/// not fit each other; WriteError.
VDB_OFFSET_API VolumeWriteResult write_volume(const std::string& path, VolumeMesh mesh);

/// Whether files keep a patch's name as it is, if no other patch has it: ASCII letters, digits and _ - + . alone, a
/// letter or _ first, at most 255 bytes (in .cgns, 32 are kept).
VDB_OFFSET_API bool is_patch_word(const std::string& name);

enum class StructuredFormat : std::uint8_t { Vts, Plot3d };

/// The format that a path's ending stands for: .vts or .xyz, in any case.
VDB_OFFSET_API std::optional<StructuredFormat> structured_format_of(std::string_view path);

/// Writes the block in the path's format.
/// - .vts: as .vtu.
/// - .xyz: Plot3D, text, one block without a number of blocks, whole, three-dimensional, no blanking: ni nj nk, then
/// all
///   x, all y and all z, with as many digits as read back to the same double. No fields.
/// \throw InvalidInput for an unknown ending, or arrays with lengths that do not fit the block's; WriteError.
VDB_OFFSET_API void write_structured(const std::string& path, const StructuredBlock& block);

/// Checks that the library which writes the path's format is there; it may be a module that is loaded when it is
/// needed. \throw InvalidOption if this build is without it, WriteError if the module is missing
VDB_OFFSET_API void require_volume_writer(const std::string& path);

}  // namespace vdb_offset::io
