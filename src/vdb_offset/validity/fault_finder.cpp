#include "vdb_offset/validity/fault_finder.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "vdb_offset/base/parallel.h"
#include "vdb_offset/paths/propagate.h"

namespace vdb_offset {
namespace {

/// Judges anew the members of `some`.
template <class Wrong>
void replace(Indices& wrong, const Indices& some, Wrong&& is_wrong) {
  std::erase_if(wrong, [&](std::uint32_t i) { return std::binary_search(some.begin(), some.end(), i); });
  for (const auto i : some)
    if (is_wrong(i)) wrong.push_back(i);
  std::sort(wrong.begin(), wrong.end());
}

/// Empty where what has not moved keeps its bytes.
std::vector<Vec3d> rewrite(const ConstrainedSurface& constrained, std::span<const Vec3d> source,
                           const Rounding& precision) {
  std::vector<Vec3d> places;
  if (!precision.rounds_all || constrained.file) return places;
  places.assign(source.begin(), source.end());
  for (std::uint32_t v = 0; v < places.size(); ++v)
    if (!constrained.is_of_obstacle(v)) places[v] = precision(places[v]);
  return places;
}

}  // namespace

FaultFinder::FaultFinder(const ConstrainedSurface& constrained, std::span<const Vec3d> source,
                         const Distances& distances, Rounding precision, std::optional<SelfCrossings> source_crossings)
    : constrained_(constrained),
      surface_(constrained.surface),
      source_(source),
      rewritten_(rewrite(constrained, source, precision)),
      staying_(rewritten_.empty() ? source : rewritten_),
      stands_(constrained, source, distances, precision),
      fault_(surface_.triangles.size(), Fault::None),
      touched_(surface_.triangles.size()),
      wrong_(source.size()),
      position_(source.size(), Position::AsBefore) {
  if (constrained.off_source) source_finder_.emplace(surface_, staying_);
  if (constrained.obstacles) clearance_.emplace(*constrained.obstacles);
  if (!constrained.other_skin.empty()) other_skin_finder_.emplace(surface_, constrained.other_skin);
  if (constrained.with_rim)
    rim_.emplace(constrained, constrained.other_skin.empty() ? staying_ : constrained.other_skin, places(), distances);
  if (!source_crossings) {
    finder_.emplace(surface_, in_file());
    source_crossings = finder_->listed();
  }
  source_crossings_.emplace(surface_, std::move(*source_crossings));
}

void FaultFinder::find_folded() {
  folded_.assign(source_.size(), 0);
  for_each_index(source_.size(), [&](std::size_t v) {
    const auto vertex = static_cast<std::uint32_t>(v);
    const std::uint32_t on_front = constrained_.front_vertex.empty() ? vertex : constrained_.front_vertex[vertex];
    folded_[v] = on_front != kNone && is_folded(constrained_.front.surface(), on_front);
  });
}

Indices FaultFinder::triangles_around(const Indices& vertices) {
  if (vertices.size() == source_.size()) {
    Indices triangles(surface_.triangles.size());
    std::iota(triangles.begin(), triangles.end(), 0u);
    return triangles;
  }
  for (const auto v : vertices)
    for (const auto t : surface_.triangles_around(v)) touched_.add(t);
  return touched_.take();
}

/// Whether a pair that meets is not to. What has not moved is as it was, even if a coarser format makes it meet.
bool FaultFinder::is_fault(const TrianglePair& pair) const {
  return !goes_along(pair.first, pair.second) && !goes_along(pair.second, pair.first) &&
         !std::binary_search(source_crossings().pairs().begin(), source_crossings().pairs().end(), pair) &&
         !still_touches(pair) && (stands_.has_moved_corner(pair.first) || stands_.has_moved_corner(pair.second));
}

/// Whether a face that met an obstacle from the start does no more than touch one.
bool FaultFinder::still_touches(const TrianglePair& pair) const {
  return constrained_.is_obstacle(pair.second) && constrained_.obstacles->start &&
         !constrained_.is_obstacle(pair.first) && constrained_.obstacles->start->touches[pair.first] &&
         !finder_->go_through(pair);
}

/// Not what is near where sheets of the source cross, which has to slide.
bool FaultFinder::matters(std::uint32_t t) const { return !source_crossings_->is_near(t); }

void FaultFinder::add_crossings_of_updated() {
  for (const TrianglePair& pair : finder_->of_updated([&](std::uint32_t t) { return matters(t); }))
    if (is_fault(pair)) crossings_.push_back(pair);
}

void FaultFinder::forget_crossings_of_updated() {
  std::erase_if(crossings_, [&](const TrianglePair& pair) {
    return finder_->is_updated(pair.first) || finder_->is_updated(pair.second);
  });
}

void FaultFinder::update_finder(const Indices& touched) {
  const bool knows_all = !finder_ && touched.size() == surface_.triangles.size();
  if (!finder_) finder_.emplace(surface_, in_file());
  if (!knows_all) finder_->update(touched);
}

void FaultFinder::look_for_crossings(const Indices& moved, const Indices& touched, Crossings crossings) {
  update_finder(touched);
  const bool first = touched.size() == surface_.triangles.size();
  forget_crossings_of_updated();
  if (crossings == Crossings::OneOfEach) {
    mark_to_take_back();
    for (const TrianglePair& pair :
         finder_->one_of_each_updated([&](std::uint32_t t) { return matters(t) && !is_to_take_back(t); },
                                      [&](const TrianglePair& each) { return is_fault(each); }))
      crossings_.push_back(pair);
  } else if (first) {
    for (const TrianglePair& pair : finder_->all([&](std::uint32_t t) { return matters(t); }))
      if (is_fault(pair)) crossings_.push_back(pair);
  } else {
    add_crossings_of_updated();
  }
  look_at_rim(moved, touched);
}

void FaultFinder::look_at_rim(const Indices& moved, const Indices& touched) {
  if (!rim_) return;
  rim_->look(moved, touched, *finder_, other_skin_finder_ ? *other_skin_finder_ : *source_finder_, *source_crossings_);
}

bool FaultFinder::has_bound(std::uint32_t t) const {
  const auto& corners = surface_.triangles[t];
  return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return constrained_.is_bound(v); });
}

