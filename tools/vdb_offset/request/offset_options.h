// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "request/command_line.h"
#include "request/request.h"

namespace vdb_offset::tool {

/// Declares the options that say how CAD models become meshes.
void declare_level_set(CommandLine& line, Request& request);
void declare_cad(CommandLine& line, Request& request);

/// Declares the options that give parts distances of their own.
void declare_part_distances(CommandLine& line, Request& request);
/// Takes a plane of --symmetry, or that none are to be found.
void take_plane(const std::string& text, Request& request);

/// Where parts alone have distances, the rest stays.
void complete_part_distances(Request& request);

/// A request that is being made, and values that become part of it only if another option says so.
struct Draft {
  Request request;
  bool no_sync = false;
  IsoRequest iso;
  LayersRequest layers;
  bool asks_for_layers = false;
  bool fills = false;
  FillRequest fill;
  ToleranceRequest tolerance;
  std::string distance_xy, distance_z;
};

/// Sets of options that say the same thing in other ways, as how far the offset goes. What the command line has of a
/// set stands in the place of all that a file or a preset has of it.
std::vector<std::vector<std::string>> alternative_options();

/// Declares the options of layers (layer_options.cpp).
void declare_layers(CommandLine& line, Draft& draft);
/// Settles whether layers are asked for, by what is given, before rules are applied to that. \throw UsageError unless
/// what is given of layers says the rest
void settle_given_layers(Draft& draft);
/// Makes layers part of the request if they are asked for.
void complete_layers(Draft& draft);

/// Declares the options that say how the rest of the domain is filled (fill_options.cpp).
void declare_fill(CommandLine& line, Draft& draft);
/// Declares those of patches, flows and cases for solvers (case_options.cpp).
void declare_case(CommandLine& line, Draft& draft);

/// Declares all options of an offset. \pre the draft lives as long as the command line
void declare_offset_options(CommandLine& line, Draft& draft);

}  // namespace vdb_offset::tool
