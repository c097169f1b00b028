// SPDX-License-Identifier: Apache-2.0
#include "write/write_offset.h"

#include <BRepCheck_Analyzer.hxx>
#include <BRep_Builder.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>

#include <algorithm>
#include <cmath>
#include <optional>

#include "ground/process/progress.h"
#include "judge/clearance.h"
#include "judge/judge.h"
#include "judge/parameters.h"
#include "judge/soup.h"
#include "offset/offset_solid.h"
#include "trim/trim_offset.h"
#include "write/assemblies.h"
#include "write/body_shape.h"
#include "write/faceted.h"
#include "write/offset_bodies.h"
#include "write/own_process.h"
#include "write/thick_solids.h"
#include "write/write_model.h"

namespace vdb_offset::cad {
namespace {

constexpr std::size_t kMostGaps = 8;    // that are reported
constexpr unsigned kMostTrimming = 60;  // seconds, of a trial
constexpr unsigned kMostHolding = 120;  // seconds, of the whole model with its faces held back

/// What is tried.
enum class Attempt {
  Whole,       ///< All bodies; faces or triangles of those that are not good.
  Trimmed,     ///< All bodies, crossing faces trimmed, swallowed edges taken out first; or nothing.
  TrimmedAll,  ///< As above, with no edge taken out.
  Rest,        ///< Faces or triangles alone.
  Facets,      ///< Triangles alone.
};

/// Up to which share of the request an attempt is shown as done: most succeed at first.
double shown_until(Attempt attempt) {
  switch (attempt) {
    case Attempt::Whole:
      return 0.85;
    case Attempt::Trimmed:
      return 0.9;
    case Attempt::TrimmedAll:
      return 0.95;
    default:
      return 1;
  }
}

// Shares of an attempt that are shown as done once its bodies are made, and once they are written and read again.
// Measured on six models: making takes 0.1 to 0.4.
constexpr double kMade = 0.2, kReadAgain = 0.3;

bool is_trial(Attempt attempt) { return attempt == Attempt::Trimmed || attempt == Attempt::TrimmedAll; }

class OffsetWriter {
 public:
  OffsetWriter(const CadModel& model, const io::WriteCad& write)
      : model_(model), write_(write), millimetres_(model.has_unit ? model.unit_micrometres / 1000 : 1) {}

  io::CadWritten run(Attempt attempt) {
    if (attempt == Attempt::Facets) {
      write_facets();
      return std::move(written_);
    }
    make(attempt == Attempt::TrimmedAll);
    if (attempt == Attempt::Whole && try_whole()) return std::move(written_);
    if (is_trial(attempt)) {
      if (trim()) try_whole();
      return std::move(written_);
    }
    if (write_.faceted) write_facets();
    else write_faces();
    written_.gaps.resize(std::min(written_.gaps.size(), kMostGaps));
    return std::move(written_);
  }

 private:
  double largest() const { return millimetres_ * std::abs(write_.distance); }

  void make(bool keeps_turned) {
    const ProgressPart part(0, kMade);
    OffsetBodies made = offset_bodies(model_, write_, millimetres_, keeps_turned);
    written_.held = made.held;
    written_.least_held = made.least_held;
    written_.gaps = std::move(made.gaps);
    for (OffsetBody& each : made.all) bodies_.push_back(std::move(each));
    for (const OffsetBody& each : bodies_) {
      for (const CadFace face : each.result.faces)
        ++(face == CadFace::Kept      ? written_.kept
           : face == CadFace::Fitted  ? written_.fitted
           : face == CadFace::Missing ? written_.missing
                                      : written_.swallowed);
      written_.fit_error = std::max(written_.fit_error, each.result.fit_error / millimetres_);
      for (const std::string& gap : each.result.gaps) written_.gaps.push_back(gap);
    }
  }

  /// Trims the solids where their faces cross, and counts faces anew; false if there is nothing to trim.
  bool trim() {
    for (const OffsetBody& body : bodies_)
      if (!body.is_even() || body.result.shape.IsNull() || !body.result.gaps.empty()) return false;
    for (OffsetBody& body : bodies_)
      if (body.body.is_solid) body.result = trim_offset(body.source.shape, body.result, millimetres_ * write_.distance);
    written_.swallowed = 0;
    for (const OffsetBody& body : bodies_)
      written_.swallowed +=
          static_cast<std::size_t>(std::count(body.result.faces.begin(), body.result.faces.end(), CadFace::Swallowed));
    count_made();
    return true;
  }

