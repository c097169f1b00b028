// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <Geom_Surface.hxx>

namespace vdb_offset::cad {

/// The curve in (u, v) of an edge over [first, last]: as the file has it, or, where that leads more than `off` past the
/// edge's curve though this lies on the surface, the one that it should be. `curve` has the same parameters.
Handle(Geom2d_Curve) mended_pcurve(const Handle(Geom2d_Curve) & pcurve, const Handle(Geom_Curve) & curve,
                                   const Handle(Geom_Surface) & surface, double first, double last, double off);

}  // namespace vdb_offset::cad
