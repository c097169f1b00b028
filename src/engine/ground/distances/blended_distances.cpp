// SPDX-License-Identifier: Apache-2.0
// One distance for each vertex, from those that faces ask for at their corners.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "ground/distances/part_weight.h"
#include "ground/numbers/box_tree.h"
#include "ground/system/parallel.h"
#include "vdb_offset/distances.h"
#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

// The first box in which an edge is looked for, as a share of the blend; then it is doubled. Not measured.
constexpr double kFirstReach = 1.0 / 64;

/// A piece of the edge of a zone, and the zone's distances at its ends.
struct EdgeOfZone {
  Vec3d start, end;
  double at_start, at_end;
};

/// The faces of a part within one piece.
struct Zone {
  std::uint32_t piece = 0;
  std::vector<EdgeOfZone> edge;  ///< Where it meets others of its piece.
  BoxTree tree;                  ///< Of those.
};

/// The distances of the corners that a zone has at a place.
struct Share {
  std::uint32_t zone;
  double first, sum;
  std::size_t count = 1;
  bool agree = true;

  void add(double distance) {
    agree = agree && distance == first;
    sum += distance;
    ++count;
  }
  /// Where all agree, theirs to the last bit.
  double mean() const { return agree ? first : sum / static_cast<double>(count); }
};

FloatBox box_around(const Vec3d& a, const Vec3d& b, double reach) {
  FloatBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto i = static_cast<int>(k);
    box.lower[k] = std::nextafter(static_cast<float>(std::min(a[i], b[i]) - reach), -FloatBox::kInfinity);
    box.upper[k] = std::nextafter(static_cast<float>(std::max(a[i], b[i]) + reach), FloatBox::kInfinity);
  }
  return box;
}

class VertexBlend {
 public:
  VertexBlend(PolygonView mesh, const FaceDistances& faces) : mesh_(mesh), faces_(faces) {
    find_places();
    find_zones();
    find_shares();
    if (faces.blend > 0) find_edges();
  }

  Distances distances() const {
    std::vector<double> of_place(position_.size(), 0.0), of_share(shares_.size(), 0.0), each(place_.size(), 0.0);
    for_each_index(
        of_place.size(), [&](std::size_t place) { of_place[place] = settle(place, of_share); }, 64);
    for (std::size_t v = 0; v < each.size(); ++v) each[v] = of_place[place_[v]];
    std::vector<double> at_corner(mesh_.corners.size());
    bool differ = false;
    for (std::size_t f = 0; f < mesh_.face_count(); ++f)
      for (std::uint32_t c = mesh_.face_begin[f]; c < mesh_.face_begin[f + 1]; ++c) {
        const std::uint32_t place = place_[mesh_.corners[c]];
        at_corner[c] = of_share[share_of(place, zone_of_[f])];
        differ |= at_corner[c] != of_place[place];
      }
    if (differ) return {std::move(each), std::move(at_corner)};
    if (!each.empty() && std::all_of(each.begin(), each.end(), [&](double d) { return d == each.front(); }))
      return each.front();
    return Distances(std::move(each));
  }

 private:
  /// Vertices at one position are at one place.
  void find_places() {
    std::vector<std::uint32_t> order(mesh_.positions.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto less = [&](std::uint32_t a, std::uint32_t b) { return mesh_.positions[a] < mesh_.positions[b]; };
    std::sort(order.begin(), order.end(), less);
    place_.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (i == 0 || mesh_.positions[order[i]] != mesh_.positions[order[i - 1]])
        position_.push_back(mesh_.positions[order[i]]);
      place_[order[i]] = static_cast<std::uint32_t>(position_.size() - 1);
    }
  }

  std::uint32_t piece_of(std::size_t face) const { return faces_.piece.empty() ? 0 : faces_.piece[face]; }

