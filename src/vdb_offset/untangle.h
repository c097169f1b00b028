#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "vdb_offset/closest.h"

namespace vdb_offset {

/// Unfolds patches of a surface's offset, every vertex staying at its distance.
///
/// A patch's vertices slide in their planes so that a foldover-free energy of its faces falls (Garanzha, Kaporin,
/// Kudryavtseva, Protais, Ray, Sokolov, Foldover-free maps in 50 lines of code, 2021): the sum over faces of
/// area (tr J'J + lambda (det J^2 + 1)) / chi(det J), where J takes the source's triangle to its image in the plane of
/// its corners' normals and chi is smooth, positive, and tiny where det J < 0. A few steps of L-BFGS; then along the
/// normals back to the distance, and all planes anew. The normals are directions away from the surface, *smoothed over
/// the patch*: seen along those the offset surface is a graph even across a concave crease, where its own normal
/// jumps, so that what is unfolded in the planes is unfolded on the surface.
class Untangler {
 public:
  struct Options {
    int smoothing;       ///< How often normals are smoothed over the patch.
    double area_weight;  ///< lambda: of the faces' areas against their shapes.
  };

  /// Keeps a reference to the query. `distance` in world units, not 0; negative is inward.
  Untangler(const ClosestQuery& query, double distance, const Options& options)
      : query_(query), target_(std::abs(distance)), side_(distance < 0 ? -1 : 1), options_(options) {}

  /// Moves the patch's vertices: `way` leads from each of the surface's vertices to its place, at the distance for
  /// those of the patch, which are sorted. Reads the ways of the vertices around the patch.
  /// Safe for patches that share no face, from any number of threads.
  void operator()(std::span<const std::uint32_t> patch, std::span<Vec3d> way) const;

 private:
  const ClosestQuery& query_;
  double target_;
  int side_;
  Options options_;
};

}  // namespace vdb_offset
