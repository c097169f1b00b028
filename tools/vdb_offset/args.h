#pragma once

#include <optional>
#include <string>
#include <vector>

#include "vdb_offset/error.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/scene/scene.h"

namespace vdb_offset::tool {

/// What the command line asks for.
struct Arguments {
  std::string input, output;
  std::optional<scene::Distance> distance;  ///< Empty only for a scene, which brings its own.
  std::string distance_text;
  OffsetOptions options;               ///< All but the distance, which may need the mesh's diagonal, and progress.
  std::optional<Solver> solver;        ///< As given; a scene's own counts otherwise.
  std::optional<Collision> collision;  ///< The same.
  std::string weld_text, orient_text;  ///< As given.
  std::string report, states, vdb;
  std::optional<io::Format> format;  ///< Of files whose ending names none.
  io::WriteOptions write;            ///< All but its format, which is the output's alone.
  bool strict = false, dry_run = false, quiet = false, verbose = false;
};

/// The format of a mesh by its name, or else the one that was given.
std::optional<io::Format> format_of(const std::string& path, const Arguments& args);

/// A command line that cannot be carried out.
struct UsageError : Error {
  using Error::Error;
};

/// 'exact', 'none' or a tolerance. \throw UsageError
WeldOptions parse_weld(const std::string& text);

/// 'keep' or 'fix-direction-only'. \throw UsageError
Orient parse_orient(const std::string& text);

/// Parses the command line. Empty if it asked only for help or the version, which are then printed.
/// \throw UsageError with one line that says what is wrong.
std::optional<Arguments> parse_arguments(int argc, const char* const* argv);

}  // namespace vdb_offset::tool
