// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

#include "vdb_offset/output_files.h"
namespace vdb_offset {

/// A file or an empty folder that goes again with this object, or when remove_temporaries() is called, unless it is
/// kept. Safe to use on any number of threads.
class Temporary {
 public:
  enum class Kind { File, Folder };

  /// Takes care of what is at `path`, or will be.
  Temporary(std::string path, Kind kind);
  Temporary(Temporary&& other) noexcept;
  Temporary& operator=(Temporary&&) = delete;
  ~Temporary();

  const std::string& path() const;
  /// The file or folder stays.
  void keep();

 private:
  struct Known;
  static Known& free_one();
  /// For remove_temporaries(), which may be called at any moment.
  static std::atomic<Known*> first_known;
  friend bool remove_temporaries() noexcept;

  Known* known_;  ///< Null once it is kept or moved from.
};

/// Makes an empty file beside `target`, of a name that nobody can guess and that was not there before. It is as long as
/// the target's own name: where the file system takes that one, it takes this one. The target's ending stays last, as
/// writers choose a format by it. Its permissions follow the process's mask. \throw WriteError, which names `path`
Temporary new_temporary_file(const std::filesystem::path& target, const std::string& path);

/// While it lives, remove_temporaries() does nothing. One at a time: others wait, and for ever once the process ends.
class PuttingInPlace {
 public:
  PuttingInPlace();
  PuttingInPlace(const PuttingInPlace&) = delete;
  PuttingInPlace& operator=(const PuttingInPlace&) = delete;
  ~PuttingInPlace();
};

}  // namespace vdb_offset
