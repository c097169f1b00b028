// SPDX-License-Identifier: Apache-2.0
#include "judge/judge.h"

#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepGProp.hxx>
#include <BRepLib.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "ground/process/progress.h"
#include "judge/edge_points.h"
#include "judge/soup.h"
#include "judge/soup_samples.h"
#include "offset/offset_surface.h"

namespace vdb_offset::cad {
namespace {

// Farthest that a miter may reach, in distances: edges of 10 degrees.
constexpr double kLongestMitre = 12;

// The angle of faces that do not touch.
constexpr double kSharp = 0.02;

// How far from a sharp edge its miter is looked for over other faces.
constexpr double kMitreOverFace = 3;

// Points that are held against the exact shape where its tessellation leaves doubt. More doubt than that is none.
constexpr int kMostDoubts = 300;

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

std::string text_of(const gp_Pnt& p) { return number(p.X()) + " " + number(p.Y()) + " " + number(p.Z()); }

// Which faces a point lies on and over.
std::string place_of(const Soup& source, const SoupPoint& foot, const Soup& result, const SoupPoint& p) {
  return " on face " + std::to_string(result.triangles()[p.triangle].face + 1) + " over the source's face " +
         std::to_string(source.triangles()[foot.triangle].face + 1);
}

struct Counts {
  int solids = 0, shells = 0, open = 0;
};

Counts counts_of(const TopoDS_Shape& s) {
  Counts c;
  for (TopExp_Explorer e(s, TopAbs_SOLID); e.More(); e.Next()) c.solids++;
  for (TopExp_Explorer e(s, TopAbs_SHELL); e.More(); e.Next()) {
    c.shells++;
    if (!BRep_Tool::IsClosed(e.Current())) c.open++;
  }
  return c;
}

// How much nearer than the distance a tessellation may make a point seem.
constexpr double kDoubtful = 0.1;
constexpr double kBeyondDoubt = 0.2;     // of the scale, twice what the source's triangles may be off
constexpr double kNoVolume = 1e-9;       // of the source's
constexpr double kMostVolumeOff = 1e-3;  // of a volume, as it is found by numbers

// Without solids: a point in one is at no distance from it.
TopoDS_Shape faces_of(const TopoDS_Shape& shape) {
  TopoDS_Compound all;
  BRep_Builder().MakeCompound(all);
  for (TopExp_Explorer e(shape, TopAbs_FACE); e.More(); e.Next()) BRep_Builder().Add(all, e.Current());
  return all;
}

// The edges of a shape where its faces do not touch.
TopoDS_Shape sharp_edges_of(const TopoDS_Shape& shape) {
  TopoDS_Compound all;
  BRep_Builder().MakeCompound(all);
  TopTools_IndexedDataMapOfShapeListOfShape faces;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces);
  for (int i = 1; i <= faces.Extent(); i++) {
    const TopoDS_Edge& e = TopoDS::Edge(faces.FindKey(i));
    if (BRep_Tool::Degenerated(e) || faces(i).Extent() < 2) continue;
    const TopoDS_Face &a = TopoDS::Face(faces(i).First()), &b = TopoDS::Face(faces(i).Last());
    if (!a.IsSame(b) && BRepLib::ContinuityOfFaces(e, a, b, kSharp) == GeomAbs_C0) BRep_Builder().Add(all, e);
  }
  return all;
}

bool is_along(const gp_Vec& way, const gp_Vec& normal) {
  return way.Crossed(normal).Magnitude() < 0.02 * way.Magnitude() * normal.Magnitude();
}

// The distance by the exact geometry, and whether it is to the inside of a face: along its normal.
double exact_distance(const TopoDS_Shape& shape, const gp_Pnt& point, bool& is_inside, double otherwise) {
  BRepExtrema_DistShapeShape d(BRepBuilderAPI_MakeVertex(point).Vertex(), shape);
  is_inside = false;
  if (!d.IsDone()) return otherwise;
  for (int i = 1; i <= d.NbSolution(); i++) {
    if (d.SupportTypeShape2(i) != BRepExtrema_IsInFace) continue;
    double u, v;
    d.ParOnFaceS2(i, u, v);
    gp_Pnt foot;
    gp_Vec du, dv;
    surface_of(TopoDS::Face(d.SupportOnShape2(i)))->D1(u, v, foot, du, dv);
    is_inside = is_inside || is_along(gp_Vec(foot, point), du.Crossed(dv));
  }
  return d.Value();
}

double exact_distance(const TopoDS_Shape& shape, const gp_Pnt& point) {
  bool is_inside;
  return exact_distance(shape, point, is_inside, 0);
}

// Shares of the judgement that are shown as done once triangles are made, and points of the result and of the source
// have been looked at. Not measured.
constexpr double kSoups = 0.2, kPoints = 0.6, kCover = 0.9;

/// Reports how many of some points have been looked at.
class ProgressOf {
 public:
  ProgressOf(double from, double to, std::size_t count) : part_(from, to), count_(count) {}

