// SPDX-License-Identifier: Apache-2.0
#include "valid/faults/face_faults.h"

#include <algorithm>

#include "ground/system/assert.h"
#include "motion/paths/propagate.h"
#include "space/surface/start_direction.h"

namespace vdb_offset {
namespace {

// Share of its area in the source below which a face has collapsed. Reasoned: far below what a valid offset does to a
// face, far above rounding.
constexpr double kCollapsed = 1e-6;

}  // namespace

FaceFaults::FaceFaults(const ConstrainedSurface& constrained, std::span<const Vec3d> source,
                       std::span<const Vec3d> staying, const VertexPositions& positions,
                       const SourceCrossings& source_crossings)
    : constrained_(constrained),
      surface_(constrained.surface),
      source_(source),
      positions_(positions),
      source_crossings_(source_crossings),
      fault_(surface_.triangles.size(), Fault::None) {
  VDB_OFFSET_ASSERT(source.size() == surface_.vertices.size() && staying.size() == source.size());
  if (constrained.off_source) source_finder_.emplace(surface_, staying);
  if (constrained.obstacles) clearance_.emplace(*constrained.obstacles);
  if (!constrained.other_skin.empty()) other_skin_finder_.emplace(surface_, constrained.other_skin);
}

void FaceFaults::judge(const Indices& triangles) {
  VDB_OFFSET_ASSERT(is_index_set(triangles, fault_.size()));
  for_each_index(
      triangles.size(), [&](std::size_t i) { fault_[triangles[i]] = fault_of(triangles[i]); }, 64);
  list(triangles);
}

void FaceFaults::list(const Indices& triangles) {
  replace_members(faulty_, triangles, [&](std::uint32_t t) { return fault_[t] != Fault::None; });
}

FaultCounts FaceFaults::count() const {
  FaultCounts counts;
  for (const auto t : faulty_)
    ++(fault_[t] == Fault::Inverted    ? counts.inverted
       : fault_[t] == Fault::Collapsed ? counts.collapsed
                                       : counts.crowded);
  return counts;
}

/// Faces that have not moved may be anywhere, obstacles themselves above all.
FaceFaults::Fault FaceFaults::fault_of(std::uint32_t t) const {
  if (constrained_.rests(t) || !positions_.has_moved_corner(t)) return Fault::None;
  const bool is_on_part = constrained_.triangle_on_part(t);
  if (!(twice_area(surface_.triangles[t], source_).lengthSqr() > 0)) return Fault::None;
  Fault fault = shape_of(surface_.triangles[t], is_on_part);
  if (const SplitTriangle* const whole = surface_.whole_of(t); whole && fault == Fault::None)
    fault = shape_of(whole->corners, is_on_part);
  return fault == Fault::None && is_crowded(t) ? Fault::Crowded : fault;
}

/// What is wrong with the shape of a triangle that has an area in the source.
FaceFaults::Fault FaceFaults::shape_of(const std::array<std::uint32_t, 3>& corners, bool is_on_part) const {
  const Vec3d before = twice_area(corners, source_), now = twice_area(corners, positions_.all());
  if (now.length() <= kCollapsed * before.length()) return Fault::Collapsed;
  const bool against = is_on_part ? positions_.faces_against_part(corners) : now.dot(before) < 0;
  return against ? Fault::Inverted : Fault::None;
}

bool FaceFaults::is_crowded(std::uint32_t t) const {
  if (!clearance_ && !source_finder_) return false;
  if (source_finder_ && constrained_.triangle_on_part(t) && meets_source(t)) return true;
  if (other_skin_finder_ && constrained_.triangle_on_part(t) && meets_other_skin(t)) return true;
  return clearance_ && is_near_obstacle(t);
}

/// A face that stood nearer than the clearance from the start keeps its gap, as far as coordinates resolve it.
bool FaceFaults::is_near_obstacle(std::uint32_t t) const {
  const auto& [a, b, c] = surface_.triangles[t];
  const Vec3d& origin = surface_.origin;
  const double clearance = constrained_.obstacles->clearance,
               bound = constrained_.obstacles->start ? constrained_.obstacles->start->bound[t] : clearance,
               slack = bound < clearance
                           ? std::max({positions_.rounding(a), positions_.rounding(b), positions_.rounding(c)})
                           : 0;
  return clearance_->is_crowded({positions_.at(a) - origin, positions_.at(b) - origin, positions_.at(c) - origin},
                                bound, slack);
}

/// Faces that stay are no hindrance, since borders slide along them; but if they rest, those at the border hinder all
/// faces without a sliding edge. Where the source crosses itself, what leaves one sheet has to go through the other.
bool FaceFaults::meets_source(std::uint32_t t) const {
  // The ball around a corner, as large as its distance, holds nothing of the moving part; often it holds the whole
  // face.
  const auto& corners = surface_.triangles[t];
  for (const auto v : corners) {
    if (constrained_.resting_faces > 0) break;
    double farthest = 0;
    for (const auto w : corners) farthest = std::max(farthest, (positions_.at(w) - positions_.at(v)).length());
    if (positions_.distance(v) * kFreeShare > farthest) return false;
  }
  const Indices met = source_finder_->met_by(t, positions_.all());
  return std::any_of(met.begin(), met.end(), [&](std::uint32_t s) {
    if (constrained_.rests(s) && constrained_.has_bound_corner(s)) return !constrained_.has_bound_corner(t);
    return constrained_.triangle_on_part(s) && (s == t || !source_crossings_.sheets_cross(s, t));
  });
}

bool FaceFaults::meets_other_skin(std::uint32_t t) const {
  const Indices met = other_skin_finder_->met_by(t, positions_.all());
  return std::any_of(met.begin(), met.end(), [&](std::uint32_t s) {
    return constrained_.triangle_on_part(s) && !source_crossings_.sheets_cross(s, t);
  });
}

void FaceFaults::find_folded() {
  folded_.assign(source_.size(), 0);
  for_each_index(source_.size(), [&](std::size_t v) {
    const std::uint32_t on_part = constrained_.part_vertex_of(static_cast<std::uint32_t>(v));
    folded_[v] = on_part != kNone && is_folded(constrained_.moving_part.surface(), on_part);
  });
}

Indices FaceFaults::unmovable_folds() {
  Indices unmovable;
  if (!source_finder_) return unmovable;
  if (folded_.empty()) find_folded();
  for (const auto t : faulty_) {
    const auto& corners = surface_.triangles[t];
    const bool folded = folded_[corners[0]] || folded_[corners[1]] || folded_[corners[2]];
    if (!folded || fault_[t] != Fault::Crowded) continue;
    for (const auto s : source_finder_->met_by(t, positions_.all()))
      for (const auto v : surface_.triangles[s])
        if (folded_[v] && std::find(corners.begin(), corners.end(), v) != corners.end()) unmovable.push_back(v);
  }
  sort_unique(unmovable);
  return unmovable;
}

}  // namespace vdb_offset
