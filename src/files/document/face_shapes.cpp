// SPDX-License-Identifier: Apache-2.0
// Finds what the faces of a mesh are by their shape: up and down, curved outward and inward, and round holes. Faces in
// one plane that share an edge are joined to facets; between neighbouring facets stand bends, above 0 where the edge is
// convex. A ring grows from a facet and two neighbours that bend to one side, whose normals give an axis, to neighbours
// around nearly that axis until it closes. It is round if it has eight facets or more, all normals make one angle with
// its axis, the direction in which they vary least, and they go around it once. The diameter follows from a
// least-squares circle, or from the tip of a cone. A facet of no ring is curved by the sum of its bends, weighted by
// the lengths of edges, without sharp ones. Edges that do not have two faces in opposite directions are passed over.
#include "document/face_shapes.h"

#include <openvdb/math/BBox.h>
#include <openvdb/math/Mat3.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "ground/mesh/edge_sides.h"

namespace vdb_offset::io {
namespace {

constexpr double kOneDegree = std::numbers::pi / 180;
// The largest bend between facets of one ring, and the fewest of these. Reasoned: a cylinder of eight facets bends by
// 45 degrees, a hexagonal socket by 60.
constexpr double kMostBend = 50 * kOneDegree;
constexpr std::size_t kFewestSides = 8;
// The largest bend that makes a facet of no ring part of a curved surface. Reasoned: far above the bends of fillets,
// below those of chamfers, whose faces are flat.
constexpr double kMostCurved = 29 * kOneDegree;
// Sine between faces of one facet: far above the rounding of seven digits, far below the bends of curved surfaces.
constexpr double kOneFacet = 1e-3;
// Sine between the axes of three facets at a time, which rounding disturbs; and how far the angles between the
// axis of a ring and its normals may differ. Not measured.
constexpr double kOneAxis = 0.1, kOneAngle = 0.02;
// Cosine between the axis of a ring and its normals below which it is a cylinder. As kOneAngle.
constexpr double kCylinder = 0.02;
// The most neighbours to one side of a facet that may be of a ring: two, and a few at its ends. Larger faces, as the
// top of a plate inside a chamfer, have hundreds. Not measured.
constexpr std::size_t kMostBeside = 16;
// Faces that look up do so within less than this angle. Rounding: what is drawn at 45 degrees is not among them.
constexpr double kFacing = 45 * kOneDegree - 1e-6;

// How far faces of one end may lie apart, as a share of the diagonal. Not measured: far above rounding.
constexpr double kEndSlack = 1e-4;

/// For each vertex the first one at its position.
std::vector<std::uint32_t> first_at_positions(PolygonView mesh) {
  std::vector<std::uint32_t> order(mesh.positions.size()), first(mesh.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t v) {
    const Vec3d& p = mesh.positions[v];
    return std::tuple(p[0], p[1], p[2]);
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  return first;
}

Vec3d twice_area_of(PolygonView mesh, std::size_t f) {
  const auto face = mesh.face(f);
  Vec3d sum(0.0);
  for (std::size_t k = 2; k < face.size(); ++k)
    sum += (mesh.positions[face[k - 1]] - mesh.positions[face[0]])
               .cross(mesh.positions[face[k]] - mesh.positions[face[0]]);
  return sum;
}

Vec3d direction_of(const Vec3d& v) { return v.lengthSqr() > 0 ? v.unit() : v; }

/// x with squares * x = right, in the sense of least squares where directions are left open.
Vec3d solve(const openvdb::math::Mat3d& squares, const Vec3d& right) {
  constexpr double kOpen = 1e-12;  // share of the largest; reasoned: rounding
  openvdb::math::Mat3d axes;
  Vec3d sizes, x(0.0);
  openvdb::math::diagonalizeSymmetricMatrix(squares, axes, sizes);
  const double largest = std::max({sizes[0], sizes[1], sizes[2]});
  for (int k = 0; k < 3; ++k)
    if (sizes[k] > kOpen * largest) x += axes.col(k) * (axes.col(k).dot(right) / sizes[k]);
  return x;
}

void add_square(const Vec3d& v, openvdb::math::Mat3d& squares) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) squares(i, j) += v[i] * v[j];
}

}  // namespace

