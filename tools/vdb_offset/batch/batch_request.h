// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "request/command_line.h"

namespace vdb_offset::tool {

/// What `vdb_offset batch` was asked for.
struct BatchRequest {
  std::string folder, out;                 ///< Absolute.
  std::string output = "{model}{ending}";  ///< The pattern of the outputs' names.
  std::string config;                      ///< The file of options; empty: none.
  std::vector<std::string> selection;      ///< Patterns of the models' names; empty: by their endings.
  std::vector<GivenOption> each;           ///< Options of vdb_offset, for each model.
  std::optional<int> jobs;                 ///< Models at once, on each machine.
  std::optional<std::size_t> max_memory;   ///< Bytes, for all models at once.
  bool threads_given = false;
  std::string sshlogin, partition;  ///< Of GNU parallel and of Slurm; empty: neither.
  bool retry_failed = false, dry_run = false, quiet = false, verbose = false;
};

/// Reads the command line of a batch. Empty if it asked only for help, which is then printed. \throw UsageError
std::optional<BatchRequest> parse_batch(int argc, const char* const* argv);

}  // namespace vdb_offset::tool
