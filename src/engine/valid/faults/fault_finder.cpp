// SPDX-License-Identifier: Apache-2.0
#include "valid/faults/fault_finder.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "ground/system/assert.h"
#include "motion/paths/propagate.h"
#include "valid/faults/replace_members.h"

namespace vdb_offset {
namespace {

/// The source as it is written. Empty where vertices that have not moved keep their bytes.
std::vector<Vec3d> rewrite(const ConstrainedSurface& constrained, std::span<const Vec3d> source,
                           const Rounding& precision) {
  std::vector<Vec3d> positions;
  if (!precision.rounds_all || constrained.file) return positions;
  positions.assign(source.begin(), source.end());
  for (std::uint32_t v = 0; v < positions.size(); ++v)
    if (!constrained.is_of_obstacle(v)) positions[v] = precision(positions[v]);
  return positions;
}

/// The index of a member of a sorted set.
std::size_t index_in(const Indices& sorted, std::uint32_t member) {
  const auto at = std::lower_bound(sorted.begin(), sorted.end(), member);
  VDB_OFFSET_ASSERT(at != sorted.end() && *at == member);
  return static_cast<std::size_t>(at - sorted.begin());
}

}  // namespace

FaultFinder::Parts::Parts(const ConstrainedSurface& constrained_surface, std::span<const Vec3d> source,
                          const Distances& distances, const Rounding& precision,
                          std::optional<SelfCrossings> source_crossings)
    : constrained(constrained_surface),
      surface(constrained.surface),
      rewritten(rewrite(constrained, source, precision)),
      staying(rewritten.empty() ? source : rewritten),
      positions(constrained, source, distances, precision),
      pairs(constrained, positions, std::move(source_crossings)),
      faces(constrained, source, staying, positions, pairs.source_crossings()),
      triangles(surface.triangles.size()),
      vertices(source.size()),
      mark(source.size(), Mark::AsBefore) {
  if (constrained.with_rim)
    rim.emplace(constrained, constrained.other_skin.empty() ? staying : constrained.other_skin, positions.all(),
                distances);
}

/// Whether any corner of a triangle has a mark.
bool FaultFinder::Parts::has(std::uint32_t t, Mark wanted) const {
  const auto& corners = surface.triangles[t];
  return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return mark[v] == wanted; });
}

Indices FaultFinder::Parts::triangles_around(const Indices& some) {
  if (some.size() == surface.vertices.size()) {
    Indices all(surface.triangles.size());
    std::iota(all.begin(), all.end(), 0u);
    return all;
  }
  for (const auto v : some)
    for (const auto t : surface.triangles_around(v)) {
      triangles.add(t);
      if (const SplitTriangle* const whole = surface.whole_of(t))  // which all of its pieces are judged by
        for (const auto piece : whole->pieces) triangles.add(piece);
    }
  return triangles.take();
}

void FaultFinder::Parts::find_misplaced(const Indices& moved) {
  replace_members(misplaced, moved, [&](std::uint32_t v) { return positions.is_misplaced(v); });
}

/// To be called right after the update of the pairs, as the rim asks which triangles that one was called for.
void FaultFinder::Parts::find_rim_crossings(const Indices& moved, const Indices& touched) {
  if (rim) rim->find(moved, touched, pairs.finder(), faces.other_skin(), pairs.source_crossings());
}

FaultFinder::FaultFinder(const ConstrainedSurface& constrained, std::span<const Vec3d> source,
                         const Distances& distances, const Rounding& precision,
                         std::optional<SelfCrossings> source_crossings)
    : source_(source) {
  VDB_OFFSET_ASSERT(source.size() == constrained.surface.vertices.size());
  VDB_OFFSET_ASSERT(constrained.fits());
  parts_ = std::make_unique<Parts>(constrained, source, distances, precision, std::move(source_crossings));
}

void FaultFinder::move_all(const PositionOf& position_of) {
  Indices all(source_.size());
  std::iota(all.begin(), all.end(), 0u);
  move(all, position_of, nullptr, Crossings::All);
}

FaultFinder::Trial FaultFinder::try_ends(const Paths& paths, const Indices& moved) {
  return try_out(
      moved, [&](std::uint32_t v) { return source_[v] + paths.displacement[v]; }, Crossings::OneOfEach);
}

void FaultFinder::move_to_ends(const Paths& paths) {
  VDB_OFFSET_ASSERT(paths.displacement.size() == source_.size());
  Indices all(source_.size());
  std::iota(all.begin(), all.end(), 0u);
  move_to_ends(paths, all);
}

void FaultFinder::move_to_ends(const Paths& paths, const Indices& moved) {
  move(
      moved, [&](std::uint32_t v) { return source_[v] + paths.displacement[v]; }, &paths, Crossings::All);
}

void FaultFinder::move(const Indices& moved, const PositionOf& position_of, const Paths* ends) {
  VDB_OFFSET_ASSERT(!parts_->trial_is_open);
  move(moved, position_of, ends, Crossings::All);
}