FaceShapes::FaceShapes(PolygonView mesh) : mesh_(mesh) {
  for (std::size_t f = 0; f < mesh.face_count(); ++f) area_.push_back(twice_area_of(mesh, f));
  const std::vector<std::uint32_t> first = first_at_positions(mesh);
  const auto face_of = [&](const EdgeSide& side) {
    const auto next = std::upper_bound(mesh.face_begin.begin(), mesh.face_begin.end(), side.corner);
    return static_cast<std::uint32_t>(next - mesh.face_begin.begin() - 1);
  };
  visit_edges(mesh, first, [&](std::uint32_t low, std::span<const EdgeSide> sides) {
    const auto runs_up = [&](const EdgeSide& side) { return first[mesh.corners[side.corner]] == low; };
    if (sides.size() != 2 || runs_up(sides[0]) == runs_up(sides[1])) return;
    const std::size_t up = runs_up(sides[0]) ? 0 : 1;
    edges_.push_back({low, sides[0].larger_end, face_of(sides[up]), face_of(sides[1 - up])});
  });
  find_facets();
  find_neighbours();
}

void FaceShapes::find_facets() {
  std::vector<std::uint32_t> root(mesh_.face_count());
  std::iota(root.begin(), root.end(), 0u);
  const auto root_of = [&](std::uint32_t f) {
    while (root[f] != f) f = root[f] = root[root[f]];
    return f;
  };
  for (const Edge& edge : edges_) {
    const Vec3d a = direction_of(area_[edge.left]), b = direction_of(area_[edge.right]);
    // A face without an area is of the facet beside it.
    if (a.lengthSqr() > 0 && b.lengthSqr() > 0 && (a.dot(b) < 0 || a.cross(b).length() > kOneFacet)) continue;
    const std::uint32_t left = root_of(edge.left), right = root_of(edge.right);
    root[std::max(left, right)] = std::min(left, right);
  }
  facet_.resize(root.size());
  for (std::uint32_t f = 0; f < root.size(); ++f) {
    const std::uint32_t first = root_of(f);
    if (first == f) {
      facet_[f] = static_cast<std::uint32_t>(faces_.size());
      faces_.emplace_back();
      normal_.emplace_back(0.0);
    }
    facet_[f] = facet_[first];
    faces_[facet_[f]].push_back(f);
    normal_[facet_[f]] += area_[f];
  }
  for (Vec3d& normal : normal_) normal = direction_of(normal);
}

void FaceShapes::find_neighbours() {
  beside_.resize(normal_.size());
  for (const Edge& edge : edges_) {
    const std::uint32_t left = facet_[edge.left], right = facet_[edge.right];
    const Vec3d along = mesh_.positions[edge.to] - mesh_.positions[edge.from],
                across = normal_[left].cross(normal_[right]);
    const double bend = std::atan2(across.length(), normal_[left].dot(normal_[right]));
    if (left == right || !(bend > kOneFacet) || bend > kMostBend) continue;
    const double signed_bend = across.dot(along) > 0 ? bend : -bend;
    beside_[left].push_back({right, signed_bend, along.length()});
    beside_[right].push_back({left, signed_bend, along.length()});
  }
  for (std::vector<Neighbour>& beside : beside_) {
    std::stable_sort(beside.begin(), beside.end(),
                     [](const Neighbour& a, const Neighbour& b) { return a.facet < b.facet; });
    std::vector<Neighbour> each;
    for (const Neighbour& one : beside)
      if (!each.empty() && each.back().facet == one.facet) each.back().length += one.length;
      else each.push_back(one);
    beside = std::move(each);
  }
}

std::vector<std::uint8_t> FaceShapes::facing(int side) const {
  std::vector<std::uint8_t> marks;
  for (const Vec3d& area : area_) marks.push_back(side * area[2] > std::cos(kFacing) * area.length());
  return marks;
}

