// SPDX-License-Identifier: Apache-2.0
#include "space/surface/seams.h"

#include <tbb/concurrent_vector.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "ground/mesh/edge_sides.h"
#include "ground/mesh/single_edges.h"
#include "ground/numbers/disjoint_sets.h"
#include "ground/numbers/hash_mix.h"
#include "ground/numbers/median.h"

namespace vdb_offset {
namespace {

// Largest gap that is welded, in units in the last place: a few roundings in each of three coordinates. Not measured.
constexpr double kUnitsApart = 4;
// Gap that is welded in any case, as a share of the diagonal: nobody models a crack as narrow, even if the coordinates
// are precise enough for it. Not measured.
constexpr double kNothingOfDiagonal = 1e-9;
// Borders closer to each other than this share of their edges are reported. Not measured.
constexpr double kSuspiciousOfEdge = 5e-3;
// Least length of an edge, in gaps: the direction of a shorter one says nothing about where a border runs. Not
// measured.
constexpr double kLongInGaps = 4;

struct BorderEdge {
  std::uint32_t a, b;
};

/// The vertices of a border and their neighbours along it.
class Borders {
 public:
  Borders(std::span<const Vec3d> positions, const std::vector<SingleEdge>& edges) : positions_(positions) {
    for (const auto& [a, b, corner] : edges) {
      ends_.push_back({a, b});
      ends_.push_back({b, a});
    }
    std::sort(ends_.begin(), ends_.end(),
              [](const BorderEdge& l, const BorderEdge& r) { return std::pair(l.a, l.b) < std::pair(r.a, r.b); });
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      if (i > 0 && ends_[i - 1].a == ends_[i].a) continue;
      vertices_.push_back(ends_[i].a);
      begin_.push_back(i);
    }
    begin_.push_back(ends_.size());
    std::vector<double> lengths;
    lengths.reserve(edges.size());
    for (const auto& [a, b, corner] : edges) lengths.push_back((positions[a] - positions[b]).length());
    median_edge_ = median(lengths);
  }

  const std::vector<std::uint32_t>& vertices() const { return vertices_; }
  double median_edge() const { return median_edge_; }
  const Vec3d& position(std::size_t i) const { return positions_[vertices_[i]]; }

  /// The gap between two borders at vertices i and j: for a pair of edges that begin at these, the larger one of the
  /// distances between the vertices and between the end of the shorter edge and the other edge. Of all such pairs, the
  /// least counts. Infinite if it is above `most_share` of the shorter edge's length for all pairs.
  double gap(std::size_t i, std::size_t j, double most_share) const {
    const double apart = (position(i) - position(j)).length();
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t p : neighbours(i))
      for (const std::uint32_t q : neighbours(j)) {
        if (p == vertices_[j] || q == vertices_[i]) continue;
        Vec3d along = positions_[q] - position(j), end = positions_[p] - position(j);
        if (along.lengthSqr() < (positions_[p] - position(i)).lengthSqr()) {
          along = positions_[p] - position(i);
          end = positions_[q] - position(i);
        }
        // `along` is the longer edge now, and `end` leads from its beginning to the end of the shorter one.
        const double length = end.length(), share = along.lengthSqr() > 0 ? along.dot(end) / along.lengthSqr() : 0;
        const double off = std::max(apart, (end - along * std::clamp(share, 0.0, 1.0)).length());
        if (off <= most_share * length) least = std::min(least, off);
      }
    return least;
  }

 private:
  struct Neighbours {
    const BorderEdge *first, *last;
    struct Iterator {
      const BorderEdge* at;
      std::uint32_t operator*() const { return at->b; }
      Iterator& operator++() { return ++at, *this; }
      bool operator!=(const Iterator& other) const { return at != other.at; }
    };
    Iterator begin() const { return {first}; }
    Iterator end() const { return {last}; }
  };
  Neighbours neighbours(std::size_t i) const { return {ends_.data() + begin_[i], ends_.data() + begin_[i + 1]}; }

