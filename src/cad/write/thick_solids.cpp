// SPDX-License-Identifier: Apache-2.0
#include "write/thick_solids.h"

#include <BRep_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Solid.hxx>

namespace vdb_offset::cad {
namespace {

std::vector<TopoDS_Shape> shells_in(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Shape> shells;
  for (TopExp_Explorer shell(shape, TopAbs_SHELL); shell.More(); shell.Next()) shells.push_back(shell.Current());
  return shells;
}

}  // namespace

std::vector<TopoDS_Shape> thick_solids(const TopoDS_Shape& source, const TopoDS_Shape& offset, bool is_outward) {
  const std::vector<TopoDS_Shape> from = shells_in(source), to = shells_in(offset);
  std::vector<TopoDS_Shape> solids;
  for (std::size_t i = 0; i < from.size() && from.size() == to.size(); ++i) {
    TopoDS_Solid solid;
    BRep_Builder builder;
    builder.MakeSolid(solid);
    // The material of the thick solid lies outside of the source's where the offset is the larger, around cavities as
    // well.
    builder.Add(solid, is_outward ? to[i] : from[i]);
    builder.Add(solid, (is_outward ? from[i] : to[i]).Reversed());
    solids.push_back(solid);
  }
  return solids;
}

}  // namespace vdb_offset::cad
