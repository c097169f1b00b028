// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "vdb_offset/volume/foam_measures.h"
#include "vdb_offset/volume_mesh.h"

namespace vdb_offset::io {

// The writers of all formats. \pre the mesh's arrays fit each other. \throw WriteError, InvalidInput (volume_file.h).
// write_vtu() gives cells VTK's order of corners.
void write_vtu(const std::string& path, VolumeMesh& mesh);
void write_msh(const std::string& path, const VolumeMesh& mesh);
void write_cgns(const std::string& path, const VolumeMesh& mesh);
void write_su2(const std::string& path, const VolumeMesh& mesh);
void write_vts(const std::string& path, const StructuredBlock& block);
FoamQuality write_foam(const std::string& path, const VolumeMesh& mesh);

bool has_polyhedra(const VolumeMesh& mesh);

/// For formats without polyhedra. \throw InvalidInput for polyhedra, and for faces of patches with more than four
/// corners. `ending` is for messages.
void require_standard_cells(const std::string& path, const VolumeMesh& mesh, const char* ending);

/// Makes words distinct: of equal ones, the later ones end in _2, _3 ... They have at most `longest` bytes.
std::vector<std::string> distinct_words(std::span<const std::string> words, std::size_t longest);

/// The patches' names as every format can hold them: ASCII letters, digits and _ - + . alone, a letter or _ first, at
/// most `longest` bytes, and no two alike.
std::vector<std::string> patch_words(const VolumeMesh& mesh, std::size_t longest = 255);

}  // namespace vdb_offset::io
