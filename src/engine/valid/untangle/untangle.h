// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "motion/parts/constrained_surface.h"
#include "vdb_offset/distances.h"

namespace vdb_offset {

/// Unfolds patches of a surface's offset, every vertex staying at its distance.
///
/// A patch's vertices slide in their planes so that a foldover-free energy of its faces falls (Garanzha, Kaporin,
/// Kudryavtseva, Protais, Ray, Sokolov, Foldover-free maps in 50 lines of code, 2021): the sum over faces of
/// area (tr J'J + lambda (det J^2 + 1)) / chi(det J), where J takes the source's triangle to its image in the plane of
/// its corners' normals and chi is smooth, positive, and tiny where det J < 0. After a few steps of L-BFGS
/// (quasi_newton.h) the vertices go back along the normals to their distance, and all planes are made anew. The normals
/// are directions away from the surface, *smoothed over the patch*: seen along those the offset surface is a graph even
/// across a concave crease, where its own normal jumps, so that a face that is unfolded in the planes is unfolded on
/// the surface.
class Untangler {
 public:
  struct Options {
    double area_weight;     ///< lambda: weight of the faces' areas against their shapes.
    int smoothing;          ///< How often normals are smoothed over the patch.
    bool keep_borders;      ///< Vertices at a border slide in the plane across it alone; held ones always do.
    bool thorough = false;  ///< Goes on where little more is gained: to the best shapes, and while faces stay folded.
  };

  /// Keeps references to the constrained surface and the distances of its vertices.
  Untangler(const ConstrainedSurface& constrained, const Distances& distances, const Options& options)
      : constrained_(constrained), distances_(distances), options_(options) {}

  /// Moves the vertices of a patch, which are on the moving part and whose distances are not 0. `displacement` has one
  /// for each vertex of the constrained surface; those of the patch lead to the vertices' distances, before and after.
  /// Displacements of the vertices around the patch are read. Safe for patches that share no face, from any number of
  /// threads. \pre the patch is sorted
  void operator()(std::span<const std::uint32_t> patch, std::span<Vec3d> displacement) const;

 private:
  const ConstrainedSurface& constrained_;
  const Distances& distances_;
  Options options_;
};

}  // namespace vdb_offset
