// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/cad/write/blended_faces.h"

#include <BRepBndLib.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Curve.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <gp_Pnt2d.hxx>
#include <limits>
#include <memory>
#include <numeric>

#include "vdb_offset/mesh/part_weight.h"

namespace vdb_offset::cad {
namespace {

// Normals that are farther apart along an edge make it sharp, in radians. As edges are told apart in place.cpp.
constexpr double kSmoothBend = 0.06;
// Where along an edge that is looked at.
constexpr double kPlacesAlong[] = {0.03, 0.25, 0.5, 0.75, 0.97};
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
      // One that is met twice has the number of the first time.
      if (numbers_.Add(face.Current()) > static_cast<int>(number_.size())) number_.push_back(blend_->faces.size());
      BlendedFace& each = blend_->faces.emplace_back();
      each.surface = surface_of(TopoDS::Face(face.Current()));
      BRepTools::UVBounds(TopoDS::Face(face.Current()), each.range.u0, each.range.u1, each.range.v0, each.range.v1);
      BRepBndLib::Add(face.Current(), each.box);
      each.distance = faces[blend_->faces.size() - 1].distance;
    }
    blend_->length = length;
    piece_.resize(blend_->faces.size());
    std::iota(piece_.begin(), piece_.end(), std::size_t{0});
    TopExp::MapShapesAndUniqueAncestors(shape, TopAbs_EDGE, TopAbs_FACE, edges_);
    for (int pass : {0, 1})
      for (int e = 1; e <= edges_.Extent(); ++e) take_edge(e, pass == 0);
  }

  std::shared_ptr<const Blend> blend() const { return blend_; }
  std::size_t piece(std::size_t face) const { return piece_of(face); }

 private:
  std::size_t piece_of(std::size_t face) const {
    while (piece_[face] != face) face = piece_[face];
    return face;
  }

  std::size_t smooth_part(std::size_t face) {
    const std::size_t piece = piece_of(face), part = faces_[face].part;
    auto& parts = blend_->parts;
    const auto at = std::find_if(parts.begin(), parts.end(),
                                 [&](const SmoothPart& each) { return each.part == part && each.piece == piece; });
    if (at != parts.end()) return static_cast<std::size_t>(at - parts.begin());
    parts.push_back({part, piece, {}, {}});
    return parts.size() - 1;
  }

  gp_Vec outside(const TopoDS_Face& face, std::size_t number, const gp_Pnt2d& uv) const {
    const BlendedFace& own = blend_->faces[number];
    const gp_Vec n = unit_normal(*own.surface, uv.X(), uv.Y(), own.range);
    return face.Orientation() == TopAbs_REVERSED ? -n : n;
  }

  bool is_smooth(const TopoDS_Edge& edge, const std::array<TopoDS_Face, 2>& faces,
                 const std::array<std::size_t, 2>& numbers) const {
    double first = 0, last = 0;
    const Handle(Geom2d_Curve) a = BRep_Tool::CurveOnSurface(edge, faces[0], first, last);
    const Handle(Geom2d_Curve) b = BRep_Tool::CurveOnSurface(edge, faces[1], first, last);
    if (a.IsNull() || b.IsNull()) return false;
    return std::all_of(std::begin(kPlacesAlong), std::end(kPlacesAlong), [&](double part) {
      const double t = first + part * (last - first);
      const gp_Vec n = outside(faces[0], numbers[0], a->Value(t)), m = outside(faces[1], numbers[1], b->Value(t));
      return n.Magnitude() < 0.5 || m.Magnitude() < 0.5 || n.Angle(m) < kSmoothBend;
    });
  }

  /// Joins the faces of smooth edges; or adds what such edges are for parts.
  void take_edge(int e, bool joins) {
    const TopoDS_Edge edge = TopoDS::Edge(edges_.FindKey(e));
    const TopTools_ListOfShape& around = edges_(e);
    if (around.Extent() != 2 || BRep_Tool::Degenerated(edge)) return;
    const std::array<TopoDS_Face, 2> faces = {TopoDS::Face(around.First()), TopoDS::Face(around.Last())};
    const auto number = [&](const TopoDS_Face& face) {
      return number_[static_cast<std::size_t>(numbers_.FindIndex(face) - 1)];
    };
    const std::array<std::size_t, 2> numbers = {number(faces[0]), number(faces[1])};
    if (!is_smooth(edge, faces, numbers)) return;
    if (joins) {
      const std::size_t a = piece_of(numbers[0]), b = piece_of(numbers[1]);
      piece_[std::max(a, b)] = std::min(a, b);
      return;
    }
    if (faces_[numbers[0]].part == faces_[numbers[1]].part) return;
    for (const int side : {0, 1}) add(edge, faces[side], numbers[side]);
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
  TopTools_IndexedMapOfShape numbers_;
  std::vector<std::size_t> number_;  // of each face of that map
  TopTools_IndexedDataMapOfShapeListOfShape edges_;
  std::vector<std::size_t> piece_;  // of each face the least of those that it is joined with
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
