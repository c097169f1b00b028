// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "messages/cad_messages.h"
#include "write/write_model.h"

namespace vdb_offset::cad {

/// A file in memory, which has a name for as long as this lives.
class MemoryFile {
 public:
  MemoryFile();
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }
  void write(std::string_view all) const;  ///< In place of what it has.
  std::string bytes() const;

 private:
  int descriptor_;
};

/// Writes a file in a process of its own: what OpenCASCADE's writer sets for units, its reader would take for its own.
void write_apart(const WrittenModel& model, const std::string& format, const std::string& path);

/// How long a process may take: seconds of a processor, 0: any number; and seconds by the clock, > 0.
struct MostTime {
  unsigned of_processor;
  double in_all;
};

/// Keeps an answer for the case that no better one is found in time.
using Keep = std::function<void(std::string_view)>;

/// Does work in a process of its own. If that is ended by a signal or an exception: what it has kept, or nothing; `gap`
/// then says so.
std::optional<std::string> in_own_process(const std::function<std::string(const Keep&)>& work, const MostTime& most,
                                          std::string& gap);

/// Lets this process have so many more seconds of a processor.
void limit_seconds(unsigned seconds);

}  // namespace vdb_offset::cad
