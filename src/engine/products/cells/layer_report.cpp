// SPDX-License-Identifier: Apache-2.0
// Sums up layers and the cells over them, for each boundary patch and for all, and puts the main figures into words.
// Faces are sorted by patch. For each patch come the roles of its faces, the cells by type, areas and thickness
// weighted by area, the errors of the first height at vertices that keep all of theirs, and the quantiles of the cells'
// quality. Repeated and degenerate faces and faces that were not asked to carry layers do not count for areas. Areas
// are summed up in blocks of a fixed size, which are added in order, so that no figure depends on the number of
// threads. The quality of cells comes in measured (measure_cells.cpp, curve_cells.cpp).
#include "vdb_offset/cells.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "ground/numbers/quantiles.h"
#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "products/volume/cell_quality.h"

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
  FacesByPatch sorted{std::vector<std::uint32_t>(count), {0, static_cast<std::uint32_t>(count)}};
  if (names.of_face.empty()) {
    for_each_index(count, [&](std::size_t f) { sorted.faces[f] = static_cast<std::uint32_t>(f); });
    return sorted;
  }
  sorted.begin.assign(names.names.size() + 2, 0);
  for (const auto patch : names.of_face) ++sorted.begin[patch + 2];
  std::partial_sum(sorted.begin.begin(), sorted.begin.end(), sorted.begin.begin());
  for (std::size_t f = 0; f < count; ++f)
    sorted.faces[sorted.begin[names.of_face[f] + 1]++] = static_cast<std::uint32_t>(f);
  return sorted;
}

/// The area of a face; of a segment its length.
double area_of(std::span<const Vec3d> points, std::span<const std::uint32_t> face) {
  if (face.size() == 2) return (points[face[1]] - points[face[0]]).length();
  Vec3d sum(0.0);
  for (std::size_t k = 2; k < face.size(); ++k)
    sum += (points[face[k - 1]] - points[face[0]]).cross(points[face[k]] - points[face[0]]);
  return sum.length() / 2;
}

/// Collects the figures of parts of the wall.
class FigureCollector {
 public:
  FigureCollector(PolygonView mesh, const LayersResult& layers, const LayerCellFacts& facts,
                  const LayerQuality& quality)
      : mesh_(mesh), layers_(layers), facts_(facts), quality_(quality), upper_(cells_before(facts.cells)) {
    if (!facts.first_cells.empty()) first_ = cells_before(facts.first_cells);
  }

  LayerFigures figures(std::string name, std::span<const std::uint32_t> faces) const {
    LayerFigures figures;
    figures.name = std::move(name);
    for (const auto f : faces)
      if (!is_of_fan(f)) ++figures.faces_by_role[static_cast<std::size_t>(facts_.role[f])];
    if (layers_.count() == 0) return figures;
    // These fill in different figures, and each has a part that keeps one thread busy.
    tbb::parallel_invoke([&] { add_cells(faces, figures); }, [&] { add_thickness(faces, figures); },
                         [&] { add_first_heights(faces, figures); });
    return figures;
  }

 private:
  bool is_of_fan(std::uint32_t f) const {
    if (layers_.foot.empty()) return false;
    const auto face = mesh_.face(f);
    for (std::size_t k = 0; k < face.size(); ++k)
      if (layers_.foot[face[k]] == layers_.foot[face[(k + 1) % face.size()]]) return true;
    return false;
  }
  bool full(std::uint32_t v) const { return layers_.share[v] == 1 && !falls_short(layers_.states[v]); }

  /// A face's area, and means over its corners.
  struct OnFace {
    double area, to_reach, achieved, share;
    bool full;
  };
  OnFace means(std::uint32_t f) const {
    const auto face = mesh_.face(f);
    const double each = 1 / static_cast<double>(face.size());
    OnFace of{area_of(mesh_.positions, face), 0, 0, 0, true};
    for (const auto v : face) {
      of.to_reach += each * std::abs(layers_.heights.back()[v]);
      of.achieved += each * layers_.achieved[v];
      of.share += each * layers_.share[v];
      of.full = of.full && full(v);
    }
    return of;
  }

  /// Areas of some faces: in all; times the share of heights that they keep; of the faces that keep all of them.
  struct Areas {
    double all = 0, kept = 0, full = 0;
  };

