// SPDX-License-Identifier: Apache-2.0
// What becomes of exact faces where triangles take their place. A program of its own, as it is linked to OpenCASCADE.
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <cmath>
#include <cstdio>
#include <gp_Pln.hxx>
#include <utility>
#include <vector>

#include "hybrid/hybrid_offset.h"
#include "judge/judge.h"
#include "tessellate/tessellate.h"
#include "write/own_process.h"

namespace {

using namespace vdb_offset;

constexpr double kRadius = 10, kHeight = 20, kDistance = 1;

/// The offset mesh of an upright cylinder, each vertex of which is at a rim.
std::vector<Vec3d> moved(const std::vector<Vec3d>& positions) {
  std::vector<Vec3d> all;
  all.reserve(positions.size());
  for (const Vec3d& at : positions)
    all.emplace_back(at.x() * (1 + kDistance / kRadius), at.y() * (1 + kDistance / kRadius),
                     at.z() + (at.z() > kHeight / 2 ? kDistance : -kDistance));
  return all;
}

int cylinders_in(const TopoDS_Shape& shape) {
  int count = 0;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next())
    count += !Handle(Geom_CylindricalSurface)::DownCast(BRep_Tool::Surface(TopoDS::Face(face.Current()))).IsNull();
  return count;
}

bool is_solid(const char* what, const cad::OffsetCadResult& result, int cylinders) {
  if (result.shape.IsNull()) {
    std::printf("%s: nothing\n", what);
    return false;
  }
  constexpr double kPi = 3.14159265358979323846;
  const double radius = kRadius + kDistance, exact = kPi * radius * radius * (kHeight + 2 * kDistance);
  const double volume = cad::volume_of(result.shape);
  const bool is_valid = BRepCheck_Analyzer(result.shape).IsValid();
  std::printf("%s: %s, of %d exact walls and %zu triangles, volume %g of %g\n", what, is_valid ? "valid" : "not valid",
              cylinders_in(result.shape), result.triangles, volume, exact);
  return is_valid && cylinders_in(result.shape) == cylinders && std::abs(volume / exact - 1) < 0.01;
}

/// Whether a face without triangles, which is a shell of its own, is left out.
bool is_empty_shell_left_out(cad::OffsetCadRequest request, std::vector<cad::ShellMesh> meshes) {
  BRep_Builder builder;
  TopoDS_Shell alone;
  builder.MakeShell(alone);
  builder.Add(alone, BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 0, 1, 0, 1).Face());
  TopoDS_Solid solid;
  builder.MakeSolid(solid);
  builder.Add(solid, TopExp_Explorer(request.source, TopAbs_SHELL).Current());
  builder.Add(solid, alone);
  request.source = solid;
  meshes.emplace_back();
  const cad::OffsetCadResult result = cad::HybridOffset(request, std::move(meshes), cad::ExactParts::Near).make();
  return is_solid("beside a face without triangles", result, 1) && result.faces.back() == cad::CadFace::Swallowed;
}

}  // namespace

int main() {
  const cad::MemoryFile file;
  BRepTools::Write(BRepPrimAPI_MakeCylinder(kRadius, kHeight).Shape(), file.path().c_str());
  cad::CadModel model = cad::read_model(file.path(), "brep");
  io::CadFineness fineness;
  fineness.deflection = 0.2;
  fineness.angle = 0.5;
  const cad::Tessellation made = cad::tessellate(model, fineness);
  const cad::Body& body = model.bodies.front();
  const cad::BodyShape shape = cad::shape_of(body);
  cad::OffsetCadRequest request;
  request.source = shape.shape;
  request.distance = kDistance;
  const std::vector<Vec3d> positions = moved(made.mesh.positions);
  const std::vector<cad::ShellMesh> meshes = cad::shell_meshes(body, shape, made.bodies.front(), positions, 1);
  cad::HybridOffset hybrid(request, meshes, cad::ExactParts::Near);
  bool is_right = is_solid("all of it is exact", hybrid.make(), 1);

  // A strip opposite of the seam, which parts the wall in two that meet there.
  std::vector<gp_Pnt> strip;
  for (double z = 0; z <= kHeight; ++z) strip.emplace_back(-kRadius - kDistance, 0, z);
  is_right = hybrid.take_off_near(strip) && is_right;
  const cad::OffsetCadResult parted = hybrid.make();
  is_right = is_solid("with a strip of triangles", parted, 2) && parted.triangles > 0 && is_right;

  // Far from all that is exact, its own triangles are at fault only if an exact face beside has moved their vertices.
  is_right = hybrid.take_off_near({gp_Pnt(-kRadius - kDistance, 0, kHeight / 2)}) && is_right;
  const cad::OffsetCadResult wider = hybrid.make();
  is_right = is_solid("with a wider strip", wider, 2) && wider.triangles > parted.triangles && is_right;
  is_right = is_empty_shell_left_out(request, meshes) && is_right;
  return is_right ? 0 : 1;
}
