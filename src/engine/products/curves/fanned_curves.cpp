// SPDX-License-Identifier: Apache-2.0
// Opens the sharp corners of curves. A corner at which two segments meet, and that is convex on the side to which it
// goes, becomes a row of copies, from the normal of the one segment to that of the other. The row is put into one of
// the curves there, in the place of the corner; a curve that ends or begins there takes the copy at its own segment.
#include "products/curves/fanned_curves.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "ground/mesh/miter_point.h"
#include "products/offset/stand_off.h"
#include "space/curve/curve_line.h"

namespace vdb_offset {
namespace {

/// The segments that meet at a point of joined curves.
struct AtPoint {
  std::uint32_t before = kNone,
                behind = kNone;  // the other ends of the one that leads here and of the one that leads on
  int segments = 0;
};

/// To the right of a segment, which is outward.
Vec2d normal_of(const Vec2d& from, const Vec2d& to) {
  const Vec2d along = to - from;
  Vec2d normal(along[1], -along[0]);
  normal.normalize();
  return normal;
}

class CornerOpener {
 public:
  CornerOpener(CurvesView curves, const Distances& outer, double angle)
      : curves_(curves),
        outer_(outer),
        plane_(chains_in_plane(curves)),
        at_(curves.positions.size()),
        copies_(curves.positions.size()),
        is_laid_(curves.positions.size(), 0) {
    for (const auto& [a, b] : plane_.chains.segments) {
      at_[a].behind = b, at_[b].before = a;
      ++at_[a].segments, ++at_[b].segments;
    }
    for (std::uint32_t p = 0; p < at_.size(); ++p)
      if (at_[p].segments == 2 && at_[p].before != kNone && at_[p].behind != kNone) open(p, angle);
  }

  FannedCurves make() {
    if (std::all_of(copies_.begin(), copies_.end(), [](const auto& copies) { return copies.empty(); })) return {};
    for (std::uint32_t p = 0; p < at_.size(); ++p) {
      made_.curves.positions.push_back(curves_.positions[p]);
      made_.origin.push_back(p);
      copy_of_.push_back(kNone);
      const std::uint32_t v = plane_.chains.welded_to[p];
      if (v != kNone && copies_[v].empty()) stand_off(p, way_of(v));
    }
    is_taken_.assign(at_.size(), 0);
    for (std::size_t f = 0; f < curves_.face_count(); ++f) add_curve(curves_.face(f));
    find_feet();
    return std::move(made_);
  }

 private:
  Vec2d normal_before(std::uint32_t v) const { return normal_of(plane_.points[at_[v].before], plane_.points[v]); }
  Vec2d normal_behind(std::uint32_t v) const { return normal_of(plane_.points[v], plane_.points[at_[v].behind]); }

  /// Gives a corner copies, if it is convex on the side to which it goes, and sharp enough.
  void open(std::uint32_t v, double angle) {
    // A curve that all but turns back has no side on which its corner is. Not measured.
    constexpr double kMost = 3.13;
    if (outer_[v] == 0) return;
    const double side = outer_[v] < 0 ? -1 : 1;
    const Vec2d from = normal_before(v), to = normal_behind(v);
    const double turn = std::atan2(from[0] * to[1] - from[1] * to[0], from.dot(to));
    if (!(turn * side > angle) || std::abs(turn) > kMost) return;
    const auto steps = static_cast<std::size_t>(std::ceil(std::abs(turn) / angle));
    for (std::size_t i = 0; i <= steps; ++i) {
      const double by = turn * static_cast<double>(i) / static_cast<double>(steps);
      copies_[v].push_back(
          Vec2d(from[0] * std::cos(by) - from[1] * std::sin(by), from[0] * std::sin(by) + from[1] * std::cos(by)) *
          side);
    }
  }

  /// Where a point goes at first that is no corner, in distances.
  Vec2d way_of(std::uint32_t v) const {
    std::vector<Vec3d> normals;
    const double side = outer_[v] < 0 ? -1 : 1;
    const auto add = [&](const Vec2d& normal) { normals.emplace_back(normal[0] * side, normal[1] * side, 0); };
    if (at_[v].segments > 2) return {0, 0};
    if (at_[v].before != kNone) add(normal_before(v));
    if (at_[v].behind != kNone) add(normal_behind(v));
    const auto point = miter_point(normals);
    return point ? Vec2d(point->position[0], point->position[1]) : Vec2d(0, 0);
  }
  void stand_off(std::uint32_t p, const Vec2d& way) {
    const std::uint32_t v = plane_.chains.welded_to[made_.origin[p]];
    const Vec3d displacement = plane_.frame.to_space(way * std::abs(outer_[v]));
    made_.curves.positions[p] = vdb_offset::stand_off(curves_.positions[v], displacement);
  }

