#pragma once

#include <functional>
#include <string>

namespace vdb_offset {

/// Lets `write` make a file under a temporary name beside `path`, then renames it to `path`. Whatever happens,
/// `path` is either what it was or complete, and no temporary file stays. `write` gets the temporary name.
/// \throw WriteError if the rename fails, and whatever `write` throws.
void replace_file(const std::string& path, const std::function<void(const std::string& temporary)>& write);

/// Finds out before a long run whether `path` could be written. \throw WriteError
void require_writable(const std::string& path);

/// Writes `bytes` to `path` through replace_file(), and calls `before_rename` in between. \throw WriteError
void write_file(const std::string& path, const std::string& bytes, const std::function<void()>& before_rename = {});

}  // namespace vdb_offset
