// SPDX-License-Identifier: Apache-2.0
#include "hold/hold_back.h"

#include <Geom_Plane.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "hold/smooth_edges.h"
#include "judge/triangle_boxes.h"

namespace vdb_offset::cad {
namespace {

// Not measured, but chosen: what they trade is room that is lost near fronts that meet against smooth, small splines.
constexpr double kSpacing = 1.0 / 3;  // of fields, of the largest distance
constexpr double kMargin = 0.98;      // of the way to where fronts meet
constexpr double kSteps = 64;        // from a share to twice as much, to which it is rounded down: flat parts stay flat
constexpr double kBeyond = 2;        // how far what holds a face holds it beyond its sharp edges, in its distances
constexpr double kMostPlaces = 1e6;  // that may be looked at
constexpr double kDeflection = 0.01;  // of the largest distance
constexpr double kAngle = 0.3;        // between normals at neighbouring corners, in radians
// Fronts that come towards each other, by the cosine between their outsides: of faces that are told to hold each other
// as they lie opposite, and where those that do can meet.
constexpr double kOpposite = -0.5, kAside = 0.2;

std::array<int, 2> ordered(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

Soup source_soup(const HoldRequest& request) {
  const double deflection = kDeflection * request.largest;
  return {request.source, deflection, deflection, kAngle};
}

bool is_flat(const Soup::Face& face) { return !Handle(Geom_Plane)::DownCast(face.surface).IsNull(); }

double rounded_down(double share) {
  int exponent = 0;
  const double part = std::frexp(share, &exponent);  // of 0.5 to 1
  return std::ldexp(std::floor(kSteps * 2 * part) / (kSteps * 2), exponent);
}

/// The distance that is farthest from 0 on a triangle, as far as points all over it show.
double most_on(const FaceDistance& distance, const Soup::Triangle& triangle) {
  constexpr int kDivisions = 12;
  if (!distance.at) return distance.constant;
  double most = 0;
  for (int i = 0; i <= kDivisions; ++i)
    for (int j = 0; i + j <= kDivisions; ++j) {
      const double a = static_cast<double>(i) / kDivisions, b = static_cast<double>(j) / kDivisions;
      const gp_XY uv = triangle.uv[0].XY() * (1 - a - b) + triangle.uv[1].XY() * a + triangle.uv[2].XY() * b;
      const double here = distance(uv.X(), uv.Y());
      if (std::abs(here) > std::abs(most)) most = here;
    }
  return most;
}

/// So that no more places than may be are looked at: parts of triangles are halved until they are small enough, to a
/// fourth of the square of their longest side.
double spacing_for(const Soup& soup, double largest) {
  double area = 0;
  for (const Soup::Triangle& t : soup.triangles()) area += normal_of(t).Magnitude() / 2;
  return std::max(kSpacing * largest, std::sqrt(4 * area / kMostPlaces) / HeldField::kSampling);
}

}  // namespace

/// What has been told of a face.
struct HoldBack::HeldFace {
  std::vector<SourcePlace> places;  // that are held back
  double least = 1;                 // the least share
  double even = 1;                  // the share that one of what is opposite leaves to all of the face
};

HoldBack::HoldBack(HoldRequest request)
    : request_(std::move(request)), soup_(source_soup(request_)), spacing_(spacing_for(soup_, request_.largest)) {
  const std::size_t faces = soup_.faces().size();
  piece_ = smooth_pieces(smooth_edges(request_.source), faces);
  triangles_.resize(faces);
  most_.resize(faces, 0);
  sign_.resize(faces, 1);
  for (std::size_t t = 0; t < soup_.triangles().size(); ++t) {
    const Soup::Triangle& triangle = soup_.triangles()[t];
    const auto face = static_cast<std::size_t>(triangle.face);
    triangles_[face].push_back(static_cast<int>(t));
    const double most = most_on(request_.distances[face], triangle);
    if (std::abs(most) <= most_[face]) continue;
    most_[face] = std::abs(most);
    sign_[face] = most < 0 ? -1 : 1;
  }
  find_neighbours();
  find_miters();
  find_facing();
}

/// Which faces share a vertex, and which sides of their triangles they share smoothly.
void HoldBack::find_neighbours() {
  TopTools_IndexedMapOfShape faces;
  std::vector<int> numbers;  // of each face of that map
  int count = 0;
  for (TopExp_Explorer face(request_.source, TopAbs_FACE); face.More(); face.Next(), ++count)
    if (faces.Add(face.Current()) > static_cast<int>(numbers.size())) numbers.push_back(count);
  TopTools_IndexedDataMapOfShapeListOfShape vertices;
  TopExp::MapShapesAndUniqueAncestors(request_.source, TopAbs_VERTEX, TopAbs_FACE, vertices);
  for (int v = 1; v <= vertices.Extent(); ++v)
    for (const TopoDS_Shape& one : vertices(v))
      for (const TopoDS_Shape& other : vertices(v)) {
        const int a = numbers[static_cast<std::size_t>(faces.FindIndex(one) - 1)],
                  b = numbers[static_cast<std::size_t>(faces.FindIndex(other) - 1)];
        if (a < b) neighbours_.insert({a, b});
      }
  for (const Soup::Triangle& triangle : soup_.triangles())
    for (int k = 0; k < 3; ++k) {
      if (!triangle.is_border[k]) continue;
      const std::array<int, 2> side = ordered(triangle.nodes[(k + 1) % 3], triangle.nodes[(k + 2) % 3]);
      const auto number = static_cast<int>(&triangle - soup_.triangles().data());
      const auto [at, is_new] = sides_.emplace(side, std::array{number, -1});
      if (is_new) continue;
      at->second[1] = number;
      const auto piece = [&](int t) { return piece_[static_cast<std::size_t>(soup_.triangles()[t].face)]; };
      if (piece(at->second[0]) == piece(number)) joints_.insert(side);
    }
}

/// What the miters of sharp edges add to the faces: strips within their planes.
void HoldBack::find_miters() {
  std::vector<gp_Pnt> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<int> faces;
  for (const auto& [side, both] : sides_) {
    if (both[1] < 0 || joints_.contains(side)) continue;
    for (const int own : {0, 1}) {
      const Soup::Triangle& t = soup_.triangles()[static_cast<std::size_t>(both[own])];
      const Soup::Triangle& other = soup_.triangles()[static_cast<std::size_t>(both[1 - own])];
      int k = 0;  // the corner across from the side
      while (ordered(t.nodes[(k + 1) % 3], t.nodes[(k + 2) % 3]) != side) ++k;
      const gp_Pnt &p = t.points[(k + 1) % 3], &q = t.points[(k + 2) % 3];
      const gp_Vec n = normal_of(t), m = normal_of(other);
      const gp_Vec away = gp_Vec(p, q).Crossed(n);
      if (n.Magnitude() == 0 || m.Magnitude() == 0 || away.Magnitude() == 0) continue;
      // Two planes that go as far meet at a tangent of half the angle between their outsides.
      const auto face = static_cast<std::size_t>(t.face), beside = static_cast<std::size_t>(other.face);
      const bool grows = (away.Dot(m) > 0) == (sign_[beside] > 0);
      const double reach = std::min(std::tan(n.Angle(m) / 2), kBeyond) * std::max(most_[face], most_[beside]);
      if (!grows || most_[beside] == 0 || reach <= 0) continue;
      const gp_Vec out = away.Normalized() * reach;
      const auto first = static_cast<std::uint32_t>(points.size());
      points.insert(points.end(), {p, q, q.Translated(out), p.Translated(out)});
      triangles.push_back({first, first + 2, first + 1});
      triangles.push_back({first, first + 3, first + 2});
      faces.insert(faces.end(), 2, t.face);
    }
  }
  miters_.emplace(points, triangles, faces);
}

/// Finds the faces whose fronts come towards each other.
void HoldBack::find_facing() {
  for (std::size_t face = 0; face < triangles_.size(); ++face) {
    if (most_[face] == 0) continue;
    std::vector<char> others(triangles_.size(), 1);
    for (std::size_t other = 0; other < others.size(); ++other) {
      const auto a = static_cast<int>(face), b = static_cast<int>(other);
      if (neighbours_.contains(ordered(a, b)) || pairs_.contains(ordered(a, b))) others[other] = 0;
    }
    const double keep = 2 * kDeflection * request_.largest;
    const Opposite opposite{&soup_, &others, request_.largest / most_[face], keep, kOpposite};
    const double far = keep + (most_[face] + request_.largest) / kMargin;
    const double sign = sign_[face];
    for (const int t : triangles_[face])
      visit_triangle(soup_, t, HeldField::kSampling * spacing_, far, opposite, [&](const SourcePlace& at) {
        const Room room = room_along(at.point, at.outside * sign, at.outside, most_[face] / kMargin, opposite);
        if (room.triangle < 0) return;
        const int other = soup_.triangles()[static_cast<std::size_t>(room.triangle)].face;
        pairs_.insert(ordered(static_cast<int>(face), other));
        others[static_cast<std::size_t>(other)] = 0;  // which need not be found again
      });
  }
}

bool HoldBack::add(const std::vector<std::array<int, 2>>& pairs) {
  bool is_new = false;
  for (const std::array<int, 2>& pair : pairs)
    if (!neighbours_.contains(pair)) is_new = pairs_.insert(pair).second || is_new;
  return is_new;
}

/// What holds a face back, and how far it goes itself: faces that are as fast together. \param masks which faces each
/// is of; has to outlive them
std::vector<Opposite> HoldBack::opposites_of(std::size_t face, Masks& masks) const {
  for (const std::array<int, 2>& pair : pairs_) {
    const auto own = static_cast<int>(face);
    if (pair[0] != own && pair[1] != own) continue;
    const auto other = static_cast<std::size_t>(pair[0] == own ? pair[1] : pair[0]);
    const bool comes = sign_[other] == sign_[face];
    // Triangles lie beside curved faces.
    const int curved = !is_flat(soup_.faces()[face]) + !is_flat(soup_.faces()[other]);
    auto& mask = masks[{comes ? most_[other] / most_[face] : 0, curved * kDeflection * request_.largest}];
    mask.resize(triangles_.size(), 0);
    mask[other] = 1;
  }
  std::vector<Opposite> opposites;
  opposites.reserve(2 * masks.size() + 1);
  for (const auto& [key, mask] : masks)
    for (const Soup* const soup : {&soup_, &*miters_}) opposites.push_back({soup, &mask, key[0], key[1], kAside});
  if (request_.obstacles) {
    const double beside = is_flat(soup_.faces()[face]) ? 0 : kDeflection * request_.largest;
    opposites.push_back({request_.obstacles, nullptr, 0, request_.clearance + beside, 1});
  }
  return opposites;
}

/// Samples a face, and lowers the field where an opposite face leaves less room.
void HoldBack::constrain(std::size_t face, HeldField& field, HeldFace& held) {
  if (most_[face] == 0) return;
  Masks masks;
  for (const Opposite& each : opposites_of(face, masks)) {
    const double far = each.keep + (1 + each.speed) * most_[face] / kMargin;
    bool is_all = true;
    double least = 1, most = 0;  // shares
    std::vector<std::pair<SourcePlace, double>> told;
    for (const int t : triangles_[face]) {
      const auto visit = [&](const SourcePlace& at) {
        const double share = share_at(face, at, each);
        least = std::min(least, share);
        most = std::max(most, share);
        if (share < 1) told.emplace_back(at, share);
      };
      if (!visit_triangle(soup_, t, HeldField::kSampling * spacing_, far, each, visit)) is_all = false;
    }
    held.least = std::min(held.least, least);
    // A face that is held back alike, but for the steps of shares, stays what it is.
    const bool is_even = is_all && least * (1 + 2.5 / kSteps) >= most;
    if (is_even) held.even = std::min(held.even, least);
    for (auto& [at, share] : told) {
      if (is_even) share = least;
      field.lower(at.point, share);
      constrain_beyond(at, share, most_[face], field);
      held.places.push_back(at);
    }
  }
}

/// What share of its distance a point of a face may go.
double HoldBack::share_at(std::size_t face, const SourcePlace& at, Opposite opposite) const {
  const double distance = request_.distances[face](at.uv.X(), at.uv.Y()), length = std::abs(distance);
  if (length == 0) return 1;
  opposite.speed *= most_[face] / length;
  const Room room = room_along(at.point, at.outside * (distance < 0 ? -1 : 1), at.outside, length / kMargin, opposite);
  return room.length >= length / kMargin ? 1 : rounded_down(kMargin * room.length / length);
}

/// Goes on where the face ends and is drawn out to meet others.
void HoldBack::constrain_beyond(const SourcePlace& at, double share, double most, HeldField& field) const {
  const Soup::Triangle& t = soup_.triangles()[static_cast<std::size_t>(at.triangle)];
  const double apart = HeldField::kSampling * spacing_;
  for (int k = 0; k < 3; ++k) {
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    if (!t.is_border[k] || joints_.contains(ordered(t.nodes[a], t.nodes[b]))) continue;
    const gp_Vec side(t.points[a], t.points[b]), to(t.points[a], at.point);
    const double length = side.Magnitude();
    if (length == 0 || side.Crossed(to).Magnitude() > apart * length) continue;
    const gp_Vec along = side / length;
    gp_Vec away = gp_Vec(t.points[k], t.points[a]);
    away -= along * away.Dot(along);
    if (away.Magnitude() == 0) continue;
    away.Normalize();
    for (const double aside : {-1.0, 0.0, 1.0}) {
      const gp_Vec way = (away + along * aside).Normalized();
      for (double gone = apart; gone <= kBeyond * most; gone += apart)
        field.lower(at.point.Translated(way * gone), share);
    }
  }
}

/// Whether places of other faces of the piece may hold a face that has none.
bool HoldBack::is_reached(std::size_t face, const std::vector<HeldFace>& all) const {
  std::vector<char> mask(triangles_.size(), 0);
  mask[face] = 1;
  const double reach = HeldField::kFarthest * spacing_;
  for (std::size_t other = 0; other < all.size(); ++other) {
    if (piece_[other] != piece_[face]) continue;
    for (const SourcePlace& at : all[other].places) {
      if (soup_.has_near(at.point, reach, {&mask, at.outside, 1})) return true;
    }
  }
  return false;
}

FaceDistance HoldBack::held_distance(std::size_t face, const std::shared_ptr<const HeldField>& field,
                                     const HeldFace& held) const {
  const FaceDistance& own = request_.distances[face];
  if (!own.at && !held.places.empty() && held.even == held.least) {
    const bool is_same = std::all_of(held.places.begin(), held.places.end(), [&](const SourcePlace& at) {
      return field->is_even_around(at.point, held.least);
    });
    if (is_same) return {own.constant * held.least, {}, own.detail};
  }
  FaceDistance distance;
  distance.detail = own.detail > 0 ? std::min(own.detail, spacing_) : spacing_;
  distance.at = [own, field, surface = soup_.faces()[face].surface](double u, double v) {
    return own(u, v) * (*field)(surface->Value(u, v));
  };
  return distance;
}

std::vector<FaceDistance> HoldBack::distances() {
  std::vector<FaceDistance> result = request_.distances;
  std::vector<HeldFace> all(result.size());
  std::map<std::size_t, std::shared_ptr<HeldField>> fields;  // of each piece
  held_ = 0;
  least_ = 1;
  for (std::size_t face = 0; face < result.size(); ++face) {
    auto& field = fields[piece_[face]];
    if (!field) field = std::make_shared<HeldField>(spacing_);
    constrain(face, *field, all[face]);
  }
  for (std::size_t face = 0; face < result.size(); ++face) {
    const std::shared_ptr<HeldField>& field = fields[piece_[face]];
    if (field->is_empty() || (all[face].places.empty() && !is_reached(face, all))) continue;
    result[face] = held_distance(face, field, all[face]);
    ++held_;
    least_ = std::min(least_, all[face].least);
  }
  return result;
}

}  // namespace vdb_offset::cad
