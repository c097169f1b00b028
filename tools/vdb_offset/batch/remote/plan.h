// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "batch/batch_request.h"
#include "batch/models.h"

namespace vdb_offset::tool {

/// The work of a batch for other machines, as they find it in a file: which models, and how. It is shared out as tasks:
/// task i of n has the models i, i + n, i + 2 n ...
struct Plan {
  BatchRequest request;
  std::vector<Model> models;
  std::string mark;  ///< Of the batch.
  std::size_t tasks = 0;
  std::size_t most_at_once = 0;  ///< Of the tasks; 0: as many as there is room for. Not for the tasks themselves.
};

std::string path_of_plan(const std::string& out);

/// \throw WriteError
void write_plan(const Plan& plan);

/// Reads a plan, and enters the folder that it was made in. \throw ReadError, InvalidInput
Plan read_plan(const std::string& path);

}  // namespace vdb_offset::tool
