#include "vdb_offset/limit/limit.h"

#include "vdb_offset/base/progress_count.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include <tbb/parallel_for.h>

#include "vdb_offset/base/hash_mix.h"
#include "vdb_offset/base/parallel.h"
#include "vdb_offset/limit/blocked_moves.h"
#include "vdb_offset/limit/limit_schedule.h"
#include "vdb_offset/limit/live_area.h"
#include "vdb_offset/limit/untangle.h"
#include "vdb_offset/limit/vertex_patches.h"
#include "vdb_offset/validity/fault_finder.h"

namespace vdb_offset {
namespace {

// How much of its way a vertex of a wrong face keeps in a round; below the last share it keeps none. That share is
// small, as the skins of a shell touch where a vertex has not moved at all. Of a wrong face's corners that one goes
// back with which least is lost, and those with which no more than so many times as much is; the others once these have
// spent all but a share of their way.
constexpr double kKept = 0.8, kLastShare = 1e-4, kBent = 0.1, kAlikeStakes = 4, kSpent = 0.1;

// Where a precedent is followed, hardly any patch of more vertices than so many is freed that has not been already.
constexpr std::size_t kFollowedVertices = 60;

// With more faults than this, only patches of few rings are tried, and another way only if one leaves less than a
// share.
constexpr int kFewRings = 3;
constexpr std::size_t kManyFaults = 2000;
constexpr double kWorthwhile = 0.8;

// In each of so many rounds, one of kLeapers pulled vertices is let out again, by this part of what is left of its way.
// Those that have got into each other's way would do so again if they all went together.
struct Leaps {
  double part;
  int rounds;
};
constexpr Leaps kLeaps[] = {{1, 20}, {0.5, 20}};
constexpr std::uint64_t kLeapers = 4;

// Around what a precedent has mended, so many rings go along.
constexpr int kFollowedRings = 1;

// How much more of its way, per distance between them, a vertex may go than a pulled one beside it.
constexpr double kSteepest = 2;
// What cannot be taken back with all others often can afterwards.
constexpr int kEasings = 2;
// What has so many times the area of a pulled vertex around it does not follow that.
constexpr double kMuchMoreArea = 4;

// Of the short vertices so many, those with the largest areas, are settled where there is room, unless what they lose
// is less than that share of the whole area; with no more trials than so many in each turn. A trial takes others back
// faster, and is given up once these lose more than a part of what is won, or so much is wrong.
constexpr std::size_t kMostSettled = 2000, kMostTrials = 3000, kMostFaults = 150;
constexpr double kLeastSettled = 2e-5, kKeptInTrial = 0.6, kLastShareInTrial = 1e-3, kWorthLosing = 0.8;

// More than so many do not slide aside for one.
constexpr std::size_t kMostAside = 200;

// A feature goes along with a vertex if no edge that leads there is longer than this share of the distance.
constexpr double kReaches[] = {0.01, 0.1, 0.3};

constexpr std::size_t kExpectedRounds = 32;

class Limiter {
 public:
  Limiter(const ConstrainedSurface& constrained, std::span<const Vec3d> source, const Distances& distances,
          Paths& paths, FaultFinder& faults, const WarmStart* followed = nullptr)
      : constrained_(constrained),
        surface_(constrained.surface),
        source_(source),
        distances_(distances),
        paths_(paths),
        whole_way_(paths.displacement),
        share_(source.size(), 1.0),
        patches_(constrained.surface),
        gathered_(source.size()),
        stakes_(constrained, distances),
        faults_(faults),
        followed_(followed) {
    statistics_.source_crossings = faults_.source_crossings().count();
    statistics_.more_source_crossings = faults_.source_crossings().has_more();
    statistics_.before = faults_.count();
  }

  void untangle(Progress& progress) {
    if (followed_) follow();
    // What a precedent and the first way leave, the others hardly free.
    for (const UntangleSetting& attempt : kSchedule)
      if (!untangle_with(attempt, progress) || followed_) break;
    free_collided(progress);
  }

  void pull_back_and_let_out(Progress& progress) {
    while (pull_back()) progress.advance(1);
    leap(progress);
    for (const LiveArea::Lines lines : {LiveArea::Lines::KeepBorder, LiveArea::Lines::All})
      if (settle(lines)) leap(progress);
    for (int i = 0; i < kEasings; ++i) ease();
    while (pull_back()) progress.advance(1);  // should what was put back be judged otherwise than before
    statistics_.left = faults_.count();
  }

