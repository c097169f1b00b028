// SPDX-License-Identifier: Apache-2.0
#include "bytes/open_module.h"

#include <dlfcn.h>
#include <sys/mman.h>

#include <cstdlib>
#include <filesystem>
#include <new>
#include <system_error>

#include "vdb_offset/api.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

/// The file of a module or a worker. Never a relative path, which could name a stranger's file.
std::filesystem::path find_module(const std::string& file) {
  if (const char* const named = std::getenv("VDB_OFFSET_MODULES"); named && std::filesystem::path(named).is_absolute())
    return std::filesystem::path(named) / file;
  std::error_code failed;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", failed).parent_path();
  if (folder.is_absolute()) {
    const auto installed = (folder / VDB_OFFSET_MODULES_FROM_COMMAND / file).lexically_normal();
    for (const auto& found_at : {folder / file, installed})
      if (std::filesystem::exists(found_at, failed)) return found_at;
  }
  return std::filesystem::path(VDB_OFFSET_MODULES) / file;
}

// What the libraries of a module take as they start, with the stacks of their threads. Without it they end the process
// from within the loader. Measured: 40 MiB for OpenVDB's.
constexpr std::size_t kMemoryToStart = std::size_t{96} << 20;

/// \throw std::bad_alloc if there is not as much as a module takes
void require_memory_to_start() {
  void* const memory =
      ::mmap(nullptr, kMemoryToStart, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  ::munmap(memory, kMemoryToStart);
}

}  // namespace

std::string worker_program(const std::string& name) { return find_module(name).string(); }

const void* open_module(const std::string& path, const std::string& name, ModuleUse use) {
  const std::string file = name + ".so";
  const auto fail = [&](const std::string& what) {
    const bool reads = use == ModuleUse::Read;
    const std::string message = path + ": expected the module " + file + ", which " + (reads ? "reads" : "writes") +
                                " it, got: " + what + " (install the whole package, or " +
                                (reads ? "convert it first" : "write another format") + ")";
    if (reads) throw ReadError(message);
    throw WriteError(message);
  };
  require_memory_to_start();
  // Never closed: what it has loaded has threads and exit handlers of its own.
  void* const module = ::dlopen(find_module(file).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!module) fail(::dlerror());
  const void* const shown = ::dlsym(module, name.c_str());
  if (!shown) fail(::dlerror());
  const std::string found = *static_cast<const char* const*>(shown);
  if (found != VDB_OFFSET_VERSION) fail("version " + found + " for a program of version " VDB_OFFSET_VERSION);
  return shown;
}

}  // namespace vdb_offset::io
