// SPDX-License-Identifier: Apache-2.0
#include "file_plan.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cctype>
#include <filesystem>
#include <map>
#include <utility>

#include "job.h"
#include "messages.h"
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

/// The files that a request names to be read, INPUT first, and those that the input names.
std::vector<RunFile> files_read(const Request& request, std::span<const std::string> files_named) {
  std::vector<RunFile> files = surroundings_of(request);
  files.insert(files.begin(), {"INPUT", request.input});
  add(files, "--config", request.config);
  add(files, "--fit", request.fit);
  if (request.fill) add(files, "--farfield", request.fill->farfield_file);
  for (const std::string& path : files_named) add(files, "the input's own files", path);
  if (request.inner) add_source_of(files, "--inner", *request.inner);
  if (!request.layers) return files;
  add(files, "--heights", request.layers->heights);
  for (const auto& [option, asked] : request.layers->lengths()) add_source_of(files, option, *asked);
  return files;
}

/// A distance as given, without characters that file names may not have.
std::string as_name(std::string distance) {
  for (char& c : distance)
    if (!std::isalnum(static_cast<unsigned char>(c)) && std::string_view(".+-%_").find(c) == std::string_view::npos)
      c = '_';
  return distance;
}

/// A name of several outputs: `{i}` becomes their number, from 001 on, `{d}` the distance as given; without either the
/// number is put behind the name, if there are several.
std::string numbered(std::string name, std::size_t number, std::size_t of, const std::string& distance) {
  if (name.empty() || name == "-") return name;
  bool marked = false;
  for (const auto& [mark, value] :
       {std::pair<std::string, std::string>{"{i}", fmt::format("{:03}", number)}, {"{d}", as_name(distance)}})
    for (std::size_t at = name.find(mark); at != std::string::npos; at = name.find(mark, at + value.size())) {
      name.replace(at, mark.size(), value);
      marked = true;
    }
  if (!marked && of > 1) name.insert(ending_of(name), fmt::format("_{:03}", number));
  return name;
}

/// One for each distance; one with the names as they are if there is none.
std::vector<Destination> destinations(const Request& request, std::span<const DistanceRequest> distances) {
  if (distances.empty()) return {{request.output, request.report, request.states, request.paths, request.html, {}}};
  std::vector<Destination> all;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const std::string& text = distances[i].text;
    const auto named = [&](const std::string& name) { return numbered(name, i + 1, distances.size(), text); };
    all.push_back({named(request.output), named(request.report), named(request.states), named(request.paths),
                   named(request.html), text});
  }
  return all;
}

void add_reports(std::vector<RunFile>& files, const Destination& to) {
  add(files, "--report", to.report);
  add(files, "--states", to.states);
  add(files, "--paths", to.paths);
  add(files, "--html", to.html);
}

/// Adds what is written with --layers, of which there are so many.
void add_layers(FilePlan& files, const Request& request, std::size_t layers) {
  const std::string& output = request.output;
  const bool is_folder = io::volume_format_of(output) == io::VolumeFormat::Foam;
  if (io::volume_format_of(output) || io::structured_format_of(output)) {
    files.written.push_back({"OUTPUT", output, false, is_folder});
  } else {
    for (std::size_t k = 1; k <= layers; ++k) files.layers.push_back(numbered(output, k, layers, fmt::format("{}", k)));
    for (const std::string& path : files.layers) files.written.push_back({"OUTPUT", path, layers == 1});
  }
  if (is_folder)
    for (const char* const name : io::kFoamFiles)
      files.written.push_back({"OUTPUT", (fs::path(output) / name).string(), false, true});
  add_reports(files.written, files.outputs.front());
}

/// Adds what is written of an offset, or an iso-surface.
void add_offsets(FilePlan& files, const Request& request) {
  // An output may replace an input mesh. Not a scene, and not one of several outputs, as that is hardly intended.
  const bool may_be_input = files.outputs.size() == 1 && !scene::is_scene(request.input);
  for (const Destination& to : files.outputs) {
    files.written.push_back({"OUTPUT", to.mesh, may_be_input});
    // Where its numbers go, if those of the source are in a file of their own.
    if (io::format_of(to.mesh) == io::Format::Gltf)
      files.written.push_back({"OUTPUT", fs::path(to.mesh).replace_extension(".bin").string(), may_be_input, true});
    add_reports(files.written, to);
  }
  add(files.written, "--save-vdb", request.vdb);
  if (!request.tolerance) return;
  add(files.written, "--refined-source", request.tolerance->refined_source);
  add(files.written, "--map", request.tolerance->map);
}

/// \param distances of offsets, as given
FilePlan plan(const Request& request, std::span<const std::string> files_named,
              std::span<const DistanceRequest> distances, std::size_t layers) {
  FilePlan files{destinations(request, distances), {}, files_read(request, files_named), {}};
  if (request.layers) add_layers(files, request, layers);
  else add_offsets(files, request);
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

void require_apart(const FilePlan& files) {
  const RunFile& input = files.read.front();
  for (const RunFile& file : files.read)
    if (file.option == "--fit" && identity_of(file.path, STDIN_FILENO) == identity_of(input.path, STDIN_FILENO))
      throw UsageError("--fit: expected a file other than the input, got " + shown(file.path));
  require_apart(files.read, files.written);
}

void require_writable_files(const FilePlan& files) {
  for (const RunFile& file : files.written)
    if (!file.is_left_to_writer) require_writable(file.path);
}

FilePlan plan_files(const Request& request) {
  const bool layers = request.layers.has_value();
  return plan(request, {}, request.distances, layers ? request.layers->count : 0);
}

FilePlan plan_files(const Job& job) {
  const bool layers = job.request.layers.has_value();
  FilePlan files = plan(job.request, job.source.files_named, job.asked, layers ? job.distances.size() : 0);
  for (const std::string& path : job.files_of_heights) add(files.read, "--heights", path);
  return files;
}

bool is_standard_output(const std::string& path) {
  return !path.empty() && identity_of(path, STDOUT_FILENO) == identity_of("-", STDOUT_FILENO);
}

std::vector<RunFile> surroundings_of(const Request& request) {
  std::vector<RunFile> files;
  const char* const of_part = request.layers ? "--layers-of" : "--distance-of";
  for (const std::string& path : request.obstacles) add(files, "--obstacle", path);
  for (const io::Selector& part : request.only)
    if (part.by == io::Selector::By::File) add(files, "--only", part.name);
  for (const PartDistance& each : request.distances_of)
    if (each.part.by == io::Selector::By::File) add(files, of_part, each.part.name);
  for (const PartDistance& each : request.distances_of) add_source_of(files, of_part, each.distance);
  for (const DistanceRequest& each : request.distances) add_source_of(files, request.distance_option, each);
  return files;
}

std::size_t ending_of(const std::string& name) {
  const std::size_t folder = name.rfind('/') == std::string::npos ? 0 : name.rfind('/') + 1;
  std::size_t dot = name.rfind('.');
  if (dot == std::string::npos || dot <= folder) return name.size();
  const std::string last = name.substr(dot);
  if (last != ".gz" && last != ".zst") return dot;
  const std::size_t before = name.rfind('.', dot - 1);
  return before == std::string::npos || before <= folder ? dot : before;
}

}  // namespace vdb_offset::tool
