// SPDX-License-Identifier: Apache-2.0
#include "trim/solids_of_pieces.h"

#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepGProp.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <array>

#include "ground/numbers/disjoint_sets.h"

namespace vdb_offset::cad {
namespace {

// Faces that hang together by edges, as shells; none if an edge has not two faces that run against each other.
std::vector<TopoDS_Shell> closed_shells(const std::vector<FacePiece>& pieces) {
  TopTools_IndexedMapOfShape edges;
  std::vector<std::array<int, 2>> faces_of;  // by edge: those that have it forward and reversed
  DisjointSets groups(pieces.size());
  for (int i = 0; i < static_cast<int>(pieces.size()); i++)
    for (TopExp_Explorer e(pieces[i].face, TopAbs_EDGE); e.More(); e.Next()) {
      const TopAbs_Orientation way = e.Current().Orientation();
      if (way == TopAbs_INTERNAL || way == TopAbs_EXTERNAL || BRep_Tool::Degenerated(TopoDS::Edge(e.Current())))
        continue;
      const std::size_t edge = static_cast<std::size_t>(edges.Add(e.Current())) - 1;
      if (edge >= faces_of.size()) faces_of.push_back({-1, -1});
      int& face = faces_of[edge][way == TopAbs_REVERSED];
      if (face >= 0) return {};
      face = i;
    }
  for (const std::array<int, 2>& two : faces_of) {
    if (two[0] < 0 || two[1] < 0) return {};
    groups.join(static_cast<std::uint32_t>(two[0]), static_cast<std::uint32_t>(two[1]));
  }
  std::vector<TopoDS_Shell> shells(pieces.size());
  for (int i = 0; i < static_cast<int>(pieces.size()); i++) {
    TopoDS_Shell& shell = shells[groups.first(static_cast<std::uint32_t>(i))];
    if (shell.IsNull()) BRep_Builder().MakeShell(shell);
    BRep_Builder().Add(shell, pieces[i].face);
    shell.Closed(true);
  }
  shells.erase(std::remove_if(shells.begin(), shells.end(), [](const TopoDS_Shell& s) { return s.IsNull(); }),
               shells.end());
  return shells;
}

double volume_in(const TopoDS_Shell& shell) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shell, properties);
  return properties.Mass();
}

bool encloses(const TopoDS_Solid& solid, const TopoDS_Shell& shell) {
  const gp_Pnt corner = BRep_Tool::Pnt(TopoDS::Vertex(TopExp_Explorer(shell, TopAbs_VERTEX).Current()));
  return BRepClass3d_SolidClassifier(solid, corner, 1e-7).State() == TopAbs_IN;
}

}  // namespace

TopoDS_Shape solids_of_pieces(const std::vector<FacePiece>& pieces) {
  std::vector<TopoDS_Shell> shells = closed_shells(pieces);
  const auto outer =
      std::stable_partition(shells.begin(), shells.end(), [](const auto& s) { return volume_in(s) > 0; });
  std::vector<TopoDS_Solid> solids;
  BRep_Builder builder;
  for (auto shell = shells.begin(); shell != outer; ++shell) {
    builder.MakeSolid(solids.emplace_back());
    builder.Add(solids.back(), *shell);
  }
  const std::vector<TopoDS_Solid> whole = solids;
  for (auto cavity = outer; cavity != shells.end(); ++cavity) {
    const auto around = solids.size() == 1 ? whole.begin()
                                           : std::find_if(whole.begin(), whole.end(),
                                                          [&](const auto& s) { return encloses(s, *cavity); });
    if (around == whole.end()) return {};
    builder.Add(solids[static_cast<std::size_t>(around - whole.begin())], *cavity);
  }
  if (solids.size() == 1) return solids.front();
  if (solids.empty()) return {};
  TopoDS_Compound all;
  builder.MakeCompound(all);
  for (const TopoDS_Solid& solid : solids) builder.Add(all, solid);
  return all;
}

std::vector<TopoDS_Shape> faces_left(const std::vector<FacePiece>& pieces, std::size_t faces) {
  std::vector<TopoDS_Shape> left(faces);
  BRep_Builder builder;
  for (const FacePiece& piece : pieces) {
    if (piece.of < 0) continue;
    TopoDS_Shape& all = left[static_cast<std::size_t>(piece.of)];
    if (all.IsNull()) {
      TopoDS_Compound compound;
      builder.MakeCompound(compound);
      all = compound;
    }
    builder.Add(all, piece.face);
  }
  for (TopoDS_Shape& all : left)
    if (!all.IsNull() && all.NbChildren() == 1) all = TopExp_Explorer(all, TopAbs_FACE).Current();
  return left;
}

}  // namespace vdb_offset::cad
