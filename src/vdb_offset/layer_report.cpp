#include "vdb_offset/layer_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "vdb_offset/cell_quality.h"
#include "vdb_offset/error.h"
#include "vdb_offset/parallel.h"

namespace vdb_offset {
namespace {

/// Faces in the order of their patches.
struct FacesByPatch {
  std::vector<std::uint32_t> faces, begin;

  std::span<const std::uint32_t> of(std::size_t patch) const {
    return std::span(faces).subspan(begin[patch], begin[patch + 1] - begin[patch]);
  }
};

FacesByPatch sort_faces(std::size_t count, const WallNames& names) {
  const std::size_t patches = names.of_face.empty() ? 1 : names.names.size();
  const auto patch = [&](std::size_t f) { return names.of_face.empty() ? 0 : names.of_face[f]; };
  FacesByPatch sorted{std::vector<std::uint32_t>(count), std::vector<std::uint32_t>(patches + 2, 0)};
  for (std::size_t f = 0; f < count; ++f) ++sorted.begin[patch(f) + 2];
  std::partial_sum(sorted.begin.begin(), sorted.begin.end(), sorted.begin.begin());
  for (std::size_t f = 0; f < count; ++f) sorted.faces[sorted.begin[patch(f) + 1]++] = static_cast<std::uint32_t>(f);
  return sorted;
}

/// Quantiles of plain numbers.
Spread spread(std::vector<float> values) {
  if (values.empty()) return {};
  const auto quantile = [&](double share) -> double {
    const auto at = static_cast<std::ptrdiff_t>(
        std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size()))));
    std::nth_element(values.begin(), values.begin() + at, values.end());
    return values[static_cast<std::size_t>(at)];
  };
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  return {quantile(0),    quantile(0.01), quantile(0.05), quantile(0.5),
          quantile(0.95), quantile(0.99), quantile(1),    mean};
}

struct Weighted {
  double value, weight;
};

