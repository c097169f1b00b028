// SPDX-License-Identifier: Apache-2.0
// Chooses which edges of a mesh are split until its offset is proven to be within a tolerance. In a round, each new
// triangle is proven, found to be off, found to have a vertex that does not get there, or given up. The middles of its
// edges become candidates, each with the place where it would go and how far the edge bulges from there. Of a triangle
// that is off, edges that bulge by most of the tolerance are split, or else its longest one if that may gain anything.
// Of one with a short vertex, an edge is split if its middle gets there, down to a least length. Beyond the limit of
// faces the edges that bulge least stay. A round can be undone, and done again with faulty triangles whole. Candidates
// are sorted by edge and judged each by itself, so that no choice depends on threads. Offsets are not made valid here.
#include "products/tolerance/refiner.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "ground/system/assert.h"
#include "ground/system/parallel.h"

namespace vdb_offset {
namespace {

// Bulge between the ends of an edge, in tolerances, from which it is split. Reasoned: where all edges of a triangle of
// a sphere bulge by three quarters, its middle bulges by one.
constexpr double kMostBulge = 0.75;
// Lengths in units of that of an edge on a circle of radius d that bulges by the tolerance: of an edge with one end
// that does not get there, at which it is no longer split; and up to which an edge is short.
constexpr double kLeastMixed = 0.5, kShort = 0.5;
// The length, in those units, of the shortest edge that is split: where one of the source would have to be so short,
// what is next to each other in it is not in the offset.
constexpr double kShortestSplit = 1e-3;
// The height, in those units of the tolerance that is asked for, below which a piece of a wider face is narrow, and
// asks for no splits: halves of its long edges are as narrow, and so on. Without, such pieces took a third of the time
// on soups with sharp creases. 0.05 leaves a millionth of a bumpy sphere open at 0.1 %.
constexpr double kNarrow = 0.02;
// Share of an edge's bulge from which its halves count as bulging as much, and how often that may be in a row where
// edges are short. Not measured: a quarter on a smooth surface, a half across a valley.
constexpr double kMostKept = 0.6;
constexpr int kMostTimesKept = 3;
// The bulge from which an edge is split if none bulges by kMostBulge, and the length from which one is, in those units,
// if none bulges. Not measured.
constexpr double kLeastBulge = 0.1, kLongFlat = 1;
// The tolerance of the first stage, as a share of the distance. Not measured.
constexpr double kFirstTolerance = 0.1;
// Rounds of a stage. Reasoned: an edge that is a million times as long as it may be is halved twenty times.
constexpr int kMostSplitRounds = 20;

/// The length of a chord of a circle that bulges by the tolerance.
double chord(double asked, double tolerance) { return std::sqrt(8 * std::abs(asked) * tolerance); }

/// The least height of a triangle; 0 if it is a point.
double least_height(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double longest = std::max({(b - a).length(), (c - b).length(), (a - c).length()});
  return longest > 0 ? (b - a).cross(c - a).length() / longest : 0;
}

}  // namespace

Refiner::Refiner(const MeshParts& parts, const ClosestQuery& query, const InterpolatedTargets& targets,
                 RefinedTriangles& triangles, std::vector<RefinedVertex> vertices, const RefinerOptions& options)
    : parts_(parts),
      prover_(query),
      targets_(targets),
      triangles_(triangles),
      vertices_(std::move(vertices)),
      options_(options),
      state_(triangles.triangles().size(), State::New) {
  for (const std::uint32_t t : options_.whole_triangles) state_[t] = State::Whole;
}

double Refiner::loosest() const {
  double loosest = 1;
  for (const RefinedVertex& vertex : vertices_)
    if (vertex.asked != 0) loosest = std::max(loosest, kFirstTolerance * std::abs(vertex.asked) / vertex.tolerance);
  return loosest;
}

void Refiner::begin_stage(double loosened) {
  loosened_ = loosened;
  round_ = 0;
  fresh_.clear();
  for (std::uint32_t t = 0; t < state_.size(); ++t) {
    if (state_[t] == State::Off) state_[t] = State::GivenUp;
    if (state_[t] != State::Settled && state_[t] != State::Mixed && state_[t] != State::New) continue;
    state_[t] = State::New;
    fresh_.push_back(t);
  }
}

bool Refiner::begin_round(const std::function<void(double)>& tell) {
  if (is_cut_short_ || round_++ == kMostSplitRounds) return false;
  tell(1 - static_cast<double>(fresh_.size()) / static_cast<double>(state_.size()));
  look_at_fresh();
  answered_.clear();
  then_ = {vertices_.size(), state_, triangles_, fresh_};
  piece_of_.resize(state_.size());
  std::iota(piece_of_.begin(), piece_of_.end(), 0U);
  halved_once_.assign(state_.size(), 0);
  is_undone_ = false;
  return !fresh_.empty();
}

/// Judges the triangles that are to be looked at, and makes candidates of the edges of those that are not settled.
void Refiner::look_at_fresh() {
  for_each_index(
      fresh_.size(), [&](std::size_t i) { state_[fresh_[i]] = judge(triangles_.triangles()[fresh_[i]]); }, 16);
  std::erase_if(fresh_, [&](std::uint32_t t) { return state_[t] != State::Off && state_[t] != State::Mixed; });
  std::size_t i = 0;
  take_out([&](const Candidate&) { return i < marked_.size() && marked_[i++] != 0; });
  marked_.clear();  // edges that have been split are gone
  propose(fresh_);
}

bool Refiner::split() {
  is_second_ = false;
  halved_twice_.assign(then_.state.size(), 0);
  if (!split_once()) return false;
  look_at_fresh();
  is_second_ = true;
  // What stays as it is now, as a triangle beside it is halved once alone, may be split in the next round.
  std::vector<std::uint32_t> left = fresh_;
  if (!split_once()) return true;
  std::sort(fresh_.begin(), fresh_.end());
  std::erase_if(left, [&](std::uint32_t t) { return std::binary_search(fresh_.begin(), fresh_.end(), t); });
  fresh_.insert(fresh_.end(), left.begin(), left.end());
  return true;
}

/// Splits the edges that the triangles to be looked at ask for. False if that is none.
bool Refiner::split_once() {
  marked_.assign(candidates_.size(), 0);
  find_whole_edges();
  for (const std::uint32_t t : fresh_) mark(t, marked_);
  keep_to_limit(marked_);
  if (std::find(marked_.begin(), marked_.end(), 1) == marked_.end()) return false;
  split(marked_);
  return true;
}

bool Refiner::keep_whole(std::span<const std::uint32_t> triangles) {
  std::vector<std::uint32_t> pieces(then_.state.size(), 0);
  for (const std::uint32_t t : piece_of_) ++pieces[t];
  bool any = false;
  for (const std::uint32_t t : triangles) {
    const std::uint32_t whole = piece_of_[t];
    if (pieces[whole] < 2) continue;
    if (halved_twice_[whole] && !is_undone_) halved_once_[whole] = 1;
    else then_.state[whole] = State::Whole;
    any = true;
  }
  if (!any) return false;
  is_undone_ = true;
  is_cut_short_ = false;  // a round that begins is not
  vertices_.resize(then_.vertices);
  triangles_ = *then_.triangles;
  state_ = then_.state;
  fresh_ = then_.fresh;
  std::erase_if(fresh_, [&](std::uint32_t t) { return state_[t] == State::Whole; });
  piece_of_.resize(state_.size());
  take_out([&](const Candidate& one) { return one.edge.second >= then_.vertices; });
  marked_.clear();
  propose(fresh_);
  return true;
}

bool Refiner::moves(const RefinedTriangles::Triangle& triangle) const {
  if (!parts_.off_part.empty() && parts_.off_part[triangle.source]) return false;
  // Where the sign changes, or something stays, no point is at a distance above 0 from all corners' side.
  const double first = vertices_[triangle.vertex[0]].asked;
  return std::all_of(triangle.vertex.begin(), triangle.vertex.end(),
                     [&](std::uint32_t v) { return vertices_[v].asked * first > 0; });
}

Refiner::State Refiner::judge(const RefinedTriangles::Triangle& triangle) const {
  if (!moves(triangle)) return State::Settled;
  OffsetTriangle offset;
  const Surface& surface = parts_.surface();
  const Vec3d &normal = surface.triangle_normals[triangle.source], &first = triangles_.positions()[triangle.vertex[0]];
  offset.may_keep_to_plane = options_.corners == Corners::Miter && normal.lengthSqr() > 0;
  bool is_beyond_plane = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const RefinedVertex& vertex = vertices_[triangle.vertex[k]];
    if (!vertex.target.is_there) return State::Mixed;
    const Vec3d position = triangles_.positions()[triangle.vertex[k]] + vertex.target.displacement;
    offset.corners[k] = position - surface.origin;
    offset.asked[k] = std::abs(vertex.asked);
    offset.tolerance[k] = vertex.tolerance * loosened_;
    offset.over_plane[k] = normal.dot(position - first) * (vertex.asked < 0 ? -1 : 1);
    is_beyond_plane |= offset.over_plane[k] < 0;
  }
  if (prover_(offset).certainty == Certainty::Proven) return State::Settled;
  // A face that gets behind its own plane has no room; its pieces would have none, either.
  return is_beyond_plane ? State::GivenUp : State::Off;
}

