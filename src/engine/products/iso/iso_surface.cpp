// SPDX-License-Identifier: Apache-2.0
// Makes the surface at a distance from a mesh as a new mesh; the stages of products/iso in their order. The solid parts
// of the source are found, the voxel size is chosen, and distances get a surface to be measured from. Then one lattice
// after the other is tried: its voxels are filled, meshed and rounded as they will be written, specks are dropped,
// faults are mended, and flat parts merged. The attempt counts if the mesh, as the file will have it, is closed,
// manifold and without faults. After the last lattice the mesh is handed over with the faults that it has, and
// statistics say so. In the end the distances of vertices and faces are measured. Attributes of the source come along
// elsewhere (source_lookup.cpp).
#include "vdb_offset/iso_surface.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>
#include "ground/system/call_progress.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "ground/numbers/rounding.h"
#include "ground/system/memory.h"
#include "ground/system/parallel.h"
#include "ground/system/progress_count.h"
#include "ground/system/stage_timer.h"
#include "ground/system/thread_count.h"
#include "products/iso/iso_grid.h"
#include "products/iso/iso_level.h"
#include "products/iso/iso_mesh.h"
#include "products/iso/iso_plan.h"
#include "products/iso/iso_source.h"
#include "products/iso/mend.h"
#include "products/iso/merge_flats.h"
#include "products/iso/solid_boundary.h"
#include "products/iso/specks.h"
#include "valid/faults/face_error.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

// The number of lattices that are tried: on each, faults that could not be mended on the one before are met anew. Not
// measured.
constexpr std::size_t kLattices = 4;
// Seconds that stages take for each leaf node that is planned, for the progress alone. Measured on four models at 1 %.
constexpr double kIsoRasterise = 3e-4, kIsoCapture = 5e-4, kIsoMend = 1e-4, kIsoMeasure = 8e-5;
/// The lattice of an attempt. Flat parts of models often lie at round coordinates, and so do their offsets at round
/// distances; the corners of lattices, in voxels, are irrational, as are their sums and differences.
Lattice lattice_of(std::size_t attempt, double voxel_size) {
  const double turns = static_cast<double>(attempt) + 1;
  const auto part = [&](double x) { return x * turns - std::floor(x * turns); };
  return {voxel_size,
          Vec3d(part(0.41421356237309515), part(0.7320508075688772), part(0.23606797749978969)) * -voxel_size};
}

class IsoSurfaceMaker {
 public:
  IsoSurfaceMaker(PolygonView mesh, const IsoOptions& options, int threads) : mesh_(mesh), options_(options) {
    result_.statistics.threads = threads;
    result_.statistics.distance = options.distance;
  }

  IsoResult run() {
    prepare();
    reserve_memory(options_.reserve, result_.statistics.plan.bytes);
    Surface written;
    bool valid = false;
    for (std::size_t attempt = 0; attempt < kLattices && !valid; ++attempt) {
      Surface mesh = extract(lattice_of(attempt, h_));
      const MeshFaults left = mend_on_surface(mesh);
      result_.statistics.merged_vertices = 0;  // those on another lattice are gone with it
      if (!options_.adaptivity && left.total() == 0) merge_where_flat(mesh);
      hand_over(mesh);
      Topology topology = check_topology(left);
      written = std::move(topology.written);
      valid = topology.valid;
      if (!valid) expect_attempt();
      result_.statistics.attempts = attempt + 1;
    }
    measure_vertices();
    measure_faces(written);
    return std::move(result_);
  }

 private:
  const Surface& source() const { return result_.source->surface; }
  const Inside& inside() const { return result_.source->inside; }

  void prepare();
  /// Has an attempt, and the measurement after it, make up what is left of the progress.
  void expect_attempt() const;
  Surface extract(const Lattice& lattice);
  MeshFaults mend_on_surface(Surface& mesh);
  void merge_where_flat(Surface& mesh);
  std::optional<Vec3d> onto(const Vec3d& wish);
  Vec3d as_written(const Vec3d& local) const { return Rounding(options_.precision)(source().origin + local); }
  void hand_over(const Surface& mesh);
  /// The new mesh as the file has it.
  struct Topology {
    Surface written;
    bool valid;
  };
  Topology check_topology(const MeshFaults& left);
  bool is_valid(const Surface& in_file, const MeshFaults& left);
  void measure_vertices();
  void measure_faces(const Surface& written);

