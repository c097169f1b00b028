// SPDX-License-Identifier: Apache-2.0
#include "batch/remote/shell_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string_view>

#include "batch/model_run.h"
#include "batch/process/child.h"
#include "batch/remote/plan.h"
#include "messages.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {

std::string in_quotes(const std::string& path) {
  // In single quotes, fish takes two backslashes for one.
  const bool is_plain = path.find("\\\\") == std::string::npos && std::all_of(path.begin(), path.end(), [](char c) {
                          return std::string_view("'!").find(c) == std::string_view::npos &&
                                 static_cast<unsigned char>(c) >= ' ' && c != '\x7f';
                        });
  if (!is_plain)
    throw InvalidInput(
        fmt::format("{}: expected a path without quotes, double backslashes, exclamation marks and line breaks, "
                    "which shells of other machines may take otherwise",
                    readable(path)));
  return "'" + path + "'";
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
