#include "vdb_offset/iso/snap_to_creases.h"

#include <openvdb/math/Mat3.h>

#include <array>
#include <cmath>
#include <optional>

#include "vdb_offset/base/parallel.h"

namespace vdb_offset {
namespace {

// Cosine of the least angle between the gradients of two sheets: a rounding of the surface turns by less from one voxel
// to the next, if its radius, the distance, is three voxels or more.
constexpr double kSharp = 0.9;
// Least volume that the gradients of three sheets span.
constexpr double kCorner = 0.2;

/// Two or three sheets, each by a triangle that a place on it is closest to.
struct CreaseSheets {
  std::array<std::uint32_t, 3> triangle;
  std::size_t count;
};

class CreaseFinder {
 public:
  CreaseFinder(const LevelSet& level, const VoxelMesh& mesh, const std::vector<Vec3d>& places,
               const std::vector<std::uint32_t>& closest)
      : level_(level),
        surface_(level.query().surface()),
        mesh_(mesh),
        places_(places),
        closest_(closest),
        away_(places.size()),
        second_(places.size(), kNone),
        third_(places.size(), kNone) {
    for_each_index(places.size(), [&](std::size_t v) {
      const Vec3d away = places_[v] - surface_.closest_on(closest_[v], places_[v]).point;
      away_[v] = away.lengthSqr() > 0 ? away.unit() : Vec3d(0.0);
    });
    for_each_neighbour([&](std::uint32_t v, std::uint32_t w) { look_for_second(v, w); });
    for_each_neighbour([&](std::uint32_t v, std::uint32_t w) { look_for_third(v, w); });
  }

  /// Where a vertex would be on a crease, and what it is closest to there.
  std::optional<std::pair<Vec3d, std::uint32_t>> place(std::size_t v) const {
    if (second_[v] == kNone) return std::nullopt;
    const std::uint32_t own = closest_[v], second = closest_[second_[v]];
    if (third_[v] == kNone) return meet(v, {{own, second, kNone}, 2});
    const std::uint32_t third = closest_[third_[v]];
    if (const auto corner = meet(v, {{own, second, third}, 3})) return corner;
    if (const auto crease = meet(v, {{own, second, kNone}, 2})) return crease;
    return meet(v, {{own, third, kNone}, 2});
  }

 private:
  /// Across a quad, too: of the voxels at a corner's sides, those alone may hold one sheet and no other.
  template <class Visit>
  void for_each_neighbour(Visit&& visit) const {
    const auto visit_pairs = [&](const auto& face, unsigned size) {
      for (unsigned i = 0; i < size; ++i)
        for (unsigned j = 0; j < size; ++j)
          if (i != j) visit(face[i], face[j]);
    };
    for (const auto& quad : mesh_.quads) visit_pairs(quad, 4);
    for (const auto& triangle : mesh_.triangles) visit_pairs(triangle, 3);
  }

  /// The neighbour whose gradient turns away most; of equals the first by number.
  void look_for_second(std::uint32_t v, std::uint32_t w) {
    const double cosine = away_[v].dot(away_[w]);
    if (cosine > kSharp || away_[w] == Vec3d(0.0)) return;
    std::uint32_t& second = second_[v];
    const double known = second == kNone ? 2 : away_[v].dot(away_[second]);
    if (cosine < known || (cosine == known && w < second)) second = w;
  }

  void look_for_third(std::uint32_t v, std::uint32_t w) {
    if (second_[v] == kNone) return;
    const Vec3d across = away_[v].cross(away_[second_[v]]);
    const double volume = std::abs(across.dot(away_[w]));
    if (volume < kCorner) return;
    std::uint32_t& third = third_[v];
    const double known = third == kNone ? 0 : std::abs(across.dot(away_[third]));
    if (volume > known || (volume == known && w < third)) third = w;
  }

