// SPDX-License-Identifier: Apache-2.0
#pragma once

// The curves that entities of a DXF file are, where they stand in the drawing.

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <utility>
#include <vector>

#include "drawing/smooth_curve.h"
#include "drawing/transform.h"
#include "dxf/dxf_document.h"
#include "dxf/dxf_spline.h"
#include "vdb_offset/numbers.h"

namespace vdb_offset::io {

/// Where what is in a block comes to stand: in planes z = constant, each as the others but for its height.
struct DxfPlacement {
  SvgMatrix plane = kSvgIdentity;
  double z_scale = 1, z_shift = 0;

  Vec3d operator()(const Vec3d& p) const {
    const Vec3d in_plane = transformed(plane, Vec2d(p[0], p[1]));
    return {in_plane[0], in_plane[1], z_scale * p[2] + z_shift};
  }
  bool operator==(const DxfPlacement&) const = default;
};

/// The placement that applies `inner` first, then `outer`.
DxfPlacement product(const DxfPlacement& outer, const DxfPlacement& inner);

/// Of entities that are seen from below, with an extrusion direction of (0, 0, -1): their x runs to the left.
inline constexpr DxfPlacement kDxfMirrored{{-1, 0, 0, 1, 0, 0}, -1, 0};

/// Whether an entity is seen from below. \throw InvalidInput, with its line, if it is seen from aside
bool is_mirrored(const DxfText& text, const DxfEntity& entity);

/// What draws an entity, in the coordinates of the drawing.
class DxfPen {
 public:
  enum class Ends { There, AtFirstPoint };

  DxfPen() = default;
  DxfPen(const DxfPen&) = delete;
  DxfPen& operator=(const DxfPen&) = delete;
  virtual ~DxfPen() = default;
  /// Begins a curve at a point, or goes on straight to it.
  virtual void point(const Vec3d& p) = 0;
  /// Goes on along an arc from the last point. One that ends at the first point closes the curve without another one.
  virtual void arc(const SvgCurve& arc, double z, Ends ends) = 0;
  /// Goes on along a piece of a spline from the last point.
  virtual void spline(const DxfBezier& piece) = 0;
  /// Ends the curve.
  virtual void end(bool closed) = 0;
};

/// Draws the curve that an entity is. One without an extent has none. Returns whether the entity can keep its form with
/// points at other positions: it has straight segments alone, between points that it names.
/// \throw InvalidInput (line, what was expected) for one that is seen from aside, for a spline without control points,
/// and for what cannot be
bool draw_dxf(const DxfText& text, const DxfEntity& entity, const DxfPlacement& placement, DxfPen& pen);

/// Whether a vertex of a POLYLINE with these flags is no point of the curve, but one that a spline is drawn to.
inline bool is_frame_vertex(std::int64_t flags) { return (flags & 16) != 0; }

/// The values of groups of an entity, each by its code.
class DxfValues {
 public:
  DxfValues(const DxfText& text, const DxfEntity& entity, std::initializer_list<int> codes);

  std::optional<double> find(int code) const;
  double value(int code, double otherwise = 0) const { return find(code).value_or(otherwise); }
  std::int64_t flags(int code) const;
  /// The coordinates behind a code, and those ten and twenty after it.
  Vec3d point(int code) const { return {value(code), value(code + 10), value(code + 20)}; }

 private:
  std::vector<std::pair<int, std::optional<double>>> values_;
};

}  // namespace vdb_offset::io
