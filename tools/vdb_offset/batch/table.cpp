// SPDX-License-Identifier: Apache-2.0
#include "batch/table.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "messages.h"
#include "vdb_offset/numbers.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

constexpr std::string_view kHeading =
    "model,distance,seconds,memory_mib,vertices,share_reached,faces_mean_error,faces_within_1_percent,faces_certified,"
    "new_crossings,exit_code,message\n";

std::string quoted(const std::string& text) {
  std::string field = "\"";
  for (const char c : text) field.append(c == '"' ? 2 : 1, c);
  return field + '"';
}

/// With an apostrophe in front where a spreadsheet would take it for a formula, as a name that begins with '='.
std::string no_formula(const std::string& text) {
  return !text.empty() && std::string_view("=+-@\t\r\n").find(text[0]) != std::string_view::npos ? "'" + text : text;
}

/// A text as a field: in quotes where it holds what ends a field.
std::string field(const std::string& text) {
  const std::string safe = no_formula(text);
  return safe.find_first_of(",\"\r\n") == std::string::npos ? safe : quoted(safe);
}

/// A number is none, whatever its sign.
std::string field_of_distance(const std::string& text) {
  const std::size_t end = text.find_last_not_of("%abcdefghijklmnopqrstuvwxyz");
  return decimal<double>(std::string_view(text).substr(0, end + 1)) ? text : field(text);
}

}  // namespace

std::string rows_of(const Model& model, const Record& record) {
  const Ending& ending = record.ending;
  const std::vector<Record::Figures> none(1);
  std::string rows;
  for (const Record::Figures& figures : record.figures.empty() ? none : record.figures)
    rows += fmt::format("{},{},{:.3f},{:.0f},{},{},{},{},{},{},{},{}\n", quoted(no_formula(as_text(model.path))),
                        field_of_distance(figures.distance), ending.seconds,
                        static_cast<double>(ending.peak_memory) / 1048576.0, figures.vertices, figures.share_reached,
                        figures.mean_error, figures.within_1_percent, figures.certified, figures.new_crossings,
                        ending.exit_code, field(ending.message.empty() ? figures.warning : ending.message));
  return rows;
}

Table::Table(const std::string& out) : path_(path_of_table(out)) {}

void Table::keep(std::size_t model, std::string rows) { rows_.emplace_back(model, std::move(rows)); }

void Table::begin() {
  struct stat is {};
  // To write to a pipe waits for somebody who reads it.
  if (::stat(path_.c_str(), &is) == 0 && !S_ISREG(is.st_mode))
    throw WriteError(fmt::format("{}: expected a file that can be replaced, got something else", path_));
  write();
}

void Table::add(std::size_t model, std::string rows) {
  const int file = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  struct stat before {};
  bool written = file >= 0 && ::fstat(file, &before) == 0;
  int error = errno;
  if (written) {
    // All at once, so that the table never ends within a row.
    const ssize_t count = ::write(file, rows.data(), rows.size());
    error = count < 0 ? errno : ENOSPC;
    written = count == static_cast<ssize_t>(rows.size());
    if (!written && ::ftruncate(file, before.st_size) != 0) error = errno;
  }
  if (file >= 0) ::close(file);
  if (!written) throw WriteError(fmt::format("{}: cannot be written: {}", path_, std::strerror(error)));
  keep(model, std::move(rows));
}

void Table::finish() {
  std::sort(rows_.begin(), rows_.end());
  write();
}

void Table::write() {
  std::string text(kHeading);
  for (const auto& [model, rows] : rows_) text += rows;
  write_file(path_, text);
}

}  // namespace vdb_offset::tool
