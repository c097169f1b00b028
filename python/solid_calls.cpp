// SPDX-License-Identifier: Apache-2.0
// Calls for new surfaces: shells, iso-surfaces and hollow solids.
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calls.h"
#include "distance_values.h"
#include "interruptible.h"
#include "keywords.h"
#include "results.h"
#include "vdb_offset/iso_surface.h"
#include "vdb_offset/run.h"
#include "vdb_offset/shell.h"

namespace vdb_offset::python {
namespace {

py::dict shell_as_dict(Shell shell, OffsetResult result, RunFacts facts, const Source& source,
                       const AskedOptions& asked) {
  facts.shell = shell.facts;
  std::vector<std::uint8_t> parts(shell.polygons.face_count());
  std::vector<std::uint32_t> sources(parts.size());
  for (std::size_t f = 0; f < parts.size(); ++f) {
    parts[f] = static_cast<std::uint8_t>(shell.part(f));
    sources[f] = shell.source_face(f);
  }
  const auto count = static_cast<py::ssize_t>(parts.size());
  py::dict all = as_dict(std::move(result), facts, source, asked);
  all["faces"] = faces_of(shell.polygons);
  all["parts"] = owning_array(std::move(parts), {count});
  all["source_faces"] = owning_array(std::move(sources), {count});
  all["vertices"] = owning_array(std::move(shell.polygons.positions));
  return all;
}

/// The offsets that were made with `off_source`, the last of which is the inner skin if there is one, as shells.
std::vector<Shell> shells_of(PolygonView mesh, std::vector<OffsetResult>& results, const OffsetOptions& options) {
  const OffsetResult* const inner = options.inner_skin_last ? &results.back() : nullptr;
  std::vector<Shell> shells;
  for (std::size_t i = 0; i + (inner ? 1 : 0) < results.size(); ++i) {
    shells.push_back(shell_of(mesh, results[i], options, inner));
    report_states(shells.back(), results[i]);
  }
  return shells;
}

}  // namespace

py::list shell_arrays(const py::object& vertices, const py::object& faces, const py::list& distances,
                      const py::object& inner, const py::dict& keywords, const py::object& progress) {
  const auto start = Clock::now();
  const Source source(Input::Mesh, vertices, faces, keywords);
  AskedOptions asked = asked_options(keywords, source);
  std::vector<Distances> wanted = distances_of_all(distances, source, asked);
  if (wanted.empty()) throw InvalidOption("distances: expected one or more, got none");
  if (!inner.is_none()) wanted.push_back(inward_distances_of(inner, source, asked, wanted));
  require_field(asked, wanted);
  asked.options.off_source = true;
  asked.options.inner_skin_last = !inner.is_none();
  std::vector<std::string> texts;
  for (const auto distance : distances) texts.push_back(text_of(py::reinterpret_borrow<py::object>(distance)));
  Interruptible run(progress, Keywords(keywords)["reserve"]);
  run.attach(asked.options);
  auto made = run([&] {
    std::vector<OffsetResult> results = offset_several(source.view(), wanted, asked.options);
    save_field(asked, results.front(), texts.front());
    std::vector<Shell> shells = shells_of(source.view(), results, asked.options);
    return std::pair(std::move(results), std::move(shells));
  });
  py::list all;
  for (std::size_t i = 0; i < made.second.size(); ++i)
    all.append(shell_as_dict(std::move(made.second[i]), std::move(made.first[i]), facts_of_run(texts[i], start), source,
                             asked));
  return all;
}

namespace {

/// The distance of an iso-surface, the same everywhere.
double distance_of_all(const py::object& distance, const Source& source) {
  if (!length_of(distance))
    throw InvalidOption(
        "distance: expected a number of world units, or a text with one or percent, as the distance of "
        "an iso-surface is, got " +
        Keywords::text_of(distance));
  return distances_of(distance, source, {})[0];
}

void require_distance(double distance, const py::object& given) {
  if (distance == 0) throw InvalidOption("distance: expected one other than 0, got " + Keywords::text_of(given));
}

double cavity_distance(const py::object& inner, const Source& source, const Distances& outer) {
  const Distances distances = inward_distances_of(inner, source, {}, {&outer, 1});
  if (!distances.uniform()) throw InvalidOption("inner: expected one distance for the whole of an iso-surface");
  return distances[0];
}

/// \throw InvalidResult for a surface that is not valid, which is never handed out
void require_valid(const IsoStatistics& found, const std::string& distance, Clock::time_point start) {
  if (found.valid()) return;
  const auto count = [](std::size_t many, const char* what) { return std::to_string(many) + what; };
  throw InvalidResult("iso-surface: expected a closed, manifold surface that does not cross itself, got " +
                          count(found.border_edges, " border edges, ") +
                          count(found.non_manifold_edges, " non-manifold edges, ") +
                          count(found.pinched_vertices, " pinched vertices, ") +
                          count(found.mending.left.crossings, " crossings and ") +
                          count(found.mending.left.needles, " triangles without area on each of ") +
                          count(found.attempts, " lattices (try another voxel_size, or more digits)"),
                      report_json(found, facts_of_run(distance, start)));
}

py::dict hollow_as_dict(const Hollow& hollow, RunFacts facts, const IsoStatistics& outer, const IsoResult* inner) {
  facts.shell = hollow.facts;
  if (inner) facts.inner_surface = inner->statistics;
  std::vector<std::uint8_t> parts(hollow.polygons.face_count(), 1);
  std::fill_n(parts.begin(), hollow.outer_faces, std::uint8_t{0});
  const auto count = static_cast<py::ssize_t>(parts.size());
  py::dict all;
  all["statistics"] = from_json(report_json(outer, facts));
  all["faces"] = faces_of(hollow.polygons);
  all["parts"] = owning_array(std::move(parts), {count});
  all["vertices"] = owning_array(hollow.polygons.positions);
  return all;
}

/// The mesh and the iso-surface, or two of these, as one solid.
Hollow hollow_of(PolygonView mesh, const IsoOptions& options, double distance, const IsoResult& iso,
                 const IsoResult* inner) {
  const PolygonView skin = iso.polygons.view();
  if (inner) return make_hollow(skin, inner->polygons.view(), Hollow::Source::Neither);
  return distance < 0 ? make_hollow(mesh, skin, Hollow::Source::Outer, options.weld)
                      : make_hollow(skin, mesh, Hollow::Source::Inner, options.weld);
}

/// \throw InvalidResult for skins that meet, which are never handed out
void require_apart(const Hollow& hollow, const IsoStatistics& outer, const std::string& distance,
                   Clock::time_point start) {
  if (hollow.facts.crossings == 0) return;
  throw InvalidResult("hollow: expected skins that do not meet, got " + std::to_string(hollow.facts.crossings) +
                          " pairs of triangles that do (a voxel_size of half the distance or less keeps them apart, or "
                          "inner, if faces lie inside the solid)",
                      report_json(outer, facts_of_run(distance, start)));
}

}  // namespace

py::dict iso_arrays(const py::object& vertices, const py::object& faces, const py::object& distance,
                    const py::dict& keywords, const py::object& progress) {
  const auto start = Clock::now();
  const Source source(Input::Mesh, vertices, faces, keywords);
  IsoOptions options = iso_options(keywords);
  options.distance = distance_of_all(distance, source);
  py::list one;
  one.append(distance);
  const std::optional<ByAxis> axes = by_axis(keywords, one, source, {});
  if (axes) options.distance = axes->distance;
  require_distance(options.distance, distance);
  const std::string text = axes ? axes->text : text_of(distance);
  Interruptible run(progress, Keywords(keywords)["reserve"]);
  run.attach(options);
  IsoResult result =
      run([&] { return make_iso_surface_in_metric(source.view(), options, axes ? axes->metric : Metric()); });
  require_valid(result.statistics, text, start);
  py::dict all;
  all["statistics"] = from_json(report_json(result.statistics, facts_of_run(text, start)));
  all["faces"] = faces_of(result.polygons);
  all["normals"] = owning_array(std::move(result.normals));
  all["vertices"] = owning_array(std::move(result.polygons.positions));
  return all;
}

py::dict iso_shell_arrays(const py::object& vertices, const py::object& faces, const py::object& distance,
                          const py::object& inner, const py::dict& keywords, const py::object& progress) {
  const auto start = Clock::now();
  const Source source(Input::Mesh, vertices, faces, keywords);
  IsoOptions options = iso_options(keywords);
  const double outward = distance_of_all(distance, source);
  require_distance(outward, distance);
  std::optional<double> inward;
  if (!inner.is_none()) inward = cavity_distance(inner, source, outward);
  options.off_source = true;
  const std::string text = text_of(distance);
  Interruptible run(progress, Keywords(keywords)["reserve"]);
  run.attach(options);
  struct Made {
    IsoResult surface;
    std::optional<IsoResult> cavity;
    Hollow hollow;
  };
  const Made made = run([&]() -> Made {
    const auto at = [&](double d, double share_before, double share_after) {
      IsoOptions own = options;
      own.distance = d;
      own.progress = [&](Stage stage, double share) {
        return options.progress(stage, share_before + (share_after - share_before) * share);
      };
      IsoResult result = make_iso_surface(source.view(), own);
      require_valid(result.statistics, text, start);
      if (!result.statistics.is_signed)
        throw InvalidInput("iso_shell: expected a mesh that has an inside, got an open one");
      return result;
    };
    const double first = inward ? 0.5 : 1;
    Made all{at(outward, 0, first), {}, {}};
    if (inward) all.cavity = at(*inward, first, 1);
    all.hollow = hollow_of(source.view(), options, outward, all.surface, all.cavity ? &*all.cavity : nullptr);
    require_apart(all.hollow, all.surface.statistics, text, start);
    return all;
  });
  return hollow_as_dict(made.hollow, facts_of_run(text, start), made.surface.statistics,
                        made.cavity ? &*made.cavity : nullptr);
}

}  // namespace vdb_offset::python
