// SPDX-License-Identifier: Apache-2.0
#include "write/write_offset.h"

#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "ground/process/packing.h"
#include "ground/process/progress.h"
#include "judge/clearance.h"
#include "judge/judge.h"
#include "judge/soup.h"
#include "vdb_offset/run.h"
#include "write/assemblies.h"
#include "write/attempts.h"
#include "write/own_process.h"
#include "write/write_model.h"

namespace vdb_offset::cad {
namespace {

constexpr std::size_t kMostGaps = 8;    // that are reported
constexpr unsigned kMostHolding = 120;  // seconds, of the whole model with its faces held back

// The share that is shown as done once all bodies are made.
constexpr double kBodiesMade = 0.9;

// Shares of the time that may be over once all exact faces have been tried, and once triangles have been.
constexpr double kTimeOfExact = 0.5, kTimeOfBodies = 0.8;
constexpr double kTimeOfBody = 0.25;  // of what is left for an attempt at least, if need be

class OffsetWriter {
 public:
  OffsetWriter(const CadModel& model, const std::vector<BodyMesh>& meshes, const io::WriteCad& write)
      : model_(model), asked_{write, model.has_unit ? model.unit_micrometres / 1000 : 1} {
    try {
      bodies_ = bodies_of(model, meshes, asked_);
    } catch (const Error& error) {
      written_.gaps.emplace_back(error.what());
    }
    made_.resize(bodies_.size());
    reasons_.resize(bodies_.size());
  }

  io::CadWritten run() {
    if (bodies_.empty()) return std::move(written_);
    {
      const ProgressPart part(0, kBodiesMade);
      if (asked_.write.held) hold_all();
      make_all();
    }
    sum_up();
    write_file();
    written_.gaps.resize(std::min(written_.gaps.size(), kMostGaps));
    return std::move(written_);
  }

 private:
  /// Until a share of the time is over.
  double seconds_until(double share) const {
    return share * asked_.write.seconds -
           std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
  }

  /// Makes all bodies with their faces held back where fronts meet.
  void hold_all() {
    std::string gap;
    const auto work = [&](const Keep&) {
      const HeldBodies held = held_bodies();
      Packer packer;
      for (std::size_t b = 0; b < bodies_.size(); ++b) {
        MadeBody made = check_body(bodies_[b], held.results[b], asked_, Exactness::Exact);
        if (asked_.write.thick && held.held > 0 && held.least_held <= 0) {
          made.facts.made = io::CadMade::Nothing;
          made.facts.gaps.emplace_back("faces that are held back where they are leave no wall");
        }
        packer.text(pack(made));
      }
      packer.value(std::uint64_t{held.held}).value(held.least_held);
      return packer.take();
    };
    const auto bytes = in_own_process(work, {kMostHolding, seconds_until(time_of_exact())}, gap);
    if (!bytes) {
      written_.gaps.push_back(std::move(gap));
      written_.gaps.push_back("holding faces back may take " + std::to_string(kMostHolding) + " s, and 2 GiB");
      return;
    }
    Unpacker unpacker(*bytes);
    for (MadeBody& made : made_) made = unpack_body(unpacker.text());
    written_.held = unpacker.value<std::uint64_t>();
    written_.least_held = unpacker.value<double>();
  }

  /// Without results of bodies, but why, where distances have no value.
  HeldBodies held_bodies() {
    try {
      return hold_bodies(bodies_, asked_);
    } catch (const Error& error) {
      HeldBodies none;
      none.results.resize(bodies_.size());
      for (OffsetCadResult& each : none.results) each.gaps.emplace_back(error.what());
      return none;
    }
  }

  /// The share of the time that may be over once all that needs no mesh has been tried.
  double time_of_exact() const { return asked_.write.positions.empty() ? kTimeOfBodies : kTimeOfExact; }

  /// Tries one way after the other with all bodies that are not made; only the last ones if their faces were to be held
  /// back.
  void make_all() {
    double shown = 0;
    for (const Attempt& attempt : attempts()) {
      const ProgressPart part(shown, attempt.share);
      shown = attempt.share;
      if (asked_.write.held && !attempt.is_of_mesh) continue;
      std::vector<std::size_t> left;
      for (std::size_t b = 0; b < bodies_.size(); ++b)
        if ((!made_[b].is_good() || made_[b].may_be_better) && attempt.may({bodies_[b], asked_})) left.push_back(b);
      const auto count = static_cast<double>(left.size());
      for (std::size_t i = 0; i < left.size(); ++i) {
        const auto at = static_cast<double>(i);
        const ProgressPart of_body(at / count, (at + 1) / count);
        // Most take little, and leave the rest to others.
        const double left_over = seconds_until(attempt.is_of_mesh ? kTimeOfBodies : time_of_exact());
        make(left[i], attempt, left_over * attempt.most_time * std::max(kTimeOfBody, 1 / (count - at)));
      }
    }
    for (std::size_t b = 0; b < bodies_.size(); ++b)
      if (!made_[b].is_good()) made_[b].facts.missing = bodies_[b].body.faces.size();
  }

