#include "vdb_offset/faults.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "vdb_offset/parallel.h"
#include "vdb_offset/propagate.h"

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

}  // namespace

FaultFinder::FaultFinder(const Body& body, std::span<const Vec3d> source, const Distances& distances,
                         Precision precision, std::optional<std::vector<TrianglePair>> source_crossings)
    : body_(body),
      surface_(body.surface),
      source_(source),
      distances_(distances),
      near_(1e-3 * distances.scale()),
      precision_(precision),
      place_(source.begin(), source.end()),
      away_(source.size()),
      distance_(source.size()),
      closest_(source.size(), kNone),
      right_side_(source.size(), 1),
      fault_(surface_.triangles.size(), Fault::None),
      touched_(surface_.triangles.size()),
      wrong_(source.size()),
      position_(source.size(), Position::AsBefore) {
  if (body.file) written_.assign(body.file->source.begin(), body.file->source.end());
  if (body.off_source) source_finder_.emplace(surface_, source_);
  if (body.obstacles) clearance_.emplace(*body.obstacles);
  if (!body.other_skin.empty()) other_skin_finder_.emplace(surface_, body.other_skin);
  if (body.with_rim) rim_.emplace(body, body.other_skin.empty() ? source_ : body.other_skin, place_, distances_);
  if (!source_crossings) {
    finder_.emplace(surface_, in_file());
    source_crossings = finder_->all();
  }
  source_crossings_.emplace(surface_, std::move(*source_crossings));
}

void FaultFinder::find_folded() {
  folded_.assign(source_.size(), 0);
  for_each_index(source_.size(), [&](std::size_t v) {
    const auto vertex = static_cast<std::uint32_t>(v);
    const std::uint32_t on_front = body_.front_vertex.empty() ? vertex : body_.front_vertex[vertex];
    folded_[v] = on_front != kNone && is_folded(body_.front.surface(), on_front);
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

/// Whether a pair that meets is not to.
bool FaultFinder::is_fault(const TrianglePair& pair) const {
  return !goes_along(pair.first, pair.second) && !goes_along(pair.second, pair.first) &&
         !std::binary_search(source_crossings().begin(), source_crossings().end(), pair) && !still_touches(pair);
}

/// Whether a face that met an obstacle from the start does no more than touch one.
bool FaultFinder::still_touches(const TrianglePair& pair) const {
  return body_.is_obstacle(pair.second) && body_.obstacles->start && !body_.is_obstacle(pair.first) &&
         body_.obstacles->start->touches[pair.first] && !finder_->go_through(pair);
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
    for (const TrianglePair& pair : finder_->all())
      if (!is_fault(pair)) continue;
      else if (matters(pair.first) && matters(pair.second)) crossings_.push_back(pair);
      else ++crossings_near_source_;
  } else {
    add_crossings_of_updated();
  }
  look_at_rim(moved, touched);
}

void FaultFinder::look_at_rim(const Indices& moved, const Indices& touched) {
  if (!rim_) return;
  rim_->look(moved, touched, *finder_, other_skin_finder_ ? *other_skin_finder_ : *source_finder_, *source_crossings_);
}

/// Whether a vertex stands where its path ended, rounded: then what was found there holds here to as much, phi being
/// 1-Lipschitz.
bool FaultFinder::is_known(std::uint32_t v, const Vec3d& x, const Paths& ends) const {
  constexpr double kSamePlace = 1e-11, kLittle = 1e-2;
  const double same = kSamePlace * ends.achieved[v] + std::min(2 * rounding(v), kLittle * ends.achieved[v]);
  return ends.closest[v] != kNone && (x - surface_.vertices[v] - ends.displacement[v]).length() <= same;
}

void FaultFinder::measure(std::span<const std::uint32_t> vertices, const Paths* ends) {
  const Surface& front = body_.front.surface();
  Indices unknown;
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> hints;
  for (const auto v : vertices) {
    const std::uint32_t before = std::exchange(closest_[v], kNone);
    distance_[v] = 0;
    away_[v] = Vec3d(0.0);
    right_side_[v] = 1;
    // What stands where it was is on the front, or no part of it.
    if (place_[v] == source_[v] || !body_.on_front(v)) continue;
    const Vec3d x = place_[v] - front.origin;
    if (ends && is_known(v, x, *ends)) {
      std::uint32_t triangle = ends->closest[v];
      const TrianglePoint nearest = front.walk_to_closest(x, triangle);
      take(v, x, {std::sqrt(nearest.squared_distance), triangle, nearest.feature, nearest.point});
      continue;
    }
    unknown.push_back(v);
    points.push_back(x);
    hints.push_back(before != kNone ? before : body_.hint(v));
  }
  std::vector<Closest> answers(points.size());
  body_.front.answer_together(points, hints, answers);
  for (std::size_t i = 0; i < unknown.size(); ++i) take(unknown[i], points[i], answers[i]);
}

void FaultFinder::take(std::uint32_t v, const Vec3d& x, const Closest& closest) {
  const Surface& front = body_.front.surface();
  distance_[v] = closest.distance;
  closest_[v] = closest.triangle;
  away_[v] = x - closest.point;
  const int side = distances_[v] < 0 ? -1 : 1;
  if (front.facts.closed() && front.facts.oriented() && closest.distance > near_)
    right_side_[v] = side * front.pseudonormal(closest.triangle, closest.feature).dot(away_[v]) > 0;
}

double FaultFinder::rounding(std::uint32_t v) const {
  double size = 0;
  for (int k = 0; k < 3; ++k) size = std::max(size, std::abs(place_[v][k]));
  return size * precision_.epsilon();
}

Vec3d FaultFinder::twice_area(std::uint32_t t, std::span<const Vec3d> at) const {
  const auto& [a, b, c] = surface_.triangles[t];
  return (at[b] - at[a]).cross(at[c] - at[a]);
}

bool FaultFinder::has_bound(std::uint32_t t) const {
  const auto& corners = surface_.triangles[t];
  return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return body_.is_bound(v); });
}