/// Whether a face that rests is met by one that has to: whose edge goes along such faces; or is not where it seems to
/// be, as the edge that it shares has gone.
bool FaultFinder::goes_along(std::uint32_t resting, std::uint32_t other) const {
  return constrained_.rests(resting) && (has_bound(resting) || has_bound(other));
}

/// Faces that have not moved may be anywhere, obstacles themselves above all.
FaultFinder::Fault FaultFinder::judge(std::uint32_t t) const {
  constexpr double kCollapsed = 1e-6;
  if (constrained_.rests(t) || !stands_.has_moved_corner(t)) return Fault::None;
  const Vec3d before = stands_.twice_area(t, source_), now = stands_.twice_area(t, places());
  if (!(before.lengthSqr() > 0)) return Fault::None;
  if (now.length() <= kCollapsed * before.length()) return Fault::Collapsed;
  const bool against = constrained_.is_front(t) ? stands_.faces_against_front(t) : now.dot(before) < 0;
  if (against) return Fault::Inverted;
  return is_crowded(t) ? Fault::Crowded : Fault::None;
}

bool FaultFinder::is_crowded(std::uint32_t t) const {
  if (!clearance_ && !source_finder_) return false;
  if (source_finder_ && constrained_.is_front(t) && meets_source(t)) return true;
  if (other_skin_finder_ && constrained_.is_front(t) && meets_other_skin(t)) return true;
  return clearance_ && is_near_obstacle(t);
}

/// What stood nearer than the clearance keeps its gap, as far as coordinates can tell.
bool FaultFinder::is_near_obstacle(std::uint32_t t) const {
  const auto& [a, b, c] = surface_.triangles[t];
  const Vec3d& origin = surface_.origin;
  const double clearance = constrained_.obstacles->clearance,
               bound = constrained_.obstacles->start ? constrained_.obstacles->start->bound[t] : clearance,
               slack = bound < clearance ? std::max({rounding(a), rounding(b), rounding(c)}) : 0;
  return clearance_->is_crowded({stands_.place(a) - origin, stands_.place(b) - origin, stands_.place(c) - origin},
                                bound, slack);
}