std::vector<std::uint8_t> FaceShapes::flat_end(std::size_t axis, int side) const {
  openvdb::math::BBox<Vec3d> box;
  for (const auto v : mesh_.corners) box.expand(mesh_.positions[v]);
  const double slack = kEndSlack * box.extents().length();
  // How far each face reaches, if it looks that way.
  std::vector<double> reach(area_.size(), -INFINITY);
  double farthest = -INFINITY;
  for (std::size_t f = 0; f < area_.size(); ++f) {
    if (!(side * area_[f][axis] > std::cos(kOneDegree) * area_[f].length())) continue;
    reach[f] = INFINITY;
    for (const auto v : mesh_.face(f)) reach[f] = std::min(reach[f], side * mesh_.positions[v][axis]);
    farthest = std::max(farthest, reach[f]);
  }
  std::vector<std::uint8_t> marks(reach.size());
  for (std::size_t f = 0; f < reach.size(); ++f) marks[f] = reach[f] > -INFINITY && reach[f] >= farthest - slack;
  return marks;
}

std::vector<std::uint8_t> FaceShapes::curved(int side) const {
  std::vector<double> bend(normal_.size(), 0.0);
  for (std::size_t facet = 0; facet < bend.size(); ++facet)
    for (const Neighbour& other : beside_[facet])
      if (std::abs(other.bend) < kMostCurved) bend[facet] += other.bend * other.length;
  for (const int each : {1, -1})
    for (const Ring& ring : rings(each))
      for (const auto facet : ring) bend[facet] = each;
  std::vector<std::uint8_t> marks;
  for (const auto facet : facet_) marks.push_back(side * bend[facet] > 0);
  return marks;
}

/// A facet with each two others that bend from it to one side.
std::vector<FaceShapes::Link> FaceShapes::links_of(std::uint32_t facet, int side) const {
  std::vector<Link> links;
  std::vector<Neighbour> beside = beside_[facet];
  std::erase_if(beside, [&](const Neighbour& each) { return !(side * each.bend > 0); });
  if (beside.size() > kMostBeside) return links;
  for (std::size_t i = 0; i < beside.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3d &middle = normal_[facet], a = normal_[beside[j].facet] - middle,
                  b = normal_[beside[i].facet] - middle, axis = a.cross(b);
      if (!(axis.lengthSqr() > 0)) continue;
      links.push_back({facet, {beside[j].facet, beside[i].facet}, axis.unit()});
    }
  return links;
}

/// The link around the same axis of a facet beside that of another link.
std::optional<FaceShapes::Link> FaceShapes::next_of(const Link& link, std::uint32_t to, int side) const {
  std::optional<Link> best;
  double least = kOneAxis;
  for (const Link& next : links_of(to, side)) {
    const double off = next.axis.cross(link.axis).length();
    if ((next.beside[0] != link.facet && next.beside[1] != link.facet) || !(off < least)) continue;
    least = off;
    best = next;
  }
  return best;
}

/// The ring that a link is of, from its facet on.
std::optional<FaceShapes::Ring> FaceShapes::ring_from(const Link& start, int side) const {
  Ring ring{start.facet};
  Link link = start;
  std::uint32_t to = start.beside[1];
  while (to != start.facet) {
    const auto next = next_of(link, to, side);
    if (!next || ring.size() > normal_.size() || std::find(ring.begin(), ring.end(), to) != ring.end())
      return std::nullopt;
    ring.push_back(to);
    to = next->beside[next->beside[0] == link.facet ? 1 : 0];
    link = *next;
  }
  if (link.facet != start.beside[0] || !is_round(ring)) return std::nullopt;
  return ring;
}

std::vector<FaceShapes::Ring> FaceShapes::rings(int side) const {
  std::vector<Ring> rings;
  std::vector<std::uint8_t> taken(normal_.size(), 0);
  for (std::uint32_t facet = 0; facet < normal_.size(); ++facet) {
    if (taken[facet]) continue;
    for (const Link& link : links_of(facet, side)) {
      std::optional<Ring> ring = ring_from(link, side);
      if (!ring) continue;
      for (const auto each : *ring) taken[each] = 1;
      rings.push_back(std::move(*ring));
      break;
    }
  }
  return rings;
}

