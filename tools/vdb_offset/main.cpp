#include <fmt/format.h>
#include <tbb/global_control.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "args.h"
#include "check_command.h"
#include "terminal.h"
#include "vdb_offset/error.h"
#include "vdb_offset/field.h"
#include "vdb_offset/file_replace.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/io/states_file.h"
#include "vdb_offset/report.h"

namespace vdb_offset::tool {
namespace {

enum ExitCode { kDone = 0, kUsage = 1, kInput = 2, kProcessing = 3, kOutput = 4 };

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// A mesh to offset: from a file, or made by a scene.
struct Source {
  std::optional<scene::Scene> scene;
  std::optional<io::MeshFile> file;

  PolygonView view() const { return file ? file->polygons.view() : scene->shape.view(); }
};

Source read_source(const Arguments& args) {
  Source source;
  if (scene::is_scene(args.input)) source.scene = scene::read_scene(args.input);
  if (!source.scene) source.file = io::read_mesh(args.input, format_of(args.input, args));
  else if (!source.scene->mesh_path.empty()) source.file = io::read_mesh(source.scene->mesh_path);
  return source;
}

/// Takes from a scene what the command line leaves open, and turns percent into world units.
void settle_options(Source& source, Arguments& args) {
  if (source.scene) {
    const scene::Scene& scene = *source.scene;
    // What a scene expects holds for its own distance.
    if (args.distance) source.scene->expect = {};
    else args.distance = scene.distance;
    if (!args.options.grid.voxel_size && !args.options.grid.voxels_per_distance) args.options.grid = scene.grid;
    args.options.solver = scene.solver;
    args.options.collision = scene.collision;
  }
  if (args.solver) args.options.solver = *args.solver;
  if (args.collision) args.options.collision = *args.collision;
  const double diagonal = args.distance->percent ? used_diagonal(source.view()) : 0;
  args.options.distance = args.distance->in_world_units(diagonal);
  if (args.distance_text.empty())
    args.distance_text = fmt::format("{}{}", args.distance->value, args.distance->percent ? "%" : "");
}

/// Every option's name and value in force, once settle_options() has run.
std::vector<std::pair<std::string, std::string>> options_in_force(const Arguments& args) {
  const auto number = [](const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string("automatic");
  };
  return {{"distance", args.distance_text},
          {"voxel-size", number(args.options.grid.voxel_size)},
          {"voxels-per-distance", number(args.options.grid.voxels_per_distance)},
          {"collision", args.options.collision == Collision::Merge ? "merge" : "limit"},
          {"solver", args.options.solver == Solver::Eikonal ? "eikonal" : "closest"},
          {"weld", args.weld_text},
          {"orient", args.orient_text},
          {"normals", args.write.normals == io::Normals::Keep ? "keep" : "recompute"},
          {"precision", args.write.digits > 0 ? fmt::format("{}", args.write.digits) : "automatic"},
          {"threads", fmt::format("{}", args.options.threads)},
          {"max-memory", fmt::format("{}", args.options.max_memory)},
          {"strict", args.strict ? "true" : "false"}};
}

void print_facts(std::FILE* out, const OffsetStatistics& statistics) {
  const MeshFacts& facts = statistics.facts;
  std::size_t faces = 0;
  for (const auto& [corners, count] : facts.faces_by_corners) faces += count;
  fmt::print(out, "mesh       {} vertices ({} positions, {} unused), {} faces, {} component{}, diagonal {:.6g}\n",
             facts.vertices, facts.welded_vertices, facts.unused_vertices, faces, facts.components,
             facts.components == 1 ? "" : "s", facts.diagonal);
  fmt::print(out,
             "           {} boundary edges, {} non-manifold edges, {} degenerate faces, {} orientation conflicts\n",
             facts.boundary_edges, facts.non_manifold_edges, facts.degenerate_faces, facts.orientation_conflicts);
  if (facts.repeated_faces + facts.folded_triangles > 0)
    fmt::print(
        out, "           {} repeated faces, {} folded triangles; without them {} boundary and {} non-manifold edges\n",
        facts.repeated_faces, facts.folded_triangles, facts.boundary_left, facts.non_manifold_left);
}

/// Where it is not clear which side is outward, and what to do about it.
void print_orientation(std::FILE* out, const MeshFacts& facts, Orient orient) {
  if (facts.inside_out_components > 0)
    fmt::print(out, "{} of {} closed components point inward as a whole: {}\n", facts.inside_out_components,
               facts.closed_components,
               orient == Orient::Keep
                   ? "a distance above 0 shrinks them (--orient fix-direction-only enlarges them)"
                   : "taken as turned, a distance above 0 enlarges them; the faces stay as they are");
  if (facts.orientation_conflicts > 0)
    fmt::print(out,
               "{} edges between faces that disagree about the outside: {} triangles taken as turned, {} edges left\n",
               facts.orientation_conflicts, facts.turned_triangles, facts.unsettled_conflicts);
}

void print_plan(std::FILE* out, const OffsetStatistics& statistics, double distance) {
  const GridPlan& plan = statistics.plan;
  fmt::print(out, "distance   {:.9g}\n", distance);
  if (distance == 0) return;
  fmt::print(out, "voxel size {:.6g} ({})\n", plan.voxel_size, plan.reason);
  fmt::print(out, "estimate   {} leaf nodes, {} voxels, {:.1f} MiB, {:.2g} s on {} thread{}\n", plan.leaf_nodes,
             plan.voxels, static_cast<double>(plan.bytes) / 1048576.0, plan.seconds, statistics.threads,
             statistics.threads == 1 ? "" : "s");
}

void print_summary(const Arguments& args, const OffsetResult& result, double total_seconds) {
  std::FILE* const out = args.output == "-" ? stderr : stdout;  // standard output may be taken by the mesh
  const AchievedSummary achieved = summarise(result, args.options.distance);
  const auto& states = result.statistics.vertices_by_state;
  const auto in = [&](VertexState state) { return states[static_cast<std::size_t>(state)]; };
  if (args.verbose) {
    print_facts(out, result.statistics);
    print_plan(out, result.statistics, args.options.distance);
    for (std::size_t s = 0; s < kStageCount; ++s)
      fmt::print(out, "{:<10} {:.3f} s\n", name(static_cast<Stage>(s)), result.statistics.seconds[s]);
  }
  fmt::print(out, "{}: {} vertices at {:.6g}: {:.3f} % reached", args.output, achieved.vertices, args.options.distance,
             100 * achieved.share_reached);
  if (in(VertexState::Collision)) fmt::print(out, ", {} stopped by collision", in(VertexState::Collision));
  if (in(VertexState::Limited)) fmt::print(out, ", {} held back to stay valid", in(VertexState::Limited));
  if (in(VertexState::OutsideField)) fmt::print(out, ", {} outside the field", in(VertexState::OutsideField));
  fmt::print(out, " ({:.2f} s)\n", total_seconds);
  print_orientation(out, result.statistics.facts, args.options.orient);
  const LimitStatistics& limit = result.statistics.limit;
  if (limit.source_crossings > 0)
    fmt::print(out, "the input crosses itself: {} pairs of triangles meet, left as they are; {} more beside them\n",
               limit.source_crossings, limit.crossings_near_source);
}

void write_report(const Arguments& args, const OffsetResult& result, Clock::time_point start) {
  RunFacts facts;
  facts.input = args.input;
  facts.output = args.output;
  facts.distance = args.options.distance;
  facts.distance_text = args.distance_text;
  facts.total_seconds = seconds_since(start);
  facts.options = options_in_force(args);
  write_file(args.report, report_json(result, facts));
}

io::WriteOptions write_options(const Arguments& args) {
  io::WriteOptions options = args.write;
  options.format = format_of(args.output, args);
  return options;
}

/// The mesh comes last: should anything else fail, its place holds what it held before.
void write_outputs(const Arguments& args, const Source& source, OffsetResult& result, Clock::time_point start) {
  if (result.field)
    save_vdb(*result.field, args.vdb, result.statistics.facts.closed(),
             {{"source", args.input},
              {"offset_distance", fmt::format("{}", args.options.distance)},
              {"made_by", std::string("vdb_offset ") + version()}});
  if (!args.states.empty()) {
    const PolygonView mesh = source.view();
    io::write_states(args.states, {result.positions, mesh.corners, mesh.face_begin},
                     {result.states, result.achieved, args.options.distance});
  }
  const auto writing = Clock::now();
  const auto before_rename = [&] {
    result.statistics.seconds[static_cast<std::size_t>(Stage::Write)] = seconds_since(writing);
    if (!args.report.empty()) write_report(args, result, start);
  };
  io::WriteOptions options = write_options(args);
  options.before_rename = before_rename;
  if (!source.file) {
    const PolygonView made = source.view();
    return io::write_mesh(args.output, PolygonView{result.positions, made.corners, made.face_begin}, options);
  }
  const io::WriteResult written = io::write_mesh(args.output, *source.file, result.positions, options);
  if (args.quiet) return;
  if (!written.lost.empty()) fmt::print(stderr, "vdb_offset: {}: not carried over: {}\n", args.output, written.lost);
  if (written.disagreeing_normals > 0)
    fmt::print(stderr,
               "vdb_offset: {}: {} normals (vn) are shared by vertices that ask for different ones now; they got "
               "the mean (--normals keep leaves all as they were)\n",
               args.output, written.disagreeing_normals);
}

int run(Arguments args) {
  const auto start = Clock::now();
  tell_of_lost_input(args.input);
  std::optional<tbb::global_control> threads;  // reading and writing, too
  if (args.options.threads > 0)
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(args.options.threads));
  ProgressBar bar(!args.quiet);
  args.options.progress = [&](Stage stage, double share) {
    bar.show(stage, share);
    return interrupted() == 0;
  };
  if (!args.dry_run)
    for (const std::string& path : {args.output, args.report, args.states, args.vdb})
      if (!path.empty()) require_writable(path);
  bar.show(Stage::Read, 0);
  Source source = read_source(args);
  settle_options(source, args);
  const double read_seconds = seconds_since(start);
  if (args.dry_run) {
    const OffsetStatistics statistics = plan_offset(source.view(), args.options);
    print_facts(stdout, statistics);
    print_plan(stdout, statistics, args.options.distance);
    print_orientation(stdout, statistics.facts, args.options.orient);
    return kDone;
  }
  args.options.keep_field = !args.vdb.empty();
  if (args.options.keep_field && args.options.distance == 0)
    throw UsageError("--save-vdb: expected a distance other than 0, for which there is a field");
  if (source.file) args.options.precision = io::precision_of(args.output, *source.file, write_options(args));
  OffsetResult result = offset(source.view(), args.options);
  result.statistics.seconds[static_cast<std::size_t>(Stage::Read)] = read_seconds;
  bar.show(Stage::Write, 0);
  if (interrupted()) throw Cancelled();
  write_outputs(args, source, result, start);
  bar.clear();
  if (!args.quiet) print_summary(args, result, seconds_since(start));

