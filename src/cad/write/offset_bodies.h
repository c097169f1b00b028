// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shape.hxx>
#include <string>
#include <vector>

#include "judge/soup.h"
#include "messages/cad_messages.h"
#include "offset/offset_solid.h"
#include "offset/offset_surface.h"
#include "read/cad_model.h"
#include "write/body_shape.h"

namespace vdb_offset::cad {

/// A body of the source, in millimetres, and its offset.
struct OffsetBody {
  const Body& body;
  BodyShape source;
  OffsetCadResult result;
  std::vector<FaceDistance> distances;  ///< Of each face; empty: all have the same.
  bool is_even() const { return distances.empty(); }
};

struct OffsetBodies {
  std::vector<OffsetBody> all;
  std::size_t held = 0;           ///< Faces that are held back.
  double least_held = 1;          ///< The least share of its distance that a point of them goes.
  std::vector<std::string> gaps;  ///< Why nothing was made.
};

/// OpenCASCADE's tolerances are lengths, and meant for millimetres: models in other units are brought to these.
TopoDS_Shape scaled(const TopoDS_Shape& shape, double factor);

/// What `shape_in` makes of each, as one shape.
template <class Bodies, class ShapeIn>
TopoDS_Shape together(const Bodies& bodies, ShapeIn&& shape_in) {
  TopoDS_Compound all;
  BRep_Builder builder;
  builder.MakeCompound(all);
  for (const auto& body : bodies) builder.Add(all, shape_in(body));
  return all;
}

/// The triangles that are judged of a result. \param distance the largest
Soup result_soup(const TopoDS_Shape& shape, double distance);

/// The corners of obstacles, in millimetres.
std::vector<gp_Pnt> obstacle_points(const io::WriteCad& write, double millimetres);
Soup obstacle_soup(const io::WriteCad& write, double millimetres);

/// Offsets each body by offset_cad(), its faces held back if that is asked for.
/// \param millimetres how many the model's unit is \param keeps_turned as that of OffsetCadRequest, for solids
OffsetBodies offset_bodies(const CadModel& model, const io::WriteCad& write, double millimetres, bool keeps_turned);

}  // namespace vdb_offset::cad