  PolygonView mesh_;
  const IsoOptions& options_;
  double h_ = 0;
  std::optional<IsoLevel> level_;
  std::uint32_t hint_ = 0;  // the triangle that was closest last: while mending, points follow each other nearby
  IsoResult result_;
};

/// What of a mesh is solid.
struct Solids {
  std::optional<Solidity> solidity;  // looked for where the mesh is not plainly closed
  bool has_inside;
};
/// Looks for solid parts, and notes down what they are.
Solids find_solids(const Surface& surface, const IsoOptions& options, IsoStatistics& statistics) {
  const MeshFacts& facts = surface.facts;
  Solids solids{{}, facts.closed() && facts.oriented()};
  SolidFacts solid{.parts = facts.components};
  if (!solids.has_inside && options.use_winding) {
    const Solidity& found = solids.solidity.emplace(find_solid_parts(surface));
    solid.parts = found.is_solid.size();
    solid.open_parts = solid.parts - found.solid_parts();
    solid.holes = found.hole_count();
    solid.hole_share = found.area > 0 ? found.hole_area() / found.area : 0;
    solids.has_inside = solid.open_parts < solid.parts;
  } else if (!solids.has_inside) {
    solid.open_parts = solid.parts;
  }
  statistics.source = facts;
  statistics.solid = solid;
  statistics.is_signed = solids.has_inside;
  return solids;
}

double level_of(const Inside& inside, double distance) {
  return !inside.has_inside() ? std::abs(distance) : inside.is_turned() ? -distance : distance;
}

std::vector<Hole> too_wide(const std::optional<Solidity>& solidity, double distance) {
  std::vector<Hole> wide;
  if (solidity)
    for (const Hole& hole : solidity->holes)
      if (!hole.is_wall && hole.radius >= std::abs(distance)) wide.push_back(hole);
  return wide;
}

void require_usable(const IsoOptions& options) {
  if (!std::isfinite(options.distance) || options.distance == 0)
    throw InvalidInput(fmt::format("iso-surface: expected a finite distance other than 0, got {}", options.distance));
  if (options.adaptivity && !(*options.adaptivity >= 0 && *options.adaptivity <= 1))
    throw InvalidInput(fmt::format("iso-surface: expected an adaptivity from 0 to 1, got {}", *options.adaptivity));
}

void IsoSurfaceMaker::prepare() {
  const StageTimer timer(result_.statistics.seconds, Stage::Rasterise);
  IsoStatistics& statistics = result_.statistics;
  Surface surface = build_surface(mesh_, options_.weld.without_joins(), options_.orient);
  require_area(surface);
  const Solids solids = find_solids(surface, options_, statistics);
  const IsoPlan plan = plan_voxels(surface, options_, solids.has_inside);
  statistics.plan = plan;
  expect_attempt();
  report_share(options_.progress, Stage::Rasterise, 0);
  h_ = plan.voxel_size;
  to_local_frame(surface, h_);
  result_.source =
      std::make_shared<const IsoSource>(std::move(surface), solids.solidity, options_.distance, options_.orient);
  if (const auto& boundary = result_.source->boundary) {
    statistics.solid.buried = boundary->buried;
    statistics.solid.cut = boundary->cut;
  }
  level_.emplace(result_.source->query, inside(), level_of(inside(), options_.distance), h_);
}

void IsoSurfaceMaker::expect_attempt() const {
  const auto leaves = static_cast<double>(result_.statistics.plan.leaf_nodes);
  StageSeconds seconds{};
  const auto of = [&](Stage stage) -> double& { return seconds[static_cast<std::size_t>(stage)]; };
  of(Stage::Rasterise) = kIsoRasterise * leaves;
  of(Stage::Capture) = kIsoCapture * leaves;
  of(Stage::Limit) = kIsoMend * leaves;
  of(Stage::Measure) = kIsoMeasure * leaves;
  expect_stages(options_.progress, seconds);
}

