// SPDX-License-Identifier: Apache-2.0
#include "write/check_body.h"

#include <BRepCheck_Analyzer.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <optional>

#include "ground/process/progress.h"
#include "judge/judge.h"
#include "judge/moved_faces.h"
#include "judge/parameters.h"
#include "judge/soup.h"
#include "judge/soup_samples.h"
#include "write/own_process.h"
#include "write/thick_solids.h"
#include "write/write_model.h"

namespace vdb_offset::cad {
namespace {

// The share of a check that is shown as done once the body is written and read again. Measured on six models.
constexpr double kReadAgain = 0.15;

class BodyChecker {
 public:
  BodyChecker(const OffsetBody& body, const OffsetCadResult& result, const Asked& asked, Exactness exactness)
      : body_(body),
        result_(result),
        asked_(asked),
        is_hybrid_(exactness != Exactness::Exact && result.triangles > 0),
        may_doubt_(exactness == Exactness::Hybrid) {}

  MadeBody run() {
    io::CadWritten& facts = made_.facts;
    facts.gaps = result_.gaps;
    if (result_.shape.IsNull() || !result_.gaps.empty()) return std::move(made_);
    count_faces();
    const TopoDS_Shape again = read_again({result_.shape});
    const bool is_doubtful = !is_good(again);
    if (is_doubtful && !(may_doubt_ && !again.IsNull() && BRepCheck_Analyzer(again).IsValid())) return std::move(made_);
    if (asked_.write.thick && !make_thick()) return std::move(made_);
    if (!asked_.write.thick) {
      made_.shapes = solids_of(result_.shape);
      name_faces();
    }
    facts.made = is_doubtful           ? io::CadMade::Doubtful
                 : is_hybrid_          ? io::CadMade::Hybrid
                 : body_.body.is_solid ? io::CadMade::Solid
                                       : io::CadMade::Shells;
    return std::move(made_);
  }

 private:
  void gap(std::string text) { made_.facts.gaps.push_back(std::move(text)); }

  void count_faces() {
    io::CadWritten& facts = made_.facts;
    for (const CadFace face : result_.faces)
      ++(face == CadFace::Kept      ? facts.kept
         : face == CadFace::Fitted  ? facts.fitted
         : face == CadFace::Faceted ? facts.faceted
                                    : facts.swallowed);
    facts.fit_error = result_.fit_error / asked_.millimetres;
    facts.triangles = result_.triangles;
    facts.exact_area = result_.exact_area;
    facts.flat_area = result_.flat_area;
  }

  std::vector<TopoDS_Shape> solids_of(const TopoDS_Shape& shape) const {
    if (!body_.body.is_solid) return {shape};
    std::vector<TopoDS_Shape> solids;
    for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next()) solids.push_back(solid.Current());
    return solids;
  }

  void name_faces() {
    for (std::size_t k = 0; k < result_.made_of.size(); ++k)
      if (!result_.made_of[k].IsNull()) made_.faces.emplace_back(body_.source.face_numbers[k], result_.made_of[k]);
  }

  /// What a file of shapes holds, in millimetres; null if that is not as many bodies of the same kind.
  TopoDS_Shape read_again(const std::vector<TopoDS_Shape>& shapes) {
    WrittenModel model;
    model.millimetres = asked_.millimetres;
    for (const TopoDS_Shape& shape : shapes)
      for (const TopoDS_Shape& each : solids_of(shape)) {
        model.shapes.push_back(each);
        model.names.emplace_back();
        model.place_of.emplace_back();
      }
    const MemoryFile file;
    write_apart(model, asked_.write.format, file.path());
    const CadModel again = read_model(file.path(), asked_.write.format);
    const auto is_alike = [&](const Body& each) { return each.is_solid == body_.body.is_solid; };
    if (again.bodies.size() != model.shapes.size() ||
        !std::all_of(again.bodies.begin(), again.bodies.end(), is_alike)) {
      const auto alike = std::count_if(again.bodies.begin(), again.bodies.end(), is_alike);
      gap("read again, the file has " + std::to_string(alike) + (body_.body.is_solid ? " solids" : " shells") +
          " and not " + std::to_string(model.shapes.size()));
      return {};
    }
    const double millimetres = in_millimetres(again, asked_);
    if (again.bodies.size() == 1) return scaled(shape_of(again.bodies.front()).shape, millimetres);
    return together(again.bodies, [&](const Body& each) { return scaled(shape_of(each).shape, millimetres); });
  }

  bool is_good(const TopoDS_Shape& again) {
    if (again.IsNull()) return false;
    const ProgressPart part(kReadAgain, 1);
    io::CadWritten& facts = made_.facts;
    AskedDistance distance = AskedDistance::even(asked_.millimetres * asked_.write.distance);
    if (!body_.is_even() && !is_hybrid_ && !is_at_distances(distance)) return false;
    if (is_hybrid_) distance = sides();
    JudgeOptions options;
    options.is_of_mesh = is_hybrid_;
    const Verdict verdict = judge_offset(body_.source.shape, result_.shape, again, distance, options);
    if (distance.is_even) report_measured(verdict.samples, verdict.least, verdict.most);
    if (verdict.is_good && body_.body.is_solid) facts.volume = volume_of(again) / std::pow(asked_.millimetres, 3);
    facts.gaps.insert(facts.gaps.end(), verdict.faults.begin(), verdict.faults.end());
    made_.bad_places = verdict.places;
    return verdict.is_good;
  }

  /// To which sides the body's faces go.
  AskedDistance sides() const {
    AskedDistance distance = AskedDistance::even(asked_.millimetres * asked_.write.distance);
    distance.is_even = false;
    if (!body_.is_even()) distance.outward = distance.inward = asked_.largest();  // not known everywhere
    return distance;
  }

