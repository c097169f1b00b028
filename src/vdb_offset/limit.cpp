#include "vdb_offset/limit.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include <tbb/parallel_for.h>

#include "vdb_offset/faults.h"
#include "vdb_offset/mix.h"
#include "vdb_offset/parallel.h"
#include "vdb_offset/patches.h"
#include "vdb_offset/refusals.h"
#include "vdb_offset/untangle.h"

namespace vdb_offset {
namespace {

// How much of its way a vertex of a wrong face keeps in a round; below the last share it keeps none. That share is
// small, as the skins of a shell touch where a vertex has not moved at all.
constexpr double kKept = 0.8, kLastShare = 1e-4, kBent = 0.1;

// Patches are tried in these ways, the first to its end, with ever more rings around what is wrong. What frees one
// patch fails in the next; borders leave their planes only for what else does not free. The last ways are for small
// patches in which little has collided: these cost next to nothing, and one of several ways frees many of them. Patches
// of more vertices than so many, or in which more have collided, are left out: of 23,000 patches of fifteen models
// these took more than half of the time, and hardly any of them was freed. Larger meshes than all of those may have
// patches as many times larger as they have kManyVertices, rounded up.
// Where faces stay wrong so many times over in the first way, fronts have run through each other, and there is no way
// out: of 380 such patches, which took almost half of the time on thirteen models, two were freed.
constexpr std::size_t kAnyNumber = kNone, kManyVertices = 200000;
constexpr std::size_t kHopelessVertices = 100, kHopelessCorners = 8;  // more of the latter for each of the former
struct Growth {
  int rings;
  std::size_t most_vertices, most_collided = kAnyNumber;
};
struct Attempt {
  Untangler::Options options;
  std::span<const Growth> growths;
};
constexpr Growth kFarGrowths[] = {{1, kAnyNumber}, {2, 5000},     {3, 5000},      {4, 3000, 40},
                                  {6, 3000, 40},   {8, 3000, 40}, {12, 3000, 40}, {16, 3000, 40}};
constexpr Growth kLessGrowths[] = {{1, 1000}, {2, 1000}, {3, 1000}, {4, 1000, 40}, {6, 1000, 40}, {8, 1000, 40}};
constexpr Growth kNearGrowths[] = {{1, 1000}, {2, 1000}, {3, 1000}};
constexpr Growth kNearestGrowths[] = {{1, 300}, {2, 300}, {3, 300}};
constexpr Growth kHopefulGrowths[] = {{1, 1000, 20}, {2, 1000, 20}};
constexpr Growth kSmoothGrowths[] = {{1, 1000, 20}, {2, 1000, 20}, {4, 1000, 3}, {6, 1000, 3}};
constexpr Attempt kAttempts[] = {
    {{1, 4, true, true}, kFarGrowths},    {{0.1, 10, true}, kNearGrowths},   {{1, 30, false}, kLessGrowths},
    {{0.01, 10, false}, kNearestGrowths}, {{1, 60, false}, kSmoothGrowths},  {{1, 10, true}, kHopefulGrowths},
    {{0.3, 2, true}, kHopefulGrowths},    {{3, 4, true}, kHopefulGrowths},   {{0.03, 30, true}, kHopefulGrowths},
    {{1, 2, true}, kHopefulGrowths},      {{0.1, 4, false}, kHopefulGrowths}};

// Where a precedent is followed, hardly any patch of more vertices than so many is freed that has not been already.
constexpr std::size_t kFollowedVertices = 60;

// Then what has collided is tried in these, with so many rings around. If it is much, and one of them leaves more than
// this share of it where it is, fronts have met, and there is no way out.
struct Freeing {
  Untangler::Options options;
  Growth growth;
};
constexpr Freeing kFreeings[] = {{{1, 30, true}, {1, kAnyNumber}},
                                 {{1, 4, true, true}, {0, kAnyNumber}},
                                 {{1, 30, true}, {0, kAnyNumber}},
                                 {{1, 30, false}, {0, 300}},
                                 {{0.01, 10, false}, {0, 300}}};
constexpr double kHopeless = 0.99;

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

constexpr std::size_t kExpectedRounds = 32;

class Limiter {
 public:
  Limiter(const Body& body, std::span<const Vec3d> source, const Distances& distances, Paths& paths,
          FaultFinder& faults, const Precedent* followed = nullptr)
      : body_(body),
        surface_(body.surface),
        source_(source),
        distances_(distances),
        paths_(paths),
        whole_way_(paths.displacement),
        share_(source.size(), 1.0),
        patches_(body.surface),
        gathered_(source.size()),
        faults_(faults),
        followed_(followed) {
    statistics_.source_crossings = faults_.source_crossings().size();
    statistics_.crossings_near_source = faults_.crossings_near_source();
    statistics_.before = faults_.count();
  }

