// SPDX-License-Identifier: Apache-2.0
#include <pybind11/stl.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <tuple>
#include <utility>

#include "arrays.h"
#include "interruptible.h"
#include "option_values.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/error.h"
#include "vdb_offset/report.h"
#include "vdb_offset/shell.h"
#include "vdb_offset/tolerance.h"
#include "vdb_offset/version.h"
#include "volume_arrays.h"

/// The module vdb_offset._core, which vdb_offset/__init__.py makes functions with keywords of. Results are dictionaries
/// of arrays that own what they show.
namespace vdb_offset::python {
namespace {

using Clock = std::chrono::steady_clock;

py::object from_json(const std::string& text) { return py::module_::import("json").attr("loads")(text); }

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

py::array states_of(const std::vector<VertexState>& states) {
  std::vector<std::uint8_t> numbers(states.size());
  std::transform(states.begin(), states.end(), numbers.begin(),
                 [](VertexState state) { return static_cast<std::uint8_t>(state); });
  return owning_array(std::move(numbers), {static_cast<py::ssize_t>(states.size())});
}

py::array distances_array(const Distances& distances, std::size_t count) {
  std::vector<double> each(count);
  for (std::size_t v = 0; v < count; ++v) each[v] = distances[v];
  return owning_array(std::move(each), {static_cast<py::ssize_t>(count)});
}

py::dict as_dict(OffsetResult result, const RunFacts& run) {
  const std::size_t count = result.positions.size();
  py::dict all;
  all["statistics"] = from_json(report_json(result, run));
  all["distances"] = distances_array(result.distances, count);
  all["states"] = states_of(result.states);
  all["achieved"] = owning_array(std::move(result.achieved), {static_cast<py::ssize_t>(count)});
  py::list paths;
  for (auto& path : result.paths) paths.append(owning_array(std::move(path)));
  all["paths"] = result.paths.empty() ? py::object(py::none()) : py::object(paths);
  all["positions"] = owning_array(std::move(result.positions));
  return all;
}

RunFacts facts_of_run(const std::string& distance, Clock::time_point start) {
  RunFacts run;
  run.distance_text = distance;
  run.total_seconds = seconds_since(start);
  return run;
}

std::string text_of(const py::object& distance) {
  if (py::isinstance<py::str>(distance) || py::isinstance<py::float_>(distance) || py::isinstance<py::int_>(distance))
    return py::str(distance).cast<std::string>();
  return "an array";
}

enum class Input : bool { Mesh, Curves };

/// The offsets of a mesh, or of curves, to each of some distances.
py::list offset_arrays(Input input, const py::object& vertices, const py::object& faces, const py::list& distances,
                       const py::dict& keywords, const py::object& progress) {
  const auto start = Clock::now();
  const MeshArrays mesh(vertices, faces);
  AskedOptions asked = asked_options(keywords, mesh);
  std::vector<Distances> wanted;
  for (const auto distance : distances)
    wanted.push_back(
        distances_of(py::reinterpret_borrow<py::object>(distance), mesh.view(), input == Input::Curves, asked.options));
  if (keywords.contains("distance_z") && wanted.size() > 1)
    throw InvalidOption("distance_z: expected one distance, got " + std::to_string(wanted.size()));
  for (const Distances& each : wanted) measure_by_axis(keywords, each, mesh.view(), asked.options.metric);
  Interruptible run(progress);
  asked.options.progress = run.progress();
  std::vector<OffsetResult> results = run([&] {
    return input == Input::Curves ? offset_curves(mesh.view(), wanted, asked.options)
                                  : offset_several(mesh.view(), wanted, asked.options);
  });
  py::list all;
  for (std::size_t i = 0; i < results.size(); ++i)
    all.append(as_dict(std::move(results[i]), facts_of_run(text_of(distances[i]), start)));
  return all;
}

py::dict fit_arrays(const py::object& vertices, const py::object& faces, const py::tuple& other, double clearance,
                    const py::dict& keywords, const py::object& progress) {
  const auto start = Clock::now();
  if (other.size() != 2) throw InvalidOption("other: expected a pair of vertices and faces");
  const MeshArrays mesh(vertices, faces), near(other[0], other[1]);
  AskedOptions asked = asked_options(keywords, mesh);
  Interruptible run(progress);
  asked.options.progress = run.progress();
  OffsetResult result = run([&] { return fit(mesh.view(), near.view(), clearance, asked.options); });
  return as_dict(std::move(result), facts_of_run("fit", start));
}

/// Of each added vertex the face that it comes from, the three vertices there and their shares.
py::dict origins_of(const std::vector<VertexOrigin>& added) {
  const auto count = static_cast<py::ssize_t>(added.size());
  std::vector<std::uint32_t> face, corners;
  std::vector<double> shares;
  for (const VertexOrigin& origin : added) {
    face.push_back(origin.face);
    corners.insert(corners.end(), origin.vertex.begin(), origin.vertex.end());
    shares.insert(shares.end(), origin.share.begin(), origin.share.end());
  }
  py::dict all;
  all["faces"] = owning_array(std::move(face), {count});
  all["vertices"] = owning_array(std::move(corners), {count, 3});
  all["shares"] = owning_array(std::move(shares), {count, 3});
  return all;
}

py::dict refined_arrays(const py::object& vertices, const py::object& faces, const py::object& distance,
                        const py::object& tolerance, std::size_t most_faces, const py::dict& keywords,
                        const py::object& progress) {
  const auto start = Clock::now();
  const MeshArrays mesh(vertices, faces);
  AskedOptions asked = asked_options(keywords, mesh);
  asked.options.distance = distances_of(distance, mesh.view(), false, asked.options);
  Tolerance within{.most_faces = most_faces, .precision = asked.options.precision};
  std::tie(within.share, within.length) = tolerance_of(tolerance);
  Interruptible run(progress);
  asked.options.progress = run.progress();
  RefinedOffset refined = run([&] { return offset_to_tolerance(mesh.view(), asked.options, within); });
  Refinement& refinement = refined.refinement;
  py::dict all = as_dict(std::move(refined.result), facts_of_run(text_of(distance), start));
  const auto count = static_cast<py::ssize_t>(refinement.parent.size());
  all["faces"] = faces_of(refinement.polygons);
  all["source"] = owning_array(std::move(refinement.polygons.positions));
  all["parents"] = owning_array(std::move(refinement.parent), {count});
  all["added"] = origins_of(refinement.added);
  return all;
}

py::dict shell_arrays(const py::object& vertices, const py::object& faces, const py::object& distance,
                      const py::dict& keywords, const py::object& progress) {
  const auto start = Clock::now();
  const MeshArrays mesh(vertices, faces);
  AskedOptions asked = asked_options(keywords, mesh);
  asked.options.distance = distances_of(distance, mesh.view(), false, asked.options);
  asked.options.off_source = true;
  Interruptible run(progress);
  asked.options.progress = run.progress();
  auto [result, shell] = run([&] {
    OffsetResult offset_result = offset(mesh.view(), asked.options);
    Shell made = shell_of(mesh.view(), offset_result, asked.options);
    tell_states(made, offset_result);
    return std::pair(std::move(offset_result), std::move(made));
  });
  RunFacts facts = facts_of_run(text_of(distance), start);
  facts.shell = shell.facts;
  std::vector<std::uint8_t> parts(shell.polygons.face_count());
  std::vector<std::uint32_t> sources(parts.size());
  for (std::size_t f = 0; f < parts.size(); ++f) {
    parts[f] = static_cast<std::uint8_t>(shell.part(f));
    sources[f] = shell.source_face(f);
  }
  const auto count = static_cast<py::ssize_t>(parts.size());
  py::dict all = as_dict(std::move(result), facts);
  all["faces"] = faces_of(shell.polygons);
  all["parts"] = owning_array(std::move(parts), {count});
  all["source_faces"] = owning_array(std::move(sources), {count});
  all["vertices"] = owning_array(std::move(shell.polygons.positions));
  return all;
}

/// A distance as a number, or as an array with one for each vertex.
py::object evaluate(Input input, const py::object& vertices, const py::object& faces, const py::object& distance,
                    const py::dict& keywords) {
  const MeshArrays mesh(vertices, faces);
  const AskedOptions asked = asked_options(keywords, mesh);
  const Distances distances = distances_of(distance, mesh.view(), input == Input::Curves, asked.options);
  if (distances.uniform()) return py::float_(distances[0]);
  return distances_array(distances, mesh.view().positions.size());
}

py::dict layer_arrays(Input input, const py::object& vertices, const py::object& faces, const py::list& heights,
                      const py::dict& keywords, const py::object& progress) {
  const auto start = Clock::now();
  const MeshArrays mesh(vertices, faces, MeshArrays::Corners::Copied);
  AskedOptions asked = asked_options(keywords, mesh);
  std::vector<Distances> wanted;
  for (const auto height : heights)
    wanted.push_back(
        distances_of(py::reinterpret_borrow<py::object>(height), mesh.view(), input == Input::Curves, asked.options));
  Interruptible run(progress);
  asked.options.progress = run.progress();
  struct Grown {
    LayersResult layers;
    LayerReport report;
    VolumeMesh cells;
  };
  Grown grown = run([&]() -> Grown {
    if (input == Input::Curves) {
      LayersResult layers = grow_curve_layers(mesh.view(), wanted, asked.options);
      CurveCells cells = make_curve_cells(mesh.view(), layers);
      LayerReport report =
          report_layers(cells.segments.view(), layers, {}, cells.facts, measure_curve_cells(cells, layers));
      return {std::move(layers), std::move(report), std::move(cells.mesh)};
    }
    LayersResult layers = grow_layers(mesh.view(), wanted, asked.options);
    MeasuredCells cells(mesh.view(), layers);
    LayerReport report = report_layers(mesh.view(), layers, {}, cells.facts(), cells.quality());
    VolumeMesh made = std::move(cells).make({});
    return {std::move(layers), std::move(report), std::move(made)};
  });
  RunFacts facts = facts_of_run("layers", start);
  facts.layers = std::move(grown.report);
  const auto count = static_cast<py::ssize_t>(grown.layers.states.size());
  py::dict all = volume_as_dict(std::move(grown.cells));
  all["statistics"] = from_json(report_json(grown.layers, facts));
  all["states"] = states_of(grown.layers.states);
  all["share"] = owning_array(std::move(grown.layers.share), {count});
  all["achieved"] = owning_array(std::move(grown.layers.achieved), {count});
  return all;
}

py::dict iso_arrays(const py::object& vertices, const py::object& faces, const py::object& distance,
                    const py::dict& keywords, const py::object& progress) {
  const auto start = Clock::now();
  const MeshArrays mesh(vertices, faces);
  IsoOptions options = iso_options(keywords);
  const Distances wanted = distances_of(distance, mesh.view(), false, {});
  if (!wanted.uniform()) throw InvalidOption("distance: expected one for all vertices of an iso-surface");
  options.distance = wanted[0];
  Interruptible run(progress);
  options.progress = run.progress();
  IsoResult result = run([&] { return make_iso_surface(mesh.view(), options); });
  py::dict all;
  all["statistics"] = from_json(report_json(result.statistics, facts_of_run(text_of(distance), start)));
  all["faces"] = faces_of(result.polygons);
  all["normals"] = owning_array(std::move(result.normals));
  all["vertices"] = owning_array(std::move(result.polygons.positions));
  return all;
}

py::dict check_arrays(Input input, const py::object& vertices, const py::object& faces, const py::object& positions,
                      const py::object& distance, const py::dict& keywords) {
  const MeshArrays mesh(vertices, faces, MeshArrays::Corners::Copied);
  const MeshArrays moved(positions, faces);
  const AskedOptions asked = asked_options(keywords, mesh);
  CheckOptions options = check_options(asked, keywords);
  if (!distance.is_none())
    options.distance = distances_of(distance, mesh.view(), input == Input::Curves, asked.options);
  else if (keywords.contains("distance_z")) throw InvalidOption("distance_z: expected a distance beside it, got none");
  if (options.distance) measure_by_axis(keywords, *options.distance, mesh.view(), options.metric);
  Interruptible run{py::none()};
  CheckResult result = run([&] {
    return input == Input::Curves ? check_curves(mesh.view(), moved.view().positions, options)
                                  : check_offset(mesh.view(), moved.view().positions, options);
  });
  const auto count = static_cast<py::ssize_t>(result.states.size());
  py::dict all;
  all["statistics"] = from_json(check_json(result, "", ""));
  all["valid"] = result.valid();
  all["states"] = states_of(result.states);
  all["distances"] = distances_array(result.distances, result.states.size());
  all["achieved"] = owning_array(std::move(result.achieved), {count});
  return all;
}

/// A class of exceptions that is one of the library's and one of Python's own.
py::object exception_class(py::module_& module, const char* name, const py::tuple& bases, const char* text) {
  const std::string full = "vdb_offset." + std::string(name);
  py::object made =
      py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(full.c_str(), text, bases.ptr(), nullptr));
  if (!made) throw py::error_already_set();
  module.attr(name) = made;
  return made;
}

/// The library's exceptions as Python's. Their classes live as long as the module does.
void add_exceptions(py::module_& module) {
  const auto builtin = [](PyObject* base) { return py::reinterpret_borrow<py::object>(base); };
  static const PyObject *error, *input, *option, *expression, *budget, *cancelled;
  const py::object base = exception_class(module, "Error", py::make_tuple(builtin(PyExc_Exception)),
                                          "Base class of all that the library raises on purpose.");
  const auto add = [&](const char* name, const py::object& above, PyObject* beside, const char* text) {
    return exception_class(module, name, beside ? py::make_tuple(above, builtin(beside)) : py::make_tuple(above), text);
  };
  const py::object of_input = add("InvalidInput", base, PyExc_ValueError, "A mesh or an option that cannot be used.");
  const py::object of_option =
      add("InvalidOption", base, PyExc_ValueError, "An option whose value cannot be understood.");
  const py::object of_expression =
      add("InvalidExpression", of_option, nullptr, "An expression that cannot be understood, with the column.");
  const py::object of_budget =
      add("OutOfBudget", base, PyExc_MemoryError, "Work that was refused before it started, as it would not fit.");
  const py::object of_cancelled = add("Cancelled", base, nullptr, "The progress callback asked to stop.");
  error = base.ptr();
  input = of_input.ptr();
  option = of_option.ptr();
  expression = of_expression.ptr();
  budget = of_budget.ptr();
  cancelled = of_cancelled.ptr();
  // NOLINTNEXTLINE(performance-unnecessary-value-param): pybind11's own signature
  py::register_exception_translator([](std::exception_ptr thrown) {
    const auto raise = [](const PyObject* type, const std::exception& e) {
      PyErr_SetString(const_cast<PyObject*>(type), e.what());
    };
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const py::cast_error& e) {  // a number out of range, or a text that is none
      raise(option, e);
    } catch (const InvalidExpression& e) {
      raise(expression, e);
    } catch (const InvalidOption& e) {
      raise(option, e);
    } catch (const InvalidInput& e) {
      raise(input, e);
    } catch (const OutOfBudget& e) {
      raise(budget, e);
    } catch (const Cancelled& e) {
      raise(cancelled, e);
    } catch (const Error& e) {
      raise(error, e);
    }
  });
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  add_exceptions(module);
  py::module_::import("atexit").attr("register")(py::cpp_function(&Calls::end));
  module.attr("version") = version();
  py::list states;
  for (std::size_t s = 0; s < kVertexStateCount; ++s) states.append(name(static_cast<VertexState>(s)));
  module.attr("states") = py::tuple(states);
  module.def("offset", [](const py::object& vertices, const py::object& faces, const py::list& distances,
                          const py::dict& keywords, const py::object& progress) {
    return offset_arrays(Input::Mesh, vertices, faces, distances, keywords, progress);
  });
  module.def("offset_curves", [](const py::object& points, const py::object& curves, const py::list& distances,
                                 const py::dict& keywords, const py::object& progress) {
    return offset_arrays(Input::Curves, points, curves, distances, keywords, progress);
  });
  module.def("evaluate",
             [](const py::object& vertices, const py::object& faces, const py::object& distance,
                const py::dict& keywords) { return evaluate(Input::Mesh, vertices, faces, distance, keywords); });
  module.def("layers", [](const py::object& vertices, const py::object& faces, const py::list& heights,
                          const py::dict& keywords, const py::object& progress) {
    return layer_arrays(Input::Mesh, vertices, faces, heights, keywords, progress);
  });
  module.def("evaluate_curves",
             [](const py::object& points, const py::object& curves, const py::object& distance,
                const py::dict& keywords) { return evaluate(Input::Curves, points, curves, distance, keywords); });
  module.def("curve_layers", [](const py::object& points, const py::object& curves, const py::list& heights,
                                const py::dict& keywords, const py::object& progress) {
    return layer_arrays(Input::Curves, points, curves, heights, keywords, progress);
  });
  module.def("fit", &fit_arrays);
  module.def("offset_to_tolerance", &refined_arrays);
  module.def("shell", &shell_arrays);
  module.def("iso_surface", &iso_arrays);
  module.def("check", [](const py::object& vertices, const py::object& faces, const py::object& positions,
                         const py::object& distance, const py::dict& keywords) {
    return check_arrays(Input::Mesh, vertices, faces, positions, distance, keywords);
  });
  module.def("check_curves", [](const py::object& points, const py::object& curves, const py::object& positions,
                                const py::object& distance, const py::dict& keywords) {
    return check_arrays(Input::Curves, points, curves, positions, distance, keywords);
  });
}

}  // namespace vdb_offset::python
