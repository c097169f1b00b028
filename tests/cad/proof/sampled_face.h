// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <BRepTopAdaptor_FClass2d.hxx>
#include <Geom_Surface.hxx>
#include <TopoDS_Face.hxx>
#include <gp_Pnt.hxx>
#include <gp_Pnt2d.hxx>
#include <gp_Vec.hxx>
#include <memory>
#include <optional>

#include "cad/proof/numbers.h"

namespace cad_proof {

/// A face by its (u, v): which of them lie within its wires, and what is there.
class SampledFace {
 public:
  explicit SampledFace(const TopoDS_Face& face);

  /// A random (u, v) within the wires; nothing if none is found.
  std::optional<gp_Pnt2d> inside(Numbers& numbers) const;
  bool has_inside(const gp_Pnt2d& uv) const;
  gp_Pnt point(const gp_Pnt2d& uv) const { return surface_->Value(uv.X(), uv.Y()); }
  /// The unit normal out of the material; nothing where the surface has none.
  std::optional<gp_Vec> outside(const gp_Pnt2d& uv) const;

 private:
  Handle(Geom_Surface) surface_;
  double sign_, box_[4];
  std::unique_ptr<BRepTopAdaptor_FClass2d> classifier_;
};

}  // namespace cad_proof
