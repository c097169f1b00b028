// SPDX-License-Identifier: Apache-2.0
// Calls for the positions of a mesh's own vertices, or of curves' points.
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "calls.h"
#include "distance_values.h"
#include "interruptible.h"
#include "keywords.h"
#include "results.h"
#include "vdb_offset/curve_offset.h"
#include "vdb_offset/offset.h"
#include "vdb_offset/run.h"

namespace vdb_offset::python {

py::list offset_arrays(Input input, const py::object& vertices, const py::object& faces, const py::list& distances,
                       const py::dict& keywords, const py::object& progress) {
  const auto start = Clock::now();
  const Source source(input, vertices, faces, keywords);
  AskedOptions asked = asked_options(keywords, source);
  std::vector<Distances> wanted = distances_of_all(distances, source, asked);
  std::vector<std::string> texts;
  for (const auto distance : distances) texts.push_back(text_of(py::reinterpret_borrow<py::object>(distance)));
  if (const auto axes = by_axis(keywords, distances, source, asked)) {
    asked.options.metric = axes->metric;
    wanted = {axes->distance};
    texts = {axes->text};
  }
  require_field(asked, wanted);
  constexpr std::size_t kResultBytes = 18000;  // a result as Python has it, whatever the mesh; measured
  asked.options.bytes_held += wanted.size() * kResultBytes;
  Interruptible run(progress, Keywords(keywords)["reserve"]);
  run.attach(asked.options);
  std::vector<OffsetResult> results = run([&] {
    std::vector<OffsetResult> made = source.curves() ? offset_curves(source.view(), wanted, asked.options)
                                                     : offset_several(source.view(), wanted, asked.options);
    save_field(asked, made.front(), texts.front());
    return made;
  });
  py::list all;
  for (std::size_t i = 0; i < results.size(); ++i)
    all.append(as_dict(std::move(results[i]), facts_of_run(texts[i], start), source, asked));
  return all;
}

py::dict fit_arrays(const py::object& vertices, const py::object& faces, const py::tuple& other,
                    const py::object& clearance, const py::dict& keywords, const py::object& progress) {
  const auto start = Clock::now();
  if (other.size() != 2) throw InvalidOption("other: expected a pair of vertices and faces");
  const Source source(Input::Mesh, vertices, faces, keywords);
  const MeshArrays near(other[0], other[1]);
  AskedOptions asked = asked_options(keywords, source);
  const double room = clearance_of(clearance, source.view());
  if (room == 0) throw InvalidOption("clearance: expected one above 0, got " + Keywords::text_of(clearance));
  Interruptible run(progress, Keywords(keywords)["reserve"]);
  run.attach(asked.options);
  OffsetResult result = run([&] { return fit(source.view(), near.view(), room, asked.options); });
  return as_dict(std::move(result), facts_of_run("fit", start), source, asked);
}

namespace {

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

}  // namespace

py::dict refined_arrays(const py::object& vertices, const py::object& faces, const py::object& distance,
                        const py::object& tolerance, std::size_t most_faces, bool ridges_only, const py::dict& keywords,
                        const py::object& progress) {
  const auto start = Clock::now();
  const Source source(Input::Mesh, vertices, faces, keywords);
  AskedOptions asked = asked_options(keywords, source);
  asked.options.distance = distances_of(distance, source, asked);
  Tolerance within{.most_faces = most_faces, .precision = asked.options.precision, .ridges_only = ridges_only};
  std::tie(within.share, within.length) = tolerance_of(tolerance);
  Interruptible run(progress, Keywords(keywords)["reserve"]);
  run.attach(asked.options);
  RefinedOffset refined = run([&] { return offset_to_tolerance(source.view(), asked.options, within); });
  Refinement& refinement = refined.refinement;
  py::dict all = as_dict(std::move(refined.result), facts_of_run(text_of(distance), start), source, asked);
  const auto count = static_cast<py::ssize_t>(refinement.parent.size());
  all["faces"] = faces_of(refinement.polygons);
  all["source"] = owning_array(std::move(refinement.polygons.positions));
  all["parents"] = owning_array(std::move(refinement.parent), {count});
  all["added"] = origins_of(refinement.added);
  return all;
}

namespace {

py::dict check_as_dict(CheckResult result, const Source& source, const AskedOptions& asked) {
  const std::size_t count = result.states.size();
  py::dict all;
  all["statistics"] = from_json(check_json(result, "", ""));
  all["valid"] = result.valid();
  all["states"] = states_of(result.states);
  all["distances"] = distances_array(result.distances, count);
  all["achieved"] = owning_array(std::move(result.achieved), {static_cast<py::ssize_t>(count)});
  all["face_errors"] = face_errors_of(std::move(result.face_errors), source, asked);
  return all;
}

}  // namespace

py::dict check_arrays(Input input, const py::object& vertices, const py::object& faces, const py::object& positions,
                      const py::object& distance, const py::object& tolerance, const py::dict& keywords,
                      const py::object& progress) {
  const Source source(input, vertices, faces, keywords, MeshArrays::Corners::Copied);
  const MeshArrays moved(positions, faces);
  const AskedOptions asked = asked_options(keywords, source);
  CheckOptions options = check_options(asked, tolerance);
  if (!distance.is_none()) {
    options.distance = distances_of(distance, source, asked);
    py::list one;
    one.append(distance);
    if (const auto axes = by_axis(keywords, one, source, asked)) {
      options.metric = axes->metric;
      options.distance = axes->distance;
      if (!tolerance.is_none()) throw InvalidOption("distance_z and tolerance exclude each other");
    }
  } else if (keywords.contains("distance_z")) {
    throw InvalidOption("distance_z: needs a distance as well");
  }
  Interruptible run(progress, Keywords(keywords)["reserve"]);
  run.attach(options);
  CheckResult result = run([&] {
    return source.curves() ? check_curves(source.view(), moved.view().positions, options)
                           : check_offset(source.view(), moved.view().positions, options);
  });
  return check_as_dict(std::move(result), source, asked);
}

}  // namespace vdb_offset::python
