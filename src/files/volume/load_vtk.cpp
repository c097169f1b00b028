// SPDX-License-Identifier: Apache-2.0
#include "bytes/open_module.h"
#include "volume/writer_modules.h"

// Stands in for the writers that use VTK where they are a module.
namespace vdb_offset::io {
namespace {

const VtkModule& vtk(const std::string& path) {
  static const auto& module = *static_cast<const VtkModule*>(open_module(path, "vdb_offset_vtk", ModuleUse::Write));
  return module;
}

}  // namespace

void require_vtk(const std::string& path) { vtk(path); }

void write_vtu(const WrittenFile& file, VolumeMesh& mesh) { vtk(file.path).write_vtu(file, mesh); }

void write_vts(const WrittenFile& file, const StructuredBlock& block) { vtk(file.path).write_vts(file, block); }

}  // namespace vdb_offset::io
