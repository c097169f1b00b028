// SPDX-License-Identifier: Apache-2.0
#include "trim/trim_offset.h"

#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <algorithm>
#include <cmath>

#include "judge/soup.h"
#include "offset/offset_surface.h"
#include "trim/cut_faces.h"
#include "trim/join_pieces.h"
#include "trim/point_in_face.h"
#include "trim/solids_of_pieces.h"

namespace vdb_offset::cad {
namespace {

// Points of a piece that are held against the source, and what share of the distance is enough: to both sides of a cut
// distances part slowly where faces are nearly parallel.
constexpr std::size_t kPointsOfPiece = 8;
constexpr double kEnough = 0.995;

// Whether a piece is at the distance from the source, by most of its points.
bool is_at_distance(const FacePiece& piece, const Soup& source, double far) {
  const Handle(Geom_Surface) surface = surface_of(piece.face);
  const std::vector<gp_Pnt2d> points = points_in_face(piece.face, kPointsOfPiece);
  const auto good = std::count_if(points.begin(), points.end(), [&](const gp_Pnt2d& uv) {
    return source.closest(surface->Value(uv.X(), uv.Y())).distance > kEnough * far;
  });
  return 2 * static_cast<std::size_t>(good) > points.size();
}

// What each face of the source is left with.
void report_pieces(const TopoDS_Shape& untrimmed, const std::vector<FacePiece>& pieces, OffsetCadResult& result) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(untrimmed, TopAbs_FACE, faces);
  const std::vector<TopoDS_Shape> left = faces_left(pieces, static_cast<std::size_t>(faces.Extent()));
  for (std::size_t k = 0; k < result.made_of.size(); k++) {
    if (result.made_of[k].IsNull()) continue;
    const int number = faces.FindIndex(result.made_of[k]) - 1;
    result.made_of[k] = number < 0 ? TopoDS_Shape() : left[static_cast<std::size_t>(number)];
    if (result.made_of[k].IsNull()) result.faces[k] = CadFace::Swallowed;
  }
}

}  // namespace

OffsetCadResult trim_offset(const TopoDS_Shape& source, OffsetCadResult offset, double distance) {
  const TopoDS_Shape untrimmed = offset.shape;
  const double far = std::abs(distance);
  const Soup soup(source, 0.01 * far, 0.05 * far, 0.25);
  std::vector<FacePiece> pieces = cut_faces(untrimmed);
  pieces.erase(std::remove_if(pieces.begin(), pieces.end(),
                              [&](const FacePiece& piece) { return !is_at_distance(piece, soup, far); }),
               pieces.end());
  join_pieces(pieces, 1e-3 * far);
  offset.shape = solids_of_pieces(pieces);
  if (offset.shape.IsNull()) offset.gaps.emplace_back("faces cross, and what is left of them is not closed");
  report_pieces(untrimmed, pieces, offset);
  return offset;
}

}  // namespace vdb_offset::cad