  /// Tells the paths what has become of them, and who may follow.
  LimitStatistics finish(WarmStart* set = nullptr) {
    std::vector<std::uint8_t> mended(set ? source_.size() : 0, 0);
    double lost = 0;
    std::size_t moving = 0;
    for (std::uint32_t v = 0; v < share_.size(); ++v) {
      const double target = std::abs(distances_[v]);
      if (target == 0 || !constrained_.on_front(v)) continue;
      ++moving;
      const bool stayed = paths_.displacement[v] == way(v);
      paths_.displacement[v] = way(v);
      const double distance = faults_.distance_of(v), before = std::exchange(paths_.achieved[v], distance);
      if (stayed) continue;
      if (set) mended[v] = 1;
      lost += std::max(0.0, before - distance) / target;
      paths_.closest[v] = faults_.closest_to(v);
      if (std::abs(distance - target) <= kReachedTolerance * target + faults_.rounding(v)) {
        paths_.state[v] = VertexState::Reached;  // one that had collided may have slid to where there is room
      } else if (share_[v] != 1 || paths_.state[v] == VertexState::Reached) {
        paths_.state[v] = VertexState::Limited;
        ++statistics_.limited_vertices;
      }
    }
    statistics_.thickness_lost = lost / static_cast<double>(std::max<std::size_t>(1, moving));
    statistics_.left = faults_.count();
    statistics_.crossings_near_source = faults_.crossings_near_source();
    if (set) {
      const std::vector<std::uint8_t> none(source_.size(), 0);
      *set = {distances_, paths_.displacement, paths_.achieved, std::move(mended), none, none, is_much_wrong()};
      for (const auto v : pulled_) set->pulled[v] = 1;
      for (std::size_t v = 0; v < share_.size(); ++v) set->held[v] = share_[v] != 1;
    }
    return statistics_;
  }

 private:
  std::size_t fault_count() const { return faults_.count().total(); }
  /// At first; as little is tried as where that was so before.
  bool is_much_wrong() const {
    return statistics_.before.total() > kManyFaults || (followed_ && followed_->much_wrong);
  }
  bool has_many_faults() const { return fault_count() > kManyFaults || (followed_ && followed_->much_wrong); }

  /// Whether a vertex goes no farther than the one that was there before, to the same side.
  bool may_follow(std::uint32_t v) const {
    const double distance = distances_[v], farther = followed_->distances[v];
    return may_slide(v) && distance * farther > 0 && std::abs(distance) <= std::abs(farther);
  }

  /// Begins with what became of a farther offset, where something is wrong with this one.
  void follow() {
    for (std::uint32_t v = 0; v < source_.size(); ++v)
      if (followed_->mended[v] && may_follow(v)) gathered_.add(v);
    if (gathered_.so_far().empty()) return;
    Indices chosen = with_rings(gathered_.take(), kFollowedRings);
    std::erase_if(chosen, [&](std::uint32_t v) { return !may_follow(v); });
    patches_.split(chosen);
    const std::vector<Wrong> wrong = wrong_by_patch();
    patches_.drop_if([&](const Indices&, std::uint32_t number) { return !wrong[number].any(); });
    const Indices began = patches_.vertices();
    statistics_.followed_vertices = try_out([&](const Indices& patch) {
      for_each_index(
          patch.size(), [&](std::size_t i) { begin_as_followed(patch[i]); }, 16);
    });
    for (const auto v : began)
      if (share_[v] != 1) pulled_.push_back(v);
  }

  /// On the straight way to where the vertex ended up there, if that is far enough, or both have collided; or, if it
  /// was held back there, as far as that on its own way.
  void begin_as_followed(std::uint32_t v) {
    const Vec3d& way = followed_->way[v];
    Vec3d& whole = whole_way_[v];
    const double distance = std::abs(distances_[v]);
    if (followed_->achieved[v] >= distance * (1 - kReachedTolerance) - faults_.rounding(v))
      whole = way_to_distance(constrained_, v, way, distance);
    else if (followed_->held[v] && whole.lengthSqr() > 0)
      share_[v] = std::clamp(way.length() / whole.length(), kLastShare, 1.0);
    else if (paths_.state[v] == VertexState::Collision) whole = way;
  }