  std::span<const Vec3d> positions_;
  std::vector<BorderEdge> ends_;  // each edge in both directions, sorted by its first vertex
  std::vector<std::uint32_t> vertices_;
  std::vector<std::size_t> begin_;
  double median_edge_ = 0;
};

/// Calls visit(i, j), i < j, for the border's vertices that are no farther apart than the radius.
template <class Visit>
void for_each_pair(const Borders& borders, double radius, Visit&& visit) {
  const double side = 8 * radius;  // large cells: most vertices have all others within the radius in their own cell
  using Cell = std::array<std::int64_t, 3>;
  const auto cell_of = [&](const Vec3d& p) {
    Cell c;
    for (int k = 0; k < 3; ++k) c[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(std::floor(p[k] / side));
    return c;
  };
  const auto hash = [](std::int64_t x, std::int64_t y, std::int64_t z) {
    return mix(static_cast<std::uint64_t>(x) + mix(static_cast<std::uint64_t>(y) + mix(static_cast<std::uint64_t>(z))));
  };
  const std::size_t count = borders.vertices().size();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> cells(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Cell c = cell_of(borders.position(i));
    cells[i] = {hash(c[0], c[1], c[2]), i};
  }
  std::sort(cells.begin(), cells.end());
  for (std::uint32_t i = 0; i < count; ++i) {
    const Cell low = cell_of(borders.position(i) - Vec3d(radius)), high = cell_of(borders.position(i) + Vec3d(radius));
    for (std::int64_t x = low[0]; x <= high[0]; ++x)
      for (std::int64_t y = low[1]; y <= high[1]; ++y)
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const std::uint64_t wanted = hash(x, y, z);
          for (auto at = std::lower_bound(cells.begin(), cells.end(), std::pair(wanted, i + 1));
               at != cells.end() && at->first == wanted; ++at)
            if ((borders.position(i) - borders.position(at->second)).lengthSqr() <= radius * radius)
              visit(i, at->second);
        }
  }
}

struct Extent {
  double largest = 0, diagonal = 0;
};

/// The extent of the vertices that faces use.
Extent extent_of(PolygonView polygons, std::span<const std::uint32_t> first) {
  Vec3d lower(std::numeric_limits<double>::max()), upper(-lower);
  for (std::size_t v = 0; v < first.size(); ++v) {
    if (first[v] == kNone) continue;
    lower = openvdb::math::minComponent(lower, polygons.positions[v]);
    upper = openvdb::math::maxComponent(upper, polygons.positions[v]);
  }
  Extent extent{0, (upper - lower).length()};
  for (int k = 0; k < 3; ++k) extent.largest = std::max({extent.largest, std::abs(lower[k]), std::abs(upper[k])});
  return extent;
}

/// Welds sets of border vertices: changes `first`, which has for each vertex the one that it is welded to.
class SeamWelder {
 public:
  SeamWelder(PolygonView polygons, const Borders& borders, std::vector<std::uint32_t>& first)
      : polygons_(polygons), borders_(borders), first_(first), clusters_(borders.vertices().size()) {}

  void unite(std::uint32_t i, std::uint32_t j) { clusters_.join(i, j); }

  void weld(double tolerance, SeamFacts& facts) {
    settle(tolerance);
    refuse_collapsing();
    for (std::uint32_t i = 0; i < refused_.size(); ++i) {
      const std::uint32_t root = clusters_.first(i);
      if (root == i || refused_[root]) continue;
      ++facts.vertices;
      facts.widest = std::max(facts.widest, (borders_.position(i) - borders_.position(root)).length());
      target_[borders_.vertices()[i]] = borders_.vertices()[root];
    }
    if (facts.vertices == 0) return;
    for_each_index(first_.size(), [&](std::size_t v) {
      if (first_[v] != kNone) first_[v] = target_[first_[v]];
    });
  }