/// The length of an edge in the source, in units of the chord that bulges by the tolerance.
double Refiner::length_of(const Edge& edge) const {
  const RefinedVertex &a = vertices_[edge.first], &b = vertices_[edge.second];
  return (triangles_.positions()[edge.second] - triangles_.positions()[edge.first]).length() /
         chord((std::abs(a.asked) + std::abs(b.asked)) / 2, (a.tolerance + b.tolerance) / 2 * loosened_);
}

/// Whether halves of a short edge would bulge as much as it does, for all that is known: those of a smooth surface
/// bulge by a quarter. So it is where what is next to each other in the source is not in the offset.
bool Refiner::is_torn(const Candidate& one) const {
  return one.vertex.kept >= kMostTimesKept && length_of(one.edge) < kShort;
}

/// Makes candidates of the edges of some triangles, where there are none.
void Refiner::propose(const std::vector<std::uint32_t>& triangles) {
  std::vector<std::pair<Edge, std::uint32_t>> wanted;  // with the triangle of the surface that it is in
  for (const std::uint32_t t : triangles) {
    const auto& [v, source] = triangles_.triangles()[t];
    for (std::size_t k = 0; k < 3; ++k) wanted.emplace_back(edge_between(v[k], v[(k + 1) % 3]), source);
  }
  tbb::parallel_sort(wanted.begin(), wanted.end());
  const auto same_edge = [](const auto& a, const auto& b) { return a.first == b.first; };
  wanted.erase(std::unique(wanted.begin(), wanted.end(), same_edge), wanted.end());
  std::erase_if(wanted, [&](const auto& one) {
    const auto at = std::lower_bound(candidates_.begin(), candidates_.end(), one.first,
                                     [](const Candidate& c, const Edge& edge) { return c.edge < edge; });
    return at != candidates_.end() && at->edge == one.first;
  });
  const std::size_t known = candidates_.size();
  candidates_.resize(known + wanted.size());
  for_each_index(
      wanted.size(), [&](std::size_t i) { candidates_[known + i] = candidate(wanted[i].first, wanted[i].second); }, 8);
  std::inplace_merge(candidates_.begin(), candidates_.begin() + static_cast<std::ptrdiff_t>(known), candidates_.end());
}

