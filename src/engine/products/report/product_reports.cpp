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
  constexpr const char* kMade[] = {"solid", "shells", "hybrid", "doubtful"};
  return {{"made", kMade[static_cast<int>(cad.made)]},
          {"faces_kept", cad.kept},
          {"faces_fitted", cad.fitted},
          {"faces_swallowed", cad.swallowed},
          {"faces_of_triangles", cad.faceted},
          {"faces_missing", cad.missing},
          {"triangles", cad.triangles},
          {"exact_share", cad.exact_share},
          {"vanished_solids", cad.vanished},
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

Json spread_json(const Spread& spread) {
  return {{"least", spread.least},
          {"quantile_01", spread.quantile_01},
          {"quantile_05", spread.quantile_05},
          {"median", spread.median},
          {"quantile_95", spread.quantile_95},
          {"quantile_99", spread.quantile_99},
          {"most", spread.most},
          {"mean", spread.mean}};
}

Json fill_json(const FillReport& fill) {
  return {{"tetrahedra", fill.tetrahedra},
          {"triangles", fill.triangles},
          {"pyramids", fill.pyramids},
          {"split_cells", fill.split_cells},
          {"added_points", fill.added_points},
          {"front_faces", fill.front},
          {"volume", fill.volume},
          {"scaled_jacobian", spread_json(fill.scaled_jacobian)},
          {"volume_jump", spread_json(fill.jump)},
          {"seconds", fill.seconds}};
}

Json boundary_json(std::span<const PatchFacts> boundary) {
  Json patches = Json::array();
  for (const auto& [patch, kind, faces, plane] : boundary) {
    Json each = {{"name", patch}, {"kind", name(kind)}, {"faces", faces}};
    if (plane)
      each["plane"] = {{"normal", {plane->normal[0], plane->normal[1], plane->normal[2]}}, {"offset", plane->offset}};
    patches.push_back(each);
  }
  return patches;
}

}  // namespace vdb_offset
