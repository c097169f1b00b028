#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace vdb_offset {

/// Lets `write` make a file under a temporary name beside `path`, then renames it to `path`. Whatever happens,
/// `path` is either what it was or complete, and no temporary file stays. `write` gets the temporary name.
/// `write` may call replace_file() for another file, which is then in place first.
/// \throw WriteError if the rename fails, and whatever `write` throws.
void replace_file(const std::string& path, const std::function<void(const std::string& temporary)>& write);

/// Finds out before a long run whether `path` could be written. \throw WriteError
void require_writable(const std::string& path);

/// Where a file's bytes go, run by run.
using Sink = std::function<void(std::string_view)>;

/// Writes what `produce` hands to its sink to `path` through replace_file(), and calls `before_rename` in between.
/// "-" is standard output. \throw WriteError
void write_file(const std::string& path, const std::function<void(const Sink&)>& produce,
                const std::function<void()>& before_rename = {});

/// The same for bytes that are all there.
void write_file(const std::string& path, std::string_view bytes, const std::function<void()>& before_rename = {});

/// Removes the temporary files of replace_file() that are under way. For signal handlers that end the process.
void remove_temporary_file() noexcept;

}  // namespace vdb_offset