  void report(std::ptrdiff_t point) const {
    constexpr std::ptrdiff_t kBetween = 256;
    if (point % kBetween == 0) report_progress(static_cast<double>(point) / static_cast<double>(count_));
  }

 private:
  ProgressPart part_;
  std::size_t count_;
};

class Judge {
 public:
  Judge(const TopoDS_Shape& source, const TopoDS_Shape& made, const TopoDS_Shape& result, const AskedDistance& asked,
        const JudgeOptions& options)
      : source_(source),
        made_(made),
        result_(result),
        source_faces_(faces_of(source)),
        result_faces_(faces_of(result)),
        asked_(asked),
        distance_(asked.outward - asked.inward),
        far_(asked.scale),
        mitered_(sharp_edges_of(source), kMitreOverFace * far_),
        options_(options) {}

  Verdict judge() {
    check_topology();
    if (is_closed_) check_turned_round();
    if (!verdict_.faults.empty()) return verdict_;
    const Soup source(source_, 0.02 * far_, 0.1 * far_, 0.25), result(result_, 0.01 * far_, 0.02 * far_, 0.3);
    report_progress(kSoups);
    if (!result.is_complete()) fault("a face has no triangles");
    if (result.triangles().empty()) return verdict_;
    // Valid by its tolerances, a wire may still be open in (u, v): who makes triangles of the face leaves some out.
    if (const std::size_t open = result.open_sides(); is_closed_ && open > 0)
      fault("triangles of the result are open at " + std::to_string(open) + " sides", result.open_places());
    verdict_.volume = result.volume();
    if (is_closed_ && verdict_.volume >= 0 && verdict_.volume < kNoVolume * std::abs(source.volume()))
      fault("the result encloses nothing");
    if (is_closed_ && verdict_.volume < 0) fault("the result is turned inside out");
    if (asked_.is_even) {
      if (is_closed_ && (verdict_.volume > source.volume()) != (distance_ > 0))
        fault("the volume is not on the right side");
      check_points(source, result);
      check_cover(source, result);
    } else if (is_closed_ && asked_.has_one_side()) {
      check_side(source, result);
    }
    report_progress(kCover);
    if (is_closed_ && asked_.has_one_side()) check_enclosed(source, result);
    if (is_closed_) check_turns(result);
    if (!crossings(result).empty())
      if (const auto places = crossings(Soup(result_, 0.005 * far_, 0.01 * far_, 0.2)); !places.empty())
        fault("the result crosses itself", places);
    return verdict_;
  }

 private:
  void fault(const std::string& text, const std::vector<gp_Pnt>& places = {}) {
    verdict_.is_good = false;
    verdict_.faults.push_back(text);
    verdict_.places.insert(verdict_.places.end(), places.begin(), places.end());
  }

  void check_topology() {
    if (const BRepCheck_Analyzer check(result_); !check.IsValid()) {
      std::vector<gp_Pnt> places;
      for (TopExp_Explorer face(result_, TopAbs_FACE); face.More(); face.Next()) {
        if (check.IsValid(face.Current())) continue;
        for (TopExp_Explorer at(face.Current(), TopAbs_VERTEX); at.More(); at.Next())
          places.push_back(BRep_Tool::Pnt(TopoDS::Vertex(at.Current())));
      }
      fault("the topology is not valid", places);
    }
    const Counts was = counts_of(source_), is = counts_of(result_);
    is_closed_ = was.open == 0;
    // Solids may fall apart, and shells of them grow together or vanish: points tell whether they do so rightly.
    const bool may_differ = asked_.is_even && is_closed_ && was.solids > 0 && is.solids > 0;
    if (!may_differ && is.solids != was.solids)
      fault(std::to_string(is.solids) + " solids in place of " + std::to_string(was.solids));
    // Of a mesh, a shell in two parts is two.
    if (!may_differ && !options_.is_of_mesh && is.shells != was.shells)
      fault(std::to_string(is.shells) + " shells in place of " + std::to_string(was.shells));
    if (is.open > was.open) fault(std::to_string(is.open) + " shells are open");
  }

