// SPDX-License-Identifier: Apache-2.0
#include "batch/remote/shell_words.h"

#include <fstream>

#include "batch/model_run.h"
#include "batch/process/child.h"
#include "batch/remote/plan.h"
#include "messages.h"

namespace vdb_offset::tool {
std::string in_quotes(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'') quoted += "'\\''";
    else quoted += c;
  }
  return quoted + "'";
}

std::string words_of_task(const std::string& out) {
  return in_quotes(this_program()) + " batch-task " + in_quotes(path_of_plan(out));
}

std::string log_of_tasks(const std::string& out) { return state_folder(out) + "/tasks.log"; }

std::string last_line_of(const std::string& path) {
  std::ifstream file(path);
  std::string last;
  for (std::string line; std::getline(file, line);)
    if (!line.empty()) last = line;
  return last.empty() ? "it said nothing" : readable(last);
}

}  // namespace vdb_offset::tool
