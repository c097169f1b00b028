#include "vdb_offset/capture.h"

#include <fmt/format.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "vdb_offset/creases.h"
#include "vdb_offset/error.h"
#include "vdb_offset/iso_grid.h"
#include "vdb_offset/level_set.h"
#include "vdb_offset/parallel.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

using openvdb::Coord;

// Voxel corners of a leaf node, OpenVDB's grids of signs and point numbers, and the new mesh with all that is made to
// check it; measured: 18,000 to 29,000, and the file is still to be made.
constexpr double kCaptureLeafBytes = 34e3;
constexpr double kTrianglesPerLeaf = 110;
constexpr double kCaptureProcessBytes = 64 << 20;

/// Puts the vertices that volumeToMesh makes onto the surface.
class Projection {
 public:
  Projection(const IsoGrid& grid, const LevelSet& level, double voxel_size, bool merged)
      : tree_(grid.phi->tree()), level_(level), h_(voxel_size), merged_(merged) {}

  /// From a point in index space. Its own voxel's corners have both signs, unless it stands for several that were
  /// merged; then it may go farther.
  Vec3d operator()(const Vec3d& index, std::uint32_t& hint) const {
    const Vec3d x = index * h_;
    const Coord cell = Coord::floor(index);
    const double most = merged_ ? kLeafWidth * h_ : h_;
    const auto is_near = [&](const Vec3d& y) {
      if (merged_) return (y - x).length() <= most;
      for (int k = 0; k < 3; ++k)
        if (!(y[k] >= cell[k] * h_ && y[k] <= (cell[k] + 1) * h_)) return false;
      return true;
    };
    if (const auto place = level_.follow(x, hint, is_near)) return *place;
    const double here = level_(x, hint);
    for (int ring = 0; ring <= (merged_ ? kLeafWidth : 1); ++ring)
      if (const auto corner = nearest_corner(cell, ring, index, here))
        return here < 0 ? level_.between(x, *corner * h_, hint) : level_.between(*corner * h_, x, hint);
    return x;
  }

 private:
  /// Among the voxel corners up to so many voxels away, one of the other sign, towards which the surface seems nearest.
  std::optional<Vec3d> nearest_corner(const Coord& cell, int ring, const Vec3d& index, double here) const {
    openvdb::tree::ValueAccessor<const openvdb::FloatTree> accessor(tree_);
    std::optional<Vec3d> nearest;
    double least = 0;
    for (int i = -ring; i <= 1 + ring; ++i)
      for (int j = -ring; j <= 1 + ring; ++j)
        for (int k = -ring; k <= 1 + ring; ++k) {
          const Coord corner = cell.offsetBy(i, j, k);
          const double there = accessor.getValue(corner);
          if ((there < 0) == (here < 0)) continue;
          const double away = (corner.asVec3d() - index).length() * std::abs(here) / (std::abs(here) + std::abs(there));
          if (nearest && away >= least) continue;
          least = away;
          nearest = corner.asVec3d();
        }
    return nearest;
  }

  const openvdb::FloatTree& tree_;
  const LevelSet& level_;
  double h_;
  bool merged_;
};

/// Splits quads along the shorter diagonal; those at a crease along the one whose middle is nearer to the surface, so
/// that the other does not cut it. Where three corners are on one crease both may be: then no triangle is to be flat.
class QuadSplitter {
 public:
  QuadSplitter(const LevelSet& level, std::span<const Vec3d> places, std::span<const std::uint32_t> closest,
               std::span<const std::uint8_t> on_crease)
      : level_(level), places_(places), closest_(closest), on_crease_(on_crease) {}

