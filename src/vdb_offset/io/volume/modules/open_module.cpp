// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>

#include <filesystem>
#include <system_error>

#include "vdb_offset/error.h"
#include "vdb_offset/io/volume/modules/writer_modules.h"
#include "vdb_offset/version.h"

namespace vdb_offset::io {
namespace {

/// The module's file: beside the command, as it is built, or else where it is installed. Never a relative path, which
/// could name a stranger's file. Empty if it is not known where the command lies.
std::filesystem::path find_module(const std::string& file) {
  std::error_code failed;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", failed).parent_path();
  if (!folder.is_absolute()) return {};
  if (std::filesystem::exists(folder / file, failed)) return folder / file;
  return (folder / VDB_OFFSET_MODULES / file).lexically_normal();
}

}  // namespace

const void* open_module(const std::string& path, const std::string& name) {
  const std::string file = name + ".so";
  const auto fail = [&](const std::string& what) {
    throw WriteError(path + ": expected the module " + file + ", which writes it, got: " + what +
                     " (install the whole package, or write another format)");
  };
  const auto found_at = find_module(file);
  if (found_at.empty()) fail("no /proc/self/exe that tells where the command lies");
  // Never closed: what it has loaded has threads and exit handlers of its own.
  void* const module = ::dlopen(found_at.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!module) fail(::dlerror());
  const void* const writers = ::dlsym(module, name.c_str());
  if (!writers) fail(::dlerror());
  const std::string found = *static_cast<const char* const*>(writers);
  if (found != VDB_OFFSET_VERSION) fail("version " + found + " for a command of version " VDB_OFFSET_VERSION);
  return writers;
}

}  // namespace vdb_offset::io
