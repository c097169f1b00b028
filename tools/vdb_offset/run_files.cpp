// SPDX-License-Identifier: Apache-2.0
#include "run_files.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <filesystem>
#include <map>

#include "messages.h"
#include "outputs.h"
#include "request/option_values.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/io/volume_file.h"
#include "vdb_offset/output_files.h"

namespace vdb_offset::tool {
namespace {

namespace fs = std::filesystem;

std::string number_of(const struct stat& file) { return fmt::format("{}:{}", file.st_dev, file.st_ino); }

/// Whether a file is /dev/null, which any number of outputs may be written to.
bool is_null_device(const struct stat& file) { return S_ISCHR(file.st_mode) && file.st_rdev == makedev(1, 3); }

/// A text that is the same for two paths if they lead to the same file. Empty for a file that cannot clash with others.
std::string identity_of(const std::string& path, int standard_stream) {
  struct stat file {};
  const bool exists = path == "-" ? ::fstat(standard_stream, &file) == 0 : ::stat(path.c_str(), &file) == 0;
  if (path == "-" && (!exists || !S_ISREG(file.st_mode))) return fmt::format("-{}", standard_stream);
  if (!exists) {
    const fs::path whole = replaced_path(path);
    return (whole.has_filename() ? whole : whole.parent_path()).string();  // the path of a folder may end in a slash
  }
  if (is_null_device(file)) return {};
  struct stat stream {};
  // The path is a name of the standard stream, such as /dev/stdout.
  if (!S_ISREG(file.st_mode) && ::fstat(standard_stream, &stream) == 0 && number_of(stream) == number_of(file))
    return fmt::format("-{}", standard_stream);
  return number_of(file);
}

std::string shown(const std::string& path) {
  constexpr std::size_t kLongest = 120;  // bytes, so that two names fit into a message
  return shortened(path, kLongest);
}

[[noreturn]] void refuse(const RunFile& file, const RunFile& other) {
  if (file.option == other.option)
    throw UsageError(
        fmt::format("{}: expected names that differ, got {} twice (use {{i}})", file.option, shown(file.path)));
  throw UsageError(fmt::format("{}: expected a file of its own, got {}, which is that of {} ({})", file.option,
                               shown(file.path), other.option, shown(other.path)));
}

void add(std::vector<RunFile>& files, const std::string& option, const std::string& path) {
  if (!path.empty()) files.push_back({option, path, false});
}

/// Adds the file that a distance is read from, if there is one.
void add_source_of(std::vector<RunFile>& files, const std::string& option, const DistanceRequest& request) {
  if (!names_property(request.from)) add(files, option, request.from);
}

/// The files that are written with --layers. `layers` is the number of surfaces, if the output is no volume mesh.
std::vector<RunFile> written_with_layers(const Request& request, std::size_t layers) {
  std::vector<RunFile> files;
  const auto volume = io::volume_format_of(request.output);
  const bool is_one = volume || io::structured_format_of(request.output);
  if (is_one) files.push_back({"OUTPUT", request.output});
  else
    for (std::size_t k = 1; k <= layers; ++k)
      files.push_back({"OUTPUT", name_of_layer(request.output, k, layers), layers == 1});
  if (volume == io::VolumeFormat::Foam)
    for (const char* const name : io::kFoamFiles)
      files.push_back({"OUTPUT", (fs::path(request.output) / name).string()});
  add(files, "--report", request.report);
  add(files, "--states", request.states);
  add(files, "--html", request.html);
  return files;
}

std::vector<RunFile> written_by(const Request& request, std::vector<Destination> destinations) {
  std::vector<RunFile> files;
  // Without distances on the command line, the scene's one is not known yet, and there is one output.
  if (destinations.empty())
    destinations.push_back({request.output, request.report, request.states, request.paths, request.html, {}});
  // An output may replace an input mesh. Not a scene, and not one of several outputs, as that is hardly intended.
  const bool may_be_input = destinations.size() == 1 && !scene::is_scene(request.input);
  for (const Destination& to : destinations) {
    files.push_back({"OUTPUT", to.mesh, may_be_input});
    // Where its numbers go, if those of the source are in a file of their own.
    if (io::format_of(to.mesh) == io::Format::Gltf)
      files.push_back({"OUTPUT", fs::path(to.mesh).replace_extension(".bin").string(), may_be_input});
    add(files, "--report", to.report);
    add(files, "--states", to.states);
    add(files, "--paths", to.paths);
    add(files, "--html", to.html);
  }
  add(files, "--save-vdb", request.vdb);
  if (!request.tolerance) return files;
  add(files, "--refined-source", request.tolerance->refined_source);
  add(files, "--map", request.tolerance->map);
  return files;
}

}  // namespace

void require_apart(std::span<const RunFile> read, std::span<const RunFile> written) {
  std::multimap<std::string, const RunFile*> readers;
  for (const RunFile& file : read) readers.emplace(identity_of(file.path, STDIN_FILENO), &file);
  std::map<std::string, const RunFile*> writers;
  for (const RunFile& file : written) {
    const std::string identity = identity_of(file.path, STDOUT_FILENO);
    if (identity.empty()) continue;
    const auto [other, is_first] = writers.emplace(identity, &file);
    if (!is_first) refuse(file, *other->second);
    const auto [first, last] = readers.equal_range(identity);
    for (auto reader = first; reader != last; ++reader)
      if (!file.may_be_input || reader->second->option != "INPUT") refuse(file, *reader->second);
  }
}

void require_apart(const Request& request, std::span<const std::string> files_named) {
  if (!request.fit.empty() && identity_of(request.fit, STDIN_FILENO) == identity_of(request.input, STDIN_FILENO))
    throw UsageError("--fit: expected a file other than the input, got " + shown(request.fit));
  require_apart(files_read(request, files_named), files_written(request));
}

void require_apart(const Job& job) {
  std::vector<RunFile> read = files_read(job.request, job.source.files_named);
  for (const std::string& path : job.files_of_heights) add(read, "--heights", path);
  require_apart(read, job.request.layers ? written_with_layers(job.request, job.distances.size())
                                         : written_by(job.request, job.outputs));
}

std::vector<RunFile> files_read(const Request& request, std::span<const std::string> files_named) {
  std::vector<RunFile> files = surroundings_of(request);
  files.insert(files.begin(), {"INPUT", request.input});
  add(files, "--config", request.config);
  add(files, "--fit", request.fit);
  for (const std::string& path : files_named) add(files, "the input's own files", path);
  if (request.inner) add_source_of(files, "--inner", *request.inner);
  if (!request.layers) return files;
  add(files, "--heights", request.layers->heights);
  if (request.layers->first) add_source_of(files, "--first-height", *request.layers->first);
  if (request.layers->total) add_source_of(files, "--total-thickness", *request.layers->total);
  return files;
}

std::vector<RunFile> files_written(const Request& request) {
  return request.layers ? written_with_layers(request, request.layers->count)
                        : written_by(request, destinations(request, request.distances));
}

bool is_standard_output(const std::string& path) {
  return !path.empty() && identity_of(path, STDOUT_FILENO) == identity_of("-", STDOUT_FILENO);
}

std::vector<RunFile> surroundings_of(const Request& request) {
  std::vector<RunFile> files;
  for (const std::string& path : request.obstacles) add(files, "--obstacle", path);
  for (const io::Selector& part : request.only)
    if (part.by == io::Selector::By::File) add(files, "--only", part.name);
  for (const PartDistance& each : request.distances_of)
    if (each.part.by == io::Selector::By::File) add(files, "--distance-of", each.part.name);
  for (const PartDistance& each : request.distances_of) add_source_of(files, "--distance-of", each.distance);
  for (const DistanceRequest& each : request.distances) add_source_of(files, request.distance_option, each);
  return files;
}

}  // namespace vdb_offset::tool
