// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <map>

#include "offset/edge_curve.h"

namespace vdb_offset::cad {

/// Curves of edges between faces of the source, for models that are made several times and are alike in most places.
class KnownCurves {
 public:
  /// As edge_curves() finds them. \pre the tolerances are the same each time
  EdgeCurves of(const Model& model, int edge, const Tolerances& tolerances);

 private:
  /// All that an edge's curves depend on.
  struct Key {
    std::array<Handle(Geom_Surface), 2> surfaces;
    std::array<Handle(Geom2d_Curve), 2> pcurves;
    std::array<double, 16> numbers{};  // its range, its ends, and these on its faces
    bool operator<(const Key& other) const;
  };
  static Key key_of(const Model& model, const ModelEdge& edge);

  std::map<Key, EdgeCurves> known_;
};

struct Built {
  TopoDS_Shape shell;                ///< Null if an edge has no curve.
  std::vector<TopoDS_Face> faces;    ///< By the number of the model's face; null for those that are gone.
  std::vector<TopoDS_Edge> edges;    ///< By the number of the model's edge; null for those that are gone.
  std::vector<std::string> trouble;  ///< What is not as it should be, in words.
  std::vector<int> bad_edges;        ///< The numbers of the edges that it is about.
};

/// The shell of a placed model. Splines are cut at poles.
/// \param known curves of earlier ones
Built build_shell(Model& model, const Tolerances& tolerances, KnownCurves& known);

}  // namespace vdb_offset::cad
