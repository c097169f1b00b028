// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "request/request.h"

namespace vdb_offset::tool {

struct Job;

/// A file that a run reads or writes, and the option that names it.
struct RunFile {
  std::string option, path;
  bool may_be_input = false;  ///< Of what is written: it may take the place of INPUT, which is complete by then.
  /// Of what is written: its writer finds out whether it can be. That is so of a folder that is written as a whole, and
  /// of a file that may not be needed.
  bool is_left_to_writer = false;
};

/// Where the offset for one distance goes. Names of files that were not asked for are empty.
struct Destination {
  std::string mesh, report, states, paths, html;
  std::string distance;  ///< The distance as the user gave it.
};

/// All files that a run reads and writes. Their names are made here and nowhere else.
struct FilePlan {
  std::vector<Destination> outputs;    ///< One for each distance. Of layers a single one, without a distance.
  std::vector<std::string> layers;     ///< The mesh of each layer, where OUTPUT is no mesh of cells.
  std::vector<RunFile> read, written;  ///< INPUT is the first that is read.
};

/// The files that a request names, as far as they are known without its input. Not known are a scene's own distance,
/// for which there is one output with its names as given, and how many heights a file has.
FilePlan plan_files(const Request& request);

/// The files of a job, whose distances are settled, with those that its input names.
FilePlan plan_files(const Job& job);

/// Refuses files that get in each other's way. \throw UsageError, which names both, if anything that is written is also
/// read, or is written twice: by whatever path, through links and hard links. `-` is standard input or output, whatever
/// these are.
void require_apart(std::span<const RunFile> read, std::span<const RunFile> written);
void require_apart(const FilePlan& files);

/// \throw WriteError for the first file that cannot be written, but for those that are left to their writers
void require_writable_files(const FilePlan& files);

/// Whether a path is standard output, as `-` and /dev/stdout are.
bool is_standard_output(const std::string& path);

/// The files that options name which `check` has as well.
std::vector<RunFile> surroundings_of(const Request& request);

/// Where the ending of a name begins. `.gz` and `.zst` belong to the ending before them.
std::size_t ending_of(const std::string& name);

}  // namespace vdb_offset::tool
