// SPDX-License-Identifier: Apache-2.0
#include "cad/proof/sampled_face.h"

#include <BRepTools.hxx>
#include <BRep_Tool.hxx>

namespace cad_proof {

SampledFace::SampledFace(const TopoDS_Face& face)
    : surface_(BRep_Tool::Surface(face)), sign_(face.Orientation() == TopAbs_REVERSED ? -1 : 1) {
  BRepTools::UVBounds(face, box_[0], box_[1], box_[2], box_[3]);
  classifier_ = std::make_unique<BRepTopAdaptor_FClass2d>(face, 1e-9);
}

bool SampledFace::has_inside(const gp_Pnt2d& uv) const { return classifier_->Perform(uv) == TopAbs_IN; }

std::optional<gp_Pnt2d> SampledFace::inside(Numbers& numbers) const {
  constexpr int kTrials = 200;
  for (int k = 0; k < kTrials; ++k) {
    const gp_Pnt2d uv(numbers.between(box_[0], box_[1]), numbers.between(box_[2], box_[3]));
    if (has_inside(uv)) return uv;
  }
  return std::nullopt;
}

std::optional<gp_Vec> SampledFace::outside(const gp_Pnt2d& uv) const {
  gp_Pnt point;
  gp_Vec along_u, along_v;
  surface_->D1(uv.X(), uv.Y(), point, along_u, along_v);
  const gp_Vec normal = along_u.Crossed(along_v);
  if (normal.Magnitude() < 1e-9 * along_u.Magnitude() * along_v.Magnitude() || normal.Magnitude() < 1e-12)
    return std::nullopt;
  return normal.Normalized() * sign_;
}

}  // namespace cad_proof
