// SPDX-License-Identifier: Apache-2.0
// The options of a batch, and which of those of an offset are passed on to each model.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "batch/batch_request.h"
#include "batch/remote/hosts.h"
#include "request/offset_options.h"
#include "request/option_rules.h"
#include "request/option_values.h"

namespace vdb_offset::tool {
namespace {

constexpr const char* kBatchAbout =
    "Offsets every model under DIR into OUT, whose folders mirror those of DIR. A model that is done is not done "
    "again\n"
    "while its content and the options stay as they are; a failure does not end the batch. OUT/batch.csv has a row "
    "for\n"
    "each model as soon as it ends.";

constexpr const char* kBatchMore = R"(
All options of vdb_offset apply to each model (vdb_offset --help). Names of files are patterns: {model} is the model's
path under DIR without its ending, {ending} that ending, as in '{model}.states.ply'. Outputs go below OUT. In names of
files that are read, {model} includes DIR: --distance-from '{model}.txt'.
Some options are for the whole batch: --max-memory limits all models at once, by their estimates (with --sshlogin per
machine, with --slurm per job); --dry-run prints which models would be done; --verbose prints the row of each model as
it ends; --quiet only prints errors.

Models are files that end in .obj, .ply, .stl, .off, .3mf, .glb, .gltf, .vtp, .vtk, .vtu, .step, .stp, .brep, .svg, .dxf, .dat or .xy, also
with .gz or .zst behind it; others (.txt, scenes in .json, .fbx) have to be chosen with --models.

Examples:
  vdb_offset batch models bigger --distance 1%
  vdb_offset batch scans thin -d -0.2 --reports --jobs 4 --max-memory 16G
  vdb_offset batch parts walls -d 1 -d 2 --output '{model}_{d}.stl' --states '{model}_{d}.csv'
  vdb_offset batch wings cells --layers 10 --total-thickness 1% --output '{model}.vtu'
  vdb_offset batch models bigger --distance 1% --sshlogin :,node1,node2
  vdb_offset batch models bigger --distance 1% --slurm compute

Exit codes: 0 all models are done, 1 usage, 2 input, 3 a model failed, 4 output. Ctrl-C and similar signals end the batch
and its running models; the table then has all that were done. Run the same command to resume.)";

constexpr int kMostJobs = 4096;  // so that a mistyped number does not start that many processes; not measured

// Options of an offset that are for the batch as a whole.
constexpr const char* kOfTheBatch[] = {"--quiet", "--verbose", "--dry-run", "--max-memory"};

void declare_batch(CommandLine& line, BatchRequest& request, bool& reports) {
  line.option("--output", "PATTERN",
              "Names of the outputs below OUT, as '{model}.ply' or '{model}/polyMesh' [{model}{ending}]",
              request.output);
  line.repeated("--models", "GLOB",
                "Models are the files with such names, as '*.stl' or 'left/*' (a path under DIR); may be repeated [by "
                "their endings]",
                [&request](const std::string& text) { request.selection.push_back(text); });
  line.option("--jobs", "N", "Models at once; with --sshlogin, on each machine [one for each processor]", request.jobs,
              count_between("--jobs", 1, kMostJobs));
  line.flag("--reports", "Write the report of each model next to its output, as OUTPUT.json", reports);
  line.flag("--retry-failed", "Also try models again that failed", request.retry_failed);
  line.option(
      "--sshlogin", "LIST",
      "Work on these machines, by GNU parallel: [N/][user@]host[:port] with commas between, ':' is this one; DIR, "
      "OUT and vdb_offset have the same paths there. Not in a file of options",
      [&request](const std::string& text) {
        require(are_hosts(text),
                fmt::format("--sshlogin: expected machines as [N/][user@]host[:port] or ':' with commas "
                            "between, got '{}'",
                            text));
        request.sshlogin = text;
      });
  line.option("--slurm", "PARTITION", "Work as an array of jobs of Slurm, in this partition",
              [&request](const std::string& text) {
                require(are_partitions(text), fmt::format("--slurm: expected the name of a partition, got '{}'", text));
                request.partition = text;
              });
}

}  // namespace

std::optional<BatchRequest> parse_batch(int argc, const char* const* argv) {
  BatchRequest request;
  Draft draft;
  bool reports = false;
  CommandLine line("vdb_offset batch", kBatchAbout, kBatchMore, "vdb_offset batch --help");
  line.file("DIR", "Folder with models, in subfolders as well", request.folder);
  line.file("OUT", "Folder to write to; created if it is missing", request.out);
  declare_batch(line, request, reports);
  line.add_config(alternative_options(), {}, {"sshlogin"});
  line.hide_what_follows();
  declare_offset_options(line, draft);
  if (!line.parse(argc, argv)) return std::nullopt;
  for (GivenOption& option : line.given_hidden())
    if (std::find(std::begin(kOfTheBatch), std::end(kOfTheBatch), option.name) == std::end(kOfTheBatch))
      request.each.push_back(std::move(option));
  // A damaged model is not to hold up the others.
  if (!line.has("--cad-seconds")) request.each.push_back({"--cad-seconds", "60"});
  require_rules(line.given(), {{{"--reports"}, OptionRule::Relation::Excludes, {"--report"}},
                               {{"--slurm"}, OptionRule::Relation::Excludes, {"--sshlogin"}}});
  if (reports) request.each.push_back({"--report", "{model}{ending}.json"});
  if (line.has("--max-memory")) request.max_memory = draft.request.max_memory;
  request.config = line.config();
  request.threads_given = line.has("--threads");
  request.dry_run = draft.request.dry_run;
  request.quiet = draft.request.quiet;
  request.verbose = draft.request.verbose;
  return request;
}

}  // namespace vdb_offset::tool