  /// Whether a triangle is one of those that untangling alone could not free before: all of its corners had to be
  /// pulled back, whether or not they could be let out again.
  bool is_given_up(std::uint32_t t) const {
    const auto& corners = surface_.triangles[t];
    return followed_ && std::all_of(corners.begin(), corners.end(), [&](std::uint32_t v) {
             return followed_->pulled[v] && distances_[v] * followed_->distances[v] > 0;
           });
  }

  /// Patches of ever more rings, for as long as something is wrong and more rings make another patch. Where much is
  /// wrong, fronts have run through each other, and large patches take long for little. False if it is not worth
  /// while to try another way.
  bool untangle_with(const UntangleSetting& attempt, Progress& progress) {
    const std::size_t before = fault_count();
    Indices last;
    for (const Growth& growth : attempt.growths) {
      if (!faults_.any()) return false;
      if (growth.rings > kFewRings && has_many_faults()) break;
      Indices chosen = patch_vertices(growth.rings);
      if (chosen == last) break;
      untangle(chosen, attempt.options, growth, attempt.least_contrast);
      ++statistics_.untanglings;
      progress.advance(1);
      last = std::move(chosen);
    }
    return !has_many_faults() || fault_count() < kWorthwhile * static_cast<double>(before);
  }

  /// Lets what has collided slide to where it has its distance.
  void free_collided(Progress& progress) {
    Indices open;
    for (std::uint32_t v = 0; v < source_.size(); ++v)
      if (may_slide(v) && is_short(v)) open.push_back(v);
    for (const auto& [options, growth] : kFreeings) {
      if (open.empty()) return;
      const std::size_t before = open.size();
      const bool many = before > kManyFaults;
      if (many && growth.rings > 0) continue;
      Indices chosen = with_rings(open, growth.rings);
      std::erase_if(chosen, [&](std::uint32_t v) { return !may_slide(v); });
      untangle(chosen, options, growth);
      ++statistics_.untanglings;
      progress.advance(1);
      std::erase_if(open, [&](std::uint32_t v) { return !is_short(v); });
      if (many && static_cast<double>(open.size()) > kHopeless * static_cast<double>(before)) return;
    }
  }

  bool is_short(std::uint32_t v) const {
    return faults_.distance_of(v) < std::abs(distances_[v]) * (1 - kReachedTolerance) - faults_.rounding(v);
  }

  /// A share of the way: back along the straight line; the last of it on a parabola that meets the surface in the
  /// vertex's own direction, as the line may dip through the faces around it.
  Vec3d way(std::size_t v) const {
    const double share = share_[v];
    const Vec3d& whole = whole_way_[v];
    if (share == 1) return whole;
    const auto vertex = static_cast<std::uint32_t>(v);
    if (share >= kBent || share == 0 || constrained_.is_bound(vertex)) return whole * share;
    const std::uint32_t on_front = constrained_.front_vertex.empty() ? vertex : constrained_.front_vertex[vertex];
    const Vec3d start = start_direction(constrained_.front.surface(), on_front) * (distances_[v] < 0 ? -1.0 : 1.0);
    if (!(start.lengthSqr() > 0)) return whole * share;
    const double u = share / kBent;
    return (whole * (u * u) + start * (whole.length() * u * (1 - u))) * kBent;
  }

  Vec3d place_of(std::uint32_t v) const { return source_[v] + way(v); }

  void look(const Indices& moved) {
    faults_.look(moved, [&](std::uint32_t v) { return place_of(v); });
  }

  Indices with_rings(const Indices& vertices, int rings) {
    for (const auto v : vertices) gathered_.add(v);
    for (std::size_t i = 0; rings > 0; --rings)
      for (const std::size_t inner = gathered_.so_far().size(); i < inner; ++i)
        for (const auto t : surface_.triangles_around(gathered_.so_far()[i]))
          for (const auto v : surface_.triangles[t]) gathered_.add(v);
    return gathered_.take();
  }

  /// What is wrong in a patch, the worse first.
  struct Wrong {
    std::size_t misplaced = 0, corners = 0, collided = 0;
    bool any_fault() const { return misplaced + corners > 0; }
    bool any() const { return any_fault() || collided > 0; }
    bool is_less_than(const Wrong& other) const {
      return std::tie(misplaced, corners, collided) < std::tie(other.misplaced, other.corners, other.collided);
    }
  };
  std::vector<Wrong> wrong_by_patch() const {
    std::vector<Wrong> wrong(patches_.count());
    faults_.for_each_wrong_corner([&](std::uint32_t v) {
      if (patches_.of(v) != kNone) ++wrong[patches_.of(v)].corners;
    });
    for (const auto v : faults_.misplaced())
      if (patches_.of(v) != kNone) ++wrong[patches_.of(v)].misplaced;
    for (std::size_t i = 0; i < wrong.size(); ++i) wrong[i].collided = count_collided(patches_[i]);
    return wrong;
  }

