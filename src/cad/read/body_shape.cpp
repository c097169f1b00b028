// SPDX-License-Identifier: Apache-2.0
#include "read/body_shape.h"

#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>

namespace vdb_offset::cad {

BodyShape shape_of(const Body& body) {
  const std::vector<std::uint32_t> shell_of = shells_of(body);
  BRep_Builder builder;
  BodyShape result;
  std::vector<TopoDS_Shell> shells;
  for (std::size_t root = 0; root < shell_of.size(); ++root) {
    if (shell_of[root] != root) continue;
    TopoDS_Shell shell;
    builder.MakeShell(shell);
    for (std::size_t f = 0; f < shell_of.size(); ++f) {
      if (shell_of[f] != root) continue;
      builder.Add(shell, body.faces[f].face);
      result.face_numbers.push_back(f);
    }
    shell.Closed(BRep_Tool::IsClosed(shell));
    shells.push_back(shell);
  }
  if (body.is_solid) {
    TopoDS_Solid solid;
    builder.MakeSolid(solid);
    for (const TopoDS_Shell& shell : shells) builder.Add(solid, shell);
    if (shells.size() == 1) BRepLib::OrientClosedSolid(solid);
    result.shape = solid;
  } else if (shells.size() == 1) {
    result.shape = shells.front();
  } else {
    TopoDS_Compound all;
    builder.MakeCompound(all);
    for (const TopoDS_Shell& shell : shells) builder.Add(all, shell);
    result.shape = all;
  }
  return result;
}

}  // namespace vdb_offset::cad
