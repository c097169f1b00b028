// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "vdb_offset/api.h"
#include "vdb_offset/io/volume/volume_writers.h"

// The command does not link VTK and CGNS, which would take a third of the time in which it starts: their writers are
// modules, opened when a file of theirs is asked for. Each shows one struct.
namespace vdb_offset::io {

struct VtkModule {
  const char* version;  ///< Of the project: the arguments' memory layout is not kept between versions.
  void (*write_vtu)(const WrittenFile&, VolumeMesh&);
  void (*write_vts)(const WrittenFile&, const StructuredBlock&);
};

struct CgnsModule {
  const char* version;
  void (*write_cgns)(const WrittenFile&, const VolumeMesh&);
};

/// The struct `name` of the module `name`.so, which is opened; it starts with the version. `path` is the file to be
/// written, for messages. Modules are looked for beside the command, and where they are installed relative to it.
/// \throw WriteError if there is none, something that it needs is missing, or it is of another version
const void* open_module(const std::string& path, const std::string& name);

}  // namespace vdb_offset::io

// NOLINTBEGIN(readability-identifier-naming): each is found by its module's name
extern "C" VDB_OFFSET_API const vdb_offset::io::VtkModule vdb_offset_vtk;
extern "C" VDB_OFFSET_API const vdb_offset::io::CgnsModule vdb_offset_cgns;
// NOLINTEND(readability-identifier-naming)
