#include "vdb_offset/limit/live_area.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vdb_offset/base/parallel.h"

namespace vdb_offset {
namespace {

// Of the way from a corner to the centre of its face, or to another corner: what stands for the corner's third.
constexpr double kInThird = 0.6;

// Of area that is not live, but may well reach its distance by sliding.
constexpr double kOfDead = 0.01;

// Nothing of the front is nearer to an image than this share of the distance.
constexpr double kLive = 1 - 1e-9;

// Where on such a way the live part begins is found to a small part of it.
constexpr int kStakeHalvings = 12;

constexpr std::size_t kMostPlaces = 8;

}  // namespace

LiveArea::LiveArea(const ConstrainedSurface& constrained, const Distances& distances)
    : constrained_(constrained),
      surface_(constrained.surface),
      distances_(distances),
      stake_(constrained.surface.vertices.size(), -1.0) {
  for (std::uint32_t t = 0; t < surface_.triangles.size(); ++t)
    if (counts(t)) whole_area_ += area_of(t);
}

bool LiveArea::counts(std::uint32_t t) const {
  return constrained_.is_front(t) && surface_.triangle_normals[t].lengthSqr() > 0;
}

double LiveArea::area_of(std::uint32_t t) const {
  const auto& [a, b, c] = surface_.triangles[t];
  const auto& x = surface_.vertices;
  return (x[b] - x[a]).cross(x[c] - x[a]).length() / 2;
}

double LiveArea::area(std::uint32_t v) const {
  double area = 0;
  for (const auto t : surface_.triangles_around(v))
    if (counts(t)) area += area_of(t) / 3;
  return area;
}

void LiveArea::measure(const Indices& vertices) {
  for_each_index(
      vertices.size(),
      [&](std::size_t i) {
        double& stake = stake_[vertices[i]];
        if (stake < 0) stake = find(vertices[i]);
      },
      16);
}

double LiveArea::find(std::uint32_t v) const {
  if (!constrained_.on_front(v) || distances_[v] == 0) return 0;
  double stake = 0;
  std::uint32_t hint = constrained_.hint(v);
  for (const auto t : surface_.triangles_around(v))
    if (counts(t)) {
      const Vec3d inward = (centre(t) - surface_.vertices[v]) * kInThird;
      stake += area_of(t) / 3 * (image(v, t, inward, hint).live ? 1 : kOfDead);
    }
  return stake;
}

Vec3d LiveArea::centre(std::uint32_t t) const {
  const auto& [a, b, c] = surface_.triangles[t];
  return (surface_.vertices[a] + surface_.vertices[b] + surface_.vertices[c]) / 3.0;
}

/// Of the point of a triangle that is so far from a vertex.
LiveArea::Image LiveArea::image(std::uint32_t v, std::uint32_t t, const Vec3d& way, std::uint32_t& hint) const {
  const Vec3d place = surface_.vertices[v] + way + surface_.triangle_normals[t] * distances_[v];
  const Closest closest = constrained_.front(place, hint);
  hint = closest.triangle;
  return {place, closest.distance >= std::abs(distances_[v]) * kLive};
}

bool LiveArea::is_at_border(std::uint32_t v) const {
  const auto& conormals = constrained_.front.surface().conormals;
  const std::uint32_t on_front = constrained_.front_vertex.empty() ? v : constrained_.front_vertex[v];
  return !conormals.empty() && conormals[on_front] != Vec3d(0.0);
}

/// As many run along each edge to one side as to the other, borders aside.
bool LiveArea::faces_agree(std::uint32_t v) const {
  std::vector<std::pair<std::uint32_t, int>> ends;
  for (const auto t : surface_.triangles_around(v))
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t from = surface_.triangles[t][k], to = surface_.triangles[t][(k + 1) % 3];
      if (from == v) ends.emplace_back(to, 1);
      if (to == v) ends.emplace_back(from, -1);
    }
  std::sort(ends.begin(), ends.end());
  for (std::size_t i = 0, next = 0; i < ends.size(); i = next) {
    int sum = 0;
    for (; next < ends.size() && ends[next].first == ends[i].first; ++next) sum += ends[next].second;
    if (sum != 0 && next - i > 1) return false;
  }
  return true;
}

std::vector<Vec3d> LiveArea::ends_of_lines(std::uint32_t v, std::uint32_t t, Lines lines) const {
  if (lines == Lines::All || !is_at_border(v)) return {centre(t)};
  std::vector<Vec3d> ends;
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t edge = 3 * t + k, from = surface_.from(edge), to = surface_.to(edge);
    if (surface_.next_around_edge[edge] == edge && (from == v || to == v))
      ends.push_back(surface_.vertices[from == v ? to : from]);
  }
  return ends;
}

std::optional<Vec3d> LiveArea::first_live(std::uint32_t v, std::uint32_t t, const Vec3d& way,
                                          std::uint32_t& hint) const {
  Image found = image(v, t, way * kInThird, hint);
  if (!found.live) return std::nullopt;
  if (const Image at_vertex = image(v, t, Vec3d(0.0), hint); at_vertex.live) return at_vertex.place;
  double dead = 0, live = kInThird;
  for (int i = 0; i < kStakeHalvings; ++i) {
    const double middle = (dead + live) / 2;
    const Image there = image(v, t, way * middle, hint);
    (there.live ? live : dead) = middle;
    if (there.live) found = there;
  }
  return found.place;
}

std::vector<Vec3d> LiveArea::places(std::uint32_t v, Lines lines) const {
  std::vector<Vec3d> places;
  if (!faces_agree(v)) return places;
  std::vector<std::pair<double, std::uint32_t>> faces;
  for (const auto t : surface_.triangles_around(v))
    if (counts(t)) faces.emplace_back(-area_of(t), t);
  std::sort(faces.begin(), faces.end());
  std::uint32_t hint = constrained_.hint(v);
  for (const auto& [area, t] : faces)
    for (const Vec3d& end : ends_of_lines(v, t, lines)) {
      if (places.size() == kMostPlaces) return places;
      if (const auto place = first_live(v, t, end - surface_.vertices[v], hint)) places.push_back(*place);
    }
  return places;
}

}  // namespace vdb_offset