/// Of numbers that count by their weights; those without any weight count alike.
Spread spread(std::vector<Weighted> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end(), [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double whole = 0, sum = 0;
  for (const Weighted& v : values) whole += v.weight, sum += v.value * v.weight;
  if (!(whole > 0)) {
    for (Weighted& v : values) v.weight = 1;
    return spread(std::move(values));
  }
  const double shares[] = {0.01, 0.05, 0.5, 0.95, 0.99};
  double quantiles[5], below = 0;
  std::size_t at = 0;
  for (std::size_t i = 0; i < std::size(shares); ++i) {
    while (at + 1 < values.size() && below + values[at].weight <= shares[i] * whole) below += values[at++].weight;
    quantiles[i] = values[at].value;
  }
  return {values.front().value, quantiles[0], quantiles[1],        quantiles[2],
          quantiles[3],         quantiles[4], values.back().value, sum / whole};
}

double area_of(std::span<const Vec3d> points, std::span<const std::uint32_t> face) {
  Vec3d sum(0.0);
  for (std::size_t k = 2; k < face.size(); ++k)
    sum += (points[face[k - 1]] - points[face[0]]).cross(points[face[k]] - points[face[0]]);
  return sum.length() / 2;
}

std::span<const float> values_of(const VolumeMesh& volume, const char* name) {
  for (const VolumeField& field : volume.cell_fields)
    if (field.name == name) return field.values;
  throw InvalidInput(std::string("layer_report: expected cells with a field ") + name + ", got none");
}

/// What the figures of all parts are read from.
class Source {
 public:
  Source(PolygonView mesh, const LayersResult& layers, const VolumeMesh& volume, const LayerCellFacts& facts)
      : mesh_(mesh),
        layers_(layers),
        volume_(volume),
        facts_(facts),
        jacobian_(values_of(volume, "scaled_jacobian")),
        aspect_(values_of(volume, "aspect_ratio")),
        first_cell_(mesh.face_count() + 1, 0) {
    for (std::size_t f = 0; f < mesh.face_count(); ++f) first_cell_[f + 1] = first_cell_[f] + facts.cells[f];
  }

  LayerFigures figures(std::string name, std::span<const std::uint32_t> faces) const {
    LayerFigures figures;
    figures.name = std::move(name);
    for (const auto f : faces) ++figures.faces_by_role[static_cast<std::size_t>(facts_.role[f])];
    if (layers_.count() == 0) return figures;
    add_thickness(faces, figures);
    add_first_heights(faces, figures);
    add_cells(faces, figures);
    std::vector<float> angles;
    for (const auto f : faces)
      if (facts_.cells[f] > 0)
        angles.push_back(static_cast<float>(wall_angle(layers_.positions[0], layers_.positions[1], mesh_.face(f))));
    figures.wall_angle = spread(std::move(angles));
    return figures;
  }

 private:
  bool full(std::uint32_t v) const { return layers_.share[v] == 1 && layers_.states[v] == VertexState::Reached; }

  /// Of faces that were to carry layers and can: those that repeat others, or are none, have no area of their own.
  void add_thickness(std::span<const std::uint32_t> faces, LayerFigures& figures) const {
    std::vector<Weighted> asked, reached;
    double kept = 0, covered = 0;
    for (const auto f : faces) {
      const FaceRole role = facts_.role[f];
      if (role != FaceRole::Full && role != FaceRole::Transition && role != FaceRole::Flat) continue;
      const auto face = mesh_.face(f);
      const double area = area_of(mesh_.positions, face), each = 1 / static_cast<double>(face.size());
      double to_reach = 0, achieved = 0, share = 0;
      for (const auto v : face) {
        to_reach += each * std::abs(layers_.heights.back()[v]);
        achieved += each * layers_.achieved[v];
        share += each * layers_.share[v];
      }
      asked.push_back({to_reach, area});
      reached.push_back({achieved, area});
      figures.area += area;
      kept += area * share;
      if (std::all_of(face.begin(), face.end(), [&](std::uint32_t v) { return full(v); })) covered += area;
    }
    if (figures.area > 0) {
      figures.layers_reached = static_cast<double>(layers_.count()) * kept / figures.area;
      figures.coverage = covered / figures.area;
    }
    figures.asked = spread(std::move(asked));
    figures.reached = spread(std::move(reached));
  }

  void add_first_heights(std::span<const std::uint32_t> faces, LayerFigures& figures) const {
    std::vector<std::uint32_t> vertices;
    for (const auto f : faces)
      if (facts_.cells[f] > 0)
        for (const auto v : mesh_.face(f))
          if (layers_.share[v] == 1) vertices.push_back(v);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    figures.full_vertices = vertices.size();
    std::vector<float> errors;
    for (const auto v : vertices) {
      const double height = std::abs(layers_.heights.front()[v]);
      if (height > 0) errors.push_back(static_cast<float>(std::abs(layers_.first_achieved[v] - height) / height));
    }
    const Spread error = spread(std::move(errors));
    figures.first_error = error.most;
    figures.first_error_99 = error.quantile_99;
  }

  void add_cells(std::span<const std::uint32_t> faces, LayerFigures& figures) const {
    std::vector<float> jacobians, aspects;
    for (std::size_t layer = 0; layer < layers_.count(); ++layer)
      for (const auto f : faces)
        for (std::size_t c = first_cell_[f]; c < first_cell_[f + 1]; ++c) {
          const std::size_t cell = layer * first_cell_.back() + c;
          ++figures.cells_by_type[static_cast<std::size_t>(volume_.cell_types[cell])];
          figures.transition_cells += facts_.role[f] == FaceRole::Transition;
          figures.inverted_cells += !(jacobian_[cell] > 0);
          jacobians.push_back(jacobian_[cell]);
          aspects.push_back(aspect_[cell]);
        }
    figures.cells = jacobians.size();
    figures.scaled_jacobian = spread(std::move(jacobians));
    figures.aspect_ratio = spread(std::move(aspects));
  }

  PolygonView mesh_;
  const LayersResult& layers_;
  const VolumeMesh& volume_;
  const LayerCellFacts& facts_;
  std::span<const float> jacobian_, aspect_;
  std::vector<std::size_t> first_cell_;  // of each face, in a layer
};

std::string cells_by_type(const LayerFigures& figures) {
  std::string text;
  for (std::size_t t = 0; t < kCellTypeCount; ++t)
    if (figures.cells_by_type[t] > 0)
      text +=
          fmt::format("{}{} {}", text.empty() ? "" : ", ", figures.cells_by_type[t], name(static_cast<CellType>(t)));
  return text.empty() ? "no cells" : text;
}

std::size_t left_out(const LayerFigures& figures) {
  std::size_t count = 0;
  for (const FaceRole role : {FaceRole::Flat, FaceRole::Degenerate, FaceRole::Repeated})
    count += figures.faces_by_role[static_cast<std::size_t>(role)];
  return count;
}

}  // namespace

