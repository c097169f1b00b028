// SPDX-License-Identifier: Apache-2.0
// The options of --layers, and what several of them say together.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "request/command_line.h"
#include "request/offset_options.h"
#include "request/option_values.h"
#include "vdb_offset/layer_plan.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset::tool {
namespace {

/// How many lengths of layers are given: with a number of layers, or a growth, two of them say the rest.
std::size_t lengths_in(const GivenNames& given) {
  return (given.contains("--first-height") || given.contains("--y-plus") ? 1u : 0u) + given.count("--total-thickness") +
         given.count("--last-height");
}

/// The angle of fans over sharp edges, in degrees.
double parse_fan_angle(const std::string& text) {
  constexpr double kLeast = 5, kMost = 180;
  constexpr const char* kExpected = "0, or degrees from 5 to 180";
  const double angle = parse_number("--fan-angle", text, kExpected, -std::numeric_limits<double>::denorm_min(), kMost);
  if (angle > 0 && angle < kLeast) throw UsageError(fmt::format("--fan-angle: expected {}, got '{}'", kExpected, text));
  return angle;
}

/// y+ at the first height, below 0 for layers inward.
double parse_y_plus(const std::string& text) {
  const auto number = decimal<double>(text);
  require(number && std::isfinite(*number) && *number != 0,
          fmt::format("--y-plus: expected a finite number other than 0, got '{}'", text));
  return *number;
}

/// `x`, `y`, `z`, or three numbers.
Vec3d parse_axis(const std::string& text) {
  if (text != "x" && text != "y" && text != "z") return parse_vector("--periodic", text);
  Vec3d axis(0.0);
  axis[text[0] - 'x'] = 1;
  return axis;
}

/// Degrees, or a share of a circle, as 360/7.
std::optional<double> angle_of(std::string_view text) {
  const std::size_t slash = text.find('/');
  const auto above = decimal<double>(text.substr(0, slash));
  const auto below = slash == std::string_view::npos ? 1.0 : decimal<double>(text.substr(slash + 1));
  if (!above || !below || *above == 0 || *below == 0 || !std::isfinite(*above / *below)) return std::nullopt;
  return *above / *below;
}

/// `rotate:AXIS,ANGLE`, with `@X,Y,Z` behind the axis where it is not through the origin, or `translate:X,Y,Z`.
PeriodicMotion parse_motion(const std::string& text) {
  const std::string turn = "rotate:", shift = "translate:";
  const std::size_t comma = text.rfind(',');
  const bool is_shift = text.starts_with(shift);
  require(is_shift || (text.starts_with(turn) && comma != std::string::npos),
          fmt::format("--periodic: expected 'rotate:x,30' (or y, z, or A,B,C, and @X,Y,Z before the angle) or "
                      "'translate:X,Y,Z', got '{}'",
                      text));
  PeriodicMotion motion;
  if (is_shift) {
    motion.shift = parse_vector("--periodic", text.substr(shift.size()));
    require(motion.shift.length() > 0, fmt::format("--periodic: expected a shift other than 0, got '{}'", text));
    return motion;
  }
  const std::string line = text.substr(turn.size(), comma - turn.size());
  const std::size_t at = line.find('@');
  motion.axis = parse_axis(line.substr(0, at));
  if (at != std::string::npos) motion.point = parse_vector("--periodic", line.substr(at + 1));
  const auto angle = angle_of(std::string_view(text).substr(comma + 1));
  require(
      motion.axis.length() > 0 && angle,
      fmt::format("--periodic: expected an axis, and an angle other than 0, in degrees or as 360/7, got '{}'", text));
  motion.axis.normalize(0.0);
  motion.angle = *angle;
  return motion;
}

/// Where a preset says how many layers there are and how they grow, and the line gives two lengths, one of what the
/// preset says gives way.
void drop_of_preset(Draft& draft) {
  GivenNames& given = draft.request.given;
  if (lengths_in(given) < 2 || !given.contains("--layers") || !given.contains("--growth")) return;
  const auto is_of_preset = [&](const char* name) {
    return std::ranges::any_of(draft.request.of_preset, [&](const PresetOption& each) { return each.name == name; });
  };
  if (is_of_preset("--growth")) {
    given.erase("--growth");
    draft.layers.growth.reset();
  } else if (is_of_preset("--layers")) {
    given.erase("--layers");
    draft.layers.count = 0;
  }
}

}  // namespace

