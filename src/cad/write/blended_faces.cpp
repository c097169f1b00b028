// SPDX-License-Identifier: Apache-2.0
#include "write/blended_faces.h"

#include <BRepBndLib.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Pnt2d.hxx>
#include <limits>
#include <memory>

#include "ground/distances/part_weight.h"
#include "hold/smooth_edges.h"

namespace vdb_offset::cad {
namespace {

// Into how many pieces an edge is divided to find where the closest point is. Not measured.
constexpr int kPieces = 48;

/// An edge of a part towards others, as one of the part's faces has it.
struct PartEdge {
  Handle(Geom_Curve) curve;
  Handle(Geom2d_Curve) parameters;  ///< On the face.
  double first, last;
  int face;
  std::vector<gp_Pnt> points;  ///< kPieces + 1 of them.
};

struct Found {
  double away, along;
};

/// The point of an edge that is closest to p.
Found closest_on(const PartEdge& edge, const gp_Pnt& p) {
  int nearest = 0;
  for (int i = 1; i <= kPieces; ++i)
    if (p.SquareDistance(edge.points[i]) < p.SquareDistance(edge.points[nearest])) nearest = i;
  const double step = (edge.last - edge.first) / kPieces;
  const double low = edge.first + std::max(nearest - 1, 0) * step,
               high = edge.first + std::min(nearest + 1, kPieces) * step;
  double t = edge.first + nearest * step;
  Found best{p.Distance(edge.points[nearest]), t};
  for (int i = 0; i < 20; ++i) {
    gp_Pnt at;
    gp_Vec d, dd;
    edge.curve->D2(t, at, d, dd);
    const gp_Vec to(p, at);
    const double slope = to.Dot(d), bend = d.SquareMagnitude() + to.Dot(dd);
    const double move = bend > 0 ? -slope / bend : -slope / std::max(d.SquareMagnitude(), 1e-300);
    const double next = std::clamp(t + move, low, high);
    if (std::abs(next - t) <= 1e-14 * std::abs(edge.last - edge.first)) break;
    t = next;
  }
  const double away = p.Distance(edge.curve->Value(t));
  if (away < best.away) best = {away, t};
  return best;
}

/// The faces of a part that are joined smoothly with each other and with those of other parts.
struct SmoothPart {
  std::size_t part, piece;
  std::vector<PartEdge> edges;
  Bnd_Box box;
};

/// A face's surface, range, box and distance.
struct BlendedFace {
  Handle(Geom_Surface) surface;
  Box2 range;
  Bnd_Box box;
  FaceDistance distance;
};

struct Blend {
  std::vector<BlendedFace> faces;
  std::vector<SmoothPart> parts;
  double length;
};

class BlendFinder {
 public:
  BlendFinder(const TopoDS_Shape& shape, const std::vector<PartOfFace>& faces, double length) : faces_(faces) {
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
      BlendedFace& each = blend_->faces.emplace_back();
      each.surface = surface_of(TopoDS::Face(face.Current()));
      BRepTools::UVBounds(TopoDS::Face(face.Current()), each.range.u0, each.range.u1, each.range.v0, each.range.v1);
      BRepBndLib::Add(face.Current(), each.box);
      each.distance = faces[blend_->faces.size() - 1].distance;
    }
    blend_->length = length;
    const std::vector<SmoothEdge> edges = smooth_edges(shape);
    piece_ = smooth_pieces(edges, blend_->faces.size());
    for (const SmoothEdge& each : edges)
      for (const int side : {0, 1})
        if (faces_[each.numbers[0]].part != faces_[each.numbers[1]].part)
          add(each.edge, each.faces[side], each.numbers[side]);
  }

  std::shared_ptr<const Blend> blend() const { return blend_; }
  std::size_t piece(std::size_t face) const { return piece_[face]; }

 private:
  std::size_t smooth_part(std::size_t face) {
    const std::size_t piece = piece_[face], part = faces_[face].part;
    auto& parts = blend_->parts;
    const auto at = std::find_if(parts.begin(), parts.end(),
                                 [&](const SmoothPart& each) { return each.part == part && each.piece == piece; });
    if (at != parts.end()) return static_cast<std::size_t>(at - parts.begin());
    parts.push_back({part, piece, {}, {}});
    return parts.size() - 1;
  }

  void add(const TopoDS_Edge& edge, const TopoDS_Face& face, std::size_t number) {
    PartEdge each;
    each.curve = BRep_Tool::Curve(edge, each.first, each.last);
    each.parameters = BRep_Tool::CurveOnSurface(edge, face, each.first, each.last);
    each.face = static_cast<int>(number);
    if (each.curve.IsNull()) return;
    SmoothPart& part = blend_->parts[smooth_part(number)];
    for (int i = 0; i <= kPieces; ++i) {
      each.points.push_back(each.curve->Value(each.first + (each.last - each.first) * i / kPieces));
      part.box.Add(each.points.back());
    }
    part.edges.push_back(std::move(each));
  }

  const std::vector<PartOfFace>& faces_;
  std::shared_ptr<Blend> blend_ = std::make_shared<Blend>();
  std::vector<std::uint32_t> piece_;  // of each face the least of those that it is joined with
};

/// The distance of a face at (u, v), with what those of other parts add.
double blended_distance(const Blend& blend, std::size_t face, const std::vector<std::size_t>& others, double u,
                        double v) {
  const BlendedFace& own = blend.faces[face];
  // Beyond the face, where a surface is drawn out to meet others, edges of parts end; what they weigh does not.
  const gp_Pnt p =
      own.surface->Value(std::clamp(u, own.range.u0, own.range.u1), std::clamp(v, own.range.v0, own.range.v1));
  double sum = own.distance(u, v), weights = 1;
  for (const std::size_t other : others) {
    const PartEdge* nearest = nullptr;
    Found found{std::numeric_limits<double>::infinity(), 0};
    for (const PartEdge& edge : blend.parts[other].edges) {
      const Found here = closest_on(edge, p);
      if (here.away < found.away) found = here, nearest = &edge;
    }
    if (!nearest || found.away >= blend.length) continue;
    const gp_Pnt2d uv = nearest->parameters->Value(found.along);
    const double weight = part_weight(found.away / blend.length);
    sum += weight * blend.faces[static_cast<std::size_t>(nearest->face)].distance(uv.X(), uv.Y());
    weights += weight;
  }
  return sum / weights;
}

}  // namespace

std::vector<FaceDistance> blended_faces(const TopoDS_Shape& shape, const std::vector<PartOfFace>& faces,
                                        double length) {
  const BlendFinder finder(shape, faces, length);
  const std::shared_ptr<const Blend> blend = finder.blend();
  std::vector<FaceDistance> blended;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    blended.push_back(faces[f].distance);
    std::vector<std::size_t> others;
    for (std::size_t k = 0; k < blend->parts.size(); ++k) {
      const SmoothPart& part = blend->parts[k];
      const bool is_near = !part.edges.empty() && part.box.Distance(blend->faces[f].box) < length;
      if (part.part != faces[f].part && part.piece == finder.piece(f) && is_near) others.push_back(k);
    }
    if (others.empty()) continue;
    blended.back().detail = length;
    blended.back().at = [blend, f, others](double u, double v) { return blended_distance(*blend, f, others, u, v); };
  }
  return blended;
}

}  // namespace vdb_offset::cad