  /// The place nearest to a vertex, by Newton's method, that has the distance to all of these sheets.
  std::optional<std::pair<Vec3d, std::uint32_t>> meet(std::size_t v, CreaseSheets sheets) const {
    constexpr int kMostSteps = 12;
    Vec3d x = places_[v];
    for (int step = 0; step < kMostSteps; ++step) {
      std::array<Vec3d, 3> gradient{Vec3d(0.0), Vec3d(0.0), Vec3d(0.0)};
      Vec3d missing(0.0);
      bool reached = true;
      for (std::size_t s = 0; s < sheets.count; ++s) {
        const TrianglePoint on_sheet = surface_.walk_to_closest(x, sheets.triangle[s]);
        const double distance = std::sqrt(on_sheet.squared_distance);
        if (distance == 0) return std::nullopt;
        gradient[s] = (x - on_sheet.point) / distance;
        missing[static_cast<int>(s)] = level_.distance() - distance;
        reached = reached && level_.is_reached(distance);
      }
      if (!are_apart(gradient, sheets.count)) return std::nullopt;  // the walks have led to one sheet
      if (reached) return accept(v, x, sheets.triangle[0]);
      x += shortest_step(gradient, sheets.count, missing);
      if (!is_near(v, x, 0.5)) return std::nullopt;
    }
    return std::nullopt;
  }

  static bool are_apart(const std::array<Vec3d, 3>& gradient, std::size_t count) {
    if (gradient[0].dot(gradient[1]) > kSharp) return false;
    return count == 2 || std::abs(gradient[0].cross(gradient[1]).dot(gradient[2])) >= kCorner;
  }

  /// With the gradients as rows of G: G^T (G G^T)^-1 missing.
  static Vec3d shortest_step(const std::array<Vec3d, 3>& g, std::size_t count, const Vec3d& missing) {
    if (count == 3) return openvdb::math::Mat3d(g[0], g[1], g[2], true).inverse() * missing;
    const double cosine = g[0].dot(g[1]), determinant = 1 - cosine * cosine;
    return g[0] * ((missing[0] - cosine * missing[1]) / determinant) +
           g[1] * ((missing[1] - cosine * missing[0]) / determinant);
  }

  /// In the vertex's voxel, or so much of a voxel beyond it.
  bool is_near(std::size_t v, const Vec3d& x, double slack) const {
    const double h = level_.voxel_size();
    if (mesh_.merged) return (x - places_[v]).length() <= (1 + slack) * h;
    const Vec3d in_lattice = x - mesh_.lattice.corner;
    for (int k = 0; k < 3; ++k) {
      const double cell = std::floor(static_cast<double>(mesh_.points[v][k]));
      if (!(in_lattice[k] >= (cell - slack) * h && in_lattice[k] <= (cell + 1 + slack) * h)) return false;
    }
    return true;
  }

  /// Nothing else may be nearer. Flat parts of models like to lie on the boundary of voxels, but for rounding.
  std::optional<std::pair<Vec3d, std::uint32_t>> accept(std::size_t v, const Vec3d& x, std::uint32_t hint) const {
    if (!is_near(v, x, 1e-6)) return std::nullopt;
    const Closest closest = level_.query()(x, hint);
    if (!level_.is_reached(closest.distance) || !level_.is_on_side(x)) return std::nullopt;
    return std::pair(x, closest.triangle);
  }

  const LevelSet& level_;
  const Surface& surface_;
  const VoxelMesh& mesh_;
  const std::vector<Vec3d>& places_;
  const std::vector<std::uint32_t>& closest_;
  std::vector<Vec3d> away_;                    // of each vertex, the unit vector away from what is closest
  std::vector<std::uint32_t> second_, third_;  // the neighbours that other sheets are told by
};

}  // namespace

std::vector<std::uint8_t> put_on_creases(const LevelSet& level, const VoxelMesh& mesh, std::vector<Vec3d>& places,
                                         std::vector<std::uint32_t>& closest) {
  const CreaseFinder finder(level, mesh, places, closest);
  std::vector<std::uint8_t> on_crease(places.size(), 0);
  std::vector<std::optional<std::pair<Vec3d, std::uint32_t>>> found(places.size());
  for_each_index(places.size(), [&](std::size_t v) { found[v] = finder.place(v); });
  for (std::size_t v = 0; v < places.size(); ++v) {
    if (!found[v]) continue;
    std::tie(places[v], closest[v]) = *found[v];
    on_crease[v] = 1;
  }
  return on_crease;
}

}  // namespace vdb_offset
