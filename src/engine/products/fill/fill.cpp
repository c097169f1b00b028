// SPDX-License-Identifier: Apache-2.0
// Fills what layers leave open. First its border is made: the front, which the layers' outermost faces and bare faces
// of the wall are, and the farfield if the front does not enclose what is left. The border has to be closed and must
// not cross itself; then a filler, which is not ours, gets it, with points relative to its middle. What comes back is
// not trusted: it is joined to the layers, and proven to be a mesh of the domain, face by face, by exact predicates and
// by its volume.
#include "vdb_offset/fill.h"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "ground/mesh/exact_predicates.h"
#include "ground/numbers/disjoint_sets.h"
#include "ground/numbers/quantiles.h"
#include "ground/system/call_progress.h"
#include "ground/system/parallel.h"
#include "products/fill/check_front.h"
#include "products/fill/farfield.h"
#include "products/fill/front.h"
#include "products/fill/openings.h"
#include "products/fill/plane_lines.h"
#include "products/volume/cell_quality.h"
#include "products/volume/free_name.h"
#include "products/volume/periodic_patches.h"
#include "products/volume/volume_faces.h"

namespace vdb_offset {
namespace {

using Index = std::uint32_t;

// How far the sum of the cells' volumes may be from that of the domain, as a share: rounding makes 1e-15 or so.
constexpr double kVolumeError = 1e-9;

struct Box {
  Vec3d lowest{std::numeric_limits<double>::infinity()}, highest{-std::numeric_limits<double>::infinity()};
  void add(const Vec3d& x) {
    lowest = openvdb::math::minComponent(lowest, x);
    highest = openvdb::math::maxComponent(highest, x);
  }
};

class Filling {
 public:
  Filling(const FillOptions& options, VolumeMesh volume) : options_(options), volume_(std::move(volume)) {}

  void take_border(PolygonView mesh, const LayersResult& layers, const LayerCellFacts& facts, const WallNames& names) {
    layer_points_ = volume_.points.size();
    layer_cells_ = volume_.cell_count();
    front_ = take_front(mesh, layers, facts, names, options_.quads, volume_);
    front_size_ = front_.triangles.size();
    if (front_size_ == 0) throw InvalidInput("fill: expected layers, got none");
    close();
    require_sound(volume_.points, front_.triangles);
    six_volumes_ = six_volumes_inside(volume_.points, front_.triangles);
    if (!(six_volumes_ > 0))
      throw FillFailed("fill: expected a domain with a volume, got one that its border turns inside out");
  }

  void fill(const Filler& filler) {
    if (options_.before) options_.before(volume_);
    const FillDomain domain = make_domain();
    const auto start = std::chrono::steady_clock::now();
    const FilledDomain filled = filler(domain);
    seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    first_tetrahedron_ = volume_.cell_count();
    join(filled);
    prove_cells();
    add_boundary();
    prove_faces();
  }

  VolumeMesh finish(FillReport* report) {
    add_fields();
    if (report) make_report(*report);
    part_cells(front_.parted, volume_);
    match_periodic_patches(volume_);
    return std::move(volume_);
  }

 private:
  /// Closes the front: its openings by caps if it encloses what is left, or else by the farfield, and by planes of
  /// symmetry between that and its openings.
  void close() {
    std::vector<OpenPlane> planes = open_planes(volume_, open_edges(front_.triangles));
    if (!planes.empty() && !options_.caps) {
      const Vec3d& place = planes[0].origin;
      throw InvalidInput(
          fmt::format("fill: expected a closed surface, got one with {} openings, the first around ({:.6g}, "
                      "{:.6g}, {:.6g})",
                      planes.size(), place[0], place[1], place[2]));
    }
    const bool has_farfield = !is_enclosed_by(volume_.points, front_.triangles, planes);
    if (has_farfield) {
      // What is to be filled lies around these edges, not between them.
      for (OpenPlane& plane : planes)
        if (!plane.meets_others) plane.normal = -plane.normal;
      add_farfield(planes);
      planes = open_planes(volume_, open_edges(front_.triangles));
    }
    guessed_planes_ = guessed_planes(volume_.points, planes);
    const PlaneLines lines = find_plane_lines(volume_.points, planes);
    if (!lines.is_closed) throw FillFailed("fill: expected openings in planes that enclose a domain, got others");
    const auto [first, second] = periodic_planes(planes);
    close_along(lines, options_.growth, options_.longest.value_or(std::numeric_limits<double>::infinity()),
                volume_.points, planes,
                second == nullptr ? std::map<Index, Index>() : periodic_images(volume_, *first, *second));
    for (std::size_t i = 0; i < planes.size(); ++i) {
      const std::string number = planes.size() > 1 ? fmt::format("_{}", i + 1) : "";
      const std::string name = free_name(volume_, (has_farfield ? "symmetry" : "cap") + number);
      if (&planes[i] != second) cover(planes[i], options_, name, has_farfield, front_, volume_);
    }
    if (second != nullptr) cover_as(*first, *second, front_, volume_);
    if (!open_edges(front_.triangles).empty())
      throw FillFailed("fill: expected openings that can be covered, got others");
  }