  void make(std::size_t b, const Attempt& attempt, double seconds) {
    if (reasons_[b].empty()) reasons_[b] = made_[b].facts.gaps;
    MadeBody made;
    std::string gap;
    const auto work = [&](const Keep& keep) {
      return pack(tried(attempt, {bodies_[b], asked_, [&](const MadeBody& best) { keep(pack(best)); }}));
    };
    if (const auto bytes = in_own_process(work, {attempt.seconds, seconds}, gap)) made = unpack_body(*bytes);
    else made.facts.gaps.push_back(std::move(gap));
    if (reasons_[b].empty()) reasons_[b] = made.facts.gaps;
    const bool is_better = made.is_good() && made.facts.made != io::CadMade::Doubtful;
    if (made_[b].is_good() && !is_better) return;
    if (!made.is_good()) made = {};
    if (!made.is_good() || made.facts.made == io::CadMade::Hybrid) made.facts.gaps = reasons_[b];
    made_[b] = std::move(made);
  }

  static MadeBody tried(const Attempt& attempt, const BodyTask& task) {
    try {
      return attempt.make(task);
    } catch (const Error& error) {  // as of an expression without a value somewhere
      MadeBody made;
      made.facts.gaps.emplace_back(error.what());
      return made;
    }
  }

  /// Adds up what is reported of the bodies.
  void sum_up() {
    written_.least = INFINITY;
    for (std::size_t b = 0; b < made_.size(); ++b) {
      const io::CadWritten& facts = made_[b].facts;
      written_.kept += facts.kept;
      written_.fitted += facts.fitted;
      written_.swallowed += facts.swallowed;
      written_.faceted += facts.faceted;
      written_.missing += facts.missing;
      written_.triangles += facts.triangles;
      written_.exact_area += facts.exact_area;
      written_.flat_area += facts.flat_area;
      written_.vanished += facts.vanished;
      written_.samples += facts.samples;
      written_.volume += facts.volume;
      written_.fit_error = std::max(written_.fit_error, facts.fit_error);
      if (facts.samples > 0) {
        written_.least = std::min(written_.least, facts.least);
        written_.most = std::max(written_.most, facts.most);
      }
      const std::string name = bodies_.size() > 1 ? "body " + std::to_string(b + 1) + ": " : "";
      for (const std::string& gap : facts.gaps) written_.gaps.push_back(name + gap);
    }
    if (written_.samples == 0) written_.least = 0;
  }

  io::CadMade kind() const {
    const auto is_any = [&](io::CadMade made) {
      return std::any_of(made_.begin(), made_.end(), [&](const MadeBody& each) { return each.facts.made == made; });
    };
    return is_any(io::CadMade::Doubtful) ? io::CadMade::Doubtful
           : is_any(io::CadMade::Hybrid) ? io::CadMade::Hybrid
           : is_any(io::CadMade::Shells) ? io::CadMade::Shells
                                         : io::CadMade::Solid;
  }

  void write_file() {
    WrittenModel model;
    model.millimetres = asked_.millimetres;
    model.places = model_.places;
    for (std::size_t b = 0; b < made_.size(); ++b) {
      const Body& body = bodies_[b].body;
      for (const TopoDS_Shape& shape : made_[b].shapes) {
        model.shapes.push_back(shape);
        model.names.push_back(body.faces.empty() ? "" : body.faces.front().facts.solid);
        model.place_of.push_back(place_of(body, model_.places));
      }
      for (const auto& [number, faces] : made_[b].faces) add_faces(faces, body.faces[number].facts, model);
    }
    if (model.shapes.empty()) {
      if (written_.vanished > 0 && written_.missing == 0) written_.gaps.emplace_back("nothing is left of it");
      return;
    }
    const MemoryFile file;
    write_apart(model, asked_.write.format, file.path());
    const CadModel again = read_model(file.path(), asked_.write.format);
    if (again.bodies.size() != model.shapes.size()) {
      written_.gaps.push_back("read again, the file has " + std::to_string(again.bodies.size()) + " bodies and not " +
                              std::to_string(model.shapes.size()));
      return;
    }
    if (again.bodies.size() > 1 && get_into_each_other(again))
      written_.gaps.emplace_back(
          "bodies get into each other, and each is written by itself: --bodies fuse makes them one");
    if (!asked_.write.obstacle_triangles.empty() && !is_clear_of_obstacles(again)) return;
    written_.bytes = file.bytes();
    written_.made = kind();
  }

