// SPDX-License-Identifier: Apache-2.0
#include "space/surface/orientation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "ground/system/parallel.h"
#include "space/surface/inside.h"

namespace vdb_offset {
namespace {

Vec3d twice_area(const Surface& surface, std::uint32_t t) {
  const auto& [a, b, c] = surface.triangles[t];
  return (surface.vertices[b] - surface.vertices[a]).cross(surface.vertices[c] - surface.vertices[a]);
}

/// Triangles that are connected over edges with two faces, and which of them have the orientation of the first.
struct OrientableSheet {
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint8_t> agrees;
  bool orientable = true;
};

/// The sheet of a triangle that belongs to no sheet yet. `state` of each triangle: 0 not seen, 1 agrees with the seed,
/// 2 does not.
OrientableSheet collect_sheet(const Surface& surface, std::uint32_t seed, std::vector<std::uint8_t>& state) {
  OrientableSheet sheet;
  sheet.triangles.push_back(seed);
  state[seed] = 1;
  for (std::size_t i = 0; i < sheet.triangles.size(); ++i) {
    const std::uint32_t t = sheet.triangles[i];
    for (std::uint32_t e = 3 * t; e < 3 * t + 3; ++e) {
      const std::uint32_t twin = surface.next_around_edge[e], other = twin / 3;
      if (twin == e || surface.next_around_edge[twin] != e) continue;
      const bool conflict = surface.from(e) == surface.from(twin);
      const auto wanted = static_cast<std::uint8_t>(conflict ? 3 - state[t] : state[t]);
      if (state[other] == 0) {
        state[other] = wanted;
        sheet.triangles.push_back(other);
      } else if (state[other] != wanted) {
        sheet.orientable = false;
      }
    }
  }
  for (const auto t : sheet.triangles) sheet.agrees.push_back(state[t] == 1);
  return sheet;
}

/// The new number of a half-edge: in a triangle whose last two corners are exchanged, half-edge k becomes 2 - k.
std::uint32_t renamed(std::uint32_t half_edge, const std::vector<std::uint8_t>& turned) {
  return turned[half_edge / 3] ? 3 * (half_edge / 3) + 2 - half_edge % 3 : half_edge;
}

void turn_round(Surface& surface, const std::vector<std::uint8_t>& turned) {
  std::vector<std::uint32_t> next(surface.next_around_edge.size());
  for (std::uint32_t e = 0; e < next.size(); ++e)
    next[renamed(e, turned)] = renamed(surface.next_around_edge[e], turned);
  surface.next_around_edge = std::move(next);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    if (turned[t]) std::swap(surface.triangles[t][1], surface.triangles[t][2]);
  surface.turned.resize(turned.size(), 0);
  for (std::size_t t = 0; t < turned.size(); ++t) surface.turned[t] ^= turned[t];
}

/// A component of the surface, taken for a solid.
struct Solid {
  bool closed = true;
  std::size_t triangles = 0;
  Vec3d reference{0.0};          // one of its vertices; volumes are measured from there, as that is rounded least
  double volume = 0, gross = 0;  // six times the signed volume; the sum of the sizes of its terms
  Vec3d lower{0.0}, upper{0.0};  // these two, and the samples, are set by locate() alone
  std::array<std::uint32_t, 3> samples{};  // triangles, far apart along the space-filling curve

  /// Whether the component is inside out. A flat one has a volume by rounding alone, which is below 1e-12 of the
  /// terms that it is the sum of.
  bool is_negative() const { return closed && volume < -1e-12 * gross; }
};

bool has_clean_edges(const Surface& surface, std::uint32_t t) {
  for (std::uint32_t e = 3 * t; e < 3 * t + 3; ++e) {
    const std::uint32_t twin = surface.next_around_edge[e];
    if (twin == e || surface.next_around_edge[twin] != e || surface.from(e) == surface.from(twin)) return false;
  }
  return true;
}

std::vector<Solid> find_solids(const Surface& surface, const std::vector<std::uint32_t>& component_of) {
  std::vector<Solid> solids(surface.facts.components);
  const bool all_clean = surface.facts.closed() && surface.facts.oriented();
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    Solid& solid = solids[component_of[t]];
    const auto& [a, b, c] = surface.triangles[t];
    if (solid.triangles++ == 0) solid.reference = surface.vertices[a];
    if (!all_clean) solid.closed = solid.closed && has_clean_edges(surface, t);
    const Vec3d p = surface.vertices[a] - solid.reference, q = surface.vertices[b] - solid.reference,
                r = surface.vertices[c] - solid.reference;
    const double volume = p.dot(q.cross(r));
    solid.volume += volume;
    solid.gross += std::abs(volume);
  }
  return solids;
}

/// Finds the boxes and the samples of all solids.
void locate(const Surface& surface, const std::vector<std::uint32_t>& component_of, std::vector<Solid>& solids) {
  std::vector<std::size_t> seen(solids.size(), 0);
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    Solid& solid = solids[component_of[t]];
    const std::size_t i = seen[component_of[t]]++;
    if (i == 0) {
      solid.lower = solid.upper = surface.vertices[surface.triangles[t][0]];
      solid.samples.fill(t);
    }
    if (i == solid.triangles / 2) solid.samples[1] = t;
    if (i + 1 == solid.triangles) solid.samples[2] = t;
    for (const auto v : surface.triangles[t]) {
      solid.lower = openvdb::math::minComponent(solid.lower, surface.vertices[v]);
      solid.upper = openvdb::math::maxComponent(solid.upper, surface.vertices[v]);
    }
  }
}