void FaultFinder::move(const Indices& moved, const PositionOf& position_of, const Paths* ends, Crossings crossings) {
  Parts& parts = *parts_;
  VDB_OFFSET_ASSERT(is_index_set(moved, source_.size()));
  // What a path has found is closest but for rounding. Where the source crosses itself, that may be on another side.
  if (parts.pairs.source_crossings().count() > 0) ends = nullptr;
  parts.positions.move(moved, position_of, ends);
  const Indices touched = parts.triangles_around(moved);
  if (ends) parts.positions.find_ties_around(touched);
  parts.faces.judge(touched);
  parts.find_misplaced(moved);
  PairFaults::Update update = parts.pairs.update(touched);
  if (crossings == Crossings::OneOfEach) {
    // Moved vertices that are misplaced or corners of faulty faces have to be taken back, whatever their faces meet.
    const auto mark = [&](std::uint32_t v) {
      if (parts.mark[v] == Mark::Moved) parts.mark[v] = Mark::ToTakeBack;
    };
    for (const auto t : parts.faces.faulty())
      for (const auto v : parts.surface.triangles[t]) mark(v);
    for (const auto v : parts.misplaced) mark(v);
    update.find_one_of_each([&](std::uint32_t t) { return parts.has(t, Mark::ToTakeBack); });
  } else {
    update.find_all();
  }
  parts.find_rim_crossings(moved, touched);
}

FaultFinder::Trial FaultFinder::try_out(const Indices& moved, const PositionOf& position_of, Crossings crossings) {
  return {*this, moved, position_of, crossings};
}

FaultFinder::Trial::Trial(FaultFinder& finder, const Indices& moved, const PositionOf& position_of, Crossings crossings)
    : parts_(*finder.parts_), vertices_(moved), triangles_(parts_.triangles_around(moved)) {
  VDB_OFFSET_ASSERT(!parts_.trial_is_open);
  parts_.trial_is_open = true;
  pairs_ = parts_.pairs.faulty();
  standings_.reserve(vertices_.size());
  for (const auto v : vertices_) {
    standings_.push_back(parts_.positions[v]);
    parts_.mark[v] = Mark::Moved;
  }
  faults_.reserve(triangles_.size());
  for (const auto t : triangles_) faults_.push_back(parts_.faces[t]);
  finder.move(moved, position_of, nullptr, crossings);
}

FaultFinder::Trial::~Trial() {
  for (const auto v : vertices_) parts_.mark[v] = Mark::AsBefore;
  parts_.trial_is_open = false;
}

void FaultFinder::Trial::take_back(const Indices& vertices) {
  VDB_OFFSET_ASSERT(is_index_set(vertices, parts_.mark.size()));
  for (const auto v : vertices) {
    parts_.positions.put_back(v, standings_[index_in(vertices_, v)]);
    parts_.mark[v] = Mark::AsBefore;
  }
  const auto is_out = [&](std::uint32_t t) {
    const auto& corners = parts_.surface.triangles[t];
    return std::any_of(corners.begin(), corners.end(),
                       [&](std::uint32_t v) { return parts_.mark[v] != Mark::AsBefore; });
  };
  const Indices touched = parts_.triangles_around(vertices);
  parts_.faces.judge_again(touched, [&](std::uint32_t t) -> std::optional<FaceFaults::Fault> {
    if (is_out(t)) return std::nullopt;
    return faults_[index_in(triangles_, t)];
  });
  parts_.find_misplaced(vertices);
  PairFaults::Update update = parts_.pairs.update(touched);
  parts_.find_rim_crossings(vertices, touched);
  update.restore(pairs_, triangles_, is_out);
}

bool FaultFinder::any() const {
  return !parts_->faces.faulty().empty() || !parts_->pairs.faulty().empty() ||
         (parts_->rim && parts_->rim->count() > 0);
}

FaultCounts FaultFinder::count() const {
  FaultCounts counts = parts_->faces.count();
  counts.crossings = parts_->pairs.faulty().size() + (parts_->rim ? parts_->rim->count() : 0);
  return counts;
}

const char* name(FaceFault fault) {
  constexpr const char* kNames[kFaceFaultCount] = {"none", "inverted", "collapsed", "crowded", "crossing"};
  return kNames[static_cast<std::size_t>(fault)];
}

std::vector<FaceFault> FaultFinder::of_faces(std::size_t count) const {
  constexpr FaceFault kOfFace[] = {FaceFault::None, FaceFault::Inverted, FaceFault::Collapsed, FaceFault::Crowded};
  std::vector<FaceFault> faults(count, FaceFault::None);
  bool is_any = false;
  const auto mark = [&](std::uint32_t triangle, FaceFault fault) {
    const std::uint32_t face = parts_->surface.face[triangle];
    if (face >= count) return;  // of an obstacle
    if (faults[face] == FaceFault::None || fault < faults[face]) faults[face] = fault;
    is_any = true;
  };
  for_each_fault([&](std::uint32_t s, std::uint32_t t) {
    if (s == t) return mark(t, kOfFace[static_cast<std::size_t>(parts_->faces[t])]);
    mark(s, FaceFault::Crossing);
    mark(t, FaceFault::Crossing);
  });
  return is_any ? faults : std::vector<FaceFault>{};
}

Indices FaultFinder::faulty_vertices() {
  IndexGatherer& gathered = parts_->vertices;
  for (const auto v : parts_->misplaced) gathered.add(v);
  for_each_faulty_corner([&](std::uint32_t v) { gathered.add(v); });
  return gathered.take();
}

}  // namespace vdb_offset