  /// Adds the figures of area and thickness, of faces that were asked to carry layers. Repeated and degenerate faces do
  /// not count, since they have no area of their own.
  void add_thickness(std::span<const std::uint32_t> faces, LayerFigures& figures) const {
    // Faces whose areas are summed up in order by one thread. For speed alone; not measured.
    constexpr std::size_t kBlock = 4096;
    std::vector<std::uint32_t> of;
    of.reserve(faces.size());
    for (const auto f : faces) {
      const FaceRole role = facts_.role[f];
      if (role == FaceRole::Full || role == FaceRole::Transition || role == FaceRole::Flat) of.push_back(f);
    }
    const Distances& asked_heights = layers_.heights.back();
    std::vector<Weighted> asked(asked_heights.uniform() ? 0 : of.size()), reached(of.size());
    std::vector<Areas> areas((of.size() + kBlock - 1) / kBlock);
    for_each_index(
        areas.size(),
        [&](std::size_t b) {
          for (std::size_t i = b * kBlock; i < std::min(of.size(), (b + 1) * kBlock); ++i) {
            const OnFace face = means(of[i]);
            areas[b].all += face.area;
            areas[b].kept += face.area * face.share;
            if (face.full) areas[b].full += face.area;
            if (!asked.empty()) asked[i] = {face.to_reach, face.area};
            reached[i] = {face.achieved, face.area};
          }
        },
        1);
    Areas sum;
    for (const Areas& each : areas) sum.all += each.all, sum.kept += each.kept, sum.full += each.full;
    figures.area = sum.all;
    if (sum.all > 0) {
      figures.layers_reached = static_cast<double>(layers_.count()) * sum.kept / sum.all;
      figures.coverage = sum.full / sum.all;
    }
    const double height = std::abs(asked_heights.farthest());
    if (!asked_heights.uniform()) figures.asked = spread_of(asked);
    else if (!of.empty()) figures.asked = {height, height, height, height, height, height, height, height};
    figures.reached = spread_of(reached);
  }

  void add_first_heights(std::span<const std::uint32_t> faces, LayerFigures& figures) const {
    std::uint32_t first = kNone, end = 0;
    if (faces.size() == mesh_.face_count()) first = 0, end = static_cast<std::uint32_t>(mesh_.positions.size());
    else
      for_each_vertex_with_cells(faces,
                                 [&](std::uint32_t v) { first = std::min(first, v), end = std::max(end, v + 1); });
    if (end == 0) return;
    std::vector<std::uint8_t> is_full(end - first, 0);
    for_each_vertex_with_cells(faces, [&](std::uint32_t v) { is_full[v - first] = layers_.share[v] == 1; });
    std::vector<float> errors;
    errors.reserve(is_full.size());
    for (std::uint32_t v = first; v < end; ++v) {
      if (is_full[v - first] == 0) continue;
      ++figures.full_vertices;
      const double height = std::abs(layers_.heights.front()[v]);
      if (height > 0) errors.push_back(static_cast<float>(std::abs(layers_.first_achieved[v] - height) / height));
    }
    const Spread error = spread_of(errors.size(), [&](std::size_t i) { return errors[i]; });
    figures.first_error = error.most;
    figures.first_error_99 = error.quantile_99;
  }
  template <class Visit>
  void for_each_vertex_with_cells(std::span<const std::uint32_t> faces, Visit&& visit) const {
    for (const auto f : faces)
      if (facts_.cells[f] > 0)
        for (const auto v : mesh_.face(f)) visit(v);
  }

  /// Whether the sine of an angle of a face is below the scaled Jacobian of poor cells: that of a cell over it is no
  /// larger at that corner.
  bool is_needle(std::span<const std::uint32_t> face) const {
    for (std::size_t k = 0; k < face.size() && face.size() > 2; ++k) {
      const Vec3d &at = mesh_.positions[face[k]], &next = mesh_.positions[face[(k + 1) % face.size()]],
                  &last = mesh_.positions[face[(k + face.size() - 1) % face.size()]];
      const Vec3d a = next - at, b = last - at;
      if (!(a.cross(b).length() >= LayerFigures::kPoorJacobian * a.length() * b.length())) return true;
    }
    return false;
  }

