// SPDX-License-Identifier: Apache-2.0
// Measures a volume mesh as OpenFOAM's checkMesh does: faces oriented wrongly, non-orthogonality and skewness. A face's
// centre and area come from the triangles around the mean of its corners, and a cell's centre from the pyramids over
// its faces. A face is wrong if such a pyramid has no positive volume, by more than rounding. Non-orthogonality is the
// angle between a face's area vector and the line between the centres on both sides, skewness the distance of its
// centre from that line as a share of its size; at the boundary the line is the normal. Sums are made over blocks of a
// fixed size, added in order, so that the result does not depend on the number of threads. Other checks of checkMesh
// are not made here.
#include "products/volume/foam_measures.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"
#include "products/volume/cell_faces.h"

namespace vdb_offset {
namespace {

// OpenFOAM's own limits for double precision (doubleScalar.H, ROOTVSMALL and VSMALL): areas, lengths and volumes below
// them count as 0.
constexpr double kRootVerySmall = 1e-150, kVerySmall = 1e-300;

/// Measures a face. `at(k)` is the position of corner k.
template <class At>
FoamFace foam_face_of(std::size_t size, At&& at) {
  if (size == 3) return {(at(0) + at(1) + at(2)) / 3, (at(1) - at(0)).cross(at(2) - at(0)) / 2};
  Vec3d mean(0.0);
  for (std::size_t k = 0; k < size; ++k) mean += at(k);
  mean /= static_cast<double>(size);
  Vec3d normals(0.0), centres(0.0);
  double areas = 0;
  for (std::size_t k = 0; k < size; ++k) {
    const Vec3d& here = at(k);
    const Vec3d& next = at((k + 1) % size);
    const Vec3d normal = (next - here).cross(mean - here);
    const double area = normal.length();
    normals += normal;
    areas += area;
    centres += area * (here + next + mean);
  }
  if (areas < kRootVerySmall) return {mean, Vec3d(0.0)};
  return {centres / (3 * areas), normals / 2};
}

/// The centres and area vectors of a cell's faces, outward.
std::span<const FoamFace> faces_of(const VolumeMesh& mesh, std::size_t cell) {
  thread_local std::vector<FoamFace> faces;
  faces.clear();
  for_each_cell_face(mesh.cell_types[cell], mesh.cell(cell),
                     [&](std::span<const std::uint32_t> face) { faces.push_back(foam_face(mesh, face)); });
  return faces;
}

Vec3d centre_of(std::span<const FoamFace> faces) {
  Vec3d mean(0.0);
  for (const FoamFace& face : faces) mean += face.centre;
  mean /= static_cast<double>(faces.size());
  Vec3d sum(0.0);
  double volumes = 0;
  for (const FoamFace& face : faces) {
    const double volume = face.area.dot(face.centre - mean);
    sum += volume * (0.75 * face.centre + 0.25 * mean);
    volumes += volume;
  }
  return std::abs(volumes) > kVerySmall ? sum / volumes : mean;
}

double degrees_of(double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi; }

/// Whether the pyramid from a cell's centre to a face has a positive volume, by more than rounding.
bool is_seen_from_inside(const FoamFace& face, const Vec3d& centre) {
  // The least cosine between the face's area vector and the direction from the centre: what OpenFOAM computes in
  // another order may be off by a few 1e-16. Not measured.
  constexpr double kLeast = 1e-9;
  const Vec3d direction = face.centre - centre;
  const double volume = face.area.dot(direction);
  return volume > 0 && volume * volume > kLeast * kLeast * face.area.lengthSqr() * direction.lengthSqr();
}

/// The distance of a face's centre from the line between two cells' centres, in the face, divided by the face's size in
/// that direction.
/// \param line from one centre to the other
/// \param least_size the least size of the face that counts, as a share of the length of `line`
double skewness_of(const VolumeMesh& mesh, std::span<const std::uint32_t> corners, const FoamFace& face,
                   const Vec3d& centre, const Vec3d& line, double least_size) {
  const Vec3d to_face = face.centre - centre;
  const Vec3d beside = to_face - (face.area.dot(to_face) / (face.area.dot(line) + kRootVerySmall)) * line;
  const double length = beside.length();
  const Vec3d direction = beside / (length + kRootVerySmall);
  double size = least_size * line.length() + kRootVerySmall;
  for (const std::uint32_t p : corners) size = std::max(size, std::abs(direction.dot(mesh.points[p] - face.centre)));
  return length / size;
}

/// Sums over faces. They are made block by block, and blocks are added in order.
struct Sums {
  FoamQuality quality;
  double cosines = 0;
  std::size_t inner_faces = 0;