  /// The corner that the diagonal starts at, 0 or 1.
  std::uint8_t operator()(const openvdb::Vec4I& q) const {
    const auto length = [&](int i, int j) { return (places_[q[i]] - places_[q[j]]).lengthSqr(); };
    if (!on_crease_[q[0]] && !on_crease_[q[1]] && !on_crease_[q[2]] && !on_crease_[q[3]])
      return length(0, 2) > length(1, 3);
    const double even = error(q[0], q[2]), odd = error(q[1], q[3]), alike = 1e-3 * level_.voxel_size();
    if (std::abs(even - odd) > alike) return even > odd;
    return std::min(area(q, 0, 1, 2), area(q, 0, 2, 3)) < std::min(area(q, 1, 2, 3), area(q, 1, 3, 0));
  }

 private:
  double error(std::uint32_t a, std::uint32_t b) const {
    return std::abs(level_.query()((places_[a] + places_[b]) / 2.0, closest_[a]).distance - level_.distance());
  }
  double area(const openvdb::Vec4I& q, int i, int j, int k) const {
    return (places_[q[j]] - places_[q[i]]).cross(places_[q[k]] - places_[q[i]]).lengthSqr();
  }

  const LevelSet& level_;
  std::span<const Vec3d> places_;
  std::span<const std::uint32_t> closest_;
  std::span<const std::uint8_t> on_crease_;
};

/// Triangles of a mesh, without its places; turned round if asked for.
Polygons split_polygons(const VoxelMesh& voxels, const QuadSplitter& split, bool turned) {
  std::vector<std::uint8_t> first(voxels.quads.size());  // corner of the diagonal
  for_each_index(first.size(), [&](std::size_t i) { first[i] = split(voxels.quads[i]); });
  Polygons mesh;
  mesh.corners.reserve(3 * (voxels.triangles.size() + 2 * voxels.quads.size()));
  mesh.face_begin.reserve(voxels.triangles.size() + 2 * voxels.quads.size() + 1);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (turned) mesh.add_face({a, c, b});
    else mesh.add_face({a, b, c});
  };
  for (const auto& t : voxels.triangles) add(t[0], t[1], t[2]);
  for (std::size_t i = 0; i < first.size(); ++i) {
    const auto& q = voxels.quads[i];
    const unsigned k = first[i];
    add(q[k], q[k + 1], q[k + 2]);
    add(q[k], q[k + 2], q[(k + 3) % 4]);
  }
  return mesh;
}

class Capture {
 public:
  Capture(PolygonView mesh, const CaptureOptions& options, int threads) : mesh_(mesh), options_(options) {
    result_.statistics.threads = threads;
    result_.statistics.distance = options.distance;
  }

  CaptureResult run() {
    prepare();
    Surface mesh = extract();
    {
      const StageTimer timer(result_.statistics.seconds, Stage::Limit);
      Progress progress(options_.progress, Stage::Limit, 1);
      result_.statistics.mending = mend(mesh, [&](const Vec3d& wish) {
        progress.advance(0);
        return onto(wish);
      });
    }
    const StageTimer timer(result_.statistics.seconds, Stage::Capture);
    hand_over(mesh);
    measure();
    check_topology();
    return std::move(result_);
  }

 private:
  const Surface& source() const { return result_.source->surface; }

  void prepare();
  Surface extract();
  void project(const IsoGrid& grid, const VoxelMesh& voxels, std::vector<Vec3d>& places,
               std::vector<std::uint32_t>& closest);
  std::optional<Vec3d> onto(const Vec3d& wish);
  Vec3d as_written(const Vec3d& local) const { return options_.precision(source().origin + local); }
  void hand_over(const Surface& mesh);
  void measure();
  void check_topology();

  PolygonView mesh_;
  const CaptureOptions& options_;
  double h_ = 0;
  std::optional<Inside> inside_;
  std::optional<LevelSet> level_;
  std::uint32_t hint_ = 0;  // while mending, tries follow each other in one place
  CaptureResult result_;
};

double longest_of(const MeshFacts& facts, double distance) { return facts.diagonal + 2 * std::abs(distance); }

/// Cubes whose centre is so near to the surface that it may pass through them make a slab of this many voxels.
constexpr double kSlabVoxels = 14.2;