Surface IsoSurfaceMaker::extract(const Lattice& lattice) {
  std::size_t most_leaves = std::numeric_limits<std::size_t>::max();
  if (options_.max_memory > 0) most_leaves = options_.max_memory / static_cast<std::size_t>(kIsoLeafBytes);
  IsoGrid grid;
  {
    const StageTimer timer(result_.statistics.seconds, Stage::Rasterise);
    grid = rasterise_iso(result_.source->query, inside(), level_->level(), lattice, most_leaves, options_.progress);
  }
  const StageTimer timer(result_.statistics.seconds, Stage::Capture);
  result_.statistics.leaf_nodes = grid.leaf_nodes;
  Polygons mesh = mesh_iso_surface(grid, lattice, *level_, options_.adaptivity.value_or(0), inside().is_turned(),
                                   options_.progress);
  if (mesh.face_count() == 0)
    throw InvalidInput(
        fmt::format("iso-surface: expected a surface at distance {:.6g}, found none (nothing inside is that "
                    "far from the surface, or only what is thinner than a voxel of {:.6g})",
                    options_.distance, h_));
  for_each_index(mesh.positions.size(), [&](std::size_t v) { mesh.positions[v] = as_written(mesh.positions[v]); });
  Surface surface = build_surface(mesh.view(), {.enabled = false});
  const std::size_t dropped =
      options_.keep_specks || surface.facts.components == 1 ? 0 : drop_specks(mesh, h_ * h_ * h_);
  result_.statistics.dropped_specks = dropped;
  return dropped == 0 ? surface : build_surface(mesh.view(), {.enabled = false});
}

/// Returns the faults that are left.
MeshFaults IsoSurfaceMaker::mend_on_surface(Surface& mesh) {
  const StageTimer timer(result_.statistics.seconds, Stage::Limit);
  Progress progress(options_.progress, Stage::Limit, 1);
  const MendStatistics mending = mend(mesh, [&](const Vec3d& wish) {
    progress.advance(0);
    return onto(wish);
  });
  result_.statistics.mending = mending;
  return mending.left;
}