  void report_measured(std::size_t samples, double least, double most) {
    made_.facts.samples = samples;
    made_.facts.least = least;
    made_.facts.most = most;
  }

  /// Whether the faces of an uneven offset are where they ought to be at the same (u, v), to 1 % of the largest
  /// distance; `distance` receives how far that is.
  bool is_at_distances(AskedDistance& distance) {
    constexpr std::size_t kSamples = 10000;  // of all faces
    constexpr double kMostOff = 0.01;
    distance = {0, 0, asked_.largest(), false};
    std::size_t samples = 0;
    double least = 1, most = 1, worst = 0;
    std::vector<MovedFace> moved;
    std::size_t k = 0;
    for (TopExp_Explorer face(body_.source.shape, TopAbs_FACE); face.More(); face.Next(), ++k) {
      const FaceDistance& asked = body_.distances[k];
      moved.push_back({TopoDS::Face(face.Current()), faces_made_of(k), asked.at ? 0 : std::abs(asked.constant)});
      for (const TopoDS_Face& made : moved.back().made) {
        const AtParameters here = measure_at_parameters(TopoDS::Face(face.Current()), made, asked,
                                                        kSamples / result_.made_of.size() + 1, distance);
        samples += here.samples;
        least = std::min(least, here.least);
        most = std::max(most, here.most);
        worst = std::max(worst, here.worst);
      }
    }
    report_measured(samples, least, most);
    if (worst > kMostOff * asked_.largest()) {
      gap("a face is off its distance by up to " + std::to_string(worst / asked_.millimetres));
      return false;
    }
    // Faces that are held back end beside others that are held back less.
    if (asked_.write.held || !distance.has_one_side()) return true;
    const auto near = nearer_than_asked(moved, asked_.largest());
    if (!near) return true;
    gap("a face is nearer to the source than asked: " + std::to_string(near->distance / near->asked) +
        " of the distance, as at " + in_file(near->point.X()) + " " + in_file(near->point.Y()) + " " +
        in_file(near->point.Z()));
    return false;
  }

  /// What a face became: a trimmed one may be in pieces; a null one if nothing is left.
  std::vector<TopoDS_Face> faces_made_of(std::size_t k) const {
    std::vector<TopoDS_Face> faces;
    if (!result_.made_of[k].IsNull())
      for (TopExp_Explorer face(result_.made_of[k], TopAbs_FACE); face.More(); face.Next())
        faces.push_back(TopoDS::Face(face.Current()));
    if (faces.empty()) faces.emplace_back();
    return faces;
  }

  std::string in_file(double millimetres) const { return std::to_string(millimetres / asked_.millimetres); }

  /// The faces that stay: nothing is over them.
  std::vector<Opening> openings() const {
    std::vector<Opening> open;
    std::size_t k = 0;
    for (TopExp_Explorer face(body_.source.shape, TopAbs_FACE); face.More(); face.Next(), ++k)
      if (body_.stays(k)) open.push_back({TopoDS::Face(face.Current()), result_.made_of[k]});
    return open;
  }

  /// Takes the solids between source and offset in place of the offset, which is good; false if they are not.
  bool make_thick() {
    const double before = volume_of(body_.source.shape), after = volume_of(result_.shape);
    const std::vector<Opening> open = openings();
    const ThickSolids thick = thick_solids(body_.source.shape, result_.shape, std::abs(after) > std::abs(before), open);
    const std::vector<TopoDS_Shape>& solids = thick.solids;
    if (!body_.body.is_solid || solids.empty()) {
      gap(open.empty() ? "a shell of the source has no offset, or is not closed"
                       : "a shell of the source has no offset, or is not closed by the rims of its openings");
      return false;
    }
    const double volume = std::abs(after - before);
    const TopoDS_Shape again = read_again(solids);
    if (again.IsNull()) return false;
    constexpr double kMostOff = 1e-3;  // of the volume, as it is found by numbers
    const double found = volume_of(again);
    if (!BRepCheck_Analyzer(again).IsValid() || !(std::abs(found - volume) <= kMostOff * volume) ||
        !Soup::of_result(again, asked_.largest()).crossings(1).empty()) {
      gap("read again, the thick solid is not valid, or crosses itself");
      return false;
    }
    made_.shapes = solids;
    name_faces();
    std::size_t k = 0;
    for (TopExp_Explorer face(body_.source.shape, TopAbs_FACE); face.More(); face.Next(), ++k)
      made_.faces.emplace_back(body_.source.face_numbers[k], face.Current());
    name_cut_faces(thick);
    made_.facts.volume = found / std::pow(asked_.millimetres, 3);
    return true;
  }

  /// Has what is cut from faces told as these are.
  void name_cut_faces(const ThickSolids& thick) {
    const auto known = made_.faces;
    for (const auto& [original, face] : thick.cut) {
      const auto from = std::find_if(known.begin(), known.end(), [&, &whole = original](const auto& each) {
        for (TopExp_Explorer one(each.second, TopAbs_FACE); one.More(); one.Next())
          if (one.Current().IsSame(whole)) return true;
        return false;
      });
      if (from != known.end()) made_.faces.emplace_back(from->first, face);
    }
  }

  const OffsetBody& body_;
  const OffsetCadResult& result_;
  const Asked& asked_;
  const bool is_hybrid_, may_doubt_;
  MadeBody made_;
};

}  // namespace

MadeBody check_body(const OffsetBody& body, const OffsetCadResult& result, const Asked& asked, Exactness exactness) {
  return BodyChecker(body, result, asked, exactness).run();
}

double in_millimetres(const CadModel& again, const Asked& asked) {
  return again.has_unit ? again.unit_micrometres / 1000 : asked.millimetres;
}

}  // namespace vdb_offset::cad
