// SPDX-License-Identifier: Apache-2.0
// Makes the results of a run from the paths of its vertices. Each result begins as a draft: faults at the ends of its
// paths are found, miters that cause some are taken back, limit() makes the rest valid, and positions are handed out to
// the vertices of the input, and measured as they will be written. The inner skin of a shell comes first, and all
// others keep off it. A nearer offset that has to be mended starts from the finished farther one, which therefore goes
// before. A few results are made at the same time; each depends on its own draft and on those two alone, so that
// neither their order nor the number of threads counts. With distances by axis, positions return to the file's space at
// the end. Without Collision::Limit only faults of miters are taken back, and all others stay.
#include "products/offset/make_results.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <optional>
#include <utility>

#include "ground/numbers/rounding.h"
#include "ground/system/assert.h"
#include "ground/system/call_progress.h"
#include "ground/system/progress_count.h"
#include "ground/system/stage_timer.h"
#include "products/offset/exactness.h"
#include "products/offset/faulty_miters.h"
#include "products/offset/moved_input.h"
#include "space/field/grid_plan.h"
#include "space/sheets/sheet_sides.h"
#include "valid/faults/face_error.h"
#include "valid/faults/fault_finder.h"
#include "valid/limit/limit.h"
#include "valid/untangle/warm_start.h"

namespace vdb_offset {
namespace {

bool is_junction(const MeshParts& parts, const std::vector<std::uint8_t>& junctions, std::size_t vertex) {
  if (junctions.empty()) return false;
  const std::size_t on_part = parts.part_vertex.empty() ? vertex : parts.part_vertex[vertex];
  return on_part < junctions.size() && junctions[on_part];
}

/// The distances of all vertices with 0 at junctions.
Distances without_junctions(const MeshParts& parts, const std::vector<std::uint8_t>& junctions,
                            const Distances& asked) {
  if (junctions.empty()) return asked;
  std::vector<double> each(parts.surface().vertices.size());
  for (std::size_t w = 0; w < each.size(); ++w) each[w] = is_junction(parts, junctions, w) ? 0 : asked[w];
  return Distances(std::move(each));
}

// Seconds for each vertex that making a result valid takes if anything is faulty; for the progress alone. Measured on
// nine models: 1e-5 to 2e-4, whatever the number of faults.
constexpr double kMendVertex = 6e-5;

class ResultMaker {
 public:
  ResultMaker(const PreparedMesh& mesh, const AskedDistances& distances, std::vector<PreparedMesh::Marched> marched)
      : mesh_(mesh),
        options_(mesh.options()),
        distances_(distances),
        marched_(std::move(marched)),
        source_crossings_(mesh.known_crossings()) {
    VDB_OFFSET_ASSERT(marched_.size() == distances_.moved.size());
    if (mesh.space().metric().even()) return;
    file_source_ = mesh.parts().source(mesh.space().file());
    file_.emplace(FileFrame{mesh.space(), file_source_, {}});
    file_facts_ = build_surface(mesh.space().file(), options_.weld, options_.orient).facts;
  }

  std::vector<OffsetResult> run() {
    const std::size_t count = marched_.size();
    if (count > 1 && has_to_be_valid() && !source_crossings_)
      source_crossings_ = CrossingFinder(mesh_.surface(), file_ ? file_source_ : mesh_.source()).listed();
    for (std::size_t i = 0; i < count; ++i)
      drafts_.push_back({constrained(marched_[i]), distances_.moved[i], marched_[i], mesh_.statistics(), {}, {}});
    results_.resize(count);
    if (options_.inner_skin_last) make_inner_skin();
    make_others(count - options_.inner_skin_last);
    return std::move(results_);
  }

 private:
  /// A result in the making.
  struct Draft {
    ConstrainedSurface constrained;
    const Distances& distances;
    PreparedMesh::Marched& marched;
    OffsetStatistics statistics;
    std::optional<FaultFinder> faults;   // from look_for_faults() to make_valid(), if the result has to be valid
    WarmStart warm_start;                // for the results that begin with this one
    std::vector<FaceFault> face_faults;  // that are left, if they are asked for
  };

