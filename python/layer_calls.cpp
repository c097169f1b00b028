// SPDX-License-Identifier: Apache-2.0
// Calls for layers of cells.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "calls.h"
#include "distance_values.h"
#include "interruptible.h"
#include "keywords.h"
#include "results.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/layer_plan.h"
#include "vdb_offset/run.h"
#include "volume_arrays.h"

namespace vdb_offset::python {

py::list plan(Input input, const py::object& vertices, const py::object& faces, const py::dict& known,
              const py::dict& keywords) {
  const Source source(input, vertices, faces, keywords);
  const AskedOptions asked = asked_options(keywords, source);
  const auto length = [&](const char* name) -> std::optional<Distances> {
    const py::object given = known[name];
    if (given.is_none()) return std::nullopt;
    return distances_of(given, source, asked, name);
  };
  LayerPlan layers{.first = length("first"), .total = length("total"), .last = length("last")};
  if (!known["count"].is_none()) layers.count = known["count"].cast<std::size_t>();
  if (!known["growth"].is_none()) layers.growth = known["growth"].cast<double>();
  py::list heights;
  for (const Distances& each : plan_layers(layers))
    if (each.uniform()) heights.append(each[0]);
    else heights.append(distances_array(each, source.view().positions.size()));
  return heights;
}

namespace {

/// Layers, and either their cells or a block of them.
struct Grown {
  LayersResult layers;
  LayerReport report;
  VolumeMesh cells;
  StructuredBlock block;
};

enum class Product : bool { Cells, Block };

/// The angle of fans, as the command has it; a block has none.
double fan_angle_of(const py::dict& keywords, std::optional<Corners> corners, Product product) {
  std::optional<double> angle;
  Keywords(keywords).read("fan_angle", angle);
  if (product == Product::Block) return 0;
  constexpr double kDefault = 60;
  return angle.value_or(corners == Corners::Miter ? 0 : kDefault);
}

Grown grow_on_curves(CurvesView curves, std::span<const Distances> heights, const OffsetOptions& options,
                     double fan_angle, Product product) {
  FannedCurveLayers fanned = grow_fanned_curve_layers(curves, heights, options, fan_angle);
  Grown grown{std::move(fanned.layers), {}, {}, {}};
  CurveCells cells = make_curve_cells(fanned.wall ? fanned.wall->view() : curves, grown.layers);
  grown.report =
      report_layers(cells.segments.view(), grown.layers, {}, cells.facts, measure_curve_cells(cells, grown.layers));
  if (product == Product::Block) grown.block = make_curve_block(curves, grown.layers);
  else grown.cells = std::move(cells.mesh);
  grown.report.boundary = patch_facts(grown.cells);
  return grown;
}

/// What a mesh has and curves do not: names of its faces, and rules for cells.
struct Walls {
  WallNames names;
  CellRules rules = CellRules::AnySolver;
  double fan_angle = 0;
};

/// The names of faces, which are numbered as they come first. \throw InvalidInput unless each face has one
WallNames wall_names(const py::object& given, std::size_t faces) {
  WallNames walls;
  if (given.is_none()) return walls;
  const auto refuse = [&](const std::string& got) {
    throw InvalidInput("walls: expected a name, a text, for each of " + std::to_string(faces) + " faces, got " + got);
  };
  if (py::isinstance<py::str>(given) || !py::isinstance<py::iterable>(given)) refuse(Keywords::text_of(given));
  std::unordered_map<std::string, std::uint32_t> numbers;
  for (const py::handle each : given) {
    if (!py::isinstance<py::str>(each)) refuse(py::repr(each).cast<std::string>());
    auto name = each.cast<std::string>();
    const auto [known, is_new] = numbers.try_emplace(name, static_cast<std::uint32_t>(walls.names.size()));
    if (is_new) walls.names.push_back(name.empty() ? "wall" : std::move(name));
    walls.of_face.push_back(known->second);
  }
  if (walls.of_face.size() != faces) refuse(std::to_string(walls.of_face.size()));
  return walls;
}

Walls walls_of(const py::dict& given, std::size_t faces, std::optional<Corners> corners, Product product) {
  const Keywords keywords(given);
  Walls walls{.names = wall_names(keywords["walls"], faces), .fan_angle = fan_angle_of(given, corners, product)};
  keywords.read("cells", walls.rules,
                std::array{std::pair{"any", CellRules::AnySolver}, std::pair{"openfoam", CellRules::OpenFoam}});
  return walls;
}

Grown grow_on_mesh(PolygonView mesh, std::span<const Distances> heights, const OffsetOptions& options,
                   const Walls& walls, Product product) {
  FannedLayers fanned = grow_fanned_layers(mesh, heights, options, walls.fan_angle, walls.rules);
  Grown grown{std::move(fanned.layers), {}, {}, {}};
  const PolygonView wall = fanned.wall ? fanned.wall->polygons.view() : mesh;
  const WallNames names = fanned.wall ? names_of_pieces(walls.names, *fanned.wall) : walls.names;
  MeasuredCells cells(wall, grown.layers);
  grown.report = report_layers(wall, grown.layers, names, cells.facts(), cells.quality());
  if (product == Product::Block) {
    grown.block = make_block(mesh, grown.layers);
    grown.report.inverted_block_cells = inverted_cells(grown.block);
  } else {
    grown.cells = std::move(cells).make(names);
    grown.report.boundary = patch_facts(grown.cells);
  }
  return grown;
}

py::dict grown_arrays(Input input, Product product, const py::object& vertices, const py::object& faces,
                      const py::list& heights, const py::dict& keywords, const py::object& progress) {
  const auto start = Clock::now();
  const Source source(input, vertices, faces, keywords, MeshArrays::Corners::Copied);
  AskedOptions asked = asked_options(keywords, source);
  const std::vector<Distances> wanted = distances_of_all(heights, source, asked);
  const Walls walls = walls_of(keywords, source.view().face_count(), asked.options.corners, product);
  Interruptible run(progress, Keywords(keywords)["reserve"]);
  run.attach(asked.options);
  Grown grown = run([&] {
    return source.curves() ? grow_on_curves(source.view(), wanted, asked.options, walls.fan_angle, product)
                           : grow_on_mesh(source.view(), wanted, asked.options, walls, product);
  });
  RunFacts facts = facts_of_run("", start);
  facts.layers = std::move(grown.report);
  py::dict statistics = from_json(report_json(grown.layers, facts));
  // The input's vertices come first, of an opened edge as one of their copies.
  const std::size_t vertex_count = source.view().positions.size();
  grown.layers.states.resize(vertex_count);
  grown.layers.share.resize(vertex_count);
  grown.layers.achieved.resize(vertex_count);
  const auto count = static_cast<py::ssize_t>(vertex_count);
  py::dict all =
      product == Product::Block ? block_as_dict(std::move(grown.block)) : volume_as_dict(std::move(grown.cells));
  all["statistics"] = std::move(statistics);
  all["states"] = states_of(grown.layers.states);
  all["share"] = owning_array(std::move(grown.layers.share), {count});
  all["achieved"] = owning_array(std::move(grown.layers.achieved), {count});
  return all;
}

}  // namespace

py::dict layer_arrays(Input input, const py::object& vertices, const py::object& faces, const py::list& heights,
                      const py::dict& keywords, const py::object& progress) {
  return grown_arrays(input, Product::Cells, vertices, faces, heights, keywords, progress);
}

py::dict block_arrays(Input input, const py::object& vertices, const py::object& faces, const py::list& heights,
                      const py::dict& keywords, const py::object& progress) {
  return grown_arrays(input, Product::Block, vertices, faces, heights, keywords, progress);
}

}  // namespace vdb_offset::python
