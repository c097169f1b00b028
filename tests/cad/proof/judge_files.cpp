// SPDX-License-Identifier: Apache-2.0
#include "cad/proof/judge_files.h"

#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cad/proof/sampled_face.h"

namespace cad_proof {
namespace {

// How much nearer than the distance a point may be, as a share of it.
constexpr double kNearer = 1e-3;
// How far points are put before and behind the offset, as shares of the distance.
constexpr double kBeside = 0.02;
// Mitres of sharp edges reach over other faces: beside them nothing is known of what is farther than the distance.
constexpr double kMitre = 4;
// How far a face may be from the offset of the face of its name: ten times what surfaces are fitted to.
constexpr double kOffSurface = 1e-3;

int count(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  int number = 0;
  for (TopExp_Explorer found(shape, kind); found.More(); found.Next()) ++number;
  return number;
}

/// Whether every edge is used twice, once each way, but those of no length.
bool is_closed(const TopoDS_Shape& shape) {
  TopTools_IndexedDataMapOfShapeListOfShape faces;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces);
  for (int k = 1; k <= faces.Extent(); ++k) {
    if (BRep_Tool::Degenerated(TopoDS::Edge(faces.FindKey(k)))) continue;
    int forward = 0, backward = 0;
    TopTools_IndexedMapOfShape seen;
    for (const TopoDS_Shape& face : faces(k)) {
      if (seen.Contains(face)) continue;
      seen.Add(face);
      for (TopExp_Explorer edge(face, TopAbs_EDGE); edge.More(); edge.Next())
        if (edge.Current().IsSame(faces.FindKey(k)))
          ++(edge.Current().Orientation() == TopAbs_FORWARD ? forward : backward);
    }
    if (forward != 1 || backward != 1) return false;
  }
  return true;
}

TopoDS_Shape faces_of(const TopoDS_Shape& shape) {
  TopoDS_Compound all;
  BRep_Builder().MakeCompound(all);
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) BRep_Builder().Add(all, face.Current());
  return all;
}

/// The edges where faces meet at an angle.
TopoDS_Shape sharp_edges_of(const TopoDS_Shape& shape) {
  TopoDS_Compound all;
  BRep_Builder().MakeCompound(all);
  TopTools_IndexedDataMapOfShapeListOfShape faces;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces);
  for (int k = 1; k <= faces.Extent(); ++k) {
    const TopoDS_Edge& edge = TopoDS::Edge(faces.FindKey(k));
    if (BRep_Tool::Degenerated(edge)) continue;
    if (BRepLib::ContinuityOfFaces(edge, TopoDS::Face(faces(k).First()), TopoDS::Face(faces(k).Last()), 0.01) ==
        GeomAbs_C0)
      BRep_Builder().Add(all, edge);
  }
  return all;
}

double distance_to(const TopoDS_Shape& shape, const gp_Pnt& point) {
  const BRepExtrema_DistShapeShape found(BRepBuilderAPI_MakeVertex(point).Vertex(), shape);
  return found.IsDone() && found.NbSolution() > 0 ? found.Value() : 1e300;
}

std::string text_of(const gp_Pnt& p) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.5g, %.5g, %.5g)", p.X(), p.Y(), p.Z());
  return text;
}

class FileJudge {
 public:
  FileJudge(const StepFile& source, const StepFile& result, double distance, const PointCounts& points)
      : source_(source),
        result_(result),
        distance_(distance),
        far_(std::abs(distance)),
        points_(points),
        source_faces_(faces_of(source.shape)),
        sharp_edges_(sharp_edges_of(source.shape)),
        in_source_(source.shape),
        in_result_(result.shape) {}

  Findings judge() {
    check_topology();
    if (!findings_.faults.empty()) return findings_;
    findings_.volume = volume_of(result_.shape);
    if (findings_.volume <= 0) fault("the result is turned inside out, or encloses nothing");
    if ((findings_.volume > volume_of(source_.shape)) != (distance_ > 0)) fault("the volume is not on its side");
    const FaceComparison& equal = findings_.equal = compare_faces(source_, result_, distance_, points_.equal);
    if (equal.faces == 0) fault("no face of the result has the name of one of the source");
    if (equal.worst > kOffSurface)
      fault("face " + equal.worst_of + " is off by " + std::to_string(equal.worst) + " distances");
    check_points_of_result();
    check_points_beside();
    return findings_;
  }

