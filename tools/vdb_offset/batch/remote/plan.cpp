// SPDX-License-Identifier: Apache-2.0
// A plan is a list of texts with a zero byte behind each, which no name and no option holds.
#include "batch/remote/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "batch/model_run.h"
#include "file_plan.h"
#include "request/option_values.h"
#include "vdb_offset/api.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

namespace fs = std::filesystem;

/// What a plan begins with: those of another version may mean something else.
std::string first_text() { return fmt::format("plan of vdb_offset batch {}", version()); }

class Texts {
 public:
  Texts(const std::string& path, std::string bytes) : path_(path), bytes_(std::move(bytes)) {}

  bool at_end() const { return at_ == bytes_.size(); }
  std::string next() {
    const std::size_t end = bytes_.find('\0', at_);
    if (end == std::string::npos)
      throw InvalidInput(fmt::format("{}:{}: expected a text of a plan, got the end of the file", path_, at_));
    return bytes_.substr(std::exchange(at_, end + 1), end - at_);
  }
  std::size_t next_count() { return static_cast<std::size_t>(parse_count("plan", next(), 0, 1 << 30)); }

 private:
  const std::string& path_;
  std::string bytes_;
  std::size_t at_ = 0;
};

}  // namespace

std::string path_of_plan(const std::string& out) { return state_folder(out) + "/plan"; }

void write_plan(const Plan& plan) {
  const BatchRequest& request = plan.request;
  std::string bytes;
  const auto add = [&](const std::string& text) { bytes.append(text).append(1, '\0'); };
  for (const std::string& text : {first_text(), fs::current_path().string(), plan.mark, request.folder, request.out,
                                  request.output, request.partition, fmt::format("{}", request.jobs.value_or(0)),
                                  fmt::format("{}", request.max_memory.value_or(0)), fmt::format("{}", plan.tasks),
                                  fmt::format("{}", request.each.size())})
    add(text);
  for (const GivenOption& option : request.each) {
    add(option.name);
    add(option.value ? "=" + *option.value : "");
  }
  for (const Model& model : plan.models) add(model.path);
  write_file(path_of_plan(request.out), bytes);
}

Plan read_plan(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw ReadError(path + ": expected a plan that can be read");
  Texts texts(path, {std::istreambuf_iterator<char>(file), {}});
  if (texts.next() != first_text()) throw InvalidInput(fmt::format("{}: expected a {}", path, first_text()));
  std::error_code failed;
  const std::string folder = texts.next();
  fs::current_path(folder, failed);
  if (failed)
    throw ReadError(fmt::format("{}: expected the same folder on each machine: {}", folder, failed.message()));
  Plan plan;
  BatchRequest& request = plan.request;
  for (std::string* const text : {&plan.mark, &request.folder, &request.out, &request.output, &request.partition})
    *text = texts.next();
  if (const auto jobs = static_cast<int>(texts.next_count()); jobs > 0) request.jobs = jobs;
  if (const std::size_t bytes = std::stoull(texts.next()); bytes > 0) request.max_memory = bytes;
  plan.tasks = std::max<std::size_t>(1, texts.next_count());
  for (std::size_t left = texts.next_count(); left > 0; --left) {
    GivenOption option{texts.next(), {}};
    if (const std::string value = texts.next(); !value.empty()) option.value = value.substr(1);
    request.threads_given |= option.name == "--threads";
    request.each.push_back(std::move(option));
  }
  while (!texts.at_end()) {
    Model model{texts.next(), 0};
    model.ending = ending_of(model.path);
    plan.models.push_back(std::move(model));
  }
  return plan;
}

}  // namespace vdb_offset::tool