 private:
  /// Refuses sets that extend farther than a crack is wide: chains of vertices, each near the next.
  void settle(double tolerance) {
    refused_.assign(borders_.vertices().size(), 0);
    target_.resize(first_.size());
    std::iota(target_.begin(), target_.end(), 0u);
    root_at_.assign(first_.size(), kNone);
    for (std::uint32_t i = 0; i < refused_.size(); ++i) {
      const std::uint32_t root = clusters_.first(i);
      if ((borders_.position(i) - borders_.position(root)).length() > 2 * tolerance) refused_[root] = 1;
      root_at_[borders_.vertices()[i]] = root;
    }
  }
  /// Refuses sets that would make one vertex of two successive corners of a face.
  void refuse_collapsing() {
    for_each_side(polygons_, first_, [&](auto, std::uint32_t from, std::uint32_t to) {
      if (root_at_[from] != kNone && root_at_[from] == root_at_[to])
        std::atomic_ref(refused_[root_at_[from]]).store(1, std::memory_order_relaxed);
    });
  }

  PolygonView polygons_;
  const Borders& borders_;
  std::vector<std::uint32_t>& first_;
  DisjointSets clusters_;
  std::vector<std::uint8_t> refused_;  // of each root: 1 if its set stays apart
  std::vector<std::uint32_t> target_,
      root_at_;  // of each vertex of the mesh: the one that it becomes; its set, or kNone
};

/// The decimal exponent of the last digit in the shortest decimal form of a number. \pre the number is not 0
int last_place(double number) {
  char text[40];
  const char* const end = std::to_chars(std::begin(text), std::end(text), number, std::chars_format::scientific).ptr;
  const char* const mark = std::find(static_cast<const char*>(text), end, 'e');
  const auto digits = static_cast<int>(
      std::count_if(static_cast<const char*>(text), mark, [](char c) { return c >= '0' && c <= '9'; }));
  int exponent = 0;
  std::from_chars(mark[1] == '+' ? mark + 2 : mark + 1, end, exponent);
  return exponent - (digits - 1);
}

/// Whether a number is one of single precision, or the shortest decimal form of one.
bool is_single(double number) {
  const auto narrow = static_cast<float>(number);
  if (static_cast<double>(narrow) == number) return true;
  char text[40];
  const char* const end = std::to_chars(std::begin(text), std::end(text), narrow).ptr;
  double back = 0;
  std::from_chars(text, end, back);
  return back == number;
}

/// The unit in the last decimal place of the largest numbers, if the numbers look like ones that were written with a
/// fixed number of digits. 0 if most of them have fewer digits than the others, or if all have so few that they may
/// well be exact. \pre the numbers are within a factor of ten
double decimal_unit(const std::vector<double>& numbers, double most) {
  constexpr double kFewDigits = 1.001e-5;  // a unit above this share of the largest number: fewer than six digits
  if (numbers.empty()) return 0;
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  int least = std::numeric_limits<int>::max(), of_largest = least;
  std::vector<int> places(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    places[i] = last_place(numbers[i]);
    least = std::min(least, places[i]);
    if (std::abs(numbers[i]) >= power) of_largest = std::min(of_largest, places[i]);
  }
  const auto as_many = std::count_if(places.begin(), places.end(), [&](int place) { return place <= least + 1; });
  if (2 * static_cast<std::size_t>(as_many) < places.size()) return 0;
  // With the same number of digits for each, the largest numbers, of one more digit before the point, end a place
  // earlier. If they end earlier than that, they are round, and the place of the others counts.
  const double unit = std::pow(10.0, of_largest <= least + 1 ? of_largest : least);
  return unit <= kFewDigits * most ? unit : 0;
}

double tolerance_of(const Borders& borders, const Extent& extent, double precision) {
  double unit = precision * extent.largest;
  if (precision == 0) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < borders.vertices().size(); ++i)
      for (int k = 0; k < 3; ++k) numbers.push_back(borders.position(i)[k]);
    unit = unit_in_last_place(numbers, extent.largest);
  }
  return std::max(kUnitsApart * unit, kNothingOfDiagonal * extent.diagonal);
}

}  // namespace

