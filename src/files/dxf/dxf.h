// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dxf/dxf_document.h"
#include "dxf/dxf_outline.h"
#include "ground/numbers/rounding.h"
#include "vdb_offset/io/curve_file.h"

namespace vdb_offset::io {

/// What the curves of a DXF file are, and where they stand there.
struct DxfDrawing {
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  /// A curve as it is drawn: in its place, or as an INSERT shows it.
  struct Shape {
    std::uint32_t entity;
    std::uint32_t insert;         ///< What shows it; kNone if it stands in the section ENTITIES.
    std::uint32_t curve = kNone;  ///< Its number; kNone if it has no extent.
    bool keeps_form = false;      ///< Its entity can have other points, if nothing shows it.
  };
  /// What an INSERT shows at one place.
  struct Insert {
    std::uint32_t entity;
    std::uint32_t shown_by;  ///< The INSERT in whose block it is; kNone if it stands in the section ENTITIES.
    DxfPlacement placement;
    std::uint64_t other = 0;  ///< Byte of something in its block that is no curve which is shown; 0 if there is none.
  };

  DxfDocument document;
  std::vector<Shape> shapes;  ///< In the order of the file; those that one INSERT shows lie together.
  std::vector<Insert> inserts;
  std::vector<std::uint8_t> closed;  ///< Of each curve: 1 if its entity closes it.
};

/// Reads the curves of a DXF file in ASCII: LINE, LWPOLYLINE, POLYLINE, ARC, CIRCLE, ELLIPSE and SPLINE of the section
/// ENTITIES, and as INSERT shows them. Curved ones are flattened. What is not a curve is left alone and reported in a
/// remark, as is what is not shown: invisible, on a layer that is off or frozen, or in paper space, unless all curves
/// are. Ends of curves that are nearer than a millionth of the diagonal of the box around all are joined. Sets all of
/// `file` that is a drawing's, from its text. \throw InvalidInput (file, line, what was expected, what was found) for
/// what is cut or no DXF in ASCII, for entities that are seen from aside, splines without control points, and for
/// blocks that are in themselves or show more than a million entities. OutOfBudget
void parse_dxf(CurveFile& file, const CurveReading& how);

/// Rewrites a file with points at other positions: of entities with straight segments the coordinates; others become
/// polylines, and an INSERT becomes all that it shows, if any of it moved. All other bytes stay. `source` are the
/// curves of the drawing. \throw InvalidInput for an INSERT that shows something else as well
std::string rewrite_dxf(const CurveFile& file, std::span<const Vec3d> positions, const Rounding& precision);

/// A file of curves that come from elsewhere, in the form of R12, which has the least that readers can stumble over:
/// one POLYLINE each, on the layer 0.
std::string as_dxf(CurvesView curves, const Rounding& precision);

/// Finds what is drawn where. Adds remarks on what is not.
DxfDrawing resolve_dxf(const DxfText& text, DxfDocument document, std::vector<std::string>& remarks);

}  // namespace vdb_offset::io