  bool has_to_be_valid() const { return options_.collision == Collision::Limit; }

  ConstrainedSurface constrained(const PreparedMesh::Marched& marched) const {
    // Faces that stay are in the way of a shell of a part, but not in the shell: its rim slides over them.
    const std::size_t resting = options_.off_source && mesh_.slides() ? mesh_.mesh().face_count() : 0;
    ConstrainedSurface constrained = mesh_.constrained(marched, options_.off_source, resting);
    constrained.with_rim = options_.off_source;
    constrained.file = file_ ? &*file_ : nullptr;
    return constrained;
  }

  /// Makes the last result, and has all others keep off it.
  void make_inner_skin() {
    const std::size_t last = drafts_.size() - 1;
    look_for_faults(drafts_[last], options_.progress);
    make_valid(drafts_[last], options_.progress, nullptr, nullptr);
    results_[last] = finish(last);
    inner_skin_ = positions_as_written(results_[last]);
    for (Draft& draft : drafts_) draft.constrained.other_skin = inner_skin_;
  }

  /// Makes the first `count` results, a few at a time; those that others begin with go first.
  void make_others(std::size_t count) {
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    // Of each result the one that it begins with; its own number if there is none.
    const std::vector<std::size_t> started_from =
        has_to_be_valid() && mesh_.corners() == Corners::Round
            ? find_warm_starts(std::span(distances_.moved).first(count))
            : order;  // another result's miters are no start for those of this one
    std::stable_partition(order.begin(), order.end(), [&](std::size_t i) { return started_from[i] == i; });
    JointProgress progress(options_.progress, count);
    const auto complete = [&](std::size_t i, const WarmStart* start) {
      const bool is_start = std::count(started_from.begin(), started_from.end(), i) > 1;
      make_valid(drafts_[i], progress.of(i), start, is_start ? &drafts_[i].warm_start : nullptr);
      results_[i] = finish(i);
    };
    for (std::size_t first = 0; first < count; first += kResultsTogether) {
      const auto some = std::span(order).subspan(first, std::min(kResultsTogether, count - first));
      std::vector<std::uint8_t> waits(count, 0);
      do_together(some, [&](std::size_t i) {
        look_for_faults(drafts_[i], progress.of(i));
        waits[i] = started_from[i] != i && needs_mending(drafts_[i]);
        if (!waits[i]) complete(i, nullptr);
      });
      do_together(some, [&](std::size_t i) {
        if (waits[i]) complete(i, &drafts_[started_from[i]].warm_start);
      });
    }
  }

  template <class Work>
  static void do_together(std::span<const std::size_t> results, Work&& work) {
    tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t i) {
      // A thread that waits for the work on one result is not to begin another result meanwhile.
      tbb::this_task_arena::isolate([&] { work(results[i]); });
    });
  }

  /// Finds the faults of a draft, if it has to be valid, or if miters may have made some: no collision mode has those.
  void look_for_faults(Draft& draft, const ProgressCallback& callback) const {
    if (!has_to_be_valid() && draft.marched.mitered.empty()) return;
    Progress progress(callback, Stage::Limit, 5 * 3);  // three steps of the first fifth
    const StageTimer timer(draft.statistics.seconds, Stage::Limit);
    draft.faults.emplace(draft.constrained, mesh_.source(), draft.distances, options_.precision, source_crossings_);
    progress.advance(1);
    draft.faults->move_to_ends(draft.marched.paths);
    progress.advance(1);
    take_faulty_miters_back(*draft.faults, mesh_.surface(), mesh_.corners(), draft.distances.scale(), draft.marched);
    progress.advance(1);
    if (needs_mending(draft))
      expect_more(options_.progress, kMendVertex * static_cast<double>(mesh_.surface().vertices.size()));
    if (!has_to_be_valid()) draft.faults.reset();
  }

