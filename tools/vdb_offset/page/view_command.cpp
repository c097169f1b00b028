// SPDX-License-Identifier: Apache-2.0
// `vdb_offset view`: the page of a mesh, or of two as `check` measures them, written and opened.
#include "page/view_command.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <cstring>
#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <system_error>
#include <vector>

#include "check_command.h"
#include "file_plan.h"
#include "job.h"
#include "messages.h"
#include "page/open_page.h"
#include "page/run_pages.h"
#include "request/command_line.h"
#include "request/option_values.h"
#include "source.h"
#include "terminal.h"
#include "vdb_offset/output_files.h"

namespace vdb_offset::tool {
namespace {

constexpr const char* kViewAbout =
    "Shows a mesh in a browser, or a mesh and its offset: writes a page, which needs no network, prints its path and\n"
    "opens it by $BROWSER or xdg-open.\n"
    "RESULT may be of any program. If it has the vertices and faces of FILE, it is measured as `vdb_offset check` "
    "does,\n"
    "and the page shows which vertices and faces are at the distance; the options that say how the offset was made\n"
    "are those of check, which calls FILE SOURCE and RESULT OFFSET. Otherwise both are shown without measures.";

constexpr const char* kViewMore = R"(
Exit codes: 0 done, 1 usage, 2 input, 3 processing, 4 output. A browser that cannot be opened is reported, with 0.)";

struct ViewRequest {
  CheckRequest check;
  bool no_open = false;
};

/// Options that say how a file is read; all others of `check` are about RESULT.
constexpr const char* kReading[] = {"--unit",        "--grid",    "--isovalue", "--deflection", "--angle",  "--bodies",
                                    "--cad-seconds", "--flatten", "--close",    "--html",       "--no-open"};

/// Reads the command line. None if it asked only for help, which is then printed.
std::optional<ViewRequest> parse_view(int argc, const char* const* argv) {
  ViewRequest request;
  request.check.may_differ = true;
  Request& made = request.check.made;
  CommandLine line("vdb_offset view", kViewAbout, kViewMore, "vdb_offset view --help");
  line.file("FILE", "Mesh, CAD model, level set, scene or curves, as INPUT of vdb_offset", made.input);
  line.file_or_none("RESULT", "Its offset", made.output);
  line.option("--html", "FILE", "Write the page to FILE (.html) [a temporary file]", made.html);
  line.flag("--no-open", "Write the page, and do not open it", request.no_open);
  declare_measuring(line, request.check);
  line.option("--threads", "N", "Threads; 0 takes all [0]", made.threads, count_between("--threads", 0, kMostThreads));
  if (!line.parse(argc, argv)) return std::nullopt;
  require_measuring(line, request.check);
  if (made.output.empty())
    if (const auto other = line.given_besides(kReading))
      throw UsageError(fmt::format("{}: expected a RESULT as well, as this says how it is measured", *other));
  return request;
}

/// A name that no file has yet, in the folder of temporary files. \throw WriteError if there is no such folder
std::string temporary_page() {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (error)
    throw WriteError(fmt::format("TMPDIR: expected a folder: {} (--html FILE names the page)", error.message()));
  std::random_device chance;
  return (folder / fmt::format("vdb_offset-{:08x}{:08x}.html", chance(), chance())).string();
}

/// Writes the page of a mesh, or of curves, alone.
void show_alone(const Request& made) {
  report_lost_input(made.input);
  require_writable(made.html);
  const Source source = read_source(made, holds_curves(made.input));
  std::vector<RunFile> read{{"FILE", made.input}};
  for (const std::string& path : source.files_named) read.push_back({"the input's own files", path});
  const RunFile page{"--html", made.html};
  require_apart(read, {&page, 1});
  write_page(made, source);
}

}  // namespace

bool is_view(int argc, const char* const* argv) { return argc > 1 && std::strcmp(argv[1], "view") == 0; }

int run_view(int argc, const char* const* argv) {
  auto request = parse_view(argc - 1, argv + 1);
  if (!request) return kDone;
  Request& made = request->check.made;
  made.command = as_typed(argc, argv);
  if (made.html.empty()) {
    ::umask(077);  // temporary files lie where others may look
    made.html = temporary_page();
  }
  OutputFiles outputs(made.sync);
  if (made.output.empty()) show_alone(made);
  else static_cast<void>(measure(request->check));
  outputs.commit(ignore_interrupts);
  if (is_standard_output(made.html)) return kDone;
  fmt::print(Printout(), "{}\n", as_text(made.html));
  if (request->no_open) return kDone;
  if (const std::string why = open_page(made.html); !why.empty())
    report_problem(fmt::format("{}: not opened ({}); open it in a browser, or set BROWSER", made.html, why));
  return kDone;
}

}  // namespace vdb_offset::tool