  // Walls that have passed each other by less than triangles resolve: readers would take the inner shell for the
  // outer one.
  void check_turned_round() {
    const double was = volume_of(source_), made = volume_of(made_), is = volume_of(result_);
    if (made * was < 0) fault("walls are gone: the result is turned inside out");
    if (std::abs(std::abs(made) - std::abs(is)) > kMostVolumeOff * std::max(std::abs(made), std::abs(is)))
      fault("walls are gone: readers turn a part of the result round");
  }

  // Of an offset to one side alone: whether points are on that side of the source, or near to it, where triangles leave
  // doubt, as what stays is.
  void check_side(const Soup& source, const Soup& result) {
    const std::vector<SoupPoint> points = spread(result, options_.samples / 10);
    const std::size_t every = step_of_turns(source, points.size());
    for (std::size_t i = 0; i < points.size(); i += every) {
      const gp_Pnt& point = points[i].point;
      if (source.contains(point) == (asked_.inward > 0)) continue;
      if (source.closest(point).distance <= kBeyondDoubt * far_) continue;
      fault("walls are gone: points are on the wrong side, as at " + text_of(point) + " on face " +
                std::to_string(result.triangles()[points[i].triangle].face + 1),
            {point});
      return;
    }
  }

  void check_points(const Soup& source, const Soup& result) {
    const std::vector<SoupPoint> points = spread(result, options_.samples);
    verdict_.samples = points.size();
    int near = 0, far = 0, doubts = 0, wrong_side = 0, n = 0;
    std::string place;
    verdict_.least = 1e300;
    const std::size_t every = step_of_turns(source, points.size());
    const ProgressOf progress(kSoups, kPoints, points.size());
    for (const SoupPoint& p : points) {
      progress.report(&p - points.data());
      SoupPoint foot = source.closest(p.point);
      double share = foot.distance / far_;
      // Beyond a sharp edge its miter may lie over the inside of a third face: of much of a thin wall's two sides.
      const auto is_mitered = [&] { return share > 1 + options_.tolerance && mitered_.has_near(p.point); };
      foot.is_inside = foot.is_inside && !is_mitered();
      if ((share < 1 - options_.tolerance || (foot.is_inside && share > 1 + options_.tolerance)) &&
          share > 1 - kDoubtful && doubts++ < kMostDoubts) {
        share = exact_distance(source_faces_, p.point, foot.is_inside, foot.distance) / far_;
        foot.is_inside = foot.is_inside && !is_mitered();
      }
      verdict_.least = std::min(verdict_.least, share);
      verdict_.most = std::max(verdict_.most, share);
      if (share < 1 - options_.tolerance && near++ == 0) place = text_of(p.point) + place_of(source, foot, result, p);
      if (share > (foot.is_inside ? 1 + options_.tolerance : kLongestMitre) && far++ == 0)
        place = text_of(p.point) + place_of(source, foot, result, p);
      const gp_Vec to(foot.point, p.point), out = source.outside(foot);
      if (foot.is_inside && (to.Dot(out) > 0) != (distance_ > 0)) wrong_side++;
      if (is_closed_ && n++ % every == 0 && source.contains(p.point) != (distance_ < 0)) wrong_side++;
    }
    if (near)
      fault(std::to_string(near) + " points are nearer than the distance (least " + number(verdict_.least) +
            ") as at " + place);
    if (far)
      fault(std::to_string(far) + " points are farther than the distance (most " + number(verdict_.most) + ") as at " +
            place);
    if (wrong_side) fault(std::to_string(wrong_side) + " points are on the wrong side");
  }