  /// Whether any vertex is farther than its distance, for its faces to be there.
  static bool goes_farther(const Draft& draft) {
    constexpr double kRounding = 1e-6;  // of the distance, as of what has reached it
    const std::span<const double> farther = draft.marched.mitered.farther();
    for (std::size_t v = 0; v < farther.size(); ++v)
      if (farther[v] > (1 + kRounding) * std::abs(draft.distances[v])) return true;
    return false;
  }

  /// Whether faces are to be kept at their distance, and not vertices alone: miters go farther for them, or most
  /// vertices have miters, as on a part of flat faces, where a vertex that slides takes whole faces out of their
  /// planes.
  bool keeps_faces(const Draft& draft) const {
    if (mesh_.corners() != Corners::Miter || !draft.distances.at_corner().empty()) return false;
    return goes_farther(draft) || 2 * draft.marched.miters.size() > mesh_.surface().vertices.size();
  }

  static bool needs_mending(const Draft& draft) {
    const auto& states = draft.marched.paths.state;
    return draft.faults &&
           (draft.faults->any() || std::find(states.begin(), states.end(), VertexState::Collision) != states.end());
  }

  /// Makes a draft valid whose faults have been looked for.
  /// \param start what it begins with, or nullptr
  /// \param to_start receives what other results begin with; nullptr if none does
  void make_valid(Draft& draft, const ProgressCallback& progress, const WarmStart* start, WarmStart* to_start) const {
    if (!draft.faults) return;
    const StageTimer timer(draft.statistics.seconds, Stage::Limit);
    draft.statistics.limit = limit(*draft.faults,
                                   {draft.constrained, mesh_.source(), draft.distances, draft.marched.paths,
                                    &draft.marched.mitered, keeps_faces(draft), options_.taper, mesh_.measured_faces()},
                                   progress, start, to_start);
    if (mesh_.surroundings()) draft.statistics.limit.source_crossings -= mesh_.surroundings()->crossing();
    if (options_.keep_face_errors) draft.face_faults = draft.faults->of_faces(mesh_.mesh().face_count());
    draft.faults.reset();
  }

  /// Hands out a draft that is done, with its figures.
  OffsetResult finish(std::size_t number) const {
    const Draft& draft = drafts_[number];
    const MeshVertices vertices{mesh_.mesh(), mesh_.surface()};
    OffsetResult result = unmoved_result(vertices);
    result.statistics = draft.statistics;
    result.has_turned_faces = mesh_.has_turned_faces();
    result.statistics.disagreeing_distances = distances_.disagreeing[number];
    result.statistics.miters = draft.marched.miter_facts;
    result.statistics.straight_vertices = draft.marched.paths.straight;
    move_vertices(vertices, draft.marched.paths, result);
    if (options_.keep_paths) hand_out_paths(vertices, draft.marched.paths, result);
    result.statistics.borders = mesh_.borders(draft.marched.paths);
    result.statistics.room = mesh_.room(draft.marched.paths, draft.distances);
    if (file_) bring_to_file(result);
    result.distances = distances_of_input(mesh_.surface(), distances_.asked[number]);
    mark_junctions(result);
    count_miters(draft.marched.miters, draft.marched.paths.state, result.statistics.miters);
    const std::vector<Vec3d> positions = ends_as_written(draft.marched.paths);
    {
      const StageTimer timer(result.statistics.seconds, Stage::Measure);
      if (mesh_.surroundings()) result.statistics.obstacles = mesh_.surroundings()->facts(positions);
      const auto own = OwnDistances::of(draft.distances, mesh_.mesh(), {}, mesh_.surface());
      const MeasuredFaces faces{draft.constrained,         positions,
                                draft.distances,           mesh_.source(),
                                draft.marched.paths.state, own ? &*own : nullptr};
      result.statistics.faces = measure_faces(faces);
      if (options_.keep_face_errors) result.face_errors = measure_each_face(faces, mesh_.mesh().face_count());
    }
    result.face_faults = draft.face_faults;
    result.statistics.rounding =
        Rounding(options_.precision).half_unit() * farthest_coordinate(result.statistics.facts);
    if (mesh_.exact()) result.statistics.exact = measure_exactness(mesh_, draft.marched, result);
    return result;
  }

