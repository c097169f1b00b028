// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "vdb_offset/api.h"
#include "vdb_offset/run.h"

namespace vdb_offset {

class Temporary;

/// Files that are put in place together, or not at all.
///
/// While one lives, what replace_file() writes on the same thread waits under a temporary name; commit() puts all of it
/// in place. One that begins while another lives hands over to that one instead. What has not been committed goes with
/// it: then all is as it was before.
class VDB_OFFSET_API OutputFiles {
 public:
  /// Whether what is put in place is on the disk before, so that after a loss of power, too, a file is as it was before
  /// or complete.
  enum class Sync { Yes, No };

  explicit OutputFiles(Sync sync = Sync::Yes);
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;
  ~OutputFiles();

  /// Has writers report how much of what they write is done, as Stage::Write, if this is to hold so many files.
  void report_to(ProgressCallback progress, std::size_t files);
  /// What the writer of the next file on this thread reports its own share to. Empty if nobody asked for it.
  static ProgressCallback progress_of_next();

  /// Adds a new file for `target`, under a temporary name until commit(), which it returns. `path` is what messages
  /// call it. \throw WriteError
  const std::string& add_file(const std::filesystem::path& target, const std::string& path);
  /// Makes the folders of a path that are not there yet; they stay if this is committed. \throw WriteError
  void add_folders(const std::filesystem::path& folder);

  /// Puts the files in place, where links lead, with the permissions of those that were there, and calls
  /// `when_in_place` before a signal can end the process again (see remove_temporaries()). If one cannot be put there,
  /// those that have been are taken back. \throw WriteError
  void commit(const std::function<void()>& when_in_place = {});

 private:
  struct File;
  void require_one_each();
  void finish(File& file) const;
  void put_in_place(File& file) const;
  static void put_back(File& file);

  OutputFiles* const outer_;
  Sync sync_;
  std::vector<File> files_;
  std::vector<Temporary> folders_;
  ProgressCallback progress_;
  std::size_t expected_files_ = 1, begun_files_ = 0;
};

/// The file that is made or replaced for a path, absolute: a link stays a link, and what it leads to is replaced,
/// whether or not that is there yet.
VDB_OFFSET_API std::filesystem::path replaced_path(const std::string& path);

/// Lets `write` make a file under a temporary name beside `path`, then puts it in the place of `path`. Whatever
/// happens, `path` is either what it was or complete, and no temporary file stays. `write` gets the temporary name. A
/// device or a pipe is written to as it is. \throw WriteError, and whatever `write` throws.
VDB_OFFSET_API void replace_file(const std::string& path,
                                 const std::function<void(const std::string& temporary)>& write);

/// Finds out before a long run whether `path` could be written. \throw WriteError
VDB_OFFSET_API void require_writable(const std::string& path);

/// Where a file's bytes go, run by run.
using Sink = std::function<void(std::string_view)>;

/// Writes what `produce` hands to its sink to `path` through replace_file(). "-" is standard output. \throw WriteError
VDB_OFFSET_API void write_file(const std::string& path, const std::function<void(const Sink&)>& produce);

/// Writes bytes to `path` through replace_file(). "-" is standard output. \throw WriteError
VDB_OFFSET_API void write_file(const std::string& path, std::string_view bytes);

/// Removes temporary files that runs on this machine have left in a folder as they were killed.
VDB_OFFSET_API void remove_stale_temporaries(const std::filesystem::path& folder) noexcept;

/// Removes all temporary files and folders that are there now; no others can be put in place from then on. For signal
/// handlers that end the process. False, and nothing is removed, if files are being put in place.
VDB_OFFSET_API bool remove_temporaries() noexcept;

}  // namespace vdb_offset
