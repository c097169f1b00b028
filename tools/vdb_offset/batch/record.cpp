// SPDX-License-Identifier: Apache-2.0
#include "batch/record.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "batch/fingerprint.h"
#include "job.h"
#include "vdb_offset/api.h"
#include "vdb_offset/output_files.h"

namespace vdb_offset::tool {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kRecordVersion = 3;

std::string path_of_record(const std::string& out, const Model& model) {
  return fmt::format("{}/{}.json", folder_of_records(out), state_name(model));
}

/// A file's JSON; discarded if it is none.
json read_json(const std::string& path) {
  std::error_code unknown;
  if (!fs::is_regular_file(path, unknown)) return json(json::value_t::discarded);
  std::ifstream file(path);
  return json::parse(file, nullptr, false);
}

/// Bytes that need not be text, as JSON has them.
std::string as_digits(const std::string& bytes) {
  std::string digits;
  for (const char c : bytes) digits += fmt::format("{:02x}", static_cast<unsigned char>(c));
  return digits;
}

std::string from_digits(const std::string& digits) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    bytes += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  return bytes;
}

/// The value at a place in a report as text; empty if there is none.
std::string figure(const json& report, const char* place) {
  const json::json_pointer pointer(place);
  if (!report.contains(pointer)) return {};
  const json& value = report.at(pointer);
  return value.is_string() ? value.get<std::string>() : value.is_number() ? value.dump() : std::string();
}

/// Pairs that meet and did not before, near crossings of the source and elsewhere; none where nothing is known of them.
std::string new_crossings(const json& report) {
  const json::json_pointer left("/limit/left/crossings"), near("/limit/crossings_near_source");
  if (!report.contains(left) || !report.contains(near)) return {};
  return fmt::format("{}", report.at(left).get<std::size_t>() + report.at(near).get<std::size_t>());
}

/// What a report says for the table. That of an iso-surface has its figures elsewhere.
Record::Figures figures_of(const json& report) {
  const std::string at = report.contains("surface") ? "/surface" : "";
  return {.distance = figure(report, "/distance_as_given"),
          .vertices = figure(report, at.empty() ? "/mesh/vertices" : "/surface/vertices"),
          .share_reached = figure(report, "/achieved/share_reached"),
          .mean_error = figure(report, (at + "/faces/mean_error").c_str()),
          .within_1_percent = figure(report, (at + "/faces/share_within_1_percent").c_str()),
          .certified = figure(report, "/certified/certified"),
          .new_crossings = at.empty() ? new_crossings(report) : figure(report, "/surface/crossings"),
          .warning = figure(report, "/warnings/0/text")};
}

std::int64_t size_of(const std::string& path) {
  std::error_code unknown;
  if (!fs::is_regular_file(path, unknown)) return -1;
  const auto size = fs::file_size(path, unknown);
  return unknown ? -1 : static_cast<std::int64_t>(size);
}

json to_json(const Record& record) {
  json figures = json::array(), besides = json::array();
  for (const Record::Figures& each : record.figures)
    figures.push_back({each.distance, each.vertices, each.share_reached, each.mean_error, each.within_1_percent,
                       each.certified, each.new_crossings, each.warning});
  for (const std::string& path : record.read_besides) besides.push_back(as_digits(path));
  const Ending& ending = record.ending;
  return {{"version", kRecordVersion}, {"batch", record.batch},        {"key", record.key},
          {"stamp", record.stamp},     {"read_besides", besides},      {"exit_code", ending.exit_code},
          {"seconds", ending.seconds}, {"memory", ending.peak_memory}, {"message", ending.message},
          {"figures", figures},        {"sizes", record.sizes}};
}

Record from_json(const json& text) {
  Record record{.batch = text.at("batch").get<std::string>(),
                .key = text.at("key").get<std::string>(),
                .stamp = text.at("stamp").get<std::string>(),
                .read_besides = {},
                .ending = {text.at("exit_code").get<int>(), text.at("seconds").get<double>(),
                           text.at("memory").get<std::size_t>(), text.at("message").get<std::string>()},
                .figures = {},
                .sizes = text.at("sizes").get<std::vector<std::int64_t>>()};
  for (const json& path : text.at("read_besides")) record.read_besides.push_back(from_digits(path.get<std::string>()));
  for (const json& each : text.at("figures")) {
    const auto texts = each.get<std::array<std::string, 8>>();
    record.figures.push_back({texts[0], texts[1], texts[2], texts[3], texts[4], texts[5], texts[6], texts[7]});
  }
  return record;
}

std::vector<std::string> joined(std::vector<std::string> files, std::span<const std::string> more) {
  files.insert(files.end(), more.begin(), more.end());
  return files;
}

}  // namespace

std::string folder_of_records(const std::string& out) { return state_folder(out) + "/records"; }

std::string Ingredients::key(std::span<const std::string> read_besides) const {
  return fingerprint_of(words, joined(files, read_besides));
}

std::string Ingredients::stamp(std::span<const std::string> read_besides) const {
  return stamp_of(words, joined(files, read_besides));
}

Ingredients ingredients_of(const BatchRequest& request, const Model& model, const ModelRun& run) {
  Ingredients made_of{{version(), model.path, request.output}, run.read};
  for (const GivenOption& option : request.each) {
    if (option.name == "--threads" || option.name == "--no-sync") continue;  // the result is the same
    made_of.words.push_back(option.name);
    made_of.words.push_back(option.value.value_or(""));
  }
  // A limit of memory may make the grid coarser.
  if (request.max_memory) made_of.words.push_back(fmt::format("--max-memory {}", *request.max_memory));
  return made_of;
}

bool Record::failed_for_good() const { return ending.exit_code != 0 && ending.exit_code < kOutput; }

Record record_of(const ModelRun& run, Ending ending) {
  Record record;
  record.ending = std::move(ending);
  for (const std::string& path : run.reports) {
    const json report = read_json(path);
    if (report.is_object()) record.figures.push_back(figures_of(report));
    std::error_code gone;
    if (!run.keeps_reports) fs::remove(path, gone);
  }
  for (const std::string& path : run.written) record.sizes.push_back(size_of(path));
  return record;
}

bool are_there(const ModelRun& run, const Record& record) {
  std::vector<std::int64_t> sizes;
  for (const std::string& path : run.written) sizes.push_back(size_of(path));
  return sizes == record.sizes;
}

std::optional<Record> load_record(const std::string& out, const Model& model) {
  try {
    const json text = read_json(path_of_record(out, model));
    if (text.is_object() && text.value("version", 0) == kRecordVersion) return from_json(text);
  } catch (const std::exception&) {  // whatever has become of it, the model is done again
  }
  return std::nullopt;
}

void save_record(const std::string& out, const Model& model, const Record& record) {
  const std::string text = to_json(record).dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
  OutputFiles files(OutputFiles::Sync::No);  // one that is lost is made again
  write_file(path_of_record(out, model), text);
  files.commit();
}

void remove_record(const std::string& out, const Model& model) {
  std::error_code gone;
  fs::remove(path_of_record(out, model), gone);
}

}  // namespace vdb_offset::tool