double unit_in_last_place(const std::vector<double>& numbers, double largest) {
  // Numbers far below the largest are left out: they may be zeros but for the rounding of an earlier computation.
  const auto those_from = [&](double least) {
    std::vector<double> some;
    std::copy_if(numbers.begin(), numbers.end(), std::back_inserter(some),
                 [&](double number) { return number != 0 && std::abs(number) >= least; });
    return some;
  };
  double most = 0;
  for (const double number : numbers) most = std::max(most, std::abs(number));
  const std::vector<double> large = those_from(most / 1000);
  const bool single = !large.empty() && std::all_of(large.begin(), large.end(), is_single);
  const int digits = single ? std::numeric_limits<float>::digits : std::numeric_limits<double>::digits;
  // Half a decimal unit: decimal numbers were rounded once, when they were written, so that two of them that are equal
  // but for this differ by one unit at most.
  return std::max(std::ldexp(1.0, std::ilogb(largest) - digits + 1), decimal_unit(those_from(most / 10), most) / 2);
}

ClosedSeams close_seams(PolygonView polygons, double precision, std::vector<std::uint32_t>& first) {
  const std::vector<SingleEdge> edges = find_single_edges(polygons, first);
  if (edges.empty()) return {};
  const Extent extent = extent_of(polygons, first);
  if (!(extent.diagonal > 0) || !std::isfinite(extent.diagonal)) return {};
  const Borders borders(polygons.positions, edges);
  const double tolerance = tolerance_of(borders, extent, precision);
  SeamFacts facts;
  SeamWelder welder(polygons, borders, first);
  std::vector<std::uint8_t> suspicious(borders.vertices().size(), 0);
  for_each_pair(borders, std::max(tolerance, kSuspiciousOfEdge * borders.median_edge()), [&](auto i, auto j) {
    const double gap = borders.gap(i, j, 1 / kLongInGaps);
    if (gap <= tolerance) {
      welder.unite(i, j);
    } else if (const double close = borders.gap(i, j, kSuspiciousOfEdge); std::isfinite(close)) {
      suspicious[i] = suspicious[j] = 1;
      facts.widest_near = std::max(facts.widest_near, close);
    }
  });
  facts.near_vertices = static_cast<std::size_t>(std::count(suspicious.begin(), suspicious.end(), 1));
  welder.weld(tolerance, facts);
  return {facts, tolerance};
}

namespace {

/// Edges that are too short, by the vertices that their ends are welded to, and the sets that these make.
class Slivers {
 public:
  Slivers(PolygonView polygons, std::vector<std::uint32_t>& first, double longest)
      : polygons_(polygons), first_(first), edges_(edges_up_to(longest)) {
    for (const auto& [a, b] : edges_) vertices_.insert(vertices_.end(), {a, b});
    std::sort(vertices_.begin(), vertices_.end());
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
  }

  bool empty() const { return edges_.empty(); }

  void weld(double longest, SeamFacts& facts) {
    DisjointSets sets(vertices_.size());
    for (const auto& [a, b] : edges_)
      if ((at(a) - at(b)).length() <= longest) sets.join(number(a), number(b));
    const std::vector<std::uint8_t> held = held_by_faces(sets);
    std::vector<std::uint8_t> wide(vertices_.size(), 0);
    for (std::uint32_t i = 0; i < wide.size(); ++i)
      if ((at(vertices_[i]) - at(vertices_[sets.first(i)])).length() > 2 * longest) wide[sets.first(i)] = 1;
    std::vector<std::uint32_t> target = vertices_;
    for (std::uint32_t i = 0; i < target.size(); ++i) {
      const std::uint32_t root = sets.first(i);
      if (root == i || wide[root] || !held[root]) continue;
      target[i] = vertices_[root];
      ++facts.slivers;
      facts.widest_sliver = std::max(facts.widest_sliver, (at(vertices_[i]) - at(target[i])).length());
    }
    for (auto& v : first_)
      if (is_end(v)) v = target[number(v)];
  }