/// Tells which closed components a component lies inside of: those with a winding number other than zero around its
/// points. Winding numbers are counted along rays from the middles of three of its faces, of which two decide.
class Nesting {
 public:
  Nesting(const Surface& surface, const std::vector<std::uint32_t>& component_of, const std::vector<Solid>& solids)
      : surface_(surface),
        component_of_(component_of),
        solids_(solids),
        rays_(surface, [&](std::size_t t) { return solids[component_of[t]].closed; }) {}

  std::vector<std::uint32_t> solids_around(std::uint32_t inner) const {
    std::vector<std::uint32_t> found, around;
    for (const auto t : solids_[inner].samples) cast_ray(inner, t, found);
    std::sort(found.begin(), found.end());
    for (std::size_t i = 0; i + 1 < found.size(); ++i)
      if (found[i] == found[i + 1] && (around.empty() || around.back() != found[i])) around.push_back(found[i]);
    return around;
  }

 private:
  /// Whether `inner` may lie inside of `outer`, by their boxes.
  bool may_hold(std::uint32_t outer, std::uint32_t inner) const {
    const Solid &a = solids_[outer], &b = solids_[inner];
    for (int k = 0; k < 3; ++k)
      if (!(a.lower[k] < b.lower[k] && b.upper[k] < a.upper[k])) return false;
    return outer != inner;
  }

  /// Adds the solids that a sample of `inner` lies inside of.
  void cast_ray(std::uint32_t inner, std::uint32_t sample, std::vector<std::uint32_t>& found) const {
    const auto& [a, b, c] = surface_.triangles[sample];
    std::vector<std::pair<std::uint32_t, int>> passes;
    rays_.cast((surface_.vertices[a] + surface_.vertices[b] + surface_.vertices[c]) / 3.0,
               [&](std::size_t t, int turn) {
                 if (may_hold(component_of_[t], inner)) passes.emplace_back(component_of_[t], turn);
               });
    std::sort(passes.begin(), passes.end());
    for (std::size_t i = 0; i < passes.size();) {
      const std::uint32_t outer = passes[i].first;
      int winding = 0;
      for (; i < passes.size() && passes[i].first == outer; ++i) winding += passes[i].second;
      if (winding != 0) found.push_back(outer);
    }
  }

  const Surface& surface_;
  const std::vector<std::uint32_t>& component_of_;
  const std::vector<Solid>& solids_;
  RayTree rays_;
};

/// How components lie in each other.
struct Judgement {
  std::vector<std::uint8_t> wrong;  // of each component: whether it faces the wrong way as a whole
  std::size_t enclosed = 0;         // components that face outward where a cavity would face inward, and are not wrong
};

/// `around` has the solids that each component lies inside of.
Judgement judge(const std::vector<Solid>& solids, const std::vector<std::vector<std::uint32_t>>& around,
                Orient orient) {
  std::vector<std::uint32_t> order(solids.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return around[a].size() < around[b].size(); });
  Judgement judgement{std::vector<std::uint8_t>(solids.size(), 0), 0};
  std::vector<std::uint8_t>& wrong = judgement.wrong;
  for (const auto c : order) {
    if (!solids[c].closed) continue;
    const bool cavity = around[c].size() % 2 == 1;
    if (solids[c].is_negative()) {
      wrong[c] = !cavity;
    } else if (cavity && solids[c].volume > 0) {
      // A component that faces outward inside another may be a solid of its own, unless the innermost one around it is
      // inside out: then both are.
      const auto innermost =
          std::max_element(around[c].begin(), around[c].end(),
                           [&](std::uint32_t a, std::uint32_t b) { return around[a].size() < around[b].size(); });
      wrong[c] = orient == Orient::FixCavities || wrong[*innermost];
      judgement.enclosed += !wrong[c];
    }
  }
  return judgement;
}

