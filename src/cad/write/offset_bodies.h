// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <BRep_Builder.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shape.hxx>
#include <optional>
#include <string>
#include <vector>

#include "judge/soup.h"
#include "messages/cad_messages.h"
#include "offset/offset_solid.h"
#include "offset/offset_surface.h"
#include "read/body_shape.h"
#include "read/cad_model.h"
#include "tessellate/body_mesh.h"

namespace vdb_offset::cad {

/// A body of the source, in millimetres, and how it is to be offset.
struct OffsetBody {
  const Body& body;
  const BodyMesh& mesh;
  BodyShape source;
  std::vector<FaceDistance> distances;  ///< Of each face; empty: all have the same.
  bool is_even() const { return distances.empty(); }
  bool stays(std::size_t face) const { return !is_even() && !distances[face].at && distances[face].constant == 0; }
  /// The distance of all faces that do not stay, if they have one and the same.
  std::optional<double> distance_of_moved() const;
  /// The faces that stay, or all others.
  TopoDS_Shape faces_that(bool stay) const;
};

/// What is asked of a model, and how many millimetres its unit is.
struct Asked {
  const io::WriteCad& write;
  double millimetres = 1;
  double largest() const { return millimetres * std::abs(write.distance); }
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

/// The corners of obstacles, in millimetres.
std::vector<gp_Pnt> obstacle_points(const Asked& asked);

/// The bodies of a model. \param meshes what each was tessellated to \throw InvalidExpression, or what is returned
/// InvalidInput, for distances without values
std::vector<OffsetBody> bodies_of(const CadModel& model, const std::vector<BodyMesh>& meshes, const Asked& asked);

/// What offset_cad() is asked for of a body.
OffsetCadRequest request_of(const OffsetBody& body, const Asked& asked);

/// Bodies whose faces are held back where fronts meet.
struct HeldBodies {
  std::vector<OffsetCadResult> results;
  std::size_t held = 0;   ///< Faces that are held back.
  double least_held = 1;  ///< The least share of its distance that a point of them goes.
};

/// Offsets bodies by offset_cad() with their faces held back, first where fronts come towards each other, then where
/// faces of the result cross as well; gives the bodies the distances that their faces then have.
HeldBodies hold_bodies(std::vector<OffsetBody>& bodies, const Asked& asked);

}  // namespace vdb_offset::cad