 private:
  const Vec3d& at(std::uint32_t v) const { return polygons_.positions[v]; }
  bool is_end(std::uint32_t v) const { return std::binary_search(vertices_.begin(), vertices_.end(), v); }
  std::uint32_t number(std::uint32_t v) const {
    return static_cast<std::uint32_t>(std::lower_bound(vertices_.begin(), vertices_.end(), v) - vertices_.begin());
  }

  std::vector<BorderEdge> edges_up_to(double longest) const {
    tbb::concurrent_vector<BorderEdge> found;
    for_each_side(polygons_, first_, [&](auto, std::uint32_t from, std::uint32_t to) {
      if ((at(from) - at(to)).lengthSqr() <= longest * longest)
        found.push_back({std::min(from, to), std::max(from, to)});
    });
    std::vector<BorderEdge> edges(found.begin(), found.end());
    std::sort(edges.begin(), edges.end(),
              [](const BorderEdge& l, const BorderEdge& r) { return std::pair(l.a, l.b) < std::pair(r.a, r.b); });
    return edges;
  }

  /// Of each root: 1 if a face beside its set keeps three corners, or one that is a line then leads to such a set.
  std::vector<std::uint8_t> held_by_faces(DisjointSets& sets) const {
    std::vector<std::vector<std::uint32_t>> faces;  // that have corners in sets, as what is left of them
    for (std::size_t f = 0; f < polygons_.face_count(); ++f) {
      const auto face = polygons_.face(f);
      if (std::none_of(face.begin(), face.end(), [&](std::uint32_t v) { return is_end(first_[v]); })) continue;
      auto& corners = faces.emplace_back();
      for (const auto v : face)
        corners.push_back(is_end(first_[v]) ? vertices_[sets.first(number(first_[v]))] : first_[v]);
      std::sort(corners.begin(), corners.end());
      corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    }
    std::vector<std::uint8_t> held(vertices_.size(), 0);
    for (bool any = true; any;) {
      any = false;
      for (const auto& corners : faces) {
        const auto is_held = [&](std::uint32_t v) { return !is_end(v) || held[number(v)]; };
        if (corners.size() < 3 && std::none_of(corners.begin(), corners.end(), is_held)) continue;
        for (const auto v : corners)
          if (!is_held(v)) held[number(v)] = 1, any = true;
      }
    }
    return held;
  }

  PolygonView polygons_;
  std::vector<std::uint32_t>& first_;
  std::vector<BorderEdge> edges_;
  std::vector<std::uint32_t> vertices_;  // ends of these edges, ascending
};

double median_side(PolygonView polygons, std::span<const std::uint32_t> first) {
  std::vector<double> lengths(polygons.corners.size(), 0);
  for_each_side(polygons, first, [&](std::uint32_t corner, std::uint32_t from, std::uint32_t to) {
    lengths[corner] = (polygons.positions[from] - polygons.positions[to]).length();
  });
  return median(lengths);
}

}  // namespace

void weld_slivers(PolygonView polygons, std::vector<std::uint32_t>& first, SeamFacts& facts) {
  // Share of the diagonal: half a unit in the last place of single precision, which most programs hand on.
  constexpr double kOfDiagonal = std::numeric_limits<float>::epsilon() / 2;
  const double diagonal = extent_of(polygons, first).diagonal, longest = kOfDiagonal * diagonal;
  if (!(diagonal > 0) || !std::isfinite(diagonal)) return;
  Slivers slivers(polygons, first, longest);
  if (slivers.empty()) return;
  slivers.weld(std::min(longest, MeshFacts::kSliver * median_side(polygons, first)), facts);
}

}  // namespace vdb_offset
