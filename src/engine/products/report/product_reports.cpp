// SPDX-License-Identifier: Apache-2.0
#include "products/report/product_reports.h"

#include <nlohmann/json.hpp>

namespace vdb_offset {

using Json = nlohmann::ordered_json;

Json shell_json(const ShellFacts& shell) {
  return {{"closed", shell.closed},
          {"oriented", shell.oriented},
          {"volume", shell.volume},
          {"rim_quads", shell.rim_quads},
          {"rim_triangles", shell.rim_triangles},
          {"border_edges_left", shell.border_edges_left},
          {"non_manifold_edges", shell.non_manifold_edges},
          {"pinched_vertices", shell.pinched_vertices},
          {"has_thickness", shell.has_thickness},
          {"junction_vertices", shell.junction_vertices},
          {"short_junctions", shell.short_junctions},
          {"source_crossings", shell.source_crossings},
          {"crossings_near_source", shell.crossings_near_source},
          {"crossings", shell.crossings}};
}

Json cad_json(const CadFileFacts& cad) {
  constexpr const char* kMade[] = {"solid", "shells", "faces", "facets"};
  return {{"made", kMade[static_cast<int>(cad.made)]},
          {"faces_kept", cad.kept},
          {"faces_fitted", cad.fitted},
          {"faces_swallowed", cad.swallowed},
          {"faces_missing", cad.missing},
          {"faces_held_back", cad.held},
          {"least_share", cad.least_held},
          {"obstacle_gap", cad.obstacle_gap ? Json(*cad.obstacle_gap) : Json()},
          {"fit_error", cad.fit_error},
          {"samples", cad.samples},
          {"least_distance", cad.least},
          {"most_distance", cad.most},
          {"volume", cad.volume},
          {"gaps", cad.gaps}};
}

}  // namespace vdb_offset
