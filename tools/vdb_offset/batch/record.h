// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "batch/model_run.h"

namespace vdb_offset::tool {

/// How a model's run ended.
struct Ending {
  int exit_code = 0;  ///< As shells have it: 128 and the signal's number, if it ended by one.
  double seconds = 0;
  std::size_t peak_memory = 0;  ///< Bytes.
  std::string message;          ///< What it said, on one line.
};

/// What a model is made of: the model and all files that its options name, the options, and the version of the command.
struct Ingredients {
  std::vector<std::string> words, files;

  /// Stands for the contents. That of files which are named in files is `read_besides`.
  std::string key(std::span<const std::string> read_besides) const;
  /// Stands for what the system notes of them; the same stamp means the same key.
  std::string stamp(std::span<const std::string> read_besides) const;
};
Ingredients ingredients_of(const BatchRequest& request, const Model& model, const ModelRun& run);

/// What the batch remembers of a model.
struct Record {
  std::string batch;                      ///< The mark of the batch that made it (see RunMark).
  std::string key, stamp;                 ///< Of its ingredients.
  std::vector<std::string> read_besides;  ///< Files that the run read and its options do not name.
  Ending ending;
  /// What the reports say, for the table: for each distance, texts by the names of columns.
  struct Figures {
    std::string distance, vertices, share_reached, mean_error, within_1_percent, certified, new_crossings;
    std::string warning;  ///< The gravest; empty: none.
  };
  std::vector<Figures> figures;
  std::vector<std::int64_t> sizes;  ///< Of the files written, in their order; -1: none, or a folder.

  /// Whether it failed for what the model or the options are, and would again.
  bool failed_for_good() const;
};

/// Makes the record of a run that has ended, from its reports, and removes those that nobody keeps.
Record record_of(const ModelRun& run, Ending ending);

/// Whether the files that a run wrote are there, of the sizes that they had.
bool are_there(const ModelRun& run, const Record& record);

/// The record of a model. Empty if there is none that can be read.
std::optional<Record> load_record(const std::string& out, const Model& model);
/// \throw WriteError
void save_record(const std::string& out, const Model& model, const Record& record);
void remove_record(const std::string& out, const Model& model);
/// Where records are, by state_name().
std::string folder_of_records(const std::string& out);

}  // namespace vdb_offset::tool