  /// What has collided may slide to where there is room; what stays put or is bound to its path may not.
  bool may_slide(std::uint32_t v) const {
    const bool there =
        paths_.state[v] == VertexState::Reached || (paths_.state[v] == VertexState::Collision && has_sides(v));
    return there && distances_[v] != 0 && constrained_.on_front(v) && !constrained_.is_bound(v);
  }

  /// Lines have none, nor do the vertices that only they hold.
  bool has_sides(std::uint32_t v) const {
    const auto around = surface_.triangles_around(v);
    return std::any_of(around.begin(), around.end(),
                       [&](std::uint32_t t) { return surface_.triangle_normals[t].lengthSqr() > 0; });
  }

  /// The vertices that may slide, so many rings around what is wrong and has not been given up.
  Indices patch_vertices(int rings) {
    // Corners are wrong many times over where fronts have run through each other.
    faults_.for_each_wrong_corner([&](std::uint32_t v) { gathered_.add(v); },
                                  [&](std::uint32_t t) { return is_given_up(t); });
    Indices chosen = with_rings(gathered_.take(), rings);
    std::erase_if(chosen, [&](std::uint32_t v) { return !may_slide(v); });
    return chosen;
  }

  /// Drops the patches that are not worth while.
  void leave_out(const Growth& growth, double least_contrast) {
    const std::size_t most = followed_ ? std::min(growth.most_vertices, kFollowedVertices)
                                       : growth.most_vertices * (1 + source_.size() / kManyVertices);
    const std::vector<Wrong> wrong = wrong_by_patch();
    const bool is_first = statistics_.untanglings == 0 && !followed_;
    patches_.drop_if([&](const Indices& patch, std::uint32_t number) {
      const std::size_t n = patch.size();
      const Wrong& is = wrong[number];
      return n > most || is.collided > growth.most_collided ||
             (!is_first && n > kHopelessVertices && is.corners > kHopelessCorners * n) ||
             (least_contrast > 0 && contrast(patch) < least_contrast);
    });
  }

  /// How many times as much area is around one vertex of a patch as around another.
  double contrast(const Indices& patch) const {
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (const auto v : patch) {
      const double area = stakes_.area(v);
      least = std::min(least, area);
      most = std::max(most, area);
    }
    return most / least;
  }

  std::size_t count_collided(const Indices& patch) const {
    return static_cast<std::size_t>(
        std::count_if(patch.begin(), patch.end(), [&](std::uint32_t v) { return is_short(v); }));
  }

  /// Untangles patches of vertices, all at their distance, and keeps those where that makes nothing worse.
  void untangle(const Indices& chosen, const Untangler::Options& options, const Growth& growth,
                double least_contrast = 0) {
    patches_.split(chosen);
    leave_out(growth, least_contrast);
    const Untangler untangler(constrained_, distances_, options);
    try_out([&](const Indices& patch) { untangler(patch, whole_way_); }, least_contrast > 0);
  }

  /// Lets move(patch) change the ways and shares of the vertices of the patches, in parallel; then puts back the
  /// patches where that has made something worse, or nothing better where there was nothing wrong; or, if they have to
  /// be freed, where anything is wrong still. Returns how many vertices are not put back.
  template <class Move>
  std::size_t try_out(Move&& move, bool to_be_freed = false) {
    const Indices& chosen = patches_.vertices();
    const std::vector<Wrong> before = wrong_by_patch();
    std::vector<std::pair<Vec3d, double>> old;
    old.reserve(chosen.size());
    for (const auto v : chosen) old.emplace_back(whole_way_[v], share_[v]);
    tbb::parallel_for(std::size_t{0}, patches_.count(), [&](std::size_t i) { move(patches_[i]); });
    faults_.try_out(chosen, [&](std::uint32_t v) { return place_of(v); });
    const std::vector<Wrong> after = wrong_by_patch();
    Indices undone;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const std::uint32_t v = chosen[i];
      const Wrong &was = before[patches_.of(v)], &is = after[patches_.of(v)];
      const bool freed = !to_be_freed || !is.any_fault();
      if (freed && (was.any_fault() ? !was.is_less_than(is) : is.is_less_than(was))) continue;
      std::tie(whole_way_[v], share_[v]) = old[i];
      undone.push_back(v);
    }
    const std::size_t kept = chosen.size() - undone.size();
    patches_.clear();
    if (!undone.empty()) faults_.take_back(undone);
    return kept;
  }