  /// The point of the opened curves that a copy is, in the place of one of the source's points.
  std::uint32_t number(std::uint32_t p, std::size_t copy) {
    const std::uint32_t v = plane_.chains.welded_to[p];
    std::uint32_t n = p;
    if (std::exchange(is_taken_[p], 1) && copy_of_[p] != copy) {
      n = static_cast<std::uint32_t>(made_.origin.size());
      made_.curves.positions.push_back(curves_.positions[p]);
      made_.origin.push_back(p);
      copy_of_.push_back(kNone);
    }
    copy_of_[n] = static_cast<std::uint32_t>(copy);
    stand_off(n, copies_[v][copy]);
    return n;
  }

  /// Adds a curve with copies in the place of corners.
  void add_curve(std::span<const std::uint32_t> curve) {
    std::vector<std::uint32_t> opened;
    const auto welded = [&](std::size_t i) { return plane_.chains.welded_to[curve[i]]; };
    for (std::size_t i = 0; i < curve.size(); ++i) {
      const std::uint32_t v = welded(i);
      if (v == kNone || copies_[v].empty()) {
        opened.push_back(curve[i]);
        continue;
      }
      std::size_t last = i, next = i;
      while (last > 0 && welded(last) == v) --last;
      while (next + 1 < curve.size() && welded(next) == v) ++next;
      add_corner(curve[i], last == i || welded(last) == v ? kNone : welded(last),
                 next == i || welded(next) == v ? kNone : welded(next), opened);
      i = std::max(i, next - (welded(next) == v ? 0 : 1));
    }
    made_.curves.corners.insert(made_.curves.corners.end(), opened.begin(), opened.end());
    made_.curves.close_face();
  }

  /// Adds a corner between two points of a curve, kNone where that begins or ends.
  void add_corner(std::uint32_t p, std::uint32_t last, std::uint32_t next, std::vector<std::uint32_t>& opened) {
    const std::uint32_t v = plane_.chains.welded_to[p];
    const std::size_t end = copies_[v].size() - 1;
    // The copies at the segments of the curve there, and in which order the row runs.
    const bool forwards = last != kNone ? last == at_[v].before : next == at_[v].behind;
    const std::size_t first = forwards ? 0 : end, behind = forwards ? end : 0;
    const bool whole = (last != kNone && next != kNone) || !std::exchange(is_laid_[v], 1);
    if (!whole) {
      opened.push_back(number(p, last != kNone ? first : behind));
      return;
    }
    is_laid_[v] = 1;
    for (std::size_t i = 0; i <= end; ++i) opened.push_back(number(p, forwards ? i : end - i));
  }

  void find_feet() {
    std::vector<std::uint32_t> first(at_.size(), kNone);
    made_.foot.resize(made_.origin.size());
    for (std::uint32_t p = 0; p < made_.foot.size(); ++p) {
      const std::uint32_t v = plane_.chains.welded_to[made_.origin[p]];
      if (v != kNone && first[v] == kNone) first[v] = p;
      made_.foot[p] = v == kNone ? p : first[v];
    }
  }

  CurvesView curves_;
  const Distances& outer_;
  PlaneChains plane_;
  std::vector<AtPoint> at_;
  std::vector<std::vector<Vec2d>> copies_;  // of each corner, by its first point: where its copies go
  std::vector<std::uint8_t> is_laid_;       // of each corner: its row is in some curve
  std::vector<std::uint8_t> is_taken_;      // of each of the source's points: it is a copy already
  std::vector<std::uint32_t> copy_of_;      // of each point that was made: which copy it is
  FannedCurves made_;
};

}  // namespace

FannedCurves open_corners(CurvesView curves, const Distances& outer, double angle) {
  return CornerOpener(curves, outer, angle).make();
}

}  // namespace vdb_offset
