// SPDX-License-Identifier: Apache-2.0
#include "distances/evaluate.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "request/option_values.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/mesh_facts.h"
#include "vdb_offset/polygons.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

Distances read_distances(const Source& source, const std::string& from) {
  if (names_property(from)) {
    if (!source.file)
      throw InvalidInput(
          fmt::format("expected a mesh from a file for '{}', as curves and scenes have no properties", from));
    const std::size_t kind = from.find(':') + 1;
    if (io::has_rows(*source.file) == from.starts_with("vtk:"))
      throw InvalidInput(fmt::format("{}: expected 'ply:NAME' for a PLY file and 'vtk:NAME' for one of VTK's, got '{}'",
                                     source.file->path, from));
    return Distances(io::vertex_property(*source.file, from.substr(kind)));
  }
  return Distances(io::read_vertex_numbers(from, source.view().positions.size()));
}

}  // namespace

Distances evaluate(const Job& job, const DistanceRequest& request) {
  const Source& source = job.source;
  if (!request.from.empty()) return read_distances(source, request.from);
  const auto texture_of = [&] {
    if (!source.file)
      throw InvalidInput(job.request.input +
                         ": expected texture coordinates (u, v), which a scene and curves have none of");
    return io::vertex_texture(*source.file);
  };
  const auto normals_of = [&] {
    return source.curves ? curve_normals(source.view())
                         : vertex_normals(source.view(), job.options.weld, job.options.orient);
  };
  const auto edges_of = [&] {
    return source.curves ? curve_edges(source.view()) : mean_edges(source.view(), job.options.weld);
  };
  return distances_of(request.distance, source.view(), {normals_of, texture_of, edges_of});
}

Distances scaled(const Distances& distances, double factor) {
  if (distances.uniform()) return factor * distances[0];
  std::vector<double> each(distances.count()), at_corner(distances.at_corner().begin(), distances.at_corner().end());
  for (std::size_t v = 0; v < each.size(); ++v) each[v] = factor * distances[v];
  for (double& distance : at_corner) distance *= factor;
  return at_corner.empty() ? Distances(std::move(each)) : Distances(std::move(each), std::move(at_corner));
}

}  // namespace vdb_offset::tool