  /// Whether a vertex has any of its way left to go back.
  bool may_go_back(std::uint32_t v) const {
    return v != pinned_ && share_[v] != 0 && constrained_.on_front(v) && whole_way_[v] != Vec3d(0.0);
  }

  /// Of each fault's corners those that are to go back: with which little is lost, and which have gone far back
  /// already. Of what a rim meets, and of what is in the wrong place, all.
  Indices vertices_to_pull() {
    faults_.for_each_wrong_corner([&](std::uint32_t v) { gathered_.add(v); });
    stakes_.measure(gathered_.take());
    faults_.for_each_fault([&](std::uint32_t s, std::uint32_t t) {
      double least = std::numeric_limits<double>::infinity();
      const auto for_each_corner = [&](auto&& visit) {
        for (const auto triangle : {s, t})
          for (const auto v : surface_.triangles[triangle])
            if (may_go_back(v)) visit(v);
      };
      for_each_corner([&](std::uint32_t v) {
        if (share_[v] > kSpent) least = std::min(least, stakes_[v]);
      });
      for_each_corner([&](std::uint32_t v) {
        if (share_[v] <= kSpent || stakes_[v] <= kAlikeStakes * least) gathered_.add(v);
      });
    });
    for (const auto v : faults_.misplaced()) gathered_.add(v);
    faults_.for_each_wrong_corner([&](std::uint32_t v) { gathered_.add(v); }, [](std::uint32_t) { return true; });
    for (const auto v : faults_.caught()) gathered_.add(v);
    Indices pulled = gathered_.take();
    std::erase_if(pulled, [&](std::uint32_t v) { return !may_go_back(v); });
    return pulled;
  }

  /// Takes vertices of what is wrong a step back. False if there are none that have any way left.
  bool pull_back() {
    const Indices wrong = vertices_to_pull();
    if (wrong.empty()) return false;
    const Indices held = faults_.caught();
    for (const auto v : wrong) {
      share_[v] *= kKept;
      if (share_[v] < kLastShare) share_[v] = 0;
      pulled_.push_back(v);
    }
    // Those around a vertex that cannot leave the source at all need not follow it back there.
    for (const auto v : held) share_[v] = 0;
    sort_unique(pulled_);
    look(wrong);
    ++statistics_.rounds;
    return true;
  }

  /// Vertices and the shares that they had, sorted by vertex.
  using OldShares = std::vector<std::pair<std::uint32_t, double>>;
  static OldShares::const_iterator find(const OldShares& shares, std::uint32_t v) {
    const auto at = std::lower_bound(shares.begin(), shares.end(), std::pair(v, 0.0));
    return at != shares.end() && at->first == v ? at : shares.end();
  }

  /// Lets a few of the pulled vertices at a time out the whole way, then ever less of what is left of it. Of a wrong
  /// face's corners often one alone is in the wrong place; the others can go once they do not go along with it.
  void leap(Progress& progress) {
    if (pulled_.empty()) return;
    refusals_.emplace(surface_);
    for (const auto& [part, rounds] : kLeaps)
      for (int i = 0; i < rounds; ++i) {
        let_out(part);
        progress.advance(1);
      }
  }

  /// Of the share of its way that a vertex may go, from one beside it.
  double steepest_change(std::uint32_t v, std::uint32_t beside) const {
    return kSteepest * (source_[v] - source_[beside]).length() / std::abs(distances_[v]);
  }

  /// Lets one of so many of the pulled vertices, others in each turn, out by a part of what is left of its way; not
  /// those that would meet what they have met before.
  void let_out(double part) {
    ++turn_;
    OldShares before;
    for (const auto v : pulled_) {
      if (share_[v] == 1 || mix(turn_ << 32 | v) % kLeapers != 0) continue;
      const double share = share_[v] + (1 - share_[v]) * part;
      if (!(share > share_[v]) || refusals_->expects(v, share)) continue;
      before.emplace_back(v, share_[v]);
      share_[v] = share;
    }
    keep_valid(before);
  }