/// Whether a face that rests is met by one that has to: whose edge goes along such faces; or is not where it seems to
/// be, as the edge that it shares has gone.
bool FaultFinder::goes_along(std::uint32_t resting, std::uint32_t other) const {
  return body_.rests(resting) && (has_bound(resting) || has_bound(other));
}

FaultFinder::Fault FaultFinder::judge(std::uint32_t t) const {
  constexpr double kCollapsed = 1e-6;
  if (body_.rests(t)) return Fault::None;
  const Vec3d before = twice_area(t, source_), now = twice_area(t, place_);
  if (!(before.lengthSqr() > 0)) return Fault::None;
  if (now.length() <= kCollapsed * before.length()) return Fault::Collapsed;
  const bool against = body_.is_front(t) ? faces_against_front(t, before, now) : now.dot(before) < 0;
  if (against) return Fault::Inverted;
  return is_crowded(t) ? Fault::Crowded : Fault::None;
}

/// Faces that have not moved may be anywhere, obstacles themselves above all.
bool FaultFinder::is_crowded(std::uint32_t t) const {
  if (!clearance_ && !source_finder_) return false;
  const auto& corners = surface_.triangles[t];
  if (std::all_of(corners.begin(), corners.end(), [&](std::uint32_t v) { return place_[v] == source_[v]; }))
    return false;
  if (source_finder_ && body_.is_front(t) && meets_source(t)) return true;
  if (other_skin_finder_ && body_.is_front(t) && meets_other_skin(t)) return true;
  return clearance_ && is_near_obstacle(t);
}

/// What stood nearer than the clearance keeps its gap, as far as coordinates can tell.
bool FaultFinder::is_near_obstacle(std::uint32_t t) const {
  const auto& [a, b, c] = surface_.triangles[t];
  const Vec3d& origin = surface_.origin;
  const double clearance = body_.obstacles->clearance,
               bound = body_.obstacles->start ? body_.obstacles->start->bound[t] : clearance,
               slack = bound < clearance ? std::max({rounding(a), rounding(b), rounding(c)}) : 0;
  return clearance_->is_crowded({place_[a] - origin, place_[b] - origin, place_[c] - origin}, bound, slack);
}

/// What stays is in nobody's way here, as edges slide along it; but where it rests, that at the border is, too, in the
/// way of what has no such edge. Where the source crosses itself, what leaves one sheet has to go through the other.
bool FaultFinder::meets_source(std::uint32_t t) const {
  // The ball around a corner, as large as its distance, holds nothing of the front; often it holds the whole face.
  const auto& corners = surface_.triangles[t];
  for (const auto v : corners) {
    if (body_.resting_faces > 0) break;
    double farthest = 0;
    for (const auto w : corners) farthest = std::max(farthest, (place_[w] - place_[v]).length());
    if (distance_[v] * kFreeShare > farthest) return false;
  }
  const Indices met = source_finder_->met_by(t, place_);
  return std::any_of(met.begin(), met.end(), [&](std::uint32_t s) {
    if (body_.rests(s) && has_bound(s)) return !has_bound(t);
    return body_.is_front(s) && (s == t || !source_crossings_->sheets_cross(s, t));
  });
}

bool FaultFinder::meets_other_skin(std::uint32_t t) const {
  const Indices met = other_skin_finder_->met_by(t, place_);
  return std::any_of(met.begin(), met.end(),
                     [&](std::uint32_t s) { return body_.is_front(s) && !source_crossings_->sheets_cross(s, t); });
}