/// Whether the box of any closed component lies in that of another one.
bool any_box_in_another(const std::vector<Solid>& solids) {
  BoxTree tree;
  const auto box_of = [&](std::size_t c) {
    FloatBox box;
    if (!solids[c].closed) return box;
    for (std::size_t k = 0; k < 3; ++k) {
      box.lower[k] = static_cast<float>(solids[c].lower[static_cast<int>(k)]);
      box.upper[k] = static_cast<float>(solids[c].upper[static_cast<int>(k)]);
    }
    return box;
  };
  tree.build(solids.size(), box_of);
  for (std::size_t c = 0; c < solids.size(); ++c) {
    const FloatBox inner = box_of(c);
    const auto is_around = [&](std::size_t other) {
      const FloatBox outer = box_of(other);
      bool is_in = other != c;
      for (std::size_t k = 0; k < 3; ++k)
        is_in = is_in && outer.lower[k] <= inner.lower[k] && inner.upper[k] <= outer.upper[k];
      return is_in;
    };
    if (solids[c].closed && tree.any_overlap(inner, is_around)) return true;
  }
  return false;
}

PieceFacts piece_facts(const Surface& surface, const std::vector<std::uint32_t>& component_of,
                       std::uint32_t component) {
  PieceFacts piece;
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
    if (component_of[t] != component) continue;
    if (vertices.empty() || surface.face[t] < piece.face) piece.face = surface.face[t];
    vertices.insert(vertices.end(), surface.triangles[t].begin(), surface.triangles[t].end());
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  piece.vertices = vertices.size();
  piece.lower = piece.upper = surface.vertices[vertices.front()];
  for (const auto v : vertices) {
    piece.lower = openvdb::math::minComponent(piece.lower, surface.vertices[v]);
    piece.upper = openvdb::math::maxComponent(piece.upper, surface.vertices[v]);
  }
  piece.lower += surface.origin;
  piece.upper += surface.origin;
  return piece;
}

Judgement look_at_components(const Surface& surface, const std::vector<std::uint32_t>& component_of,
                             std::vector<Solid>& solids, Orient orient) {
  std::vector<std::vector<std::uint32_t>> around(solids.size());
  const bool several = surface.facts.closed_components > 1;
  if (several) locate(surface, component_of, solids);
  if (several && any_box_in_another(solids)) {
    const Nesting nesting(surface, component_of, solids);
    const auto look = [&](std::size_t c) {
      if (solids[c].closed) around[c] = nesting.solids_around(static_cast<std::uint32_t>(c));
    };
    for_each_index(solids.size(), look, 16);
  }
  return judge(solids, around, orient);
}

}  // namespace

void settle_orientation(Surface& surface) {
  MeshFacts& facts = surface.facts;
  if (facts.orientation_conflicts == 0) return;
  const std::size_t count = surface.triangles.size();
  std::vector<std::uint8_t> state(count, 0), turned(count, 0);
  for (std::uint32_t seed = 0; seed < count; ++seed) {
    if (state[seed] != 0) continue;
    const OrientableSheet sheet = collect_sheet(surface, seed, state);
    if (!sheet.orientable) continue;
    double area[2] = {0, 0};
    for (std::size_t i = 0; i < sheet.triangles.size(); ++i)
      area[sheet.agrees[i]] += twice_area(surface, sheet.triangles[i]).length();
    const std::uint8_t kept = area[1] >= area[0];
    for (std::size_t i = 0; i < sheet.triangles.size(); ++i) turned[sheet.triangles[i]] = sheet.agrees[i] != kept;
  }
  facts.turned_triangles = static_cast<std::size_t>(std::count(turned.begin(), turned.end(), 1));
  turn_round(surface, turned);
  for (std::uint32_t e = 0; e < 3 * count; ++e) {
    const std::uint32_t twin = surface.next_around_edge[e];
    facts.unsettled_conflicts +=
        twin > e && surface.next_around_edge[twin] == e && surface.from(e) == surface.from(twin);
  }
}

void settle_outside(Surface& surface, const std::vector<std::uint32_t>& component_of, Orient orient) {
  MeshFacts& facts = surface.facts;
  std::vector<Solid> solids = find_solids(surface, component_of);
  facts.closed_components = static_cast<std::size_t>(
      std::count_if(solids.begin(), solids.end(), [](const Solid& solid) { return solid.closed; }));
  const auto [wrong, enclosed] = look_at_components(surface, component_of, solids, orient);
  facts.enclosed_components = enclosed;
  facts.inside_out_components = static_cast<std::size_t>(std::count(wrong.begin(), wrong.end(), 1));
  if (facts.inside_out_components == 0) return;
  std::uint32_t largest = kNone;
  for (std::uint32_t c = 0; c < solids.size(); ++c)
    if (wrong[c] && (largest == kNone || solids[c].triangles > solids[largest].triangles)) largest = c;
  facts.largest_inside_out = piece_facts(surface, component_of, largest);
  if (orient == Orient::Keep) return;
  std::vector<std::uint8_t> turned(surface.triangles.size());
  const std::vector<std::uint8_t>& is_wrong = wrong;
  for_each_index(turned.size(), [&](std::size_t t) { turned[t] = is_wrong[component_of[t]]; });
  turn_round(surface, turned);
}

}  // namespace vdb_offset