  /// What may be put somewhere else than its way leads; not what an obstacle may have stopped.
  bool may_leave_its_way(std::uint32_t v) const {
    if (constrained_.obstacles && paths_.state[v] == VertexState::Collision) return false;
    return distances_[v] != 0 && constrained_.on_front(v) && !constrained_.is_bound(v);
  }
  bool may_settle(std::uint32_t v) const { return may_leave_its_way(v) && is_short(v); }

  std::uint32_t vertex_of_front(std::uint32_t v) const {
    return constrained_.front_vertex.empty() ? v : constrained_.front_vertex[v];
  }
  /// Whether a vertex, which is on the front, has to stay in planes.
  bool is_held(std::uint32_t v) const { return constrained_.front.surface().is_held(vertex_of_front(v)); }

  /// The short vertices with which most is lost, first those with the most.
  std::vector<std::uint32_t> vertices_to_settle() {
    const double least = kLeastSettled * stakes_.whole_area();
    std::vector<std::pair<double, std::uint32_t>> order;
    for (std::uint32_t v = 0; v < share_.size(); ++v)
      if (may_settle(v))
        if (const double area = stakes_.area(v); area > least) order.emplace_back(-area, v);
    std::sort(order.begin(), order.end());
    order.resize(std::min(order.size(), kMostSettled));
    Indices largest;
    for (const auto& [area, v] : order) largest.push_back(v);
    stakes_.measure(largest);
    std::erase_if(largest, [&](std::uint32_t v) { return !(stakes_[v] > least); });
    std::stable_sort(largest.begin(), largest.end(),
                     [&](std::uint32_t v, std::uint32_t w) { return stakes_[v] > stakes_[w]; });
    return largest;
  }

  /// Puts short vertices, one by one, where live points around them go; there is room for these, and what is in the way
  /// of their faces goes back or aside, if less is lost with that. False if none has found a place.
  bool settle(LiveArea::Lines lines) {
    if (faults_.any()) return false;
    std::size_t trials = 0;
    bool any = false;
    for (const auto v : vertices_to_settle()) {
      if (trials >= kMostTrials) break;
      if (!is_short(v)) continue;
      if (lines == LiveArea::Lines::All && is_held(v)) continue;
      any |= settle(v, lines, trials);
    }
    return any;
  }

  struct Move {
    std::uint32_t vertex;
    Vec3d place;
  };

  /// In the first of its places that it can be put in; else, in the first, with its neighbours, with the small feature
  /// that it is part of, or while what is in the way slides.
  bool settle(std::uint32_t v, LiveArea::Lines lines, std::size_t& trials) {
    const auto try_at = [&](const std::vector<Move>& moves, const Aside* aside) {
      ++trials;
      return settle_at(moves, aside);
    };
    const std::vector<Vec3d> places = stakes_.places(v, lines);
    if (places.empty()) return false;
    for (const Vec3d& place : places)
      if (try_at({{v, place}}, nullptr)) return true;
    const Move move{v, places.front()};
    const std::vector<Move> together = with_short_neighbours(move, lines);
    if (together.size() > 1 && try_at(together, nullptr)) return true;
    std::size_t fewer = 1;
    for (const double reach : kReaches) {
      const std::vector<Move> feature = with_near_vertices(move, reach);
      if (feature.size() > std::exchange(fewer, feature.size()) && try_at(feature, nullptr)) return true;
    }
    return std::any_of(std::begin(kAsides), std::end(kAsides),
                       [&](const Aside& aside) { return try_at({move}, &aside); });
  }

  /// And where the short vertices next to it have their distances; not where there are many.
  std::vector<Move> with_short_neighbours(const Move& move, LiveArea::Lines lines) {
    std::vector<Move> moves{move};
    gathered_.add(move.vertex);
    const Indices around = with_rings(gathered_.take(), 1);
    if (around.size() > kMostAside) return moves;
    for (const auto w : around) {
      if (w == move.vertex || !may_settle(w) || (lines == LiveArea::Lines::All && is_held(w))) continue;
      if (const std::vector<Vec3d> places = stakes_.places(w, lines); !places.empty())
        moves.push_back({w, places.front()});
    }
    return moves;
  }