  /// The planes of the first and of the second periodic patch, if there are both.
  static std::array<const OpenPlane*, 2> periodic_planes(std::span<const OpenPlane> planes) {
    std::array<const OpenPlane*, 2> both{};
    for (const OpenPlane& plane : planes)
      if (plane.patch != kNone) both[both[0] == nullptr ? 0 : 1] = &plane;
    if (both[1] == nullptr) return {};
    if (both[1]->patch < both[0]->patch) std::swap(both[0], both[1]);
    return both;
  }

  void add_farfield(std::span<const OpenPlane> planes) {
    std::vector<Vec3d> points;
    for (const FrontTriangle& triangle : front_.triangles)
      for (const Index p : triangle.corners) points.push_back(volume_.points[p]);
    const Polygons farfield = make_farfield(options_.farfield, points, planes);
    const auto first = static_cast<Index>(volume_.points.size()), patch = static_cast<Index>(volume_.patches.size());
    volume_.points.insert(volume_.points.end(), farfield.positions.begin(), farfield.positions.end());
    for (std::size_t f = 0; f < farfield.face_count(); ++f) {
      const auto face = farfield.view().face(f);
      front_.triangles.push_back({{first + face[0], first + face[1], first + face[2]}, kNone, patch});
    }
    volume_.patches.push_back({.name = free_name(volume_, "farfield"), .kind = BoundaryPatch::Kind::Outer});
    if (planes.empty() && !open_edges(std::span(front_.triangles).subspan(front_size_)).empty())
      throw InvalidInput("farfield: expected a closed surface, got one with open edges");
  }

  FillDomain make_domain() {
    FillDomain domain;
    std::vector<Index> number(volume_.points.size(), kNone);
    Box box;
    for (const FrontTriangle& triangle : front_.triangles)
      for (const Index p : triangle.corners) {
        if (number[p] != kNone) continue;
        number[p] = static_cast<Index>(of_domain_.size());
        of_domain_.push_back(p);
        box.add(volume_.points[p]);
      }
    middle_ = (box.lowest + box.highest) / 2;
    domain.points.reserve(of_domain_.size());
    for (const Index p : of_domain_) domain.points.push_back(volume_.points[p] - middle_);
    domain.triangles.reserve(front_.triangles.size());
    for (const FrontTriangle& triangle : front_.triangles) {
      const auto& [a, b, c] = triangle.corners;
      domain.triangles.push_back({number[a], number[b], number[c]});
    }
    add_outside(domain);
    domain.growth = options_.growth;
    domain.longest = options_.longest.value_or((box.highest - box.lowest).length());
    return domain;
  }

  /// Adds a point in a cell behind each shell that has cells behind it.
  void add_outside(FillDomain& domain) const {
    DisjointSets shells(volume_.points.size());
    for (const FrontTriangle& triangle : front_.triangles)
      for (std::size_t k = 0; k < 2; ++k) shells.join(triangle.corners[k], triangle.corners[k + 1]);
    std::vector<std::uint8_t> has_point(volume_.points.size(), 0);
    for (const FrontTriangle& triangle : front_.triangles) {
      const Index shell = shells.first(triangle.corners[0]);
      if (triangle.cell == kNone || has_point[shell] != 0) continue;
      has_point[shell] = 1;
      Vec3d sum(0.0);
      for (const Index p : volume_.cell(triangle.cell)) sum += volume_.points[p];
      domain.outside.push_back(sum / static_cast<double>(volume_.cell(triangle.cell).size()) - middle_);
    }
  }

  void join(const FilledDomain& filled) {
    const auto first = static_cast<Index>(volume_.points.size());
    if (volume_.points.size() + filled.added.size() >= kNone || volume_.cell_count() + filled.cells.size() >= kNone)
      throw FillFailed("fill: expected fewer than 2^32 points and cells, got more");
    for (const Vec3d& point : filled.added) volume_.points.push_back(point + middle_);
    const std::size_t known = of_domain_.size(), count = known + filled.added.size();
    for (const auto& cell : filled.cells) {
      for (const Index p : cell) {
        if (p >= count) throw FillFailed("fill: expected cells of the domain's points, got others");
        volume_.corners.push_back(p < known ? of_domain_[p] : first + static_cast<Index>(p - known));
      }
      volume_.cell_begin.push_back(volume_.corners.size());
      volume_.cell_types.push_back(CellType::Tetrahedron);
    }
  }

