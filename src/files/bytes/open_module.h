// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace vdb_offset::io {

// The command does not link libraries that read or write single formats and take a third of the time in which it
// starts: what uses them are modules, opened when a file of theirs is asked for. Each shows one struct, which starts
// with the version of the project, as the arguments' memory layout is not kept between versions.

enum class ModuleUse { Read, Write };

/// The struct `name` of the module `name`.so, which is opened. `path` is the file to be read or written, for messages.
/// Modules are looked for in the folder that the environment variable VDB_OFFSET_MODULES names, if it does; else beside
/// the program, where they are installed relative to it, and where this build installs them.
/// \throw ReadError or WriteError if there is none, something that it needs is missing, or it is of another version
const void* open_module(const std::string& path, const std::string& name, ModuleUse use);

/// The file of a program that a program of the project starts for what it does not do itself; looked for where modules
/// are. It may not be there.
std::string worker_program(const std::string& name);

}  // namespace vdb_offset::io
