// SPDX-License-Identifier: Apache-2.0
#include "distance_values.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "keywords.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/run.h"

namespace vdb_offset::python {
namespace {

Distances distances_of_text(const std::string& text, const Source& source, const AskedOptions& asked,
                            const std::string& what) {
  const PolygonView mesh = source.view();
  const auto normals = [&] {
    return source.curves() ? curve_normals(mesh) : vertex_normals(mesh, asked.options.weld, asked.options.orient);
  };
  const auto texture = [&] {
    if (!asked.texture.empty()) return asked.texture;
    throw InvalidInput(what + ": expected an expression without u and v, as " +
                       (source.curves() ? "curves have no texture coordinates" : "no texture was given"));
  };
  const auto edges = [&] { return source.curves() ? curve_edges(mesh) : mean_edges(mesh, asked.options.weld); };
  return distances_of(parse_distance_or_expression(text), mesh, {normals, texture, edges});
}

}  // namespace

Distances distances_of(const py::object& distance, const Source& source, const AskedOptions& asked, const char* what) {
  const std::string name(what);
  if (py::isinstance<py::str>(distance)) return distances_of_text(distance.cast<std::string>(), source, asked, name);
  const auto numbers = [&]() -> py::array_t<double, py::array::c_style | py::array::forcecast> {
    try {
      return {distance};
    } catch (const py::error_already_set& error) {
      if (!error.matches(PyExc_TypeError) && !error.matches(PyExc_ValueError)) throw;
      throw InvalidOption(name + ": expected a number, an array or a text, got " + Keywords::text_of(distance));
    }
  }();
  if (numbers.ndim() == 0) {
    if (!std::isfinite(*numbers.data()))
      throw InvalidOption(name + ": expected a finite number, got " + Keywords::text_of(distance));
    return *numbers.data();
  }
  const std::size_t vertices = source.view().positions.size();
  if (numbers.ndim() != 1 || static_cast<std::size_t>(numbers.size()) != vertices)
    throw InvalidInput(name + ": expected one for each of " + std::to_string(vertices) +
                       " vertices, got an array of the shape " + shape_of(numbers));
  return Distances(std::vector<double>(numbers.data(), numbers.data() + numbers.size()));
}

std::vector<Distances> distances_of_all(const py::list& distances, const Source& source, const AskedOptions& asked) {
  std::vector<Distances> all;
  for (const auto distance : distances)
    all.push_back(distances_of(py::reinterpret_borrow<py::object>(distance), source, asked));
  return all;
}

Distances inward_distances_of(const py::object& inner, const Source& source, const AskedOptions& asked,
                              std::span<const Distances> outer) {
  const Distances given = distances_of(inner, source, asked, "inner");
  if (given.inward() > 0 || (given.uniform() && given[0] == 0))
    throw InvalidInput("inner: expected a distance above 0, or distances of 0 or more, got " +
                       Keywords::text_of(inner));
  for (const Distances& each : outer)
    if (each.inward() > 0) throw InvalidInput("distance: expected distances of 0 or more at all vertices with inner");
  if (given.uniform()) return -given[0];
  std::vector<double> each(given.count());
  for (std::size_t v = 0; v < each.size(); ++v) each[v] = -given[v];
  return Distances(std::move(each));
}

std::pair<double, double> tolerance_of(const py::object& tolerance) {
  try {
    const GivenDistance asked = parse_distance(py::str(tolerance).cast<std::string>());
    if (asked.value > 0) return asked.percent ? std::pair(asked.value / 100, 0.0) : std::pair(0.0, asked.value);
  } catch (const InvalidInput&) {  // no number
  }
  throw InvalidOption("tolerance: expected a length above 0, or a text with one or percent of the distance, got " +
                      Keywords::text_of(tolerance));
}

std::optional<GivenDistance> length_of(const py::object& given) {
  GivenDistance length;
  if (py::isinstance<py::str>(given)) {
    try {
      return parse_distance(given.cast<std::string>());
    } catch (const InvalidInput&) {
      return std::nullopt;
    }
  }
  if (is_truth(given) || PyNumber_Check(given.ptr()) != 1) return std::nullopt;
  try {
    length.value = given.cast<double>();
  } catch (const py::cast_error&) {  // an array, or a number out of range
    return std::nullopt;
  }
  if (!std::isfinite(length.value)) return std::nullopt;
  return length;
}

namespace {

// The largest ratio of distances by axis, which a distance of 0 also gets: beyond this the lesser one drowns in the
// rounding of the larger one, as the command says.
constexpr double kMostRatio = 1000;

void require_alone(const py::list& distances, const Source& source, const AskedOptions& asked) {
  if (distances.size() != 1)
    throw InvalidOption("distance_z: expected a single distance with it, got " + std::to_string(distances.size()));
  if (!asked.vdb.empty()) throw InvalidOption("distance_z and save_vdb exclude each other");
  if (asked.obstacles) throw InvalidOption("distance_z and obstacles exclude each other");
  if (source.curves() && asked.options.precision.kind != Precision::Kind::Double)
    throw InvalidOption("distance_z and precision exclude each other for curves");
}

GivenDistance length_by_axis(const py::object& given, const char* name) {
  if (const auto length = length_of(given)) return *length;
  throw InvalidOption(std::string(name) + ": expected a number of world units, or a text with one or percent, as " +
                      "distances by axis are, got " + Keywords::text_of(given));
}

}  // namespace

std::optional<ByAxis> by_axis(const py::dict& keywords, const py::list& distances, const Source& source,
                              const AskedOptions& asked) {
  const py::object along = Keywords(keywords)["distance_z"];
  if (along.is_none()) return std::nullopt;
  require_alone(distances, source, asked);
  const py::object across = distances[0];
  GivenDistance xy = length_by_axis(across, "distance"), z = length_by_axis(along, "distance_z");
  if (xy.value == 0 && z.value == 0)
    throw InvalidOption("distance_z: expected one other than 0, as the distance is, got " + Keywords::text_of(along));
  const auto least_beside = [](GivenDistance other) {
    other.value /= kMostRatio;
    return other;
  };
  if (xy.value == 0) xy = least_beside(z);
  if (z.value == 0) z = least_beside(xy);
  const double diagonal = xy.percent || z.percent ? used_diagonal(source.view()) : 0,
               length = xy.in_world_units(diagonal), ratio = length / z.in_world_units(diagonal);
  if (!(ratio > 0) || !(std::max(ratio, 1 / ratio) <= kMostRatio * (1 + 1e-9)))
    throw InvalidOption("distance_z: expected the sign of the distance, and a size within " +
                        std::to_string(static_cast<int>(kMostRatio)) + " times it, either way, got " +
                        Keywords::text_of(along) + " with " + Keywords::text_of(across));
  const auto text = [](const py::object& given) { return py::str(given).cast<std::string>(); };
  return ByAxis{Metric::of_half_axes(length, z.in_world_units(diagonal)), length,
                text(across) + " xy " + text(along) + " z"};
}

}  // namespace vdb_offset::python