 private:
  void fault(const std::string& text) { findings_.faults.push_back(text); }

  void check_topology() {
    if (!BRepCheck_Analyzer(result_.shape).IsValid()) fault("the topology is not valid");
    for (const auto kind : {TopAbs_SOLID, TopAbs_SHELL})
      if (count(result_.shape, kind) != count(source_.shape, kind))
        fault(std::to_string(count(result_.shape, kind)) + (kind == TopAbs_SOLID ? " solids" : " shells") +
              " in place of " + std::to_string(count(source_.shape, kind)));
    if (!is_closed(result_.shape)) fault("the result is not closed");
  }

  bool is_within(BRepClass3d_SolidClassifier& solid, const gp_Pnt& point) const {
    solid.Perform(point, 1e-7);
    return solid.State() == TopAbs_IN;
  }

  void check_points_of_result() {
    Numbers numbers(2);
    const int faces = count(result_.shape, TopAbs_FACE), each = std::max(3, points_.beside / faces);
    findings_.least = 1e300;
    int near = 0, wrong_side = 0;
    std::string at;
    for (TopExp_Explorer face(result_.shape, TopAbs_FACE); face.More(); face.Next()) {
      const SampledFace sampled(TopoDS::Face(face.Current()));
      for (int k = 0; k < each; ++k) {
        const auto uv = sampled.inside(numbers);
        if (!uv) continue;
        const gp_Pnt point = sampled.point(*uv);
        ++findings_.points;
        const double share = distance_to(source_faces_, point) / far_;
        if (share < findings_.least) {
          findings_.least = share;
          at = text_of(point);
        }
        near += share < 1 - kNearer;
        wrong_side += is_within(in_source_, point) != (distance_ < 0);
      }
    }
    if (near > 0)
      fault(std::to_string(near) + " points are nearer than the distance (" + std::to_string(findings_.least) +
            ") as at " + at);
    if (wrong_side > 0) fault(std::to_string(wrong_side) + " points are on the wrong side of the source");
  }

  /// A point just before the offset is nearer than the distance, where none of the result's solid may begin (or,
  /// outward, all is solid); one just behind it is solid inward and outward not, but where a miter reaches over it.
  void check_points_beside() {
    Numbers numbers(3);
    const int each = std::max(2, points_.beside / std::max<int>(1, static_cast<int>(source_.faces.size())));
    for (const auto& [name, face] : source_.faces) {
      const SampledFace sampled(face);
      int missing = 0, too_much = 0;
      std::string at;
      for (int k = 0; k < each; ++k) {
        const auto uv = sampled.inside(numbers);
        const auto normal = uv ? sampled.outside(*uv) : std::nullopt;
        if (!normal) continue;
        const gp_Pnt before = sampled.point(*uv).Translated(*normal * distance_ * (1 - kBeside));
        const gp_Pnt behind = sampled.point(*uv).Translated(*normal * distance_ * (1 + kBeside));
        ++findings_.points;
        if (is_within(in_result_, before) != (distance_ > 0)) {
          ++missing;
          at = text_of(before);
        }
        if (distance_to(source_faces_, behind) < far_ * (1 + kBeside - kNearer)) continue;
        if (is_within(in_result_, behind) == (distance_ < 0)) continue;
        if (distance_to(sharp_edges_, behind) < kMitre * far_) continue;
        ++too_much;
        at = text_of(behind);
      }
      if (missing > 0)
        fault("over face " + name + " " + std::to_string(missing) +
              " points before the offset are behind the result, as " + at);
      if (too_much > 0)
        fault("over face " + name + " " + std::to_string(too_much) +
              " points behind the offset are before the result, as " + at);
    }
  }

  const StepFile &source_, &result_;
  double distance_, far_;
  PointCounts points_;
  TopoDS_Shape source_faces_, sharp_edges_;
  BRepClass3d_SolidClassifier in_source_, in_result_;
  Findings findings_;
};

}  // namespace

Findings judge_files(const StepFile& source, const StepFile& result, double distance, const PointCounts& points) {
  return FileJudge(source, result, distance, points).judge();
}

}  // namespace cad_proof
