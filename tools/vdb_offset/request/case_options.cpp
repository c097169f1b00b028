// SPDX-License-Identifier: Apache-2.0
// The options of patches, of flows and of cases for solvers.
#include <fmt/format.h>

#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "request/command_line.h"
#include "request/offset_options.h"
#include "request/option_values.h"
#include "vdb_offset/io/volume_file.h"

namespace vdb_offset::tool {
namespace {

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
  require(
      io::is_patch_word(request.name),
      fmt::format("--patch: expected a name of letters, digits and . _ + - that begins with a letter or _, got '{}'",
                  request.name));
  return request;
}

Vec3d parse_direction(const std::string& text) {
  const Vec3d direction = parse_vector("--direction", text);
  require(direction.length() > 0, fmt::format("--direction: expected three numbers as in 1,0,0, got '{}'", text));
  return direction;
}

}  // namespace

void declare_case(CommandLine& line, Draft& draft) {
  Request& request = draft.request;
  CaseRequest& made = request.solver_case;
  FlowRequest& flow = request.flow;
  line.repeated("--patch", "PATCH=NAME",
                "Of files of cells: call a patch NAME, as in 'sides_1=inlet', and say what it is with 'NAME:wall', "
                "':inlet', ':outlet', ':symmetry' or ':farfield'; may be repeated",
                [&request](const std::string& text) { request.patches.push_back(parse_patch(text)); });
  line.option(
      "--case", "KIND:FOLDER",
      "With --fill: what else a solver needs for a steady laminar flow: 'openfoam:FOLDER' for simpleFoam, with OUTPUT "
      "FOLDER/constant/polyMesh, or 'su2:FOLDER', with OUTPUT a .su2 file in FOLDER; files that are there stay",
      [&made](const std::string& text) {
        constexpr std::string_view kOpenFoam = "openfoam:", kSu2 = "su2:";
        made.of_su2 = text.starts_with(kSu2);
        const std::size_t begin = made.of_su2 ? kSu2.size() : kOpenFoam.size();
        require((made.of_su2 || text.starts_with(kOpenFoam)) && text.size() > begin,
                fmt::format("--case: expected 'openfoam:FOLDER' or 'su2:FOLDER', got '{}'", text));
        made.folder = text.substr(begin);
      });
  const double most = std::numeric_limits<double>::max();
  const auto above_0 = [most](const char* option) { return number_between(option, "a number above 0", 0, most); };
  line.option("--speed", "V", "The speed of the flow far away, and into inlets [1]", flow.given.speed,
              above_0("--speed"));
  line.option("--direction", "X,Y,Z", "With --case: where the flow goes far away [1,0,0]", flow.given.direction,
              parse_direction);
  line.option("--viscosity", "NU", "The kinematic viscosity of the flow; with --density, the dynamic one",
              flow.viscosity, above_0("--viscosity"));
  line.option("--density", "RHO", "The density of the flow: then --viscosity is the dynamic one", flow.density,
              above_0("--density"));
  line.option("--reynolds", "RE", "The flow's Reynolds number, in place of --viscosity", flow.reynolds,
              above_0("--reynolds"));
  line.option(
      "--length", "L",
      "The length that --reynolds, --y-plus and coefficients of forces refer to, world units [the longest side of "
      "INPUT's box]",
      flow.length, above_0("--length"));
}

}  // namespace vdb_offset::tool