  static void add_faces(const TopoDS_Shape& faces, const io::CadFaceFacts& facts, WrittenModel& model) {
    for (TopExp_Explorer face(faces, TopAbs_FACE); face.More(); face.Next())
      model.faces.emplace_back(face.Current(), facts);
  }

  TopoDS_Shape shape_in(const Body& body, const CadModel& again) const {
    return scaled(shape_of(body).shape, in_millimetres(again, asked_));
  }

  Soup soup_of(const TopoDS_Shape& shape) const { return Soup::of_result(shape, asked_.largest()); }

  /// Whether bodies get into each other: faces cross, or points just inside of one are inside of another.
  bool get_into_each_other(const CadModel& again) const {
    std::vector<Soup> soups;
    for (const Body& body : again.bodies)
      if (body.is_solid) soups.push_back(soup_of(shape_in(body, again)));
    const auto in = [&](const Body& body) { return shape_in(body, again); };
    if (!soup_of(together(again.bodies, in)).crossings(1).empty()) return true;
    for (const Soup& one : soups)
      for (const Soup& other : soups)
        if (&one != &other && reaches_into(one, other)) return true;
    return false;
  }

  bool reaches_into(const Soup& one, const Soup& other) const {
    constexpr std::size_t kMostPoints = 200;
    const double inward = 1e-3 * asked_.largest();
    const std::size_t count = one.triangles().size(), step = std::max<std::size_t>(1, count / kMostPoints);
    for (std::size_t t = 0; t < count; t += step) {
      const SoupPoint at = one.on_triangle(static_cast<int>(t), 1.0 / 3, 1.0 / 3);
      if (other.contains(at.point.Translated(one.outside(at) * -inward))) return true;
    }
    return false;
  }

  /// Whether the bodies neither cross nor enclose a part of an obstacle, nor come nearer to it than asked, or than the
  /// source is; measures the least gap. A part that goes through the source is in nobody's way.
  bool is_clear_of_obstacles(const CadModel& again) {
    constexpr double kOff = 0.01;  // of the distance, as far as triangles show
    const double required = asked_.millimetres * asked_.write.clearance;
    const Soup before = soup_of(together(bodies_, [](const OffsetBody& each) { return each.source.shape; }));
    const Soup after = soup_of(together(again.bodies, [&](const Body& body) { return shape_in(body, again); }));
    const auto encloses = [](const Soup& soup, const Soup& part) {
      return soup.contains(part.triangles().front().points[0]);
    };
    for (const Soup& part : connected_parts(obstacle_points(asked_), asked_.write.obstacle_triangles)) {
      if (before.crosses(part)) continue;
      const auto& corner = part.triangles().front().points[0];
      const double gap = gap_between(after, part, after.triangles().front().points[0].Distance(corner));
      const bool is_hit = after.crosses(part) || encloses(after, part) != encloses(before, part);
      if (is_hit || gap < gap_between(before, part, required) - kOff * asked_.largest()) {
        written_.gaps.emplace_back("the result comes nearer to an obstacle than asked, or meets it");
        return false;
      }
      if (written_.obstacle_gap < 0 || gap / asked_.millimetres < written_.obstacle_gap)
        written_.obstacle_gap = gap / asked_.millimetres;
    }
    return true;
  }

  const std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
  const CadModel& model_;
  const Asked asked_;
  std::vector<OffsetBody> bodies_;
  std::vector<MadeBody> made_;
  std::vector<std::vector<std::string>> reasons_;  // why the first way that was tried has not made each body
  io::CadWritten written_;
};

}  // namespace

io::CadWritten write_offset(const CadModel& model, const std::vector<BodyMesh>& meshes, const io::WriteCad& write) {
  std::size_t faces = 0;
  for (const Body& body : model.bodies) faces += body.faces.size();
  if (write.of_face.size() != 1 && write.of_face.size() != faces)
    throw InvalidCad("expected distances of " + std::to_string(faces) + " faces, got " +
                     std::to_string(write.of_face.size()));
  return OffsetWriter(model, meshes, write).run();
}

}  // namespace vdb_offset::cad
