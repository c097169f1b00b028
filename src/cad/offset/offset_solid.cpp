// SPDX-License-Identifier: Apache-2.0
#include "offset/offset_solid.h"

#include <BRep_Builder.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <cmath>

#include "ground/process/progress.h"
#include "offset/arrange.h"
#include "offset/build.h"

namespace vdb_offset::cad {
namespace {

// Readers of STEP find tolerances anew, from fewer points than checkers of it take, unless curves are within
// OpenCASCADE's own 1e-7.
constexpr double kCurve = 5e-8;

double vertex_margin(double distance) { return 2.5 * std::abs(distance); }

/// A distance along Su x Sv, of one towards the outside.
FaceDistance towards(const FaceDistance& outside, double sign) {
  FaceDistance along{sign * outside.constant, {}, outside.detail};
  if (outside.at) along.at = [at = outside.at, sign](double u, double v) { return sign * at(u, v); };
  return along;
}

/// Tells how each face of a model was made, and which face it became; of those from `first` on.
void report_faces(const Model& model, const std::vector<TopoDS_Face>& built, std::size_t first,
                  OffsetCadResult& result) {
  for (std::size_t f = 0; f < model.faces.size(); f++) {
    if (f < built.size()) result.made_of[first + f] = built[f];
    if (model.faces[f].is_gone) result.faces[first + f] = CadFace::Swallowed;
  }
}

std::size_t count_faces(const TopoDS_Shape& shell) {
  std::size_t count = 0;
  for (TopExp_Explorer face(shell, TopAbs_FACE); face.More(); face.Next()) ++count;
  return count;
}

OffsetCadResult offset_all(const OffsetCadRequest& request) {
  OffsetCadResult result;
  const Tolerances tolerances = tolerances_of(request);
  BRep_Builder builder;
  TopoDS_Compound all;
  builder.MakeCompound(all);
  const auto all_faces = static_cast<double>(count_faces(request.source));
  std::vector<TopoDS_Shape> pieces;
  for (TopExp_Explorer s(request.source, TopAbs_SOLID); s.More(); s.Next()) pieces.push_back(s.Current());
  for (TopExp_Explorer s(request.source, TopAbs_SHELL, TopAbs_SOLID); s.More(); s.Next()) pieces.push_back(s.Current());
  for (TopExp_Explorer f(request.source, TopAbs_FACE, TopAbs_SHELL); f.More(); f.Next()) {
    TopoDS_Shell shell;
    builder.MakeShell(shell);
    builder.Add(shell, f.Current());
    pieces.push_back(shell);
  }
  int made = 0;
  TopoDS_Shape last;
  for (const TopoDS_Shape& piece : pieces) {
    std::vector<TopoDS_Shape> shells;
    for (TopExp_Explorer s(piece, TopAbs_SHELL); s.More(); s.Next()) {
      const std::size_t first_face = result.faces.size();
      Model model = offset_faces(s.Current(), request, first_face);
      report_progress(static_cast<double>(first_face) / all_faces);
      if (!model.failure.empty()) {
        result.gaps.push_back(model.failure);
        result.faces.resize(first_face + count_faces(s.Current()), CadFace::Swallowed);
        result.made_of.resize(result.faces.size());
        continue;
      }
      for (const ModelFace& face : model.faces) {
        result.fit_error = std::max(result.fit_error, face.offset.error);
        result.faces.push_back(made_by(face.offset.made));
      }
      result.made_of.resize(result.faces.size());
      const std::size_t gaps_before = result.gaps.size();
      if (std::any_of(model.edges.begin(), model.edges.end(), [](const ModelEdge& e) { return e.is_step; }))
        result.gaps.emplace_back("distances of faces that are joined smoothly differ where they meet (--blend)");
      if (request.keeps_turned) arrange_turned(model, tolerances, result.gaps);
      else arrange(model, tolerances, result.gaps);
      if (result.gaps.size() > gaps_before) continue;
      if (std::all_of(model.faces.begin(), model.faces.end(), [](const ModelFace& f) { return f.is_gone; })) {
        result.gaps.push_back("the shell is swallowed whole");
        continue;
      }
      KnownCurves none;
      Built built = build_shell(model, tolerances, none);
      result.gaps.insert(result.gaps.end(), built.trouble.begin(), built.trouble.end());
      report_faces(model, built.faces, first_face, result);
      if (!built.shell.IsNull()) shells.push_back(built.shell);
    }
    if (shells.empty()) continue;
    if (piece.ShapeType() == TopAbs_SOLID) {
      TopoDS_Solid solid;
      builder.MakeSolid(solid);
      for (const TopoDS_Shape& s : shells) builder.Add(solid, s);
      last = solid;
    } else {
      last = shells.front();
    }
    builder.Add(all, last);
    made++;
  }
  if (made == 1) result.shape = last;
  else if (made > 1) result.shape = all;
  return result;
}

}  // namespace

CadFace made_by(FaceMade made) {
  return made == FaceMade::Kept ? CadFace::Kept : made == FaceMade::Fitted ? CadFace::Fitted : CadFace::Swallowed;
}

Tolerances tolerances_of(const OffsetCadRequest& request) {
  Tolerances tolerances;
  tolerances.distance = std::abs(request.distance);
  tolerances.fit = request.fit_tolerance > 0 ? request.fit_tolerance : 1e-4 * tolerances.distance;
  tolerances.curve = kCurve;
  tolerances.gap = 2e-3 * tolerances.distance;
  return tolerances;
}

Model offset_faces(const TopoDS_Shape& shell, const OffsetCadRequest& request, std::size_t first_face) {
  const Tolerances tolerances = tolerances_of(request);
  Model model = read_model(shell, tolerances.gap / 4);
  for (std::size_t f = 0; f < model.faces.size() && model.failure.empty(); f++) {
    ModelFace& face = model.faces[f];
    face.distance.constant = face.sign * request.distance;
    if (!request.of_face.empty()) face.distance = towards(request.of_face[first_face + f], face.sign);
    face.offset = offset_surface(face.surface, face.box, face.distance, sharp_sides(model, static_cast<int>(f)),
                                 vertex_margin(request.distance), tolerances.fit);
  }
  if (model.failure.empty()) classify_edges(model, tolerances);
  return model;
}

OffsetCadResult offset_cad(const OffsetCadRequest& request) {
  try {
    return offset_all(request);
  } catch (const Standard_Failure& failure) {
    OffsetCadResult result;
    result.gaps.push_back(std::string("the offset failed: ") + failure.GetMessageString());
    return result;
  }
}

}  // namespace vdb_offset::cad
