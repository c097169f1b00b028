// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "ground/numbers/index_set.h"
#include "ground/system/parallel.h"
#include "motion/parts/constrained_surface.h"
#include "valid/faults/clearance.h"
#include "valid/faults/replace_members.h"
#include "valid/faults/source_crossings.h"
#include "valid/faults/triangle_crossings.h"
#include "valid/faults/vertex_positions.h"
#include "vdb_offset/result.h"

namespace vdb_offset {

/// The faces of an offset that are faulty by themselves, as vertices are moved about.
///
/// A face is inverted if it faces against the direction away from the moving part at its centre and at each corner
/// (there, its distance has folded over; see VertexPositions) or, if it is not on the moving part, against its own
/// source. It is collapsed if its area is below 1e-6 of the source's. Pieces of a triangle that was split at hanging
/// vertices are so as well if it is, as the offset's file has it whole. A face is crowded if it is too near to an
/// obstacle; or if it meets the source, or the other skin of a shell, where it must not: anywhere but where sheets of
/// the source cross (see source_crossings.h).
class FaceFaults {
 public:
  enum class Fault : std::uint8_t { None, Inverted, Collapsed, Crowded };

  /// Keeps references to all.
  /// \param staying positions of vertices that do not move, as written
  FaceFaults(const ConstrainedSurface& constrained, std::span<const Vec3d> source, std::span<const Vec3d> staying,
             const VertexPositions& positions, const SourceCrossings& source_crossings);

  /// Faulty triangles, sorted.
  const Indices& faulty() const { return faulty_; }
  Fault operator[](std::uint32_t triangle) const { return fault_[triangle]; }
  /// Numbers of inverted, collapsed and crowded faces; crossings are left 0.
  FaultCounts count() const;

  /// Judges triangles anew whose corners have moved. \pre sorted, each once
  void judge(const Indices& triangles);
  /// Judges triangles anew, except those that known(triangle) has a result for. \pre sorted, each once
  template <class Known>
  void judge_again(const Indices& triangles, Known&& known);

  /// Folded vertices (see is_folded()) of crowded faces that meet the source around them.
  Indices unmovable_folds();
  /// Finds what meets the skin of a shell that does not move. \pre there is one
  const CrossingFinder& other_skin() const { return other_skin_finder_ ? *other_skin_finder_ : *source_finder_; }

 private:
  Fault fault_of(std::uint32_t triangle) const;
  Fault shape_of(const std::array<std::uint32_t, 3>& corners, bool is_on_part) const;
  bool is_crowded(std::uint32_t triangle) const;
  bool is_near_obstacle(std::uint32_t triangle) const;
  bool meets_source(std::uint32_t triangle) const;
  bool meets_other_skin(std::uint32_t triangle) const;
  void find_folded();
  void list(const Indices& triangles);

  const ConstrainedSurface& constrained_;
  const Surface& surface_;
  std::span<const Vec3d> source_;
  const VertexPositions& positions_;
  const SourceCrossings& source_crossings_;
  std::vector<Fault> fault_;  // of each triangle
  Indices faulty_;
  std::vector<std::uint8_t> folded_;                 // of each vertex; empty until unmovable_folds() needs it
  std::optional<CrossingFinder> source_finder_;      // where moved faces must not meet the source
  std::optional<CrossingFinder> other_skin_finder_;  // where a shell's other skin is not the source
  std::optional<ClearanceFinder> clearance_;         // if there are obstacles
};

template <class Known>
void FaceFaults::judge_again(const Indices& triangles, Known&& known) {
  for_each_index(
      triangles.size(),
      [&](std::size_t i) {
        const std::uint32_t t = triangles[i];
        const std::optional<Fault> fault = known(t);
        fault_[t] = fault ? *fault : fault_of(t);
      },
      64);
  list(triangles);
}

}  // namespace vdb_offset
