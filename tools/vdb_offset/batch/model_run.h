// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "batch/batch_request.h"
#include "batch/models.h"
#include "request/request.h"

namespace vdb_offset::tool {

/// How a model is offset: the command line, and the files that it names.
struct ModelRun {
  std::vector<std::string> words;    ///< Behind the name of the command; without threads and memory.
  std::vector<std::string> read;     ///< The model first.
  std::vector<std::string> written;  ///< But for reports that are kept for the table alone.
  std::vector<std::string> reports;  ///< One for each distance.
  bool keeps_reports = false;        ///< They are outputs.
};

/// Where the batch keeps what it knows of its models.
std::string state_folder(const std::string& out);

/// A name for what the batch keeps of a model: unlike the model's own, always short enough and of plain letters.
std::string state_name(const Model& model);

/// The table of a batch.
std::string path_of_table(const std::string& out);

/// A model whose name means something else in names of outputs.
struct UnusableName : UsageError {
  using UsageError::UsageError;
};

/// Fills in the patterns of a batch for a model. \throw UsageError if its command line cannot be carried out,
/// UnusableName
ModelRun run_of(const BatchRequest& request, const Model& model);

/// Requires that no two models write the same file, and none what is a model or the batch's own. \throw UsageError that
/// names both
void require_apart(const BatchRequest& request, std::span<const Model> models);

}  // namespace vdb_offset::tool
