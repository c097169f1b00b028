#pragma once

#include <cstdint>
#include <span>

#include "vdb_offset/distances.h"
#include "vdb_offset/parts/constrained_surface.h"

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
    double area_weight;     ///< lambda: of the faces' areas against their shapes.
    int smoothing;          ///< How often normals are smoothed over the patch.
    bool keep_borders;      ///< Vertices at a border slide in the plane across it alone; held ones always do.
    bool thorough = false;  ///< Goes on where little more is gained: to the best shapes, and with what stays folded.
    /// In distances: edges and heights of faces count as no shorter. Where features are far smaller than the distance,
    /// slivers would else rule the energy: what is nothing in the source is much where it is.
    double least_edge = 0;
  };

  /// Keeps references to the body and the distances of its vertices.
  Untangler(const ConstrainedSurface& constrained, const Distances& distances, const Options& options)
      : constrained_(constrained), distances_(distances), options_(options) {}

  /// Moves the patch's vertices, which are on the front and not at distance 0: `way` leads from each of the body's
  /// vertices to its place, at its distance for those of the patch, which are sorted. Reads the ways of the vertices
  /// around the patch. Safe for patches that share no face, from any number of threads.
  void operator()(std::span<const std::uint32_t> patch, std::span<Vec3d> way) const;

 private:
  const ConstrainedSurface& constrained_;
  const Distances& distances_;
  Options options_;
};

}  // namespace vdb_offset