  static std::vector<std::size_t> cells_before(const std::vector<std::uint8_t>& of_faces) {
    std::vector<std::size_t> before(of_faces.size() + 1, 0);
    for (std::size_t f = 0; f < of_faces.size(); ++f) before[f + 1] = before[f] + of_faces[f];
    return before;
  }
  const std::vector<std::size_t>& before(std::size_t layer) const {
    return layer == 0 && !first_.empty() ? first_ : upper_;
  }
  CellType type(std::size_t layer, std::size_t cell) const {
    return layer == 0 || quality_.upper_types.empty() ? quality_.types[cell] : quality_.upper_types[cell];
  }

  void add_cells(std::span<const std::uint32_t> faces, LayerFigures& figures) const {
    const auto add = [&](std::uint32_t f, std::size_t layer, std::size_t layers) {
      const std::vector<std::size_t>& cells = before(layer);
      for (std::size_t c = cells[f]; c < cells[f + 1]; ++c)
        figures.cells_by_type[static_cast<std::size_t>(type(layer, c))] += layers;
      const std::size_t count = layers * (cells[f + 1] - cells[f]);
      if (facts_.role[f] == FaceRole::Transition) figures.transition_cells += count;
      if (is_of_fan(f)) figures.fan_cells += count;
    };
    for (const auto f : faces) {
      figures.needles += facts_.cells[f] > 0 && !is_of_fan(f) && is_needle(mesh_.face(f));
      add(f, 0, 1);
      add(f, 1, layers_.count() - 1);
    }
    figures.cells = std::accumulate(figures.cells_by_type.begin(), figures.cells_by_type.end(), std::size_t{0});
    if (figures.cells == quality_.scaled_jacobian.size()) {
      add_quality([](std::size_t i) { return i; }, before(0).back(), figures);
      return;
    }
    std::vector<std::uint32_t> numbers;  // of these faces' cells, in the first layer and then in any other
    numbers.reserve(figures.cells / layers_.count());
    std::size_t in_first = 0;
    for (const std::size_t layer : {0, 1}) {
      for (const auto f : faces)
        for (std::size_t c = before(layer)[f]; c < before(layer)[f + 1]; ++c)
          numbers.push_back(static_cast<std::uint32_t>(c));
      if (layer == 0) in_first = numbers.size();
    }
    const std::size_t in_upper = numbers.size() - in_first;
    const auto number = [&](std::size_t i) -> std::size_t {
      if (i < in_first) return numbers[i];
      i -= in_first;
      return before(0).back() + i / in_upper * upper_.back() + numbers[in_first + i % in_upper];
    };
    add_quality(number, in_first, figures);
  }

  /// Adds the figures of quality, of figures.cells cells. number(i) is that of the i-th of them in all layers, of which
  /// so many are in the first one.
  template <class Number>
  void add_quality(Number&& number, std::size_t in_first, LayerFigures& figures) const {
    const auto count = [&](std::size_t cells, auto&& counts) {
      return tbb::parallel_reduce(
          tbb::blocked_range<std::size_t>(0, cells, 65536), std::size_t{0},
          [&](const auto& range, std::size_t sum) {
            for (std::size_t i = range.begin(); i != range.end(); ++i)
              sum += counts(quality_.scaled_jacobian[number(i)]);
            return sum;
          },
          std::plus<>());
    };
    const auto is_poor = [](double jacobian) { return !(jacobian >= LayerFigures::kPoorJacobian); };
    figures.inverted_cells = count(figures.cells, [](double jacobian) { return !(jacobian > 0); });
    figures.poor_cells = count(figures.cells, is_poor);
    figures.scaled_jacobian =
        spread_of(figures.cells, [&](std::size_t i) { return quality_.scaled_jacobian[number(i)]; });
    figures.aspect_ratio = spread_of(figures.cells, [&](std::size_t i) { return quality_.aspect_ratio[number(i)]; });
    if (layers_.foot.empty()) {
      figures.wall_angle = spread_of(in_first, [&](std::size_t i) { return quality_.wall_angle[number(i)]; });
      return;
    }
    std::vector<float> at_wall;  // cells over opened edges have no face on it
    for (std::size_t i = 0; i < in_first; ++i)
      if (const float angle = quality_.wall_angle[number(i)]; angle >= 0) at_wall.push_back(angle);
    figures.wall_angle = spread_of(at_wall.size(), [&](std::size_t i) { return at_wall[i]; });
  }

