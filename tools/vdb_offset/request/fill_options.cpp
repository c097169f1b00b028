// SPDX-License-Identifier: Apache-2.0
// The options of --fill, and what each of them sets.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "request/command_line.h"
#include "request/offset_options.h"
#include "request/option_values.h"

namespace vdb_offset::tool {
namespace {

/// `sphere:R` or `box:R`, with an L behind the number where it is in lengths; anything else is the name of a file.
void take_farfield(const std::string& text, FillRequest& fill) {
  fill.farfield_text = text;
  const std::size_t colon = text.find(':');
  const std::string shape = text.substr(0, colon);
  if (colon == std::string::npos || (shape != "sphere" && shape != "box")) {
    fill.farfield.shape = Farfield::Shape::Given;
    fill.farfield_file = text;
    return;
  }
  std::string number = text.substr(colon + 1);
  fill.farfield.shape = shape == "box" ? Farfield::Shape::Box : Farfield::Shape::Sphere;
  fill.farfield.in_lengths = number.ends_with('L') || number.ends_with('l');
  if (fill.farfield.in_lengths) number.pop_back();
  const auto size = decimal<double>(number);
  require(
      size && *size > 0,
      fmt::format("--farfield: expected 'sphere:20L' or 'box:10L', in lengths of the wall, 'sphere:5' or 'box:5' in "
                  "world units, or a file, got '{}'",
                  text));
  fill.farfield.size = *size;
}

PatchRequest parse_patch(const std::string& text) {
  const std::size_t equals = text.find('='), colon = text.rfind(':');
  const bool has_kind = colon != std::string::npos && equals != std::string::npos && colon > equals;
  PatchRequest request;
  if (equals != std::string::npos) {
    request.patch = text.substr(0, equals);
    request.name = text.substr(equals + 1, has_kind ? colon - equals - 1 : std::string::npos);
  }
  constexpr std::pair<const char*, BoundaryPatch::Kind> kKinds[] = {{"wall", BoundaryPatch::Kind::Wall},
                                                                    {"inlet", BoundaryPatch::Kind::Inlet},
                                                                    {"outlet", BoundaryPatch::Kind::Outlet},
                                                                    {"symmetry", BoundaryPatch::Kind::Symmetry},
                                                                    {"farfield", BoundaryPatch::Kind::Outer}};
  if (has_kind)
    for (const auto& [word, kind] : kKinds)
      if (text.substr(colon + 1) == word) request.kind = kind;
  require(
      !request.patch.empty() && !request.name.empty() && has_kind == request.kind.has_value(),
      fmt::format("--patch: expected PATCH=NAME or PATCH=NAME:KIND, with a kind 'wall', 'inlet', 'outlet', 'symmetry' "
                  "or 'farfield', got '{}'",
                  text));
  return request;
}

Vec3d parse_direction(const std::string& text) {
  Vec3d direction(0.0);
  std::size_t at = 0;
  int count = 0;
  for (; at <= text.size() && count < 3; ++count) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    const auto number = decimal<double>(text.substr(at, comma - at));
    if (!number) break;
    direction[count] = *number;
    at = comma + 1;
  }
  require(count == 3 && at == text.size() + 1 && direction.length() > 0,
          fmt::format("--direction: expected three numbers as in 1,0,0, got '{}'", text));
  return direction;
}

}  // namespace

