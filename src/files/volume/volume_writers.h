// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "products/volume/foam_measures.h"
#include "vdb_offset/cells.h"

namespace vdb_offset::io {

/// A file that replace_file() puts in place.
struct WrittenFile {
  const std::string& temporary;  ///< Where it is written.
  const std::string& path;       ///< What messages call it.
};

// The writers of all formats. \pre the mesh's arrays fit each other. \throw WriteError, InvalidInput (volume_file.h).
void write_msh(const std::string& path, const VolumeMesh& mesh);
void write_su2(const std::string& path, const VolumeMesh& mesh);
FoamQuality write_foam(const std::string& path, const VolumeMesh& mesh);
void write_vtu(const WrittenFile& file, VolumeMesh& mesh);  ///< Gives prisms VTK's order of corners.
void write_vts(const WrittenFile& file, const StructuredBlock& block);
void write_cgns(const WrittenFile& file, const VolumeMesh& mesh);

/// Checks that .cgns can be written here. \throw WriteError if its module is missing
void require_cgns(const std::string& path);

bool has_polyhedra(const VolumeMesh& mesh);

/// For formats without polyhedra. \throw InvalidInput for polyhedra, and for faces of patches with more than four
/// corners. `ending` is for messages.
void require_standard_cells(const std::string& path, const VolumeMesh& mesh, const char* ending);

/// Makes words distinct: of equal ones, the later ones end in _2, _3 ... They have at most `longest` bytes.
std::vector<std::string> distinct_words(std::span<const std::string> words, std::size_t longest);

constexpr std::size_t kLongestWord = 255;  // bytes

/// The patches' names as every format can hold them: ASCII letters, digits and _ - + . alone, a letter or _ first, at
/// most `longest` bytes, and no two alike.
std::vector<std::string> patch_words(const VolumeMesh& mesh, std::size_t longest = kLongestWord);

}  // namespace vdb_offset::io
