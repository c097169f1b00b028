// SPDX-License-Identifier: Apache-2.0
#include "results.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "vdb_offset/api.h"
#include "vdb_offset/field.h"
#include "vdb_offset/run.h"

namespace vdb_offset::python {

py::object from_json(const std::string& text) { return py::module_::import("json").attr("loads")(text); }

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

py::object face_errors_of(std::vector<float> errors, const Source& source, const AskedOptions& asked) {
  if (!asked.options.keep_face_errors) return py::none();
  const std::size_t count = source.view().face_count();
  if (errors.empty()) errors.assign(count, std::numeric_limits<float>::quiet_NaN());
  return owning_array(std::move(errors), {static_cast<py::ssize_t>(count)});
}

py::dict as_dict(OffsetResult result, const RunFacts& run, const Source& source, const AskedOptions& asked) {
  const std::size_t count = result.positions.size();
  py::dict all;
  all["statistics"] = from_json(report_json(result, run));
  all["distances"] = distances_array(result.distances, count);
  all["states"] = states_of(result.states);
  all["achieved"] = owning_array(std::move(result.achieved), {static_cast<py::ssize_t>(count)});
  py::list paths;
  for (auto& path : result.paths) paths.append(owning_array(std::move(path)));
  all["paths"] = result.paths.empty() ? py::object(py::none()) : py::object(paths);
  all["face_errors"] = face_errors_of(std::move(result.face_errors), source, asked);
  all["positions"] = owning_array(std::move(result.positions));
  return all;
}

RunFacts facts_of_run(const std::string& distance, Clock::time_point start) {
  RunFacts run;
  run.distance_text = distance;
  run.total_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return run;
}

std::string text_of(const py::object& distance) {
  if (py::isinstance<py::str>(distance) || py::isinstance<py::float_>(distance) || py::isinstance<py::int_>(distance))
    return py::str(distance).cast<std::string>();
  return "an array";
}

void require_field(const AskedOptions& asked, std::span<const Distances> distances) {
  const auto is_none = [](const Distances& each) { return each.scale() == 0; };
  if (!asked.vdb.empty() && std::all_of(distances.begin(), distances.end(), is_none))
    throw InvalidOption("save_vdb: expected a distance other than 0, which needs a field");
}

void save_field(const AskedOptions& asked, const OffsetResult& result, const std::string& distance) {
  if (asked.vdb.empty()) return;
  save_vdb(*result.field, asked.vdb,
           {{"source", "arrays"}, {"offset_distance", distance}, {"made_by", std::string("vdb_offset ") + version()}});
}

}  // namespace vdb_offset::python