  /// Vertices at junctions are short, until a shell gives each sheet there a position of its own (see shell_of()).
  void mark_junctions(OffsetResult& result) const {
    if (distances_.junctions.empty()) return;
    for (std::size_t v = 0; v < result.states.size(); ++v) {
      const auto w = mesh_.surface().welded[v];
      if (w != kNone && is_junction(mesh_.parts(), distances_.junctions, w) && result.distances[v] != 0)
        result.states[v] = VertexState::Limited;
    }
  }

  /// Brings positions, paths and the facts of the mesh from the space of the metric to that of the file.
  void bring_to_file(OffsetResult& result) const {
    const PolygonView file = mesh_.space().file(), mesh = mesh_.mesh();
    const Surface& surface = mesh_.surface();
    for (std::size_t v = 0; v < result.positions.size(); ++v) {
      const auto w = surface.welded[v];
      if (result.positions[v] == mesh.positions[v]) {
        result.positions[v] = file.positions[v];
      } else if (w != kNone) {
        const auto first = surface.representative[w];
        result.positions[v] = mesh_.space().moved(file.positions[first], mesh.positions[first], result.positions[v]);
      }
    }
    for (auto& path : result.paths)
      for (Vec3d& position : path) position = mesh_.space().metric().from(position);
    result.statistics.facts = file_facts_;
  }

  /// Where all vertices are at the ends of their paths, as they will be written.
  std::vector<Vec3d> ends_as_written(const Paths& paths) const {
    std::vector<Vec3d> positions = mesh_.source();
    const auto& of_mesh = mesh_.surface().representative;
    for (std::size_t w = 0; w < positions.size(); ++w)
      if (w < of_mesh.size() && of_mesh[w] != kNone)
        positions[w] = Rounding(options_.precision)(positions[w], positions[w] + paths.displacement[w]);
    return positions;
  }

  /// Where all vertices are in a result, as they will be written.
  std::vector<Vec3d> positions_as_written(const OffsetResult& result) const {
    const Surface& surface = mesh_.surface();
    std::vector<Vec3d> positions = mesh_.source();
    for (std::size_t w = 0; w < positions.size(); ++w) {
      const auto v = surface.representative[w];
      if (v != kNone) positions[w] = Rounding(options_.precision)(positions[w], result.positions[v]);
    }
    return positions;
  }

  const PreparedMesh& mesh_;
  const OffsetOptions& options_;
  const AskedDistances& distances_;
  std::vector<PreparedMesh::Marched> marched_;
  std::optional<SelfCrossings> source_crossings_;  // of the source, if several results are compared with them
  std::vector<Vec3d> file_source_;  // positions of all vertices in the file, if distances are measured in another space
  std::optional<FileFrame> file_;
  MeshFacts file_facts_;  // of the mesh in the file, then
  std::deque<Draft> drafts_;
  std::vector<OffsetResult> results_;
  std::vector<Vec3d> inner_skin_;  // positions of all vertices in a shell's inner skin, once it is made
};

}  // namespace

AskedDistances ask(const PreparedMesh& mesh, std::span<const Distances> of_input) {
  AskedDistances distances;
  if (mesh.options().off_source)
    distances.junctions = find_junctions(mesh.parts().moving_part, mesh.mesh(), mesh.options().only);
  distances.disagreeing.resize(of_input.size());
  for (std::size_t i = 0; i < of_input.size(); ++i) {
    distances.asked.push_back(mesh.distances_of_all(of_input[i], distances.disagreeing[i]));
    distances.moved.push_back(without_junctions(mesh.parts(), distances.junctions, distances.asked.back()));
  }
  return distances;
}

std::vector<OffsetResult> make_results(const PreparedMesh& mesh, const AskedDistances& distances,
                                       std::vector<PreparedMesh::Marched> marched) {
  return ResultMaker(mesh, distances, std::move(marched)).run();
}

}  // namespace vdb_offset