  /// \throw FillFailed unless all new cells have volumes above 0, and the tetrahedra's sum up to that of the domain
  void prove_cells() {
    for (std::size_t c = layer_cells_; c < first_tetrahedron_; ++c)
      if (!(scaled_jacobian(volume_, c) > 0)) {
        const Vec3d& place = volume_.points[volume_.cell(c)[4]];
        throw FillFailed(fmt::format(
            "fill: expected faces that a pyramid can stand on, got one that is too bent at ({:.6g}, {:.6g}, "
            "{:.6g}) (--fill-quads split, in .vtu, .cgns or polyMesh)",
            place[0], place[1], place[2]));
      }
    std::atomic<std::uint64_t> first_wrong = kNone;
    for_each_index(volume_.cell_count() - first_tetrahedron_, [&](std::size_t i) {
      const auto cell = volume_.cell(first_tetrahedron_ + i);
      const auto point = [&](std::size_t k) -> const Vec3d& { return volume_.points[cell[k]]; };
      if (side_of_plane({point(0), point(1), point(2)}, point(3)) <= 0) lower_to(first_wrong, i);
    });
    if (first_wrong != kNone) {
      const Vec3d& place = volume_.points[volume_.cell(first_tetrahedron_ + first_wrong)[0]];
      throw FillFailed(fmt::format("fill: expected cells with a volume, got one without at ({:.6g}, {:.6g}, {:.6g})",
                                   place[0], place[1], place[2]));
    }
    double sum = 0;
    for (std::size_t c = first_tetrahedron_; c < volume_.cell_count(); ++c) sum += cell_volume(volume_, c);
    if (!(std::abs(6 * sum - six_volumes_) <= kVolumeError * six_volumes_))
      throw FillFailed(fmt::format("fill: expected cells that fill the domain, whose volume is {:.9g}, got {:.9g}",
                                   six_volumes_ / 6, sum));
    filled_volume_ = sum;
  }

  /// Gives the patches of walls and of the farfield the faces of the front that no cell of the layers is behind.
  void add_boundary() {
    find_cells_on_front();
    for (std::size_t t = 0; t < front_.triangles.size(); ++t) {
      const FrontTriangle& triangle = front_.triangles[t];
      if (triangle.patch == kNone) continue;
      BoundaryPatch& patch = volume_.patches[triangle.patch];
      patch.corners.insert(patch.corners.end(), triangle.corners.begin(), triangle.corners.end());
      patch.face_begin.push_back(static_cast<Index>(patch.corners.size()));
      patch.cell.push_back(on_front_[t]);
    }
  }

  /// \throw FillFailed unless each triangle of the front is a side of one tetrahedron
  void find_cells_on_front() {
    using Corners = std::array<Index, 3>;
    std::vector<std::pair<Corners, Index>> known;
    known.reserve(front_.triangles.size());
    for (Index t = 0; t < front_.triangles.size(); ++t) {
      Corners corners = front_.triangles[t].corners;
      std::sort(corners.begin(), corners.end());
      known.emplace_back(corners, t);
    }
    std::sort(known.begin(), known.end());
    on_front_.assign(front_.triangles.size(), kNone);
    for_each_index(volume_.cell_count() - first_tetrahedron_, [&](std::size_t i) {
      const auto cell = volume_.cell(first_tetrahedron_ + i);
      for (std::size_t left_out = 0; left_out < 4; ++left_out) {
        Corners corners{cell[(left_out + 1) % 4], cell[(left_out + 2) % 4], cell[(left_out + 3) % 4]};
        std::sort(corners.begin(), corners.end());
        const auto found = std::lower_bound(known.begin(), known.end(), std::pair(corners, Index{0}));
        // Of a face that two cells have, either is set: prove_faces() finds it.
        if (found != known.end() && found->first == corners)
          std::atomic_ref(on_front_[found->second]).store(static_cast<Index>(first_tetrahedron_ + i));
      }
    });
    const auto lost = std::find(on_front_.begin(), on_front_.end(), kNone);
    if (lost == on_front_.end()) return;
    const Vec3d& place = volume_.points[front_.triangles[lost - on_front_.begin()].corners[0]];
    throw FillFailed(
        fmt::format("fill: expected a mesh that keeps all {} faces of its border, got one without that at "
                    "({:.6g}, {:.6g}, {:.6g})",
                    front_.triangles.size(), place[0], place[1], place[2]));
  }