/// What stays is in nobody's way here, as edges slide along it; but where it rests, that at the border is, too, in the
/// way of what has no such edge. Where the source crosses itself, what leaves one sheet has to go through the other.
bool FaultFinder::meets_source(std::uint32_t t) const {
  // The ball around a corner, as large as its distance, holds nothing of the front; often it holds the whole face.
  const auto& corners = surface_.triangles[t];
  for (const auto v : corners) {
    if (constrained_.resting_faces > 0) break;
    double farthest = 0;
    for (const auto w : corners) farthest = std::max(farthest, (stands_.place(w) - stands_.place(v)).length());
    if (stands_.distance(v) * kFreeShare > farthest) return false;
  }
  const Indices met = source_finder_->met_by(t, places());
  return std::any_of(met.begin(), met.end(), [&](std::uint32_t s) {
    if (constrained_.rests(s) && has_bound(s)) return !has_bound(t);
    return constrained_.is_front(s) && (s == t || !source_crossings_->sheets_cross(s, t));
  });
}

bool FaultFinder::meets_other_skin(std::uint32_t t) const {
  const Indices met = other_skin_finder_->met_by(t, places());
  return std::any_of(met.begin(), met.end(), [&](std::uint32_t s) {
    return constrained_.is_front(s) && !source_crossings_->sheets_cross(s, t);
  });
}

Indices FaultFinder::caught() {
  Indices caught;
  if (!source_finder_) return caught;
  if (folded_.empty()) find_folded();
  for (const auto t : faces_) {
    const auto& corners = surface_.triangles[t];
    const bool folded = folded_[corners[0]] || folded_[corners[1]] || folded_[corners[2]];
    if (!folded || fault_[t] != Fault::Crowded) continue;
    for (const auto s : source_finder_->met_by(t, places()))
      for (const auto v : surface_.triangles[s])
        if (folded_[v] && std::find(corners.begin(), corners.end(), v) != corners.end()) caught.push_back(v);
  }
  sort_unique(caught);
  return caught;
}

void FaultFinder::look_everywhere(const std::function<Vec3d(std::uint32_t)>& place_of) {
  look_everywhere(place_of, nullptr);
}

void FaultFinder::look_at_ends(const Paths& paths) {
  look_everywhere([&](std::uint32_t v) { return source_[v] + paths.displacement[v]; }, &paths);
}

void FaultFinder::look_everywhere(const std::function<Vec3d(std::uint32_t)>& place_of, const Paths* ends) {
  Indices everything(source_.size());
  std::iota(everything.begin(), everything.end(), 0u);
  look(everything, place_of, ends, Crossings::All);
}

void FaultFinder::look(const Indices& moved, const std::function<Vec3d(std::uint32_t)>& place_of, const Paths* ends) {
  look(moved, place_of, ends, Crossings::All);
}

void FaultFinder::look(const Indices& moved, const std::function<Vec3d(std::uint32_t)>& place_of, const Paths* ends,
                       Crossings crossings) {
  stands_.move(moved, place_of, ends);
  const Indices touched = triangles_around(moved);
  if (ends) stands_.look_around(touched);
  for_each_index(
      touched.size(), [&](std::size_t i) { fault_[touched[i]] = judge(touched[i]); }, 64);
  replace(faces_, touched, [&](std::uint32_t t) { return fault_[t] != Fault::None; });
  replace(misplaced_, moved, [&](std::uint32_t v) { return is_misplaced(v); });
  look_for_crossings(moved, touched, crossings);
}

void FaultFinder::try_out(const Indices& moved, const std::function<Vec3d(std::uint32_t)>& place_of) {
  remember(moved);
  look(moved, place_of, nullptr, Crossings::All);
}

void FaultFinder::glance(const Indices& moved, const std::function<Vec3d(std::uint32_t)>& place_of) {
  remember(moved);
  look(moved, place_of, nullptr, Crossings::OneOfEach);
}

void FaultFinder::remember(const Indices& moved) {
  for (const auto v : before_.vertices) position_[v] = Position::AsBefore;
  before_ = {moved, triangles_around(moved), {}, {}, crossings_};
  before_.stands.reserve(moved.size());
  for (const auto v : moved) {
    before_.stands.push_back(stands_[v]);
    position_[v] = Position::Out;
  }
  before_.faults.reserve(before_.triangles.size());
  for (const auto t : before_.triangles) before_.faults.push_back(fault_[t]);
}

/// Whether any corner stands elsewhere than before.
bool FaultFinder::is_out(std::uint32_t t) const {
  const auto& corners = surface_.triangles[t];
  return std::any_of(corners.begin(), corners.end(),
                     [&](std::uint32_t v) { return position_[v] != Position::AsBefore; });
}