CapturePlan estimate_capture(const Surface& surface, double distance, double h) {
  const MeshFacts& facts = surface.facts;
  const double d = std::abs(distance), sides = facts.closed() && facts.oriented() ? 1 : 2;
  // What is curved outwards has more area farther out, and whatever it is, at least that of a ball.
  const double spread = distance > 0 || sides == 2 ? 1 + 2 * d / facts.diagonal : 1;
  const double area = sides * facts.area * spread * spread + 4 * M_PI * d * d * static_cast<double>(facts.components);
  const double leaf = kLeafWidth * h, across = longest_of(facts, d) + 2 * leaf;
  const double leaves = std::min(area * kSlabVoxels * h / (leaf * leaf * leaf) + 8, std::pow(across / leaf, 3));
  const double bytes = kCaptureProcessBytes + static_cast<double>(surface_bytes(surface)) + leaves * kCaptureLeafBytes;
  constexpr double kMost = 0x1p62;  // only to be refused; the casts must not overflow
  CapturePlan plan;
  plan.voxel_size = h;
  plan.leaf_nodes = static_cast<std::size_t>(std::min(leaves, kMost));
  plan.triangles = static_cast<std::size_t>(std::min(leaves * kTrianglesPerLeaf, kMost));
  plan.bytes = static_cast<std::size_t>(std::min(bytes, kMost));
  return plan;
}

bool fits_budget(const CapturePlan& plan, const CaptureOptions& options, const MeshFacts& facts) {
  // volumeToMesh tells places in single precision, to a small part of a voxel.
  constexpr double kMostVoxelsAcross = 0x1p19;
  return (options.max_memory == 0 || plan.bytes <= options.max_memory) &&
         longest_of(facts, options.distance) / plan.voxel_size < kMostVoxelsAcross;
}

/// Fine enough that a chord of the rounding around an edge, of radius d, is off by less than 1 % of d in its middle,
/// and for the details that the mesh has.
CapturePlan choose_voxels(const Surface& surface, const CaptureOptions& options) {
  constexpr double kPerDistance = 4, kCoarsest = 128, kFinest = 512;
  const MeshFacts& facts = surface.facts;
  const double d = std::abs(options.distance), coarsest = facts.diagonal / kCoarsest, finest = facts.diagonal / kFinest;
  const double wanted = std::min(d / kPerDistance, facts.median_edge);
  double h = std::clamp(wanted, finest, coarsest);
  std::string reason = wanted < finest                        ? "diagonal / 512, as the distance or edges are smaller"
                       : wanted > coarsest                    ? "diagonal / 128, the coarsest useful size"
                       : facts.median_edge < d / kPerDistance ? "the median edge"
                                                              : "distance / 4";
  constexpr double kCoarser = 1.25;
  const double most = longest_of(facts, d);
  for (; h < most; h *= kCoarser) {
    CapturePlan plan = estimate_capture(surface, options.distance, h);
    plan.reason = reason;
    if (fits_budget(plan, options, facts)) return plan;
    reason = "the finest that the memory allows";
  }
  return estimate_capture(surface, options.distance, most);
}

CapturePlan plan_voxels(const Surface& surface, const CaptureOptions& options) {
  const GridOptions& grid = options.grid;
  require_plannable(surface.facts.diagonal, std::abs(options.distance), grid);
  CapturePlan plan;
  if (grid.voxel_size) {
    plan = estimate_capture(surface, options.distance, *grid.voxel_size);
    plan.reason = "as given";
  } else if (grid.voxels_per_distance) {
    plan = estimate_capture(surface, options.distance, std::abs(options.distance) / *grid.voxels_per_distance);
    plan.reason = fmt::format("distance / {:.6g}, as given", *grid.voxels_per_distance);
  } else {
    plan = choose_voxels(surface, options);
  }
  if (fits_budget(plan, options, surface.facts)) return plan;
  throw OutOfBudget(fmt::format(
      "capture: expected a surface that fits into {:.0f} MiB and 524288 voxels across, got about {:.0f} MiB in {} leaf "
      "nodes with voxel size {:.6g} (a larger voxel size needs less)",
      options.max_memory ? static_cast<double>(options.max_memory) / 1048576.0 : 0x1p42,
      static_cast<double>(plan.bytes) / 1048576.0, plan.leaf_nodes, plan.voxel_size));
}

