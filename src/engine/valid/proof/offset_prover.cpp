// SPDX-License-Identifier: Apache-2.0
#include "valid/proof/offset_prover.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace vdb_offset {
namespace {

// Pieces of one triangle that are looked at before it is left open. Not measured: smooth surfaces need fewer than ten.
constexpr int kMostPieces = 8000;
// How often a piece may be halved. Reasoned: its edges are a millionth then; what is that near to the tolerance is
// left open.
constexpr int kMostHalvings = 40;
// Share of a distance that rounding may cost in what is compared here. Reasoned: far above that of doubles, and far
// below the tolerance to which vertices are put at their distance.
constexpr double kProofRounding = 1e-11;
// Triangles of the surface that are tried as the one that no point is too far from. Not measured.
constexpr std::size_t kMostWitnesses = 4;

}  // namespace

/// The pieces of one triangle. Lists of triangles of the surface are kept on a stack, those of a piece behind those of
/// the piece that it is a half of.
class OffsetProver::Recursion {
 public:
  explicit Recursion(const ClosestQuery& query) : query_(query), surface_(query.surface()) {}

  struct Piece {
    std::array<Vec3d, 3> x;
    std::array<double, 3> asked, tolerance, over_plane;

    Vec3d middle() const { return (x[0] + x[1] + x[2]) / 3.0; }
    double least(int i) const { return asked[i] - tolerance[i] - kProofRounding * asked[i]; }
    double most(int i) const { return asked[i] + tolerance[i] + kProofRounding * asked[i]; }
  };

  Proof prove(const OffsetTriangle& triangle, std::vector<std::uint32_t> near) {
    Piece piece{triangle.corners, triangle.asked, triangle.tolerance, triangle.over_plane};
    may_keep_to_plane_ = triangle.may_keep_to_plane;
    list_ = std::move(near);
    face_away(piece);
    return look_at(piece, 0, list_.size(), false);
  }

 private:
  /// What is known of a triangle of the surface beside a piece.
  struct Near {
    double distance;          // from the piece's middle
    bool is_far_enough;       // no point of the piece is too near to it
    bool may_be_near_enough;  // some point of the piece may be within the tolerance of it
  };

  struct Witness {
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t triangle = kNone;
  };
  /// The nearest few.
  struct Witnesses {
    std::array<Witness, kMostWitnesses> nearest;

    void add(Witness one) {
      for (Witness& other : nearest)
        if (one.distance < other.distance) std::swap(one, other);
    }
  };

  /// Finds the normal of all pieces, away from the surface.
  void face_away(const Piece& whole) {
    normal_ = (whole.x[1] - whole.x[0]).cross(whole.x[2] - whole.x[0]);
    const double length = normal_.length();
    if (!(length > 0) || list_.empty()) return;
    normal_ /= length;
    const Closest closest = query_(whole.middle(), list_.front());
    closest_ = closest.triangle;
    const Vec3d away = whole.middle() - closest.point;
    if (normal_.dot(away) < 0) normal_ = Vec3d(0.0) - normal_;
  }

  Near compare(const Piece& piece, const Vec3d& middle, std::uint32_t t) const {
    const TrianglePoint nearest = surface_.closest_on(t, middle);
    Near near{std::sqrt(nearest.squared_distance), true, false};
    double highest = -std::numeric_limits<double>::infinity();
    for (const auto v : surface_.triangles[t]) highest = std::max(highest, normal_.dot(surface_.vertices[v]));
    bool by_plane = true, by_ball = near.distance > 0, near_by_plane = false, near_by_ball = false;
    const Vec3d away = near.distance > 0 ? (middle - nearest.point) / near.distance : Vec3d(0.0);
    for (int i = 0; i < 3; ++i) {
      const double over_plane = normal_.dot(piece.x[i]) - highest, over_ball = away.dot(piece.x[i] - nearest.point);
      by_plane &= over_plane >= piece.least(i);
      by_ball &= over_ball >= piece.least(i);
      near_by_plane |= over_plane <= piece.most(i);
      near_by_ball |= over_ball <= piece.most(i);
    }
    near.is_far_enough = by_plane || by_ball;
    // By one bound or the other too far from all corners is too far from all points. Too far from one corner by one,
    // and from others by the other, is not.
    near.may_be_near_enough = near_by_plane && near_by_ball;
    return near;
  }