/// What has moved and is part of a face that is wrong by itself, or in the wrong place.
void FaultFinder::mark_to_take_back() {
  const auto mark = [&](std::uint32_t v) {
    if (position_[v] == Position::Out) position_[v] = Position::ToTakeBack;
  };
  for (const auto t : faces_)
    for (const auto v : surface_.triangles[t]) mark(v);
  for (const auto v : misplaced_) mark(v);
}

/// Whether any corner has to be taken back.
bool FaultFinder::is_to_take_back(std::uint32_t t) const {
  const auto& corners = surface_.triangles[t];
  return std::any_of(corners.begin(), corners.end(),
                     [&](std::uint32_t v) { return position_[v] == Position::ToTakeBack; });
}

void FaultFinder::take_back(const Indices& vertices) {
  const auto index_of = [](const Indices& sorted, std::uint32_t i) {
    return static_cast<std::size_t>(std::lower_bound(sorted.begin(), sorted.end(), i) - sorted.begin());
  };
  for (const auto v : vertices) {
    stands_.put_back(v, before_.stands[index_of(before_.vertices, v)]);
    position_[v] = Position::AsBefore;
  }
  const Indices touched = triangles_around(vertices);
  const auto judge_again = [&](std::size_t i) {
    const std::uint32_t t = touched[i];
    fault_[t] = is_out(t) ? judge(t) : before_.faults[index_of(before_.triangles, t)];
  };
  for_each_index(touched.size(), judge_again, 64);
  replace(faces_, touched, [&](std::uint32_t t) { return fault_[t] != Fault::None; });
  replace(misplaced_, vertices, [&](std::uint32_t v) { return is_misplaced(v); });
  finder_->update(touched);
  forget_crossings_of_updated();
  look_at_rim(vertices, touched);
  take_back_crossings(touched);
}

/// Pairs of what is back where it was meet again, unless one of them has stayed out: those are looked for from the side
/// that has fewer triangles.
void FaultFinder::take_back_crossings(const Indices& touched) {
  Indices out;
  std::copy_if(before_.triangles.begin(), before_.triangles.end(), std::back_inserter(out),
               [&](std::uint32_t t) { return is_out(t); });
  if (out.size() >= touched.size()) {
    add_crossings_of_updated();
    return;
  }
  for (const TrianglePair& pair : before_.crossings)
    if ((finder_->is_updated(pair.first) || finder_->is_updated(pair.second)) && !is_out(pair.first) &&
        !is_out(pair.second))
      crossings_.push_back(pair);
  if (out.empty()) return;
  finder_->update(out);
  forget_crossings_of_updated();
  add_crossings_of_updated();
}

bool FaultFinder::is_misplaced(std::uint32_t v) const { return is_beyond_wall(v) || stands_.is_misplaced(v); }

bool FaultFinder::is_beyond_wall(std::uint32_t v) const {
  const Surface& front = constrained_.front.surface();
  if (front.walls.empty() || !constrained_.on_front(v) || !stands_.has_moved(v)) return false;
  const std::uint32_t on_front = constrained_.front_vertex.empty() ? v : constrained_.front_vertex[v];
  return vdb_offset::is_beyond_wall(front, on_front, stands_.place(v) - front.origin, rounding(v));
}

FaultCounts FaultFinder::count() const {
  FaultCounts counts;
  for (const auto t : faces_)
    ++(fault_[t] == Fault::Inverted    ? counts.inverted
       : fault_[t] == Fault::Collapsed ? counts.collapsed
                                       : counts.crowded);
  counts.crossings = crossings_.size() + (rim_ ? rim_->count() : 0);
  return counts;
}

std::size_t FaultFinder::crossings_near_source() {
  if (source_crossings_->has_more()) return 0;
  Indices near;
  for (std::uint32_t t = 0; t < surface_.triangles.size(); ++t)
    if (!matters(t)) near.push_back(t);
  if (near.empty()) return 0;
  update_finder(near);
  const std::vector<TrianglePair> pairs = finder_->of_updated();
  return static_cast<std::size_t>(
      std::count_if(pairs.begin(), pairs.end(), [&](const TrianglePair& pair) { return is_fault(pair); }));
}

Indices FaultFinder::faulty_vertices() {
  for (const auto v : misplaced_) wrong_.add(v);
  for_each_faulty_corner([&](std::uint32_t v) { wrong_.add(v); });
  return wrong_.take();
}

}  // namespace vdb_offset