void declare_case(CommandLine& line, Draft& draft) {
  Request& request = draft.request;
  CaseRequest& made = request.solver_case;
  line.repeated("--patch", "PATCH=NAME",
                "Of files of cells: call a patch NAME, as in 'sides_1=inlet', and say what it is with 'NAME:wall', "
                "':inlet', ':outlet', ':symmetry' or ':farfield'; may be repeated",
                [&request](const std::string& text) { request.patches.push_back(parse_patch(text)); });
  line.option(
      "--case", "KIND:FOLDER",
      "With --fill, and OUTPUT FOLDER/constant/polyMesh: 'openfoam:FOLDER' writes what else simpleFoam needs for a "
      "steady laminar flow; files that are there stay",
      [&made](const std::string& text) {
        constexpr std::string_view kOpenFoam = "openfoam:";
        require(text.starts_with(kOpenFoam) && text.size() > kOpenFoam.size(),
                fmt::format("--case: expected 'openfoam:FOLDER', got '{}'", text));
        made.folder = text.substr(kOpenFoam.size());
      });
  const double most = std::numeric_limits<double>::max();
  line.option("--speed", "V", "With --case: the speed of the flow far away, and into inlets [1]", made.flow.speed,
              number_between("--speed", "a number above 0", 0, most));
  line.option("--direction", "X,Y,Z", "With --case: where the flow goes far away [1,0,0]", made.flow.direction,
              parse_direction);
  line.option("--viscosity", "NU", "With --case: the kinematic viscosity", made.viscosity,
              number_between("--viscosity", "a number above 0", 0, most));
  line.option("--reynolds", "RE", "With --case: the Reynolds number, in place of --viscosity", made.reynolds,
              number_between("--reynolds", "a number above 0", 0, most));
  line.option(
      "--length", "L",
      "With --case: the length that --reynolds and coefficients of forces refer to, world units [the longest side "
      "of INPUT's box]",
      made.length, number_between("--length", "a number above 0", 0, most));
}

void declare_fill(CommandLine& line, Draft& draft) {
  FillRequest& fill = draft.fill;
  line.flag("--fill",
            "With --layers: fill the rest of the domain with tetrahedra: the inside of a closed surface with "
            "layers inside of it, or the outside of bodies, out to the farfield",
            draft.fills);
  line.option("--fill-with", "FILLER",
              "With --fill: 'netgen', or 'tetgen', which has to be installed: 10 to 30 times as fast, with worse cells "
              "[netgen]",
              fill.by_tetgen, [](const std::string& text) {
                return parse_word("--fill-with", text, {"netgen", "tetgen"}) == 1;
              });
  line.option("--farfield", "WHERE",
              "With --fill around bodies: where the mesh ends: 'sphere:R' around the middle of the wall's box, 'box:R' "
              "which goes R beyond it on each side, with R in world units or as in 20L in lengths of the wall (the "
              "longest side of its box), or a file with a closed mesh [sphere:20L]",
              [&fill](const std::string& text) { take_farfield(text, fill); });
  line.option(
      "--caps", "KIND",
      "With --fill: 'flat' covers openings of the surface, each of which has to be flat: those of pipes by caps, "
      "which belong to the patches of sides, those of half bodies by a plane of symmetry; 'none' refuses them "
      "[flat]",
      fill.caps, [](const std::string& text) {
        return parse_word("--caps", text, {"flat", "none"}) == 0;
      });
  line.option("--fill-growth", "R", "With --fill: an edge is no more than R times as long as its neighbours [1.3]",
              fill.growth, number_between("--fill-growth", "a number above 1, up to 10", 1, 10));
  line.option("--fill-max", "H", "With --fill: no edge is to be longer, world units or percent, but for the farfield's",
              fill.longest, parse_fill_max);
  line.option(
      "--fill-quads", "HOW",
      "With --fill: over faces of four corners, 'split' parts them, and the cells behind them become polyhedra; "
      "'pyramids' puts pyramids on them [pyramids in .msh and .su2, else split]",
      fill.quads, [](const std::string& text) {
        return parse_word("--fill-quads", text, {"split", "pyramids"}) == 0 ? FillQuads::Split : FillQuads::Pyramids;
      });
  line.option("--fill-seconds", "S", "With --fill: give up after so many seconds [3600]", fill.seconds,
              number_between("--fill-seconds", "a number above 0", 0, std::numeric_limits<double>::max()));
  line.flag("--layers-anyway", "With --fill: write the layers alone where the rest cannot be filled",
            fill.layers_anyway);
}

}  // namespace vdb_offset::tool