/// Takes candidates out, but remembers what they asked and were answered.
template <class Condition>
void Refiner::take_out(Condition&& condition) {
  std::erase_if(candidates_, [&](const Candidate& one) {
    if (!condition(one)) return false;
    answered_.emplace_back(one.question, one.vertex.target);
    return true;
  });
  std::stable_sort(answered_.begin(), answered_.end(),
                   [](const auto& a, const auto& b) { return a.first.place < b.first.place; });
  answered_.erase(
      std::unique(answered_.begin(), answered_.end(), [](const auto& a, const auto& b) { return a.first == b.first; }),
      answered_.end());
}

VertexTarget Refiner::target_of(const Question& question) const {
  const auto& [place, position, asked, between, is_by_miter] = question;
  const auto first = std::lower_bound(answered_.begin(), answered_.end(), place,
                                      [](const auto& one, const SurfacePlace& at) { return one.first.place < at; });
  for (auto one = first; one != answered_.end() && one->first.place == place; ++one)
    if (one->first == question) return one->second;
  if (asked == 0) return {};
  if (between)
    if (const VertexTarget target = targets_.beside(place, position, asked, *between, is_by_miter); target.is_there)
      return target;
  return targets_.along(place, position, asked);
}

Refiner::Candidate Refiner::candidate(const Edge& edge, std::uint32_t source) const {
  const RefinedVertex &a = vertices_[edge.first], &b = vertices_[edge.second];
  const Vec3d middle = (triangles_.positions()[edge.first] + triangles_.positions()[edge.second]) / 2.0;
  Candidate one{
      edge, {triangles_.middle(edge, source), options_.precision(middle), (a.asked + b.asked) / 2, {}, false}, {}};
  if (a.target.is_there && b.target.is_there) {
    one.question.between = middle + (a.target.displacement + b.target.displacement) / 2.0;
    one.question.is_by_miter = a.target.is_mitered || b.target.is_mitered;
  }
  one.vertex.asked = one.question.asked;
  one.vertex.tolerance = (a.tolerance + b.tolerance) / 2;
  one.vertex.target = target_of(one.question);
  if (!one.vertex.target.is_there || !one.question.between) return one;
  one.vertex.bulge = std::abs(one.vertex.target.away.dot(one.question.position + one.vertex.target.displacement -
                                                         *one.question.between)) /
                     one.vertex.tolerance;
  const RefinedVertex& newer = b;  // numbers grow
  if (!(one.vertex.bulge < kMostKept * newer.bulge) && newer.bulge > 0) one.vertex.kept = newer.kept + 1;
  return one;
}