  const std::vector<std::string> failed =
      source.scene ? scene::unmet(source.scene->expect, source.view(), result) : std::vector<std::string>{};
  for (const std::string& expectation : failed) fmt::print(stderr, "vdb_offset: {}: {}\n", args.input, expectation);
  if (!failed.empty()) return kProcessing;
  const AchievedSummary achieved = summarise(result, args.options.distance);
  if (!args.strict || achieved.share_reached == 1) return kDone;
  fmt::print(stderr, "vdb_offset: --strict: {:.4f} % of the vertices fall short of the distance\n",
             100 * (1 - achieved.share_reached));
  return kProcessing;
}

int fail(ExitCode code, const char* message) {
  fmt::print(stderr, "vdb_offset: {}\n", message);
  return code;
}

/// Ends the way an uncaught signal would have, so that shells and scripts see it.
int end_by_signal() {
  std::signal(interrupted(), SIG_DFL);
  std::raise(interrupted());
  return kProcessing;
}

int guarded(int argc, char** argv) {
  try {
    if (is_check(argc, argv)) return run_check(argc, argv);
    auto args = parse_arguments(argc, argv);
    return args ? run(std::move(*args)) : kDone;
  } catch (const UsageError& error) {
    return fail(kUsage, error.what());
  } catch (const InvalidInput& error) {
    return fail(kInput, error.what());
  } catch (const ReadError& error) {
    return fail(kInput, error.what());
  } catch (const WriteError& error) {
    return fail(kOutput, error.what());
  } catch (const Cancelled&) {
    return end_by_signal();
  } catch (const std::bad_alloc&) {
    return fail(kProcessing, "out of memory (see --max-memory and --voxel-size)");
  } catch (const std::exception& error) {
    return fail(kProcessing, error.what());
  }
}

}  // namespace
}  // namespace vdb_offset::tool

int main(int argc, char** argv) {
  vdb_offset::tool::catch_interrupts();
  return vdb_offset::tool::guarded(argc, argv);
}
