// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

// What tasks are started with, as a shell on another machine takes it, and what they leave.

namespace vdb_offset::tool {

/// A path as one word of whatever shell a user has on another machine: of sh, csh and fish, which agree about what is
/// in single quotes but for few characters. \throw InvalidInput for a path with one of these
std::string in_quotes(const std::string& path);

/// The call of a task, for a shell, without its number.
std::string words_of_task(const std::string& out);

/// Where what tasks print goes.
std::string log_of_tasks(const std::string& out);

/// The last line of a file that is not empty, as a message has it.
std::string last_line_of(const std::string& path);

}  // namespace vdb_offset::tool