void require_usable(const CaptureOptions& options) {
  if (!std::isfinite(options.distance) || options.distance == 0)
    throw InvalidInput(fmt::format("capture: expected a finite distance other than 0, got {}", options.distance));
  if (!(options.adaptivity >= 0 && options.adaptivity <= 1))
    throw InvalidInput(fmt::format("capture: expected an adaptivity from 0 to 1, got {}", options.adaptivity));
}

void Capture::prepare() {
  const StageTimer timer(result_.statistics.seconds, Stage::Rasterise);
  Surface surface = build_surface(mesh_, options_.weld, options_.orient);
  result_.statistics.plan = plan_voxels(surface, options_);
  result_.statistics.source = surface.facts;
  h_ = result_.statistics.plan.voxel_size;
  place(surface, h_);
  result_.source = std::make_shared<const CaptureSource>(std::move(surface));
  inside_.emplace(source(), options_.orient);
  result_.statistics.is_signed = inside_->has_inside();
  const double level = !inside_->has_inside() ? std::abs(options_.distance)
                       : inside_->is_turned() ? -options_.distance
                                              : options_.distance;
  level_.emplace(result_.source->query, *inside_, level, h_);
}

Surface Capture::extract() {
  std::size_t most_leaves = std::numeric_limits<std::size_t>::max();
  if (options_.max_memory > 0) most_leaves = options_.max_memory / static_cast<std::size_t>(kCaptureLeafBytes);
  IsoGrid grid;
  {
    const StageTimer timer(result_.statistics.seconds, Stage::Rasterise);
    grid = rasterise_iso(result_.source->query, *inside_, level_->level(), h_, most_leaves, options_.progress);
  }
  const StageTimer timer(result_.statistics.seconds, Stage::Capture);
  result_.statistics.leaf_nodes = grid.leaf_nodes;
  VoxelMesh voxels;
  voxels.merged = options_.adaptivity > 0;
  openvdb::tools::volumeToMesh(*grid.phi, voxels.points, voxels.triangles, voxels.quads, 0.0, options_.adaptivity);
  if (voxels.points.empty())
    throw InvalidInput(
        fmt::format("capture: expected a surface at distance {:.6g}, found none (nothing inside is that "
                    "far from the surface, or only what is thinner than a voxel of {:.6g})",
                    options_.distance, h_));
  std::vector<Vec3d> places(voxels.points.size());
  std::vector<std::uint32_t> closest(places.size());
  project(grid, voxels, places, closest);
  const std::vector<std::uint8_t> on_crease = put_on_creases(*level_, voxels, places, closest);
  Polygons mesh = split_polygons(voxels, {*level_, places, closest, on_crease}, inside_->is_turned());
  for_each_index(places.size(), [&](std::size_t v) { places[v] = as_written(places[v]); });
  mesh.positions = std::move(places);
  return build_surface(mesh.view(), {.enabled = false});
}

void Capture::project(const IsoGrid& grid, const VoxelMesh& voxels, std::vector<Vec3d>& places,
                      std::vector<std::uint32_t>& closest) {
  const Projection project(grid, *level_, h_, voxels.merged);
  // Runs of one length, whatever the number of threads: an answer may depend on its hint.
  constexpr std::size_t kRun = 256;
  Progress progress(options_.progress, Stage::Capture, places.size());
  const auto run = [&](std::size_t r) {
    std::uint32_t hint = 0;
    const std::size_t end = std::min(places.size(), (r + 1) * kRun);
    for (std::size_t v = r * kRun; v < end; ++v) {
      places[v] = project(Vec3d(voxels.points[v]), hint);
      closest[v] = hint;
    }
    progress.advance(kRun);
  };
  for_each_index((places.size() + kRun - 1) / kRun, run, 1);
}