/// Merges flat parts of a mesh without faults, which has none after that.
void IsoSurfaceMaker::merge_where_flat(Surface& mesh) {
  // The tolerance of flatness, as a share of the distance: a tenth of the promised 1e-6.
  constexpr double kShareOfDistance = 1e-7;
  const StageTimer timer(result_.statistics.seconds, Stage::Capture);
  double farthest = 0;
  for (const Vec3d& p : mesh.vertices) farthest = std::max({farthest, std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
  const double tolerance = kShareOfDistance * level_->distance() + Rounding(options_.precision).epsilon() * farthest;
  result_.statistics.merged_vertices = merge_flats_soundly(mesh, tolerance);
}

/// A position on the surface within a voxel of a wish, as written.
std::optional<Vec3d> IsoSurfaceMaker::onto(const Vec3d& wish) {
  const Vec3d local = wish - source().origin;
  const auto on_level = level_->follow(local, hint_, [&](const Vec3d& x) { return (x - local).length() <= h_; });
  return on_level ? std::optional(as_written(*on_level)) : std::nullopt;
}

void IsoSurfaceMaker::hand_over(const Surface& mesh) {
  Polygons& polygons = result_.polygons = {};
  polygons.positions = mesh.vertices;
  polygons.corners.reserve(3 * mesh.triangles.size());
  polygons.face_begin.reserve(mesh.triangles.size() + 1);
  for (const auto& [a, b, c] : mesh.triangles) polygons.add_face({a, b, c});
}

/// Counts vertices whose faces make more than one fan.
std::size_t count_pinched(const Surface& mesh) {
  std::size_t pinched = 0;
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    const auto around = mesh.triangles_around(v);
    if (around.empty()) continue;
    const auto& first = mesh.triangles[around[0]];
    const std::uint32_t start =
        3 * around[0] + static_cast<std::uint32_t>(std::find(first.begin(), first.end(), v) - first.begin());
    std::size_t fan = 0;
    std::uint32_t edge = start;  // leads away from the vertex
    do {
      const std::uint32_t before = edge / 3 * 3 + (edge + 2) % 3;  // leads back to it, in the same triangle
      edge = mesh.next_around_edge[before];
      ++fan;
    } while (edge != start && mesh.from(edge) == v && fan <= around.size());
    pinched += fan != around.size();
  }
  return pinched;
}

/// Looks at the new mesh as the file will have it. `left` are the faults that mending has left.
IsoSurfaceMaker::Topology IsoSurfaceMaker::check_topology(const MeshFaults& left) {
  const StageTimer timer(result_.statistics.seconds, Stage::Capture);
  Surface mesh = build_surface(result_.polygons.view(), {});
  if (options_.precision.scale == Vec3d(1.0)) {
    const bool valid = is_valid(mesh, left);
    return {std::move(mesh), valid};
  }
  // Rounding on the way to the file's own coordinates may decide otherwise.
  Polygons file = result_.polygons;
  for (Vec3d& p : file.positions) p = Rounding(options_.precision).in_file(p);
  const Surface in_file = build_surface(file.view(), {});
  const MeshFaults left_in_file = find_faults(in_file);
  result_.statistics.mending.left = left_in_file;
  return {std::move(mesh), is_valid(in_file, left_in_file)};
}

/// Whether a mesh with these faults is closed, manifold and free of them. Notes down what it is made of.
bool IsoSurfaceMaker::is_valid(const Surface& in_file, const MeshFaults& left) {
  const MeshFacts& facts = in_file.facts;
  const std::size_t pinched = count_pinched(in_file);
  IsoStatistics& statistics = result_.statistics;
  statistics.vertices = in_file.vertices.size();
  statistics.triangles = result_.polygons.face_count();
  statistics.components = facts.components;
  statistics.border_edges = facts.boundary_edges;
  statistics.non_manifold_edges = facts.non_manifold_edges;
  statistics.turned_edges = facts.orientation_conflicts;
  statistics.pinched_vertices = pinched;
  return facts.boundary_edges == 0 && facts.non_manifold_edges == 0 && facts.orientation_conflicts == 0 &&
         pinched == 0 && left.total() == 0;
}

void IsoSurfaceMaker::measure_faces(const Surface& written) {
  const std::vector<std::uint32_t> none(written.vertices.size(), kNone);  // no vertex of it is one of the source's
  const ConstrainedSurface constrained{result_.source->query, written, none, {}, {}};
  const StageTimer timer(result_.statistics.seconds, Stage::Measure);
  const Distances distance(level_->distance());
  result_.statistics.faces = vdb_offset::measure_faces({constrained, written.vertices, distance, {}, {}});
}

/// Measures the distances and normals of vertices, and finds the triangles that are closest to them.
void IsoSurfaceMaker::measure_vertices() {
  const StageTimer timer(result_.statistics.seconds, Stage::Capture);
  const std::size_t count = result_.polygons.positions.size();
  std::vector<Vec3d> local(count);
  for_each_index(count, [&](std::size_t v) { local[v] = result_.polygons.positions[v] - source().origin; });
  const std::vector<Closest> closest = closest_points(result_.source->query, local);
  result_.normals.resize(count);
  result_.closest.resize(count);
  // phi grows away from the source, or towards it, and there the source's faces point.
  const double sense = (level_->level() < 0) != inside().is_turned() ? -1 : 1;
  IsoStatistics& statistics = result_.statistics;
  double squares = 0;
  for (std::size_t v = 0; v < count; ++v) {
    const auto& [distance, triangle, feature, tied, point] = closest[v];
    const double error = std::abs(distance - level_->distance()) / level_->distance();
    statistics.worst_error = std::max(statistics.worst_error, error);
    squares += error * error;
    result_.closest[v] = result_.source->given(triangle);
    result_.normals[v] = distance > 0 ? (local[v] - point) * (sense / distance) : Vec3d(0.0);
  }
  statistics.rms_error = count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0;
}

}  // namespace

IsoSource::IsoSource(Surface placed, const std::optional<Solidity>& solidity, double distance, Orient orient)
    : surface(std::move(placed)),
      inside(solidity ? Inside(surface, *solidity, orient) : Inside(surface, orient)),
      boundary(find_boundary(surface, inside, too_wide(solidity, distance), level_of(inside, distance) < 0)),
      query(boundary ? boundary->surface : surface) {}

IsoResult make_iso_surface(PolygonView mesh, const IsoOptions& options) {
  require_usable(options);
  const int threads = thread_count(options.threads);
  IsoResult result;
  const IsoOptions of_stages = with_call_progress(options);
  tbb::task_arena arena(threads);
  arena.execute([&] { result = IsoSurfaceMaker(mesh, of_stages, threads).run(); });
  report_share(of_stages.progress, Stage::Measure, 1);
  return result;
}

IsoStatistics plan_iso_surface(PolygonView mesh, const IsoOptions& options) {
  require_usable(options);
  IsoStatistics statistics;
  statistics.threads = thread_count(options.threads);
  const Surface surface = build_surface(mesh, options.weld.without_joins(), options.orient);
  const Solids solids = find_solids(surface, options, statistics);
  statistics.plan = plan_voxels(surface, options, solids.has_inside);
  return statistics;
}

}  // namespace vdb_offset