LayerReport report_layers(PolygonView mesh, const LayersResult& layers, const WallNames& names,
                          const VolumeMesh& volume, const LayerCellFacts& facts) {
  const Source source(mesh, layers, volume, facts);
  const FacesByPatch faces = sort_faces(mesh.face_count(), names);
  const std::vector<std::string> patches = patch_names(names);
  LayerReport report;
  report.layers = layers.count();
  report.all = source.figures("all", faces.faces);
  if (patches.size() == 1) {
    report.patches.push_back(report.all);
    report.patches[0].name = patches[0];
  } else {
    report.patches.resize(patches.size());
    for_each_index(
        patches.size(), [&](std::size_t p) { report.patches[p] = source.figures(patches[p], faces.of(p)); }, 1);
  }
  report.volume = total_volume(volume);
  report.points = volume.points.size();
  report.growing = layers.layer_statistics;
  report.turned_faces = facts.turned_faces;
  report.border_sides = facts.border_sides;
  report.unpaired_sides = facts.unpaired_sides;
  report.split_points = facts.split_points;
  report.coincident_sides = facts.coincident_sides;
  return report;
}

std::string summary(const LayerReport& report) {
  const LayerFigures& all = report.all;
  std::string text = fmt::format("{} layers: {}, {} points, volume {:.6g}\n", report.layers, cells_by_type(all),
                                 report.points, report.volume);
  text +=
      fmt::format("thickness {:.4g} of {:.4g} (5 %: {:.4g}), {:.1f} layers, full on {:.1f} % of the area\n",
                  all.reached.mean, all.asked.mean, all.reached.quantile_05, all.layers_reached, 100 * all.coverage);
  text += fmt::format("first height: {:.1e} off at most; at the wall {:.1f} degrees (95 %: {:.1f}, most {:.1f})\n",
                      all.first_error, all.wall_angle.median, all.wall_angle.quantile_95, all.wall_angle.most);
  text += fmt::format(
      "scaled Jacobian {:.3f} (1 %: {:.3f}, least {:.3g}), {} not above 0; aspect ratio {:.3g} (most "
      "{:.3g})\n",
      all.scaled_jacobian.median, all.scaled_jacobian.quantile_01, all.scaled_jacobian.least, all.inverted_cells,
      all.aspect_ratio.median, all.aspect_ratio.most);
  if (all.transition_cells > 0 || left_out(all) > 0)
    text +=
        fmt::format("{} transition cells where layers end, {} faces left out\n", all.transition_cells, left_out(all));
  if (report.unpaired_sides > 0)
    text += fmt::format("{} sides on edges of three faces, or of two that disagree, are on the boundary\n",
                        report.unpaired_sides);
  return text;
}

}  // namespace vdb_offset
