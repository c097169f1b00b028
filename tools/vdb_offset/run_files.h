// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "job.h"

namespace vdb_offset::tool {

/// A file that a run reads or writes, and the option that names it.
struct RunFile {
  std::string option, path;
  bool may_be_input = false;  ///< Of what is written: it may take the place of INPUT, which is complete by then.
};

/// Refuses files that get in each other's way. \throw UsageError, which names both, if anything that is written is also
/// read, or is written twice: by whatever path, through links and hard links. `-` is standard input or output, whatever
/// these are.
void require_apart(std::span<const RunFile> read, std::span<const RunFile> written);

/// Refuses them among all files that a request names. It is asked before anything is read, and again once the files are
/// known that those which are read name.
void require_apart(const Request& request, std::span<const std::string> files_named = {});

/// Refuses them among all files that a job reads and writes. It is asked before anything is written.
void require_apart(const Job& job);

/// Whether a path is standard output, as `-` and /dev/stdout are.
bool is_standard_output(const std::string& path);

/// The files that a request names to be read, INPUT first, and to be written, as far as they are known without the
/// input.
std::vector<RunFile> files_read(const Request& request, std::span<const std::string> files_named = {});
std::vector<RunFile> files_written(const Request& request);

/// The files that options name which `check` has as well.
std::vector<RunFile> surroundings_of(const Request& request);

}  // namespace vdb_offset::tool
