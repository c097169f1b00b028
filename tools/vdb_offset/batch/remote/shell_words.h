// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

// What tasks are started with, as a shell on another machine takes it, and what they leave.

namespace vdb_offset::tool {

/// A text as one word of a shell.
std::string in_quotes(const std::string& text);

/// The call of a task, for a shell, without its number.
std::string words_of_task(const std::string& out);

/// Where what tasks print goes.
std::string log_of_tasks(const std::string& out);

/// The last line of a file that is not empty, as a message has it.
std::string last_line_of(const std::string& path);

}  // namespace vdb_offset::tool
