// SPDX-License-Identifier: Apache-2.0
// The options of --fill, and what each of them sets.
#include <fmt/format.h>

#include <array>
#include <limits>
#include <string>

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

}  // namespace

void declare_fill(CommandLine& line, Draft& draft) {
  FillRequest& fill = draft.fill;
  line.flag("--fill",
            "With --layers: fill the rest of the domain with tetrahedra: the inside of a closed surface with "
            "layers inside of it, or the outside of bodies, out to the farfield",
            draft.fills);
  line.option("--fill-with", "FILLER",
              "With --fill: 'netgen', or what has to be installed: 'tetgen' is 10 to 30 times as fast, with worse "
              "cells, 'gmsh' 2 to 5 times [netgen]",
              fill.with, [](const std::string& text) {
                constexpr std::array kFillers{FillWith::Netgen, FillWith::TetGen, FillWith::Gmsh};
                return kFillers[parse_word("--fill-with", text, {"netgen", "tetgen", "gmsh"})];
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