std::vector<LayerLength> LayersRequest::lengths() const {
  std::vector<LayerLength> given;
  if (first) given.push_back({"--first-height", &*first});
  if (total) given.push_back({"--total-thickness", &*total});
  if (last) given.push_back({"--last-height", &*last});
  return given;
}

void settle_given_layers(Draft& draft) {
  drop_of_preset(draft);
  GivenNames& given = draft.request.given;
  const std::size_t lengths = lengths_in(given);
  draft.asks_for_layers = given.contains("--layers") || given.contains("--heights") || lengths > 1;
  if (lengths < 2) return;
  require(lengths == 2 && !(given.contains("--layers") && given.contains("--growth")),
          "--layers: expected three of --layers, --growth, --first-height (or --y-plus), --total-thickness and "
          "--last-height, as the others follow from these");
  require(given.contains("--layers") || given.contains("--first-height") || given.contains("--y-plus"),
          "--total-thickness with --last-height needs --layers");
  // For rules about what goes with layers.
  given.insert("--layers");
}

void complete_layers(Draft& draft) {
  constexpr double kGrowth = 1.2;
  LayersRequest& layers = draft.layers;
  const bool follows = layers.count > 0 && lengths_in(draft.request.given) > 1;
  if (!layers.growth && !follows) layers.growth = kGrowth;
  if (draft.asks_for_layers) draft.request.layers = layers;
}

void declare_layers(CommandLine& line, Draft& draft) {
  Request& request = draft.request;
  LayersRequest& layers = draft.layers;
  const auto length = [&request](const char* option, std::optional<DistanceRequest>& taken) {
    return [option, &request, &taken](const std::string& text) { taken = parse_distance_of(option, text, request); };
  };
  line.option(
      "--layers", "N",
      "Grow N layers of cells: with --first-height, --total-thickness or --last-height, and --growth or another "
      "of them; OUTPUT is .vtu, .msh, .cgns, .su2, a folder called polyMesh, or a mesh for each layer",
      layers.count, count_between("--layers", 1, static_cast<int>(kMostLayers)));
  line.option("--first-height", "A", "Height of the first layer, as --distance",
              length("--first-height", layers.first));
  line.option("--total-thickness", "T", "Height of all layers together, as --distance",
              length("--total-thickness", layers.total));
  line.option("--last-height", "B",
              "Height of the outermost layer alone, as --distance; the mean length of the edges around a vertex, edge, "
              "makes its cells as high as they are wide",
              length("--last-height", layers.last));
  line.option("--growth", "R",
              "Ratio of each layer's height to that of the layer below; without --layers the largest one allowed [1.2, "
              "or what the others say]",
              layers.growth, number_between("--growth", "a number above 0, up to 10", 0, kMostGrowth));
  line.option("--y-plus", "Y",
              "In place of --first-height: the height at which y+ is Y, by the law for a flat plate; below 0 inward; "
              "needs --reynolds or --viscosity",
              layers.y_plus, parse_y_plus);
  line.repeated("--layers-of", "PART:H",
                "For one part, in place of --first-height, or of --total-thickness or --last-height where that is not "
                "given: PART as for --only, as in group=nose:0.1%; may be repeated, the last for a face counts",
                [&request](const std::string& text) {
                  request.distance_of_texts.push_back(text);
                  request.distances_of.push_back(parse_distance_of_part("--layers-of", text, request));
                });
  line.option("--heights", "FILE", "A file of heights above the wall, one in each line, each as --distance",
              layers.heights);
  line.option(
      "--fan-angle", "A",
      "Open edges that bend by more than A degrees into fans of cells, no two sides of which are farther apart; "
      "5 to 180, or 0 for none [60 for files of cells without --corners miter, else 0]",
      layers.fan_angle, parse_fan_angle);
  line.option(
      "--periodic", "MOTION",
      "The mesh is one period of a shape: layers on its borders are those of the whole shape, and alike; MOTION takes "
      "one border to the other: 'rotate:AXIS,ANGLE' or 'translate:X,Y,Z'; AXIS is x, y, z or A,B,C, with @X,Y,Z behind "
      "it for a point that it goes through; ANGLE is in degrees, or as 360/7; without fans",
      request.periodic_text, [&request](const std::string& text) {
        request.periodic = parse_motion(text);
        return text;
      });
  line.flag("--structured",
            "With --layers: the mesh is a grid of quads, and OUTPUT a block of hexahedra: .vts, or Plot3D's .xyz",
            layers.structured);
}

}  // namespace vdb_offset::tool
