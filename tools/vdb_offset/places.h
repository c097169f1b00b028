#pragma once

#include <span>
#include <string>
#include <vector>

#include "args.h"

namespace vdb_offset::tool {

/// A file that a run reads or writes, and the option that names it.
struct Place {
  std::string option, path;
  bool may_be_input = false;  ///< Of what is written: it may take the place of INPUT, which is complete by then.
};

/// \throw UsageError, which names both, if anything that is written is also read, or is written twice: by whatever
/// path, through links and hard links. `-` is standard input or output, whatever these are.
void require_apart(std::span<const Place> read, std::span<const Place> written);

/// The same for all that a run is told of: once for what the command line says, and again for what is known when the
/// input has been read, before anything is written. `layers`: how many surfaces are written, if that is known.
void require_apart(const Arguments& args, std::size_t layers = 0, const std::string& mesh_of_scene = {});

/// Whether a path is standard output, as `-` and /dev/stdout are.
bool is_standard_output(const std::string& path);

/// The files that options name which `check` has as well.
std::vector<Place> surroundings_of(const Arguments& args);

}  // namespace vdb_offset::tool