  PolygonView mesh_;
  const LayersResult& layers_;
  const LayerCellFacts& facts_;
  const LayerQuality& quality_;
  std::vector<std::size_t> first_,
      upper_;  // cells before each face, in the first layer if it differs, and in any other
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
                          const LayerCellFacts& facts, const LayerQuality& quality) {
  VDB_OFFSET_ASSERT(facts.role.size() == mesh.face_count() && facts.cells.size() == mesh.face_count());
  require_names(names, mesh.face_count());
  const FigureCollector collector(mesh, layers, facts, quality);
  const FacesByPatch faces = sort_faces(mesh.face_count(), names);
  const std::vector<std::string> patches = patch_names(names);
  LayerReport report;
  report.layers = layers.count();
  report.all = collector.figures("all", faces.faces);
  if (patches.size() == 1) {
    report.patches.push_back(report.all);
    report.patches[0].name = patches[0];
  } else {
    report.patches.resize(patches.size());
    for_each_index(
        patches.size(), [&](std::size_t p) { report.patches[p] = collector.figures(patches[p], faces.of(p)); }, 1);
  }
  report.volume = quality.volume;
  report.plane = quality.plane;
  report.least_segment = quality.least_segment;
  report.points = quality.points;
  report.growth = growth_of(layers.heights);
  report.growing = layers.layer_statistics;
  if (layers.periodic) report.periodic = layers.periodic->facts;
  report.turned_faces = facts.turned_faces;
  report.border_sides = facts.border_sides;
  report.unpaired_sides = facts.unpaired_sides;
  report.split_points = facts.split_points;
  report.coincident_sides = facts.coincident_sides;
  return report;
}

std::string summary(const LayerReport& report) {
  const LayerFigures& all = report.all;
  std::string text = fmt::format("{} layers: {}, {} points, {} {:.6g}\n", report.layers, cells_by_type(all),
                                 report.points, report.plane ? "area" : "volume", report.volume);
  if (all.fan_cells > 0) text += fmt::format("{} of the cells in fans over sharp edges\n", all.fan_cells);
  text += fmt::format("thickness {:.4g} of {:.4g} (5 %: {:.4g}), {:.1f} layers, full on {:.1f} % of the {}\n",
                      all.reached.mean, all.asked.mean, all.reached.quantile_05, all.layers_reached, 100 * all.coverage,
                      report.plane ? "length" : "area");
  text += fmt::format("first height: {:.1e} off at most; at the wall {:.1f} degrees (95 %: {:.1f}, most {:.1f})\n",
                      all.first_error, all.wall_angle.median, all.wall_angle.quantile_95, all.wall_angle.most);
  text += fmt::format(
      "scaled Jacobian {:.3f} (1 %: {:.3f}, least {:.3g}), {} not above 0; aspect ratio {:.3g} (most "
      "{:.3g})\n",
      all.scaled_jacobian.median, all.scaled_jacobian.quantile_01, all.scaled_jacobian.least, all.inverted_cells,
      all.aspect_ratio.median, all.aspect_ratio.most);
  if (report.plane)
    text += fmt::format("segments of layers have {:.3g} of the length of those on the wall at least\n",
                        report.least_segment);
  if (report.foam)
    text += fmt::format(
        "OpenFOAM: {} faces oriented wrongly; non-orthogonality {:.1f} degrees at most, {:.1f} on average ({} faces "
        "above {:.0f}); skewness {:.3g} at most ({} faces above {:.0f})\n",
        report.foam->wrong_faces, report.foam->non_orthogonality, report.foam->mean_non_orthogonality,
        report.foam->non_orthogonal_faces, FoamQuality::kMostDegrees, report.foam->skewness, report.foam->skew_faces,
        FoamQuality::kMostSkewness);
  if (report.inverted_block_cells > 0)
    text += fmt::format("{} cells of the block have a scaled Jacobian not above 0, as where layers end\n",
                        report.inverted_block_cells);
  if (all.transition_cells > 0 || left_out(all) > 0)
    text += fmt::format("{} transition cells where layers end, {} {} left out\n", all.transition_cells, left_out(all),
                        report.plane ? "segments" : "faces");
  if (report.unpaired_sides > 0)
    text += fmt::format("{} sides on edges of three faces, or of two that disagree, are on the boundary\n",
                        report.unpaired_sides);
  return text;
}

}  // namespace vdb_offset