  // Whether an outward offset encloses the source, and an inward one none of its surface: a cavity that is missing, or
  // walls that have passed each other, leave points of the result where they ought to be.
  void check_enclosed(const Soup& source, const Soup& result) {
    const std::vector<SoupPoint> points = spread(source, options_.samples / 10);
    const std::size_t every = step_of_turns(result, points.size());
    const std::size_t faces = source.faces().size();  // the last points: one of each face
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i % every != 0 && i + faces < points.size()) continue;
      const gp_Pnt& point = points[i].point;
      if (result.contains(point) == (asked_.outward > 0) || result.closest(point).distance < 0.05 * far_) continue;
      fault("walls are gone: the result is on the wrong side of the source at " + text_of(point) + " on its face " +
            std::to_string(source.triangles()[points[i].triangle].face + 1));
      return;
    }
  }

  void check_turns(const Soup& result) {
    const std::vector<int> turned = turned_triangles(result, far_, options_.samples / 10, options_.is_of_mesh);
    if (turned.empty()) return;
    std::vector<gp_Pnt> places;
    places.reserve(turned.size());
    for (const int t : turned) places.push_back(middle_of(result.triangles()[t]));
    fault("a face lies within others, or is turned, as at " + text_of(places.front()) + " on face " +
              std::to_string(result.triangles()[turned.front()].face + 1),
          places);
  }

  // Where triangles cross, but at edges whose faces miss each other by as much as the topology allows.
  std::vector<gp_Pnt> crossings(const Soup& soup) const {
    constexpr std::size_t kMostCrossings = 200;
    std::vector<gp_Pnt> found = soup.crossings(kMostCrossings);
    std::erase_if(found, [&](const gp_Pnt& p) {
      bool is_told = false;
      for (TopExp_Explorer e(result_, TopAbs_EDGE); e.More() && !is_told; e.Next()) {
        const double tolerance = BRep_Tool::Tolerance(TopoDS::Edge(e.Current()));
        is_told = tolerance > 1e-4 * far_ && exact_distance(e.Current(), p) < 4 * tolerance + 0.02 * far_;
      }
      return is_told;
    });
    return found;
  }

  void check_cover(const Soup& source, const Soup& result) {
    int missing = 0, doubts = 0;
    double worst = 0;
    std::string place;
    const std::vector<SoupPoint> points = spread(source, options_.samples / 2);
    const ProgressOf progress(kPoints, kCover, points.size());
    for (const SoupPoint& p : points) {
      progress.report(&p - points.data());
      const gp_Pnt moved = p.point.Translated(source.outside(p) * distance_);
      if (source.closest(moved).distance < far_ * (1 - 1e-3)) continue;
      const double way = result.closest(moved).distance / far_;
      if (way > worst) place = text_of(moved) + place_of(source, p, result, result.closest(moved));
      worst = std::max(worst, way);
      if (way <= options_.tolerance || mitered_.has_near(moved)) continue;  // A miter may reach over it.
      if (doubts++ < kMostDoubts)
        missing += exact_distance(source_faces_, moved) > far_ * (1 - 1e-3) &&
                   exact_distance(result_faces_, moved) > far_ * options_.tolerance;
      else missing++;
    }
    if (missing)
      fault(std::to_string(missing) + " offset points are not in the result (farthest " + number(worst) + ") as at " +
            place);
  }

  TopoDS_Shape source_, made_, result_;
  TopoDS_Shape source_faces_, result_faces_;
  AskedDistance asked_;
  double distance_, far_;  // an even one, and the scale
  EdgePoints mitered_;     // the sharp edges
  JudgeOptions options_;
  Verdict verdict_;
  bool is_closed_ = false;
};

}  // namespace

double volume_of(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  return properties.Mass();
}

bool leaves_nothing(const TopoDS_Shape& source, double distance) {
  const double enough = std::abs(distance) * (1 - 1e-3);
  const Soup soup(source, 0.02 * std::abs(distance), 0.1 * std::abs(distance), 0.25);
  if (!soup.is_complete() || soup.open_sides() > 0) return false;
  const TopoDS_Shape faces = faces_of(source);
  for (const SoupPoint& p : spread(soup, JudgeOptions().samples)) {
    const gp_Pnt moved = p.point.Translated(soup.outside(p) * distance);
    if (soup.closest(moved).distance >= enough && exact_distance(faces, moved) >= enough) return false;
  }
  return true;
}

Verdict judge_offset(const TopoDS_Shape& source, const TopoDS_Shape& made, const TopoDS_Shape& result,
                     const AskedDistance& asked, const JudgeOptions& options) {
  try {
    return Judge(source, made, result, asked, options).judge();
  } catch (const Standard_Failure& failure) {
    Verdict v;
    v.is_good = false;
    v.faults.push_back(std::string("judging failed: ") + failure.GetMessageString());
    return v;
  }
}

}  // namespace vdb_offset::cad