Indices FaultFinder::caught() {
  Indices caught;
  if (!source_finder_) return caught;
  if (folded_.empty()) find_folded();
  for (const auto t : faces_) {
    const auto& corners = surface_.triangles[t];
    const bool folded = folded_[corners[0]] || folded_[corners[1]] || folded_[corners[2]];
    if (!folded || fault_[t] != Fault::Crowded) continue;
    for (const auto s : source_finder_->met_by(t, place_))
      for (const auto v : surface_.triangles[s])
        if (folded_[v] && std::find(corners.begin(), corners.end(), v) != corners.end()) caught.push_back(v);
  }
  sort_unique(caught);
  return caught;
}

/// At each corner and at the centre, as far as they are off the front; with none of them, against the source's normal.
bool FaultFinder::faces_against_front(std::uint32_t t, const Vec3d& before, const Vec3d& now) const {
  const auto& [a, b, c] = surface_.triangles[t];
  const int side = distances_[a] + distances_[b] + distances_[c] < 0 ? -1 : 1;
  bool any = false;
  for (const auto v : {a, b, c}) {
    if (distance_[v] < near_) continue;
    any = true;
    if (side * now.dot(away_[v]) >= 0) return false;
  }
  const Vec3d centre = (place_[a] + place_[b] + place_[c]) / 3.0 - body_.front.surface().origin;
  const Closest closest = body_.front(centre, body_.hint(a));
  if (closest.distance >= near_) return side * now.dot(centre - closest.point) < 0;
  return any || now.dot(before) < 0;
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
  crossings_near_source_ = 0;
  look(everything, place_of, ends, Crossings::All);
}

void FaultFinder::look(const Indices& moved, const std::function<Vec3d(std::uint32_t)>& place_of, const Paths* ends) {
  look(moved, place_of, ends, Crossings::All);
}

void FaultFinder::look(const Indices& moved, const std::function<Vec3d(std::uint32_t)>& place_of, const Paths* ends,
                       Crossings crossings) {
  constexpr std::size_t kBlock = 64;
  const auto look_at = [&](std::size_t block) {
    const auto some = std::span(moved).subspan(block * kBlock, std::min(kBlock, moved.size() - block * kBlock));
    for (const auto v : some) put(v, place_of(v));
    measure(some, ends);
  };
  for_each_index((moved.size() + kBlock - 1) / kBlock, look_at, 1);
  const Indices touched = triangles_around(moved);
  for_each_index(
      touched.size(), [&](std::size_t i) { fault_[touched[i]] = judge(touched[i]); }, 64);
  replace(faces_, touched, [&](std::uint32_t t) { return fault_[t] != Fault::None; });
  replace(misplaced_, moved, [&](std::uint32_t v) { return is_misplaced(v); });
  look_for_crossings(moved, touched, crossings);
}

/// What has not moved keeps its bytes.
void FaultFinder::put(std::uint32_t v, const Vec3d& place) {
  if (body_.file) {
    written_[v] = body_.file->of(v, source_[v], place, precision_);
    place_[v] = place == source_[v] ? place : body_.file->space.metric().to(written_[v]);
  } else {
    place_[v] = place == source_[v] ? place : precision_(place);
  }
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
    before_.stands.push_back(
        {place_[v], body_.file ? written_[v] : place_[v], away_[v], distance_[v], closest_[v], right_side_[v]});
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
    const Stand& stand = before_.stands[index_of(before_.vertices, v)];
    place_[v] = stand.place;
    if (body_.file) written_[v] = stand.written;
    away_[v] = stand.away;
    distance_[v] = stand.distance;
    closest_[v] = stand.closest;
    right_side_[v] = stand.right_side;
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

bool FaultFinder::is_misplaced(std::uint32_t v) const {
  if (is_beyond_wall(v)) return true;
  return !right_side_[v] || distance_[v] > std::abs(distances_[v]) * (1 + kReachedTolerance) + rounding(v);
}

bool FaultFinder::is_beyond_wall(std::uint32_t v) const {
  const Surface& front = body_.front.surface();
  if (front.walls.empty() || !body_.on_front(v) || place_[v] == source_[v]) return false;
  const std::uint32_t on_front = body_.front_vertex.empty() ? v : body_.front_vertex[v];
  return vdb_offset::is_beyond_wall(front, on_front, place_[v] - front.origin, rounding(v));
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

Indices FaultFinder::wrong_vertices() {
  for (const auto v : misplaced_) wrong_.add(v);
  for_each_wrong_corner([&](std::uint32_t v) { wrong_.add(v); });
  return wrong_.take();
}

}  // namespace vdb_offset