/// The direction that all normals of a ring make one angle with: the one in which they differ least.
Vec3d FaceShapes::axis_of(const Ring& ring) const {
  Vec3d mean(0.0);
  for (const auto facet : ring) mean += normal_[facet] / static_cast<double>(ring.size());
  openvdb::math::Mat3d squares = openvdb::math::Mat3d::zero(), axes;
  for (const auto facet : ring) add_square(normal_[facet] - mean, squares);
  Vec3d sizes;
  openvdb::math::diagonalizeSymmetricMatrix(squares, axes, sizes);
  const int least = sizes[0] < sizes[1] ? (sizes[0] < sizes[2] ? 0 : 2) : (sizes[1] < sizes[2] ? 1 : 2);
  return axes.col(least).unit();
}

/// Whether the normals of a ring make one angle with its axis, and go around it once.
bool FaceShapes::is_round(const Ring& ring) const {
  if (ring.size() < kFewestSides) return false;
  const Vec3d axis = axis_of(ring);
  const double height = axis.dot(normal_[ring[0]]);
  double turned = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (std::abs(axis.dot(normal_[ring[i]]) - height) > kOneAngle) return false;
    const Vec3d a = normal_[ring[i]] - axis * axis.dot(normal_[ring[i]]), &n = normal_[ring[(i + 1) % ring.size()]],
                b = n - axis * axis.dot(n);
    turned += std::atan2(axis.dot(a.cross(b)), a.dot(b));
  }
  return std::abs(std::abs(turned) - 2 * std::numbers::pi) < kOneAngle;
}

std::vector<Vec3d> FaceShapes::corners_of(const Ring& ring) const {
  std::vector<Vec3d> corners;
  for (const auto facet : ring)
    for (const auto f : faces_[facet])
      for (const auto v : mesh_.face(f)) corners.push_back(mesh_.positions[v]);
  return corners;
}

double FaceShapes::diameter_of(const Ring& ring) const {
  const Vec3d axis = axis_of(ring);
  const std::vector<Vec3d> corners = corners_of(ring);
  const auto across = [&](const Vec3d& x) { return x - axis * axis.dot(x); };
  Vec3d middle(0.0);
  for (const Vec3d& corner : corners) middle += corner / static_cast<double>(corners.size());
  openvdb::math::Mat3d squares = openvdb::math::Mat3d::zero();
  Vec3d right(0.0), centre;
  const bool is_cylinder = std::abs(axis.dot(normal_[ring[0]])) < kCylinder;
  if (is_cylinder) {
    // The centre of a circle: |x - c|^2 is the same for all corners.
    double mean = 0;
    for (const Vec3d& corner : corners)
      mean += across(corner - middle).lengthSqr() / static_cast<double>(corners.size());
    for (const Vec3d& corner : corners) {
      const Vec3d x = across(corner - middle);
      add_square(x, squares);
      right += x * ((x.lengthSqr() - mean) / 2);
    }
  } else {
    // The tip: where the planes of all facets meet.
    for (const auto facet : ring) {
      const Vec3d& n = normal_[facet];
      add_square(n, squares);
      right += n * n.dot(mesh_.positions[mesh_.face(faces_[facet][0])[0]] - middle);
    }
  }
  centre = middle + solve(squares, right);
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const Vec3d& corner : corners) {
    const double diameter = 2 * across(corner - centre).length();
    least = std::min(least, diameter);
    most = std::max(most, diameter);
  }
  const bool has_tip = least < kOneFacet * most;
  return is_cylinder || has_tip ? most : least;
}

std::vector<RoundHole> FaceShapes::holes() const {
  std::vector<RoundHole> holes;
  for (const Ring& ring : rings(-1)) {
    RoundHole hole{{}, diameter_of(ring)};
    for (const auto facet : ring) hole.faces.insert(hole.faces.end(), faces_[facet].begin(), faces_[facet].end());
    holes.push_back(std::move(hole));
  }
  return holes;
}

}  // namespace vdb_offset::io