  void add(const Sums& other) {
    quality.wrong_faces += other.quality.wrong_faces;
    quality.non_orthogonal_faces += other.quality.non_orthogonal_faces;
    quality.skew_faces += other.quality.skew_faces;
    quality.non_orthogonality = std::max(quality.non_orthogonality, other.quality.non_orthogonality);
    quality.skewness = std::max(quality.skewness, other.quality.skewness);
    cosines += other.cosines;
    inner_faces += other.inner_faces;
  }
};

class FoamMeasurer {
 public:
  FoamMeasurer(const VolumeMesh& mesh, const VolumeFaces& faces)
      : mesh_(mesh), faces_(faces), centres_(mesh.cell_count()) {
    for_each_index(centres_.size(), [&](std::size_t c) { centres_[c] = foam_centre(mesh_, c); });
  }

  FoamQuality measure() const {
    Sums all = sum_up(mesh_.cell_count(), [&](std::size_t c, Sums& sums) { add_inner_faces(c, sums); });
    for (const BoundaryPatch& patch : mesh_.patches)
      all.add(sum_up(patch.face_count(), [&](std::size_t f, Sums& sums) { add_boundary_face(patch, f, sums); }));
    if (all.inner_faces > 0)
      all.quality.mean_non_orthogonality = degrees_of(all.cosines / static_cast<double>(all.inner_faces));
    return all.quality;
  }

 private:
  template <class Add>
  static Sums sum_up(std::size_t count, Add&& add) {
    // Cells, or faces, that one thread adds up in order. Sums depend on it in their last bits; not measured beside
    // other sizes.
    constexpr std::size_t kFoamBlock = 2048;
    std::vector<Sums> blocks((count + kFoamBlock - 1) / kFoamBlock);
    for_each_index(
        blocks.size(),
        [&](std::size_t b) {
          for (std::size_t i = b * kFoamBlock; i < std::min(count, (b + 1) * kFoamBlock); ++i) add(i, blocks[b]);
        },
        1);
    Sums all;
    for (const Sums& block : blocks) all.add(block);
    return all;
  }

  void add_inner_faces(std::size_t c, Sums& sums) const {
    thread_local std::vector<VolumeFaces::Side> upper;
    thread_local std::vector<std::uint32_t> corners;
    faces_.upper_faces(c, upper);
    for (const VolumeFaces::Side& side : upper) {
      const CellFace known = face(mesh_, c, side.local);
      corners.clear();
      for (std::size_t k = 0; k < known.size; ++k) corners.push_back(known[k]);
      add_inner_face(c, side.cell, corners, sums);
    }
  }

  void add_inner_face(std::size_t c, std::size_t other, std::span<const std::uint32_t> corners, Sums& sums) const {
    const FoamFace seen = foam_face(mesh_, corners);
    const Vec3d line = centres_[other] - centres_[c];
    const bool from_other = is_seen_from_inside({seen.centre, -seen.area}, centres_[other]);
    sums.quality.wrong_faces += !is_seen_from_inside(seen, centres_[c]) || !from_other;
    const double cosine = seen.area.dot(line) / (seen.area.length() * line.length() + kVerySmall);
    const double degrees = degrees_of(cosine);
    ++sums.inner_faces;
    sums.cosines += cosine;
    sums.quality.non_orthogonality = std::max(sums.quality.non_orthogonality, degrees);
    sums.quality.non_orthogonal_faces += degrees > FoamQuality::kMostDegrees;
    add_skewness(skewness_of(mesh_, corners, seen, centres_[c], line, 0.2), sums);
  }

  void add_boundary_face(const BoundaryPatch& patch, std::size_t f, Sums& sums) const {
    const FoamFace seen = foam_face(mesh_, patch.face(f));
    const Vec3d& centre = centres_[patch.cell[f]];
    sums.quality.wrong_faces += !is_seen_from_inside(seen, centre);
    const Vec3d normal = seen.area / (seen.area.length() + kRootVerySmall);
    const Vec3d line = normal * normal.dot(seen.centre - centre);
    add_skewness(skewness_of(mesh_, patch.face(f), seen, centre, line, 0.4), sums);
  }

  static void add_skewness(double skewness, Sums& sums) {
    sums.quality.skewness = std::max(sums.quality.skewness, skewness);
    sums.quality.skew_faces += skewness > FoamQuality::kMostSkewness;
  }

  const VolumeMesh& mesh_;
  const VolumeFaces& faces_;
  std::vector<Vec3d> centres_;
};

}  // namespace

FoamFace foam_face(const VolumeMesh& mesh, std::span<const std::uint32_t> face) {
  return foam_face_of(face.size(), [&](std::size_t k) -> const Vec3d& { return mesh.points[face[k]]; });
}

Vec3d foam_centre(const VolumeMesh& mesh, std::size_t cell) { return centre_of(faces_of(mesh, cell)); }

bool has_foam_pyramids(const VolumeMesh& mesh, std::size_t cell) {
  const auto faces = faces_of(mesh, cell);
  const Vec3d centre = centre_of(faces);
  return std::all_of(faces.begin(), faces.end(),
                     [&](const FoamFace& face) { return is_seen_from_inside(face, centre); });
}

FoamQuality measure_foam(const VolumeMesh& mesh, const VolumeFaces& faces) {
  VDB_OFFSET_ASSERT(!mesh.plane());
  return FoamMeasurer(mesh, faces).measure();
}

}  // namespace vdb_offset
