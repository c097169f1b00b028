// SPDX-License-Identifier: Apache-2.0
#include "bytes/open_module.h"
#include "volume/writer_modules.h"

// Stands in for the writer that uses CGNS where it is a module.
namespace vdb_offset::io {
namespace {

const CgnsModule& cgns(const std::string& path) {
  static const auto& module = *static_cast<const CgnsModule*>(open_module(path, "vdb_offset_cgns", ModuleUse::Write));
  return module;
}

}  // namespace

void require_cgns(const std::string& path) { cgns(path); }

void write_cgns(const WrittenFile& file, const VolumeMesh& mesh) { cgns(file.path).write_cgns(file, mesh); }

}  // namespace vdb_offset::io