  void untangle(Progress& progress) {
    if (followed_) follow();
    // What a precedent and the first way leave, the others hardly free.
    for (const Attempt& attempt : kAttempts)
      if (!untangle_with(attempt, progress) || followed_) break;
    free_collided(progress);
  }

  void pull_back_and_let_out(Progress& progress) {
    while (pull_back()) progress.advance(1);
    statistics_.left = faults_.count();
    leap(progress);
    for (int i = 0; i < kEasings; ++i) ease();
  }

  /// Tells the paths what has become of them, and who may follow.
  LimitStatistics finish(Precedent* set = nullptr) {
    std::vector<std::uint8_t> mended(set ? source_.size() : 0, 0);
    double lost = 0;
    std::size_t moving = 0;
    for (std::uint32_t v = 0; v < share_.size(); ++v) {
      const double target = std::abs(distances_[v]);
      if (target == 0 || !body_.on_front(v)) continue;
      ++moving;
      const bool stayed = paths_.displacement[v] == way(v);
      paths_.displacement[v] = way(v);
      if (stayed) continue;
      if (set) mended[v] = 1;
      const double distance = faults_.distance_of(v);
      lost += std::max(0.0, paths_.achieved[v] - distance) / target;
      paths_.achieved[v] = distance;
      paths_.closest[v] = faults_.closest_to(v);
      if (std::abs(distance - target) <= kReachedTolerance * target + faults_.rounding(v)) {
        paths_.state[v] = VertexState::Reached;  // one that had collided may have slid to where there is room
      } else if (share_[v] != 1 || paths_.state[v] == VertexState::Reached) {
        paths_.state[v] = VertexState::Limited;
        ++statistics_.limited_vertices;
      }
    }
    statistics_.thickness_lost = lost / static_cast<double>(std::max<std::size_t>(1, moving));
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
      whole = way_to_distance(body_, v, way, distance);
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
  bool untangle_with(const Attempt& attempt, Progress& progress) {
    const std::size_t before = fault_count();
    Indices last;
    for (const Growth& growth : attempt.growths) {
      if (!faults_.any()) return false;
      if (growth.rings > kFewRings && has_many_faults()) break;
      Indices chosen = patch_vertices(growth.rings);
      if (chosen == last) break;
      untangle(chosen, attempt.options, growth);
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
    if (share >= kBent || share == 0 || body_.is_bound(vertex)) return whole * share;
    const std::uint32_t on_front = body_.front_vertex.empty() ? vertex : body_.front_vertex[vertex];
    const Vec3d start = start_direction(body_.front.surface(), on_front) * (distances_[v] < 0 ? -1.0 : 1.0);
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
    return there && distances_[v] != 0 && body_.on_front(v) && !body_.is_bound(v);
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
  void leave_out(const Growth& growth) {
    const std::size_t most = followed_ ? std::min(growth.most_vertices, kFollowedVertices)
                                       : growth.most_vertices * (1 + source_.size() / kManyVertices);
    const std::vector<Wrong> wrong = wrong_by_patch();
    const bool is_first = statistics_.untanglings == 0 && !followed_;
    patches_.drop_if([&](const Indices& patch, std::uint32_t number) {
      const std::size_t n = patch.size();
      const Wrong& is = wrong[number];
      return n > most || is.collided > growth.most_collided ||
             (!is_first && n > kHopelessVertices && is.corners > kHopelessCorners * n);
    });
  }

  std::size_t count_collided(const Indices& patch) const {
    return static_cast<std::size_t>(
        std::count_if(patch.begin(), patch.end(), [&](std::uint32_t v) { return is_short(v); }));
  }

  /// Untangles patches of vertices, all at their distance, and keeps those where that makes nothing worse.
  void untangle(const Indices& chosen, const Untangler::Options& options, const Growth& growth) {
    patches_.split(chosen);
    leave_out(growth);
    const Untangler untangler(body_, distances_, options);
    try_out([&](const Indices& patch) { untangler(patch, whole_way_); });
  }

  /// Lets move(patch) change the ways and shares of the vertices of the patches, in parallel; then puts back the
  /// patches where that has made something worse, or nothing better where there was nothing wrong. Returns how many
  /// vertices are not put back.
  template <class Move>
  std::size_t try_out(Move&& move) {
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
      if (was.any_fault() ? !was.is_less_than(is) : is.is_less_than(was)) continue;
      std::tie(whole_way_[v], share_[v]) = old[i];
      undone.push_back(v);
    }
    const std::size_t kept = chosen.size() - undone.size();
    patches_.clear();
    if (!undone.empty()) faults_.take_back(undone);
    return kept;
  }

  /// Takes the vertices that something is wrong with a step back. False if there are none that have any way left.
  bool pull_back() {
    Indices wrong = faults_.wrong_vertices();
    std::erase_if(wrong, [&](std::uint32_t v) { return share_[v] == 0 || !body_.on_front(v); });
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
      if (share_[v] == 0 || share_[v] == 1 || mix(turn_ << 32 | v) % kLeapers != 0) continue;
      const double share = share_[v] + (1 - share_[v]) * part;
      if (!(share > share_[v]) || refusals_->expects(v, share)) continue;
      before.emplace_back(v, share_[v]);
      share_[v] = share;
    }
    keep_valid(before);
  }

  /// Takes those around a pulled vertex back as well, as far as its dip is too steep; who stays pulled altogether need
  /// not be followed.
  void ease() {
    Indices eased, open = pulled_;
    const std::vector<double> before = share_;
    // First in, first out: the last in would go round by long ways, over and over.
    for (std::size_t i = 0; i < open.size(); ++i) {
      const std::uint32_t v = open[i];
      if (share_[v] == 0) continue;
      for (const auto t : surface_.triangles_around(v))
        for (const auto w : surface_.triangles[t]) {
          if (distances_[w] == 0 || !body_.on_front(w)) continue;
          const double most = share_[v] + steepest_change(w, v);
          if (!(share_[w] > most)) continue;
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

  Body body_;
  const Surface& surface_;
  std::span<const Vec3d> source_;
  const Distances& distances_;
  Paths& paths_;
  std::vector<Vec3d> whole_way_;
  std::vector<double> share_;         // of the way that a vertex goes
  std::optional<Refusals> refusals_;  // if any was pulled back
  std::uint64_t turn_ = 0;            // of letting out
  Indices pulled_;                    // vertices that have been pulled back at some time
  Patches patches_;                   // that are being untangled
  IndexGatherer gathered_;            // vertices
  FaultFinder& faults_;               // as things stand
  const Precedent* followed_;
  LimitStatistics statistics_;
};

}  // namespace

LimitStatistics untangle(FaultFinder& faults, const Body& body, std::span<const Vec3d> source,
                         const Distances& distances, Paths& paths, const ProgressCallback& callback) {
  Progress progress(callback, Stage::Limit, kExpectedRounds);
  Limiter limiter(body, source, distances, paths, faults);
  limiter.untangle(progress);
  return limiter.finish();
}

LimitStatistics limit(FaultFinder& faults, const Body& body, std::span<const Vec3d> source, const Distances& distances,
                      Paths& paths, const ProgressCallback& callback, const Precedent* followed, Precedent* set) {
  Progress progress(callback, Stage::Limit, kExpectedRounds);
  Limiter limiter(body, source, distances, paths, faults, followed);
  limiter.untangle(progress);
  limiter.pull_back_and_let_out(progress);
  return limiter.finish(set);
}

}  // namespace vdb_offset
