// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "batch/record.h"

namespace vdb_offset::tool {

/// The rows of a model in the table, one for each distance, as CSV with a line end behind each.
std::string rows_of(const Model& model, const Record& record);

/// The table of a batch, OUT/batch.csv: complete at any moment, as far as the batch has come. Rows are added as models
/// end; finish() sorts them by the models' paths.
class Table {
 public:
  /// Begins with the rows of models that are done already. \throw WriteError
  explicit Table(const std::string& out);

  const std::string& path() const { return path_; }
  /// Keeps the rows of a model that is done already.
  void keep(std::size_t model, std::string rows);
  /// Writes what is kept. \throw WriteError
  void begin();
  /// Adds the rows of a model to the file. \throw WriteError
  void add(std::size_t model, std::string rows);
  /// Writes all rows in order. \throw WriteError
  void finish();

 private:
  void write();

  std::string path_;
  std::vector<std::pair<std::size_t, std::string>> rows_;  // by the number of the model
};

}  // namespace vdb_offset::tool