/// The candidate of an edge; null if there is none.
const Refiner::Candidate* Refiner::find(const Edge& edge) const {
  const auto at = std::lower_bound(candidates_.begin(), candidates_.end(), edge,
                                   [](const Candidate& c, const Edge& wanted) { return c.edge < wanted; });
  return at != candidates_.end() && at->edge == edge ? &*at : nullptr;
}

/// Chooses edges of a triangle whose vertices all get there. Where no edge bulges and all are short, splits gain
/// nothing: so it is where a mitered crease ends at a round corner.
template <class Split>
void Refiner::mark_off(const std::array<const Candidate*, 3>& of_edge, Split&& split) const {
  // What an edge that stays bulges by, no split of another one mends.
  for (const Candidate* one : of_edge)
    if (one->stays_whole && one->vertex.bulge > kMostBulge * loosened_) return;
  bool any = false;
  const Candidate *most = nullptr, *longest = nullptr;
  for (const Candidate* one : of_edge) {
    const double length = length_of(one->edge);
    if (is_torn(*one) || one->stays_whole || length < kShortestSplit || !one->vertex.target.is_there) continue;
    if (one->vertex.bulge > kMostBulge * loosened_) {
      split(one);
      any = true;
    }
    if (!most || one->vertex.bulge > most->vertex.bulge) most = one;
    if (!longest || length > length_of(longest->edge)) longest = one;
  }
  if (any || !most) return;
  if (most->vertex.bulge > kLeastBulge * loosened_ || length_of(longest->edge) > kLongFlat) split(longest);
}

/// Whether a piece is narrow, and its face is not.
bool Refiner::is_narrow_piece(const RefinedTriangles::Triangle& triangle) const {
  const auto& vertices = parts_.surface().vertices;
  const auto& corners = parts_.surface().triangles[triangle.source];
  const auto& positions = triangles_.positions();
  const RefinedVertex& vertex = vertices_[triangle.vertex[0]];
  const double narrow = kNarrow * chord(vertex.asked, vertex.tolerance);
  return least_height(positions[triangle.vertex[0]], positions[triangle.vertex[1]], positions[triangle.vertex[2]]) <
             narrow &&
         least_height(vertices[corners[0]], vertices[corners[1]], vertices[corners[2]]) >= narrow;
}

/// Marks the edges of a triangle that is not settled which are to be split.
void Refiner::mark(std::uint32_t triangle, std::vector<std::uint8_t>& marked) const {
  if (is_narrow_piece(triangles_.triangles()[triangle])) return;
  const Corners3& v = triangles_.triangles()[triangle].vertex;
  std::array<const Candidate*, 3> of_edge;
  for (std::size_t k = 0; k < 3; ++k) {
    of_edge[k] = find(edge_between(v[k], v[(k + 1) % 3]));
    VDB_OFFSET_ASSERT(of_edge[k]);
  }
  const auto split = [&](const Candidate* one) { marked[static_cast<std::size_t>(one - candidates_.data())] = 1; };
  if (state_[triangle] == State::Off) return mark_off(of_edge, split);
  for (const Candidate* one : of_edge) {
    if (one->stays_whole || length_of(one->edge) < kShortestSplit) continue;
    const int there = vertices_[one->edge.first].target.is_there + vertices_[one->edge.second].target.is_there;
    if (there == 2 ? one->vertex.bulge > kMostBulge * loosened_ && !is_torn(*one)
                   : length_of(one->edge) > kLeastMixed && one->vertex.target.is_there)
      split(one);
  }
}