  /// What is told of a body's faces goes with the faces that are made of them.
  void name_faces(const OffsetBody& body, WrittenModel& model) const {
    for (std::size_t k = 0; k < body.result.made_of.size() && k < body.source.face_numbers.size(); ++k)
      for (TopExp_Explorer face(body.result.made_of[k], TopAbs_FACE); face.More(); face.Next())
        model.faces.emplace_back(face.Current(), body.body.faces[body.source.face_numbers[k]].facts);
  }

  WrittenModel empty_model() const {
    WrittenModel model;
    model.millimetres = millimetres_;
    model.places = model_.places;
    return model;
  }

  void add(const TopoDS_Shape& shape, const Body& body, WrittenModel& model) const {
    model.shapes.push_back(shape);
    model.names.push_back(body.faces.empty() ? "" : body.faces.front().facts.solid);
    model.place_of.push_back(place_of(body, model_.places));
  }

  /// Writes all bodies, reads them again and judges them; false if one of them is not good.
  bool try_whole() {
    WrittenModel model = empty_model();
    bool all_solid = true;
    for (const OffsetBody& body : bodies_) {
      if (body.result.shape.IsNull() || !body.result.gaps.empty()) return false;
      add(body.result.shape, body.body, model);
      name_faces(body, model);
      all_solid = all_solid && body.body.is_solid;
    }
    const MemoryFile file;
    write_apart(model, write_.format, file.path());
    const CadModel again = read_model(file.path(), write_.format);
    if (again.bodies.size() != bodies_.size()) {
      written_.gaps.push_back("read again, the file has " + std::to_string(again.bodies.size()) + " bodies and not " +
                              std::to_string(bodies_.size()));
      return false;
    }
    written_.least = INFINITY;
    written_.samples = 0;
    const ProgressPart part(kReadAgain, 1);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      report_progress(static_cast<double>(i) / static_cast<double>(bodies_.size()));
      if (!is_good(bodies_[i], again.bodies[i], in_millimetres(again))) return false;
    }
    if (bodies_.size() > 1 && get_into_each_other(again)) {
      written_.gaps.emplace_back("bodies get into each other");
      return false;
    }
    if (!write_.obstacle_triangles.empty() && !is_clear_of_obstacles(again)) return false;
    written_.bytes = file.bytes();
    written_.made = all_solid ? io::CadMade::Solid : io::CadMade::Shells;
    return !write_.thick || make_thick();
  }

  /// Writes the solids between source and offset in place of the offset, which is good; false if they are not.
  bool make_thick() {
    if (written_.held > 0 && written_.least_held <= 0) {
      written_.gaps.emplace_back("faces that are held back where they are leave no wall");
      return false;
    }
    WrittenModel model = empty_model();
    double volume = 0;
    for (const OffsetBody& body : bodies_) {
      const std::vector<TopoDS_Shape> solids = thick_solids(body.source.shape, body.result.shape, write_.distance > 0);
      if (!body.body.is_solid || solids.empty()) {
        written_.gaps.emplace_back("a shell of the source has no offset, or is not closed");
        return false;
      }
      for (const TopoDS_Shape& solid : solids) add(solid, body.body, model);
      name_faces(body, model);
      std::size_t k = 0;
      for (TopExp_Explorer face(body.source.shape, TopAbs_FACE); face.More(); face.Next(), ++k)
        model.faces.emplace_back(face.Current(), body.body.faces[body.source.face_numbers[k]].facts);
      volume += std::abs(volume_of(body.result.shape) - volume_of(body.source.shape));
    }
    const MemoryFile file;
    write_apart(model, write_.format, file.path());
    const CadModel again = read_model(file.path(), write_.format);
    double found = 0;
    bool is_valid = again.bodies.size() == model.shapes.size();
    for (const Body& body : again.bodies) {
      const TopoDS_Shape shape = scaled(shape_of(body).shape, in_millimetres(again));
      is_valid =
          is_valid && body.is_solid && BRepCheck_Analyzer(shape).IsValid() && soup_of(shape).crossings(1).empty();
      found += volume_of(shape);
    }
    constexpr double kMostOff = 1e-3;  // of the volume, as it is found by numbers
    if (!is_valid || !(std::abs(found - volume) <= kMostOff * volume)) {
      written_.gaps.emplace_back("read again, the thick solid is not valid, or crosses itself");
      return false;
    }
    written_.bytes = file.bytes();
    written_.volume = found / std::pow(millimetres_, 3);
    return true;
  }

  /// The length of the unit of a file that is read again.
  double in_millimetres(const CadModel& again) const {
    return again.has_unit ? again.unit_micrometres / 1000 : millimetres_;
  }

