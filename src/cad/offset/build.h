// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>

#include "offset/edge_curve.h"

namespace vdb_offset::cad {

struct Built {
  TopoDS_Shape shell;                ///< Null if an edge has no curve.
  std::vector<TopoDS_Face> faces;    ///< By the number of the model's face; null for those that are gone.
  std::vector<TopoDS_Edge> edges;    ///< By the number of the model's edge; null for those that are gone.
  std::vector<std::string> trouble;  ///< What is not as it should be, in words.
  std::vector<int> bad_edges;        ///< The numbers of the edges that it is about.
};

/// The shell of a placed model. Splines are cut at poles.
Built build_shell(Model& model, const Tolerances& tolerances);

}  // namespace vdb_offset::cad