  static bool keeps_to_plane(const Piece& piece) {
    for (int i = 0; i < 3; ++i)
      if (piece.over_plane[i] < piece.least(i) || piece.over_plane[i] > piece.most(i)) return false;
    return true;
  }

  /// Whether a triangle of the surface is so near to all corners that no point in between is too far.
  bool is_witness(const Piece& piece, std::uint32_t t) const {
    for (int i = 0; i < 3; ++i)
      if (surface_.closest_on(t, piece.x[i]).squared_distance > piece.most(i) * piece.most(i)) return false;
    return true;
  }

  /// Whether all of list_[begin .. end) lie so far below the piece's plane that no point is too near, and the triangle
  /// nearest to the whole's middle is a witness. In most cases this settles it, and without the closest points of all
  /// that is near: in a fan, thousands of triangles.
  bool is_proven_by_planes(const Piece& piece, std::size_t begin, std::size_t end, bool none_too_far) const {
    if (closest_ == kNone) return false;
    double highest = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) highest = std::max(highest, piece.least(i) - normal_.dot(piece.x[i]));
    for (std::size_t i = begin; i < end; ++i)
      for (const auto v : surface_.triangles[list_[i]])
        if (normal_.dot(surface_.vertices[v]) > -highest) return false;
    return none_too_far || is_witness(piece, closest_);
  }

  /// Looks at a piece, whose triangles of the surface are list_[begin .. end).
  Proof look_at(const Piece& piece, std::size_t begin, std::size_t end, bool none_too_far) {
    if (++pieces_ > kMostPieces || depth_ > kMostHalvings) return {Certainty::Open, 0};
    none_too_far = none_too_far || (may_keep_to_plane_ && keeps_to_plane(piece));
    if (is_proven_by_planes(piece, begin, end, none_too_far)) return {Certainty::Proven, 0};
    const Vec3d middle = piece.middle();
    double nearest = std::numeric_limits<double>::infinity();
    bool none_too_near = true;
    Witnesses witnesses;
    const std::size_t first = list_.size();
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t t = list_[i];
      const Near near = compare(piece, middle, t);
      nearest = std::min(nearest, near.distance);
      none_too_near &= near.is_far_enough;
      if (near.may_be_near_enough) witnesses.add({near.distance, t});
      if (!near.is_far_enough || (near.may_be_near_enough && !none_too_far)) list_.push_back(t);
    }
    for (const Witness& one : witnesses.nearest)
      none_too_far = none_too_far || (one.triangle != kNone && is_witness(piece, one.triangle));
    Proof proof{Certainty::Proven, 0};
    if (!none_too_near || !none_too_far) {
      proof = judge_middle(piece, middle, nearest, none_too_far);
      if (proof.certainty == Certainty::Proven) {
        // Every other time, as such a part may be thin.
        std::optional<Cut> cut;
        if (!none_too_far && depth_ % 2 == 0 && witnesses.nearest[0].triangle != kNone)
          cut = edge_of_witness(piece, witnesses.nearest[0].triangle);
        proof = look_at_parts(piece, cut.value_or(middle_of_longest(piece)), first, none_too_far);
      }
    }
    list_.resize(first);
    return proof;
  }

  /// Whether the middle of a piece is off. Triangles that are no longer in the list are far enough from all of it.
  Proof judge_middle(const Piece& piece, const Vec3d& middle, double nearest, bool none_too_far) const {
    const auto mean = [](const std::array<double, 3>& of_corners) {
      return (of_corners[0] + of_corners[1] + of_corners[2]) / 3;
    };
    const double asked = mean(piece.asked), allowed = mean(piece.tolerance) + kProofRounding * asked;
    if (!std::isfinite(nearest)) nearest = query_(middle, 0).distance;
    const auto error_at = [&](double distance) {
      const double off = distance - asked;
      return off > 0 && may_keep_to_plane_ ? std::min(off, std::abs(mean(piece.over_plane) - asked)) : std::abs(off);
    };
    if (nearest > asked && none_too_far) return {Certainty::Proven, 0};
    const double error = error_at(nearest);
    if (error <= allowed) return {Certainty::Proven, 0};
    // Of triangles that are all too far, some may be out of the list and nearer than those in it.
    return {Certainty::Off, nearest > asked ? error_at(query_(middle, 0).distance) : error};
  }

  /// Where a piece is parted: on its edge from corner a to b, by the share of b.
  struct Cut {
    int a, b;
    double share;
  };

  static Cut middle_of_longest(const Piece& piece) {
    Cut cut{0, 1, 0.5};
    double length = -1;
    for (int k = 0; k < 3; ++k) {
      const double squared = (piece.x[(k + 1) % 3] - piece.x[k]).lengthSqr();
      if (squared > length) length = squared, cut = {k, (k + 1) % 3, 0.5};
    }
    return cut;
  }

  /// Where the piece leaves what one triangle of the surface is a witness of, on the longest edge that does so well
  /// away from its ends: what lies over several large triangles needs few pieces then. Nothing if no edge does.
  std::optional<Cut> edge_of_witness(const Piece& piece, std::uint32_t t) const {
    constexpr double kLeastShare = 0.02;  // not measured
    constexpr int kHalvings = 12;
    const auto is_near = [&](const Vec3d& x, double most) {
      return surface_.closest_on(t, x).squared_distance <= most * most;
    };
    std::optional<Cut> cut;
    double length = -1;
    for (int a = 0; a < 3; ++a)
      for (const int b : {(a + 1) % 3, (a + 2) % 3}) {
        const double squared = (piece.x[b] - piece.x[a]).lengthSqr();
        if (squared <= length || !is_near(piece.x[a], piece.most(a)) || is_near(piece.x[b], piece.most(b))) continue;
        double near = 0, far = 1;
        for (int i = 0; i < kHalvings; ++i) {
          const double share = (near + far) / 2;
          const bool is_in = is_near(piece.x[a] + (piece.x[b] - piece.x[a]) * share,
                                     piece.most(a) + (piece.most(b) - piece.most(a)) * share);
          (is_in ? near : far) = share;
        }
        if (near < kLeastShare || near > 1 - kLeastShare) continue;
        length = squared;
        cut = Cut{a, b, near};
      }
    return cut;
  }

  /// Looks at both parts of a piece.
  Proof look_at_parts(const Piece& piece, const Cut& cut, std::size_t first, bool none_too_far) {
    const std::size_t end = list_.size();
    const auto between = [&](const auto& of) { return of[cut.a] * (1 - cut.share) + of[cut.b] * cut.share; };
    for (const int moved : {cut.a, cut.b}) {
      Piece part = piece;
      part.x[moved] = between(piece.x);
      part.asked[moved] = between(piece.asked);
      part.tolerance[moved] = between(piece.tolerance);
      part.over_plane[moved] = between(piece.over_plane);
      ++depth_;
      const Proof proof = look_at(part, first, end, none_too_far);
      --depth_;
      if (proof.certainty != Certainty::Proven) return proof;
    }
    return {Certainty::Proven, 0};
  }

  const ClosestQuery& query_;
  const Surface& surface_;
  Vec3d normal_{0.0};
  std::uint32_t closest_ = kNone;  // the triangle of the surface that is nearest to the middle
  std::vector<std::uint32_t> list_;
  bool may_keep_to_plane_ = false;
  int pieces_ = 0, depth_ = 0;
};

Proof OffsetProver::operator()(const OffsetTriangle& triangle) const {
  const auto& [a, b, c] = triangle.corners;
  const Vec3d middle = (a + b + c) / 3.0;
  double radius = 0, most = 0;
  for (int i = 0; i < 3; ++i) {
    radius = std::max(radius, (triangle.corners[i] - middle).length());
    most = std::max(most, triangle.asked[i] + triangle.tolerance[i]);
  }
  // Triangles of the surface that are farther from the middle are too far from all points to count.
  const ClosestQuery::Ball ball{middle, (most + radius) * (1 + kProofRounding)};
  std::vector<std::uint32_t> list;
  query_.collect_together({&ball, 1}, [&](std::size_t, const NearTriangles& near) {
    for (std::size_t i = 0; i < near.size(); ++i) list.push_back(near.triangle(i));
  });
  return Recursion(query_).prove(triangle, std::move(list));
}

}  // namespace vdb_offset