  bool is_good(const OffsetBody& body, const Body& again, double millimetres) {
    const TopoDS_Shape shape = scaled(shape_of(again).shape, millimetres);
    AskedDistance asked = AskedDistance::even(millimetres_ * write_.distance);
    if (!body.is_even() && !is_at_distances(body, asked)) return false;
    const Verdict verdict = judge_offset(body.source.shape, body.result.shape, shape, asked, {});
    if (body.is_even()) report_measured(verdict.samples, verdict.least, verdict.most);
    if (verdict.is_good) add_volume(again, shape);
    written_.gaps.insert(written_.gaps.end(), verdict.faults.begin(), verdict.faults.end());
    return verdict.is_good;
  }

  void report_measured(std::size_t samples, double least, double most) {
    written_.samples += samples;
    written_.least = std::min(written_.least, least);
    written_.most = std::max(written_.most, most);
  }

  /// Whether the faces of an uneven offset are where they ought to be at the same (u, v), to 1 % of the largest
  /// distance; `asked` receives how far that is.
  bool is_at_distances(const OffsetBody& body, AskedDistance& asked) {
    constexpr std::size_t kSamples = 10000;  // of all faces
    constexpr double kMostOff = 0.01;
    asked = {0, 0, largest(), false};
    std::size_t samples = 0;
    double least = 1, most = 1, worst = 0;
    const OffsetCadResult& result = body.result;
    std::size_t k = 0;
    for (TopExp_Explorer face(body.source.shape, TopAbs_FACE); face.More(); face.Next(), ++k) {
      const AtParameters here = measure_at_parameters(TopoDS::Face(face.Current()), TopoDS::Face(result.made_of[k]),
                                                      body.distances[k], kSamples / result.made_of.size() + 1, asked);
      samples += here.samples;
      least = std::min(least, here.least);
      most = std::max(most, here.most);
      worst = std::max(worst, here.worst);
    }
    report_measured(samples, least, most);
    if (worst <= kMostOff * largest()) return true;
    written_.gaps.push_back("a face is off its distance by up to " + std::to_string(worst / millimetres_));
    return false;
  }

  void add_volume(const Body& again, const TopoDS_Shape& shape) {
    if (again.is_solid) written_.volume += volume_of(shape) / std::pow(millimetres_, 3);
  }

  Soup soup_of(const TopoDS_Shape& shape) const { return result_soup(shape, largest()); }

  /// Whether bodies get into each other: faces cross, or points just inside of one are inside of another.
  bool get_into_each_other(const CadModel& again) const {
    const auto shape_in = [&](const Body& body) { return scaled(shape_of(body).shape, in_millimetres(again)); };
    std::vector<Soup> soups;
    for (const Body& body : again.bodies)
      if (body.is_solid) soups.push_back(soup_of(shape_in(body)));
    if (!soup_of(together(again.bodies, shape_in)).crossings(1).empty()) return true;
    for (const Soup& one : soups)
      for (const Soup& other : soups)
        if (&one != &other && reaches_into(one, other)) return true;
    return false;
  }

  /// Whether the bodies neither cross nor enclose a part of an obstacle, nor come nearer to it than asked, or than the
  /// source is; measures the least gap. A part that goes through the source is in nobody's way.
  bool is_clear_of_obstacles(const CadModel& again) {
    constexpr double kOff = 0.01;  // of the distance, as far as triangles show
    const double asked = millimetres_ * write_.clearance;
    const Soup before = soup_of(together(bodies_, [](const OffsetBody& each) { return each.source.shape; }));
    const Soup after = soup_of(
        together(again.bodies, [&](const Body& body) { return scaled(shape_of(body).shape, in_millimetres(again)); }));
    const auto encloses = [](const Soup& soup, const Soup& part) {
      return soup.contains(part.triangles().front().points[0]);
    };
    for (const Soup& part : connected_parts(obstacle_points(write_, millimetres_), write_.obstacle_triangles)) {
      if (before.crosses(part)) continue;
      const auto& corner = part.triangles().front().points[0];
      const double gap = gap_between(after, part, after.triangles().front().points[0].Distance(corner));
      const bool is_hit = after.crosses(part) || encloses(after, part) != encloses(before, part);
      if (is_hit || gap < gap_between(before, part, asked) - kOff * largest()) {
        written_.gaps.emplace_back("the result comes nearer to an obstacle than asked, or meets it");
        return false;
      }
      if (written_.obstacle_gap < 0 || gap / millimetres_ < written_.obstacle_gap)
        written_.obstacle_gap = gap / millimetres_;
    }
    return true;
  }

  bool reaches_into(const Soup& one, const Soup& other) const {
    constexpr std::size_t kMostPoints = 200;
    const double inward = 1e-3 * largest();
    const std::size_t count = one.triangles().size(), step = std::max<std::size_t>(1, count / kMostPoints);
    for (std::size_t t = 0; t < count; t += step) {
      const SoupPoint at = one.on_triangle(static_cast<int>(t), 1.0 / 3, 1.0 / 3);
      if (other.contains(at.point.Translated(one.outside(at) * -inward))) return true;
    }
    return false;
  }