  /// \throw FillFailed unless each inner face belongs to two cells, and all others are in the patches, each once
  void prove_faces() {
    // Cells behind parted faces have them whole yet: until they are parted, the front's own triangles are the boundary
    // of both the layers and what fills the rest.
    VolumeMesh tetrahedra;
    tetrahedra.points = volume_.points;
    const std::uint64_t first = volume_.cell_begin[first_tetrahedron_];
    tetrahedra.corners.assign(volume_.corners.begin() + static_cast<std::ptrdiff_t>(first), volume_.corners.end());
    for (std::size_t c = first_tetrahedron_; c < volume_.cell_count(); ++c) {
      tetrahedra.cell_types.push_back(volume_.cell_types[c]);
      tetrahedra.cell_begin.push_back(volume_.cell_begin[c + 1] - first);
    }
    BoundaryPatch& border = tetrahedra.patches.emplace_back();
    for (std::size_t t = 0; t < front_.triangles.size(); ++t) {
      const auto& corners = front_.triangles[t].corners;
      border.corners.insert(border.corners.end(), corners.begin(), corners.end());
      border.face_begin.push_back(static_cast<Index>(border.corners.size()));
      border.cell.push_back(on_front_[t] - static_cast<Index>(first_tetrahedron_));
    }
    try {
      const VolumeFaces matched(tetrahedra);
    } catch (const InvalidInput& error) {
      throw FillFailed(fmt::format("fill: expected cells whose faces match, got: {}", error.what()));
    }
  }

  void add_fields() {
    // Of points and cells that no layer has; of the farfield's and the filler's points all else is 0.
    constexpr float kNoLayer = -1;
    for (VolumeField& field : volume_.point_fields)
      field.values.resize(volume_.points.size(), field.name == "layer" ? kNoLayer : 0.0F);
    for (VolumeField& field : volume_.cell_fields) {
      const bool is_quality = field.name == "scaled_jacobian" || field.name == "aspect_ratio";
      const bool is_layer = field.name == "layer";
      field.values.resize(volume_.cell_count(), is_quality || is_layer ? 0.0F : kNoLayer);
      if (!is_quality) continue;
      for_each_index(volume_.cell_count() - layer_cells_, [&](std::size_t i) {
        const CellQuality quality = cell_quality(volume_, layer_cells_ + i);
        field.values[layer_cells_ + i] =
            static_cast<float>(field.name == "aspect_ratio" ? quality.aspect : quality.jacobian);
      });
    }
  }

  void make_report(FillReport& report) const {
    report.tetrahedra = volume_.cell_count() - first_tetrahedron_;
    report.pyramids = first_tetrahedron_ - layer_cells_;
    std::vector<Index> split;
    for (const PartedFace& face : front_.parted) split.push_back(face.cell);
    std::sort(split.begin(), split.end());
    report.split_cells = static_cast<std::size_t>(std::unique(split.begin(), split.end()) - split.begin());
    report.added_points = volume_.points.size() - layer_points_;
    report.front = front_.triangles.size();
    report.seconds = seconds_;
    report.guessed_planes = guessed_planes_;
    report.volume = filled_volume_;
    for (std::size_t c = layer_cells_; c < first_tetrahedron_; ++c) report.volume += cell_volume(volume_, c);
    const std::size_t made = volume_.cell_count() - layer_cells_;
    report.scaled_jacobian = spread_of(made, [&](std::size_t i) { return scaled_jacobian(volume_, layer_cells_ + i); });
    std::vector<double> jumps;
    for (std::size_t t = 0; t < front_size_; ++t) {
      if (front_.triangles[t].cell == kNone) continue;
      const double ratio = cell_volume(volume_, on_front_[t]) / cell_volume(volume_, front_.triangles[t].cell);
      if (ratio > 0) jumps.push_back(std::max(ratio, 1 / ratio));
    }
    if (!jumps.empty()) report.jump = spread_of(jumps.size(), [&](std::size_t i) { return jumps[i]; });
  }

  const FillOptions& options_;
  VolumeMesh volume_;
  FillFront front_;  // with the farfield, whose triangles come last
  std::size_t layer_points_ = 0, layer_cells_ = 0, front_size_ = 0, first_tetrahedron_ = 0;
  double six_volumes_ = 0, filled_volume_ = 0, seconds_ = 0;
  Vec3d middle_{0.0};
  std::vector<SymmetryPlane> guessed_planes_;
  std::vector<Index> of_domain_;  // the points that the filler gets, by its numbers
  std::vector<Index> on_front_;   // of each triangle of the front, the tetrahedron on it
};

}  // namespace

VolumeMesh fill_volume(PolygonView mesh, const LayersResult& layers, const LayerCellFacts& facts,
                       const WallNames& names, VolumeMesh cells, const FillOptions& options, const Filler& filler,
                       FillReport* report) {
  if (!(options.growth > 1)) throw InvalidOption("fill: expected a growth above 1");
  if (options.longest && !(*options.longest > 0)) throw InvalidOption("fill: expected a longest edge above 0");
  Filling filling(options, std::move(cells));
  report_share(options.progress, Stage::Fill, 0);
  filling.take_border(mesh, layers, facts, names);
  filling.fill(filler);
  report_share(options.progress, Stage::Fill, 1);
  return filling.finish(report);
}

}  // namespace vdb_offset
