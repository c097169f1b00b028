// SPDX-License-Identifier: Apache-2.0
#include "batch/model_run.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "batch/fingerprint.h"
#include "file_plan.h"
#include "outputs.h"
#include "request/request.h"
#include "vdb_offset/io/curve_file.h"
#include "vdb_offset/io/volume_file.h"

namespace vdb_offset::tool {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kModel = "{model}", kEnding = "{ending}";

// Options that name a file to write: their patterns are below the folder of outputs.
constexpr std::string_view kWriting[] = {"--report",   "--states",         "--paths", "--html",
                                         "--save-vdb", "--refined-source", "--map"};

/// A pattern with what stands for a model in its place. `stem`: for {model}.
std::string filled(std::string_view pattern, const std::string& stem, const std::string& ending) {
  std::string text;
  for (std::size_t at = 0; at < pattern.size();) {
    if (pattern.substr(at).starts_with(kModel)) {
      text += stem;
      at += kModel.size();
    } else if (pattern.substr(at).starts_with(kEnding)) {
      text += ending;
      at += kEnding.size();
    } else {
      text += pattern[at++];
    }
  }
  return text;
}

/// Requires a name below the folder of outputs that is another for each model. \throw UsageError
void require_pattern(const std::string& option, const std::string& pattern) {
  if (pattern.find(kModel) == std::string::npos)
    throw UsageError(
        fmt::format("{}: expected a name with {{model}} in it, one for each model, got '{}'", option, pattern));
  const fs::path path = pattern;
  if (path.is_absolute() || std::find(path.begin(), path.end(), "..") != path.end())
    throw UsageError(fmt::format("{}: expected a path below OUT, got '{}'", option, pattern));
}

std::string path_of_report(const std::string& out, const Model& model) {
  return fmt::format("{}/running/{}.json", state_folder(out), state_name(model));
}

/// {i} and {d} mean something else in the names of outputs. \throw UnusableName
void require_plain(const std::string& path, const char* of_what) {
  for (const char* const mark : {"{i}", "{d}"})
    if (path.find(mark) != std::string::npos)
      throw UnusableName(
          fmt::format("{}: expected {} without {{i}} and {{d}}, which stand for the number of a distance "
                      "and for the distance",
                      path, of_what));
}

std::optional<std::pair<dev_t, ino_t>> identity_of(const std::string& path) {
  struct stat file {};
  if (::stat(path.c_str(), &file) != 0) return std::nullopt;
  return std::pair{file.st_dev, file.st_ino};
}

/// How a model is offset. Empty if its name cannot be used: its run reports that later.
ModelRun run_if_usable(const BatchRequest& request, const Model& model) {
  try {
    return run_of(request, model);
  } catch (const UnusableName&) {
    return {};
  }
}

/// Requires an ending of a format that can be written, so that this is not found out model by model. \throw UsageError
void require_known_ending(const Request& request) {
  const std::string& path = request.output;
  if (!format_of(path, request) && !io::curve_format_of(path) &&
      !(request.layers && (io::volume_format_of(path) || io::structured_format_of(path))))
    throw UsageError(fmt::format("--output: expected names that end in a format's ending, got {}", path));
}

}  // namespace

std::string path_of_table(const std::string& out) { return out + "/batch.csv"; }

std::string state_folder(const std::string& out) { return out + "/" + kStateFolder; }

std::string state_name(const Model& model) { return fingerprint_of(model.path); }

ModelRun run_of(const BatchRequest& request, const Model& model) {
  require_plain(model.path, "the name of a model");
  const std::string stem = model.path.substr(0, model.ending), ending = model.path.substr(model.ending);
  const auto output = [&](const std::string& option, const std::string& pattern) {
    require_pattern(option, pattern);
    return request.out + "/" + filled(pattern, stem, ending);
  };
  ModelRun run;
  run.words = {request.folder + "/" + model.path, output("--output", request.output)};
  for (const GivenOption& option : request.each) {
    const bool is_written = std::find(std::begin(kWriting), std::end(kWriting), option.name) != std::end(kWriting);
    run.keeps_reports |= option.name == "--report";
    if (!option.value) run.words.push_back(option.name);
    else if (is_written) run.words.push_back(option.name + "=" + output(option.name, *option.value));
    else run.words.push_back(option.name + "=" + filled(*option.value, request.folder + "/" + stem, ending));
  }
  if (!run.keeps_reports) run.words.push_back("--report=" + path_of_report(request.out, model));
  run.words.push_back("--quiet");

  std::vector<const char*> line{"vdb_offset"};
  for (const std::string& word : run.words) line.push_back(word.c_str());
  const Request parsed = parse_command_line(static_cast<int>(line.size()), line.data()).value();
  require_known_ending(parsed);
  const FilePlan files = plan_files(parsed);
  for (const Destination& to : files.outputs) run.reports.push_back(to.report);
  for (const RunFile& file : files.read) run.read.push_back(file.path);
  for (const RunFile& file : files.written)
    if (run.keeps_reports || file.option != "--report") run.written.push_back(file.path);
  return run;
}

void require_apart(const BatchRequest& request, std::span<const Model> models) {
  const std::string table = path_of_table(request.out), state = state_folder(request.out) + "/";
  std::map<std::string, const Model*> taken;
  std::set<std::pair<dev_t, ino_t>> read;    // by any model
  std::set<std::pair<dev_t, ino_t>> config;  // none, or one
  if (const auto identity = identity_of(request.config)) config.insert(*identity);
  if (const auto identity = identity_of(table); identity && config.contains(*identity))
    throw UsageError(
        fmt::format("--config: expected another file than the table of the batch, got {}", request.config));
  std::vector<std::vector<std::string>> written;
  const auto add_read = [&](const std::string& path) {
    taken.emplace(fs::path(path).lexically_normal(), nullptr);
    if (const auto identity = identity_of(path)) read.insert(*identity);
  };
  for (const Model& model : models) {
    add_read(request.folder + "/" + model.path);
    ModelRun run = run_if_usable(request, model);
    for (const std::string& path : run.read) add_read(path);
    written.push_back(std::move(run.written));
  }
  if (const auto identity = identity_of(table); identity && read.contains(*identity))
    throw UsageError(fmt::format("{}: expected a table, got a file that is read", table));
  for (const Model& model : models)
    for (const std::string& path : written[static_cast<std::size_t>(&model - models.data())]) {
      const auto [other, is_new] = taken.emplace(fs::path(path).lexically_normal(), &model);
      const auto identity = identity_of(path);
      // By whatever link it is reached.
      if ((!is_new && !other->second) || (identity && read.contains(*identity)))
        throw UsageError(fmt::format("{}: its output {} would replace a file that the batch reads", model.path, path));
      if (identity && config.contains(*identity))
        throw UsageError(fmt::format("{}: its output {} would replace the file of --config", model.path, path));
      if (path == table || path.starts_with(state))
        throw UsageError(fmt::format("{}: its output {} would replace one of the batch's own files (the table, {})",
                                     model.path, path, state));
      if (!is_new)
        throw UsageError(
            fmt::format("--output: expected a name of its own for each model, got {} for {} and {} (use "
                        "{{ending}}, or --models)",
                        path, other->second->path, model.path));
    }
}

}  // namespace vdb_offset::tool