/// Notes which edges are those of triangles that have to stay whole.
void Refiner::find_whole_edges() {
  std::vector<Edge> edges;
  for (std::uint32_t t = 0; t < state_.size(); ++t) {
    if (state_[t] != State::Whole && !(is_second_ && halved_once_[piece_of_[t]])) continue;
    const Corners3& v = triangles_.triangles()[t].vertex;
    for (std::size_t k = 0; k < 3; ++k) edges.push_back(edge_between(v[k], v[(k + 1) % 3]));
  }
  edges.insert(edges.end(), options_.whole_edges.begin(), options_.whole_edges.end());
  tbb::parallel_sort(edges.begin(), edges.end());
  auto edge = edges.begin();
  for (Candidate& one : candidates_) {
    while (edge != edges.end() && *edge < one.edge) ++edge;
    one.stays_whole = edge != edges.end() && *edge == one.edge;
  }
}

/// Unmarks the edges that bulge least if there would be too many triangles.
void Refiner::keep_to_limit(std::vector<std::uint8_t>& marked) {
  const auto& triangles = triangles_.triangles();
  std::vector<std::pair<std::uint32_t, std::uint32_t>> beside;  // marked candidates, each with the triangles there
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Candidate* const one = find(edge_between(triangles[t].vertex[k], triangles[t].vertex[(k + 1) % 3]));
      const auto i = one ? static_cast<std::uint32_t>(one - candidates_.data()) : kNone;
      if (one && marked[i]) beside.emplace_back(i, t);
    }
  tbb::parallel_sort(beside.begin(), beside.end());
  const RefinedTriangles::FaceCount count = triangles_.face_count(options_.mesh_faces);
  std::vector<std::uint32_t> whole = count.whole;
  // How many more faces a split gives: one for each triangle there, and the triangles of a polygon that was whole yet.
  const auto more = [&](std::uint32_t i) {
    std::size_t faces = 0;
    for (auto at = std::lower_bound(beside.begin(), beside.end(), std::pair(i, 0U));
         at != beside.end() && at->first == i; ++at) {
      const RefinedTriangles::Triangle& triangle = triangles[at->second];
      const std::uint32_t of_polygon = std::exchange(whole[triangles_.face_of(triangle)], 1);
      faces += of_polygon * triangles_.copies(triangle);
    }
    return faces;
  };
  std::vector<std::uint32_t> some;
  for (std::uint32_t i = 0; i < marked.size(); ++i)
    if (marked[i]) some.push_back(i);
  std::size_t room = options_.most_faces > count.all ? options_.most_faces - count.all : 0, all_more = 0;
  for (const std::uint32_t i : some) all_more += more(i);
  if (all_more <= room) return;
  is_cut_short_ = true;
  whole = count.whole;
  std::stable_sort(some.begin(), some.end(), [&](std::uint32_t a, std::uint32_t b) {
    return candidates_[a].vertex.bulge > candidates_[b].vertex.bulge;
  });
  auto one = some.begin();
  for (; one != some.end(); ++one) {
    const std::size_t here = more(*one);
    if (here > room) break;
    room -= here;
  }
  for (; one != some.end(); ++one) marked[*one] = 0;
}

void Refiner::split(const std::vector<std::uint8_t>& marked) {
  std::vector<Edge> edges;
  std::vector<SurfacePlace> places;
  std::vector<Vec3d> positions;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (!marked[i]) continue;
    edges.push_back(candidates_[i].edge);
    places.push_back(candidates_[i].question.place);
    positions.push_back(candidates_[i].question.position);
    vertices_.push_back(candidates_[i].vertex);
  }
  std::vector<std::uint32_t> split_from;
  fresh_ = triangles_.split(edges, places, positions, &split_from);
  for (const std::uint32_t t : split_from) {
    state_.push_back(state_[t]);
    piece_of_.push_back(piece_of_[t]);
    if (is_second_) halved_twice_[piece_of_[t]] = 1;
  }
  std::erase_if(fresh_, [&](std::uint32_t t) { return state_[t] == State::GivenUp; });
  for (const std::uint32_t t : fresh_) state_[t] = State::New;
}

}  // namespace vdb_offset
