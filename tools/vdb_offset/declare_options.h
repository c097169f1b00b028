#pragma once

#include <optional>
#include <string>
#include <vector>

#include "args.h"

namespace vdb_offset::tool {

/// What stands above and below the options in --help.
extern const char* const kAbout;
extern const char* const kMore;

/// What CLI11 fills in before it is checked.
struct Raw {
  std::vector<std::string> distances, only, symmetry;
  std::optional<std::string> layers, growth, adaptivity;
  std::string distance_from, distance_xy, distance_z, first_height, total_thickness, heights;
  bool structured = false, keep_specks = false;
  std::string max_memory, clearance, inner, weld = "auto", orient = "keep";
  std::optional<std::string> solver, collision, border, format, transport;
  std::string mode = "topology";
  std::optional<std::string> inside;
  std::string normals = "recompute";
  std::optional<std::string> voxel_size, voxels_per_distance;
  std::optional<std::string> precision;
  std::string threads = "0";
};

/// Tells CLI11 of the options of an offset, which it puts into `args` and `raw`.
void declare(CLI::App& app, Arguments& args, Raw& raw);

}  // namespace vdb_offset::tool