  /// And what edges join to it of which none is longer than a share of the distance, by the same way: a feature that
  /// small goes along as it is.
  std::vector<Move> with_near_vertices(const Move& move, double reach) {
    std::vector<Move> moves{move};
    const Vec3d way = move.place - surface_.vertices[move.vertex];
    const double longest = reach * std::abs(distances_[move.vertex]);
    for (std::size_t i = 0; i < moves.size() && moves.size() <= kMostAside; ++i) {
      const Vec3d& from = surface_.vertices[moves[i].vertex];
      for (const auto t : surface_.triangles_around(moves[i].vertex))
        for (const auto w : surface_.triangles[t]) {
          const bool is_near = (surface_.vertices[w] - from).length() <= longest &&
                               (surface_.vertices[w] - surface_.vertices[move.vertex]).length() <= 2 * longest;
          if (!is_near || !may_go_along(w) || holds(moves, w)) continue;
          moves.push_back({w, surface_.vertices[w] + way});
        }
    }
    return moves;
  }
  bool may_go_along(std::uint32_t v) const { return may_leave_its_way(v) && !is_held(v); }

  struct Old {
    std::uint32_t vertex;
    Vec3d whole_way;
    double share;
    bool was_short;
  };
  Old old_of(std::uint32_t v) const { return {v, whole_way_[v], share_[v], is_short(v)}; }
  static bool holds(const std::vector<Move>& moves, std::uint32_t v) {
    return std::any_of(moves.begin(), moves.end(), [&](const Move& move) { return move.vertex == v; });
  }
  static bool holds(const std::vector<Old>& old, std::uint32_t v) {
    return std::any_of(old.begin(), old.end(), [&](const Old& o) { return o.vertex == v; });
  }
  /// What is at stake with those that were at their distance and are not now.
  double lost_since(const std::vector<Old>& old) const {
    double lost = 0;
    for (const Old& o : old)
      if (!o.was_short && is_short(o.vertex)) lost += stakes_[o.vertex];
    return lost;
  }

  /// False, and nothing has changed, if more is lost than won, or the first one does not get where it is put.
  bool settle_at(const std::vector<Move>& moves, const Aside* aside) {
    std::vector<Old> old;
    Indices moved;
    for (const auto& [v, place] : moves) {
      old.push_back(old_of(v));
      moved.push_back(v);
      Vec3d whole_way = place - surface_.vertices[v];
      if (is_held(v)) whole_way = constrained_.front.surface().along_border(vertex_of_front(v), whole_way);
      whole_way_[v] = round_way(whole_way, std::abs(distances_[v]));
      share_[v] = 1;
    }
    const std::uint32_t vertex = moves.front().vertex;
    sort_unique(moved);
    stakes_.measure(moved);
    look(moved);
    if (is_short(vertex) || (aside && !slide_aside(vertex, *aside, old))) {
      put_back(old);
      return false;
    }
    while (faults_.any() || !faults_.misplaced().empty()) {
      pinned_ = vertex;
      const Indices in_the_way = vertices_to_pull();
      pinned_ = kNone;
      const bool in_vain = in_the_way.empty() || fault_count() > kMostFaults;
      if (!in_vain) pull_in_trial(in_the_way, old);
      if (in_vain || lost_since(old) > kWorthLosing * stakes_[vertex]) {
        put_back(old);
        return false;
      }
      ++statistics_.rounds;
    }
    for (const Old& o : old) pulled_.push_back(o.vertex);
    sort_unique(pulled_);
    return true;
  }

  void pull_in_trial(const Indices& vertices, std::vector<Old>& old) {
    for (const auto v : vertices) {
      if (!holds(old, v)) old.push_back(old_of(v));
      share_[v] = share_[v] < kLastShareInTrial ? 0 : share_[v] * kKeptInTrial;
    }
    look(vertices);
  }

  /// Lets what is in the way of a vertex, and what is around that, slide at its distance to where it is not. False if
  /// nothing may, or too much would have to.
  bool slide_aside(std::uint32_t vertex, const Aside& aside, std::vector<Old>& old) {
    faults_.for_each_wrong_corner([&](std::uint32_t v) { gathered_.add(v); });
    Indices sliding = with_rings(gathered_.take(), aside.rings);
    std::erase_if(sliding, [&](std::uint32_t v) { return v == vertex || !may_slide(v); });
    if (sliding.empty() || sliding.size() > kMostAside) return false;
    stakes_.measure(sliding);
    for (const auto v : sliding) {
      if (!holds(old, v)) old.push_back(old_of(v));
      share_[v] = 1;
    }
    Untangler(constrained_, distances_, aside.options)(sliding, whole_way_);
    look(sliding);
    return true;
  }