  void write_facets() {
    written_.kept = written_.fitted = written_.swallowed = written_.missing = 0;
    WrittenModel model = empty_model();
    model.shapes.push_back(scaled(faceted_shape(write_.positions, write_.triangles), millimetres_));
    model.names.emplace_back();
    model.place_of.emplace_back();
    finish(model, io::CadMade::Facets);
  }

  /// Counts the faces of the source by what is written of them.
  void count_made() {
    written_.kept = written_.fitted = written_.missing = 0;
    for (const OffsetBody& body : bodies_)
      for (std::size_t k = 0; k < body.result.faces.size(); ++k) {
        const CadFace made = body.result.faces[k];
        if (made == CadFace::Swallowed) continue;
        const bool is_there = !body.result.shape.IsNull() && k < body.result.made_of.size() &&
                              !body.result.made_of[k].IsNull() && BRepCheck_Analyzer(body.result.made_of[k]).IsValid();
        ++(!is_there ? written_.missing : made == CadFace::Fitted ? written_.fitted : written_.kept);
      }
  }

  /// Writes the faces that there are, as none of a solid.
  void write_faces() {
    WrittenModel model = empty_model();
    count_made();
    for (const OffsetBody& body : bodies_) {
      TopoDS_Compound faces;
      BRep_Builder builder;
      builder.MakeCompound(faces);
      bool any = false;
      for (TopExp_Explorer face(body.result.shape, TopAbs_FACE); !body.result.shape.IsNull() && face.More();
           face.Next()) {
        if (!BRepCheck_Analyzer(face.Current()).IsValid()) continue;
        builder.Add(faces, face.Current());
        any = true;
      }
      if (!any) continue;
      add(faces, body.body, model);
      name_faces(body, model);
    }
    if (!model.shapes.empty()) finish(model, io::CadMade::Faces);
  }

  void finish(const WrittenModel& model, io::CadMade made) {
    const MemoryFile file;
    write_apart(model, write_.format, file.path());
    read_model(file.path(), write_.format);
    written_.bytes = file.bytes();
    written_.made = made;
    written_.least = written_.most = written_.volume = 0;
    written_.samples = 0;
  }

  const CadModel& model_;
  const io::WriteCad& write_;
  const double millimetres_;  // of the file's unit
  std::vector<OffsetBody> bodies_;
  io::CadWritten written_;
};

/// How long an attempt may take; 0: as long as it takes.
unsigned seconds_for(Attempt attempt, const io::WriteCad& write) {
  if (is_trial(attempt)) return kMostTrimming;
  return write.held && attempt == Attempt::Whole ? kMostHolding : 0;
}

bool is_whole(const io::CadWritten& written) {
  return written.made == io::CadMade::Solid || written.made == io::CadMade::Shells;
}

}  // namespace

io::CadWritten write_offset(const CadModel& model, const io::WriteCad& write) {
  std::size_t faces = 0;
  for (const Body& body : model.bodies) faces += body.faces.size();
  if (write.of_face.size() != 1 && write.of_face.size() != faces)
    throw InvalidCad("expected distances of " + std::to_string(faces) + " faces, got " +
                     std::to_string(write.of_face.size()));
  std::vector<std::string> gaps;
  std::optional<io::CadWritten> rest;
  double shown = 0;
  for (const Attempt attempt :
       {Attempt::Whole, Attempt::Trimmed, Attempt::TrimmedAll, Attempt::Rest, Attempt::Facets}) {
    if (attempt == Attempt::Facets && !write.faceted) break;
    if (attempt == Attempt::Rest && rest) return std::move(*rest);
    if (write.held && (is_trial(attempt) || attempt == Attempt::Rest)) continue;
    std::string gap;
    const ProgressPart part(shown, shown_until(attempt));
    shown = shown_until(attempt);
    auto written =
        in_own_process([&] { return OffsetWriter(model, write).run(attempt); }, seconds_for(attempt, write), gap);
    if (written && is_whole(*written)) return std::move(*written);
    if (is_trial(attempt)) continue;
    if (!written) {
      gaps.push_back(std::move(gap));
      if (write.held && attempt == Attempt::Whole)
        gaps.push_back("holding faces back may take " + std::to_string(kMostHolding) + " s, and 2 GiB");
      continue;
    }
    written->gaps.insert(written->gaps.begin(), gaps.begin(), gaps.end());
    if (attempt != Attempt::Whole) return std::move(*written);
    rest = std::move(written);
  }
  io::CadWritten nothing;
  nothing.gaps = std::move(gaps);
  return nothing;
}

}  // namespace vdb_offset::cad