  void find_zones() {
    std::vector<std::array<std::uint32_t, 2>> known;
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) known.push_back({piece_of(f), faces_.part[f]});
    std::vector<std::array<std::uint32_t, 2>> sorted = known;
    std::sort(sorted.begin(), sorted.end());
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    for (const auto& each : known)
      zone_of_.push_back(
          static_cast<std::uint32_t>(std::lower_bound(sorted.begin(), sorted.end(), each) - sorted.begin()));
    for (const auto& each : sorted) zones_.push_back({each[0], {}, {}});
  }

  void find_shares() {
    std::vector<std::vector<Share>> of_place(position_.size());
    for (std::size_t f = 0; f < mesh_.face_count(); ++f)
      for (std::uint32_t c = mesh_.face_begin[f]; c < mesh_.face_begin[f + 1]; ++c) {
        std::vector<Share>& own = of_place[place_[mesh_.corners[c]]];
        const auto at =
            std::find_if(own.begin(), own.end(), [&](const Share& share) { return share.zone == zone_of_[f]; });
        if (at == own.end()) own.push_back({zone_of_[f], faces_.at_corner[c], faces_.at_corner[c]});
        else at->add(faces_.at_corner[c]);
      }
    share_begin_.push_back(0);
    for (const std::vector<Share>& own : of_place) {
      shares_.insert(shares_.end(), own.begin(), own.end());
      share_begin_.push_back(shares_.size());
    }
  }

  std::size_t share_of(std::size_t place, std::uint32_t zone) const {
    std::size_t at = share_begin_[place];
    while (shares_[at].zone != zone) ++at;
    return at;
  }

  std::span<const Share> shares(std::size_t place) const {
    return std::span(shares_).subspan(share_begin_[place], share_begin_[place + 1] - share_begin_[place]);
  }

  /// An edge of a mesh's face, between places.
  struct Side {
    std::array<std::uint32_t, 2> places;  // the lower first
    std::uint32_t zone;
    bool operator==(const Side& other) const { return places == other.places && zone == other.zone; }
    bool operator<(const Side& other) const {
      return places != other.places ? places < other.places : zone < other.zone;
    }
  };

  void find_edges() {
    std::vector<Side> sides;
    for (std::size_t f = 0; f < mesh_.face_count(); ++f) {
      const auto corners = mesh_.face(f);
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const std::uint32_t a = place_[corners[k]], b = place_[corners[(k + 1) % corners.size()]];
        sides.push_back({{std::min(a, b), std::max(a, b)}, zone_of_[f]});
      }
    }
    std::sort(sides.begin(), sides.end());
    sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
    for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
      for (end = begin; end < sides.size() && sides[end].places == sides[begin].places;) ++end;
      for (std::size_t i = begin; i < end; ++i)
        for (std::size_t k = begin; k < end; ++k)
          if (i != k && zones_[sides[i].zone].piece == zones_[sides[k].zone].piece) {
            add_edge(sides[i]);
            break;
          }
    }
    for (Zone& zone : zones_)
      if (!zone.edge.empty())
        zone.tree.build(zone.edge.size(),
                        [&](std::size_t i) { return box_around(zone.edge[i].start, zone.edge[i].end, 0); });
  }

  void add_edge(const Side& side) {
    const auto own = [&](std::uint32_t place) {
      const auto all = shares(place);
      return std::find_if(all.begin(), all.end(), [&](const Share& share) { return share.zone == side.zone; })->mean();
    };
    const auto [a, b] = side.places;
    zones_[side.zone].edge.push_back({position_[a], position_[b], own(a), own(b)});
  }

  /// How far a point is from the edge of a zone, and the zone's distance at the closest point; nothing beyond the
  /// blend.
  std::optional<std::array<double, 2>> closest_on_edge(const Zone& zone, const Vec3d& p) const {
    if (zone.edge.empty()) return std::nullopt;
    std::optional<std::array<double, 2>> closest;
    for (double reach = kFirstReach * faces_.blend; !closest; reach = std::min(2 * reach, faces_.blend)) {
      zone.tree.for_each_overlap(box_around(p, p, reach), [&](std::size_t i) {
        const auto& [start, end, at_start, at_end] = zone.edge[i];
        const Vec3d way = end - start;
        const double along = std::clamp(way.dot(p - start) / std::max(way.lengthSqr(), 1e-300), 0.0, 1.0);
        const double away = (start + way * along - p).length();
        if (away <= reach && (!closest || away < (*closest)[0]))
          closest = {{away, at_start + (at_end - at_start) * along}};
      });
      if (reach == faces_.blend) break;
    }
    return closest;
  }

  /// The distance of a place, and those of the corners that zones have there.
  double settle(std::size_t place, std::vector<double>& of_share) const {
    const auto own = shares(place);
    if (own.empty()) return 0;
    // Where no pieces are given, parts may meet at a sharp edge as well.
    const bool may_part = faces_.piece.empty() && faces_.blend == 0;
    double sum = 0;
    std::size_t pieces = 0;
    for (std::size_t i = 0; i < own.size(); ++i) {
      const std::uint32_t piece = zones_[own[i].zone].piece;
      const auto is_of_piece = [&](const Share& share) { return zones_[share.zone].piece == piece; };
      if (std::any_of(own.begin(), own.begin() + static_cast<std::ptrdiff_t>(i), is_of_piece)) continue;
      const double of_piece = blended(place, piece);
      sum += of_piece;
      ++pieces;
      for (std::size_t k = i; k < own.size(); ++k)
        if (is_of_piece(own[k])) of_share[share_begin_[place] + k] = may_part ? own[k].mean() : of_piece;
    }
    return sum / static_cast<double>(pieces);
  }

  double blended(std::size_t place, std::uint32_t piece) const {
    double sum = 0, weights = 0;
    for (std::uint32_t z = 0; z < zones_.size(); ++z) {
      if (zones_[z].piece != piece) continue;
      const auto own = shares(place);
      const auto at = std::find_if(own.begin(), own.end(), [&](const Share& share) { return share.zone == z; });
      if (at != own.end()) {
        sum += at->mean();
        weights += 1;
      } else if (const auto closest = closest_on_edge(zones_[z], position_[place])) {
        const double weight = part_weight((*closest)[0] / faces_.blend);
        sum += weight * (*closest)[1];
        weights += weight;
      }
    }
    return sum / weights;
  }

  PolygonView mesh_;
  const FaceDistances& faces_;
  std::vector<std::uint32_t> place_;    // of each vertex
  std::vector<Vec3d> position_;         // of each place
  std::vector<std::uint32_t> zone_of_;  // of each face
  std::vector<Zone> zones_;
  std::vector<Share> shares_;
  std::vector<std::size_t> share_begin_;
};

}  // namespace

Distances vertex_distances(PolygonView mesh, const FaceDistances& faces) {
  const auto require_for_all = [](const char* what, std::size_t expected, std::size_t found) {
    if (expected != found)
      throw InvalidInput(fmt::format("face distances: expected {} for each of {}, got {}", what, expected, found));
  };
  require_for_all("a distance", mesh.corners.size(), faces.at_corner.size());
  require_for_all("a part", mesh.face_count(), faces.part.size());
  if (!faces.piece.empty()) require_for_all("a piece", mesh.face_count(), faces.piece.size());
  if (!(faces.blend >= 0) || !std::isfinite(faces.blend))
    throw InvalidInput(fmt::format("face distances: expected a blend of 0 or more, got {}", faces.blend));
  return VertexBlend(mesh, faces).distances();
}

}  // namespace vdb_offset