  void put_back(const std::vector<Old>& old) {
    Indices vertices;
    for (const Old& o : old) {
      whole_way_[o.vertex] = o.whole_way;
      share_[o.vertex] = o.share;
      vertices.push_back(o.vertex);
    }
    sort_unique(vertices);
    look(vertices);
  }

  /// Takes those around a pulled vertex back as well, as far as its dip is too steep. A vertex at its distance stays
  /// there, and one that is pulled back altogether need not be followed.
  void ease() {
    Indices eased, open = pulled_;
    const std::vector<double> before = share_;
    // First in, first out: the last in would go round by long ways, over and over.
    for (std::size_t i = 0; i < open.size(); ++i) {
      const std::uint32_t v = open[i];
      if (share_[v] == 0) continue;
      for (const auto t : surface_.triangles_around(v))
        for (const auto w : surface_.triangles[t]) {
          if (distances_[w] == 0 || !constrained_.on_front(w)) continue;
          const double most = share_[v] + steepest_change(w, v);
          if (!(share_[w] > most) || !is_short(w) || stakes_.area(w) > kMuchMoreArea * stakes_.area(v)) continue;
          share_[w] = most;
          eased.push_back(w);
          open.push_back(w);
        }
    }
    sort_unique(eased);
    OldShares old;
    for (const auto v : eased) old.emplace_back(v, before[v]);
    keep_valid(old);
  }

  /// Gives what is wrong, now that these vertices have moved, its old share again, for as long as anything is. Who has
  /// none at first is stopped by others that have moved, and go back as well, or by what has not.
  void keep_valid(const OldShares& before) {
    if (before.empty()) return;
    Indices moved;
    for (const auto& [v, share] : before) moved.push_back(v);
    faults_.glance(moved, [&](std::uint32_t v) { return place_of(v); });
    refusals_->note(
        faults_, [&](std::uint32_t v) { return find(before, v) != before.end(); },
        [&](std::uint32_t v) { return share_[v]; });
    do {
      moved = take_back_wrong(before);
      faults_.take_back(moved);
      ++statistics_.rounds;
    } while (!moved.empty());
    for (const auto& [v, share] : before)
      if (share_[v] != share) refusals_->note_change(v);
  }

  /// Gives those that something is wrong with their old share, if they have another. Returns them.
  Indices take_back_wrong(const OldShares& before) {
    Indices wrong = faults_.wrong_vertices();
    std::erase_if(wrong, [&](std::uint32_t v) {
      const auto at = find(before, v);
      if (at == before.end() || at->second == share_[v]) return true;
      share_[v] = at->second;
      return false;
    });
    return wrong;
  }

  ConstrainedSurface constrained_;
  const Surface& surface_;
  std::span<const Vec3d> source_;
  const Distances& distances_;
  Paths& paths_;
  std::vector<Vec3d> whole_way_;
  std::vector<double> share_;             // of the way that a vertex goes
  std::optional<BlockedMoves> refusals_;  // if any was pulled back
  std::uint64_t turn_ = 0;                // of letting out
  std::uint32_t pinned_ = kNone;          // does not go back
  Indices pulled_;                        // vertices that have been pulled back at some time
  Patches patches_;                       // that are being untangled
  IndexGatherer gathered_;                // vertices
  LiveArea stakes_;
  FaultFinder& faults_;  // as things stand
  const WarmStart* followed_;
  LimitStatistics statistics_;
};

}  // namespace

LimitStatistics untangle(FaultFinder& faults, const ConstrainedSurface& constrained, std::span<const Vec3d> source,
                         const Distances& distances, Paths& paths, const ProgressCallback& callback) {
  Progress progress(callback, Stage::Limit, kExpectedRounds);
  Limiter limiter(constrained, source, distances, paths, faults);
  limiter.untangle(progress);
  return limiter.finish();
}

LimitStatistics limit(FaultFinder& faults, const ConstrainedSurface& constrained, std::span<const Vec3d> source,
                      const Distances& distances, Paths& paths, const ProgressCallback& callback,
                      const WarmStart* followed, WarmStart* set) {
  Progress progress(callback, Stage::Limit, kExpectedRounds);
  Limiter limiter(constrained, source, distances, paths, faults, followed);
  limiter.untangle(progress);
  limiter.pull_back_and_let_out(progress);
  return limiter.finish(set);
}

}  // namespace vdb_offset