std::optional<Vec3d> Capture::onto(const Vec3d& wish) {
  const Vec3d local = wish - source().origin;
  const auto place = level_->follow(local, hint_, [&](const Vec3d& x) { return (x - local).length() <= h_; });
  return place ? std::optional(as_written(*place)) : std::nullopt;
}

void Capture::hand_over(const Surface& mesh) {
  Polygons& polygons = result_.polygons;
  polygons.positions = mesh.vertices;
  polygons.corners.reserve(3 * mesh.triangles.size());
  polygons.face_begin.reserve(mesh.triangles.size() + 1);
  for (const auto& [a, b, c] : mesh.triangles) polygons.add_face({a, b, c});
}

/// Distances, and all else that closest points tell.
void Capture::measure() {
  const std::size_t count = result_.polygons.positions.size();
  std::vector<Vec3d> local(count);
  for_each_index(count, [&](std::size_t v) { local[v] = result_.polygons.positions[v] - source().origin; });
  const std::vector<Closest> closest = closest_points(result_.source->query, local);
  result_.normals.resize(count);
  result_.closest.resize(count);
  // Away from the source, or towards it, is where phi grows, and where the source's faces point.
  const double sense = (level_->level() < 0) != inside_->is_turned() ? -1 : 1;
  CaptureStatistics& statistics = result_.statistics;
  double squares = 0;
  for (std::size_t v = 0; v < count; ++v) {
    const auto& [distance, triangle, feature, point] = closest[v];
    const double error = std::abs(distance - level_->distance()) / level_->distance();
    statistics.worst_error = std::max(statistics.worst_error, error);
    squares += error * error;
    result_.closest[v] = triangle;
    result_.normals[v] = distance > 0 ? (local[v] - point) * (sense / distance) : Vec3d(0.0);
  }
  statistics.rms_error = count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0;
}

/// Vertices whose faces, from one to the next over edges, are not all that there are.
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

/// As whoever reads the file will find it.
void Capture::check_topology() {
  const Surface mesh = build_surface(result_.polygons.view(), {});
  CaptureStatistics& statistics = result_.statistics;
  statistics.vertices = mesh.vertices.size();
  statistics.triangles = result_.polygons.face_count();
  statistics.components = mesh.facts.components;
  statistics.border_edges = mesh.facts.boundary_edges;
  statistics.non_manifold_edges = mesh.facts.non_manifold_edges;
  statistics.turned_edges = mesh.facts.orientation_conflicts;
  statistics.pinched_vertices = count_pinched(mesh);
  constexpr std::size_t kInteriorSamples = 10000;
  const std::vector<std::uint32_t> none(mesh.vertices.size(), kNone);  // of its vertices is one of the source's
  const Body body{result_.source->query, mesh, none, {}, {}};
  const StageTimer timer(statistics.seconds, Stage::Measure);
  statistics.interior = measure_interior(body, mesh.vertices, Distances(level_->distance()), kInteriorSamples);
}

}  // namespace

CaptureResult capture(PolygonView mesh, const CaptureOptions& options) {
  require_usable(options);
  const int threads = thread_count(options.threads);
  CaptureResult result;
  tbb::task_arena arena(threads);
  arena.execute([&] { result = Capture(mesh, options, threads).run(); });
  return result;
}

CaptureStatistics plan_capture(PolygonView mesh, const CaptureOptions& options) {
  require_usable(options);
  CaptureStatistics statistics;
  statistics.threads = thread_count(options.threads);
  const Surface surface = build_surface(mesh, options.weld, options.orient);
  statistics.source = surface.facts;
  statistics.is_signed = surface.facts.closed() && surface.facts.oriented();
  statistics.plan = plan_voxels(surface, options);
  return statistics;
}

}  // namespace vdb_offset
