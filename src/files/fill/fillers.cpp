// SPDX-License-Identifier: Apache-2.0
// Has Netgen, TetGen or gmsh fill a domain, by a program of its own: it is started for one domain, has to be of this
// version, gets the domain as a message and answers with one. Whatever it does else becomes an error.
#include <fmt/format.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>
#include <vector>

#include "bytes/open_module.h"
#include "ground/process/worker_process.h"
#include "ground/system/temporary.h"
#include "messages/fill_messages.h"
#include "vdb_offset/io/filler.h"

namespace vdb_offset::io {
namespace {

constexpr const char* kFillProgram = "vdb_offset_fill";
constexpr std::uint64_t kMostOfFilling = std::uint64_t{1} << 40;

[[noreturn]] void fail_without_program(const std::string& found) {
  throw ReadError(fmt::format("fill: expected the program {}, which fills volumes, got: {} (install the whole package)",
                              kFillProgram, found));
}

/// A folder for files that goes with this object.
class FolderForFiles {
 public:
  FolderForFiles() {
    std::error_code error;
    std::string name = (std::filesystem::temp_directory_path(error) / "vdb_offset-XXXXXX").string();
    if (error || name.find_first_of("'\"\\\n") != std::string::npos) {
      const char* const asked = std::getenv("TMPDIR");
      throw ReadError(
          fmt::format("TMPDIR: expected a folder for a filler's files, without quotes in its name, got '{}'",
                      asked == nullptr ? "" : asked));
    }
    if (!::mkdtemp(name.data())) throw WriteError(name + ": cannot be made: " + std::strerror(errno));
    folder_.emplace(name, Temporary::Kind::Folder);
    // What TetGen or gmsh reads and writes goes too where a signal ends this process, which removes no folder that is
    // not empty.
    for (const char* const file :
         {"domain.poly", "domain.1.node", "domain.1.ele", "domain.1.face", "domain.1.edge", "domain.1.smesh",
          "domain.1.poly", "domain.msh", "domain.geo", "domain.sizes", "filled.msh"})
      files_.emplace_back(name + "/" + file, Temporary::Kind::File);
  }
  FolderForFiles(const FolderForFiles&) = delete;
  FolderForFiles& operator=(const FolderForFiles&) = delete;

  const std::string& path() const { return folder_->path(); }

 private:
  std::optional<Temporary> folder_;
  std::vector<Temporary> files_;  // go before it
};

const char* name_of(FillWith with) {
  switch (with) {
    case FillWith::Netgen:
      return "Netgen";
    case FillWith::TetGen:
      return "TetGen";
    case FillWith::Gmsh:
      return "gmsh";
  }
  throw InvalidInput("fill: expected Netgen, TetGen or gmsh");
}

/// What a filler asks for at least, in bytes for each triangle of the border. Measured on insides of 4,000 to 60,000
/// triangles: 6.4 kB to 7 kB for Netgen, 2.5 to 3 for TetGen, 5.4 to 8 for gmsh.
std::uint64_t least_memory(FillWith with, std::size_t triangles) {
  const std::uint64_t of_one = with == FillWith::Netgen ? 5000 : with == FillWith::TetGen ? 2000 : 4000;
  return of_one * triangles;
}

class FillerRun {
 public:
  FillerRun(FillWith with, const FillerLimits& limits) : with_(with), limits_(limits) {
    constexpr double kForever = 1e8;  // seconds, three years; more would not be counted
    if (limits.seconds < kForever)
      until_ = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                      std::chrono::duration<double>(limits.seconds));
  }

  FilledDomain fill(const FillDomain& domain) {
    if (const std::uint64_t least = least_memory(with_, domain.triangles.size());
        limits_.most_memory > 0 && least > limits_.most_memory)
      throw OutOfBudget(
          fmt::format("fill: {} needs at least {} MB for a border of {} triangles, more than {} MB "
                      "(--max-memory)",
                      name_of(with_), least / 1'000'000, domain.triangles.size(), limits_.most_memory / 1'000'000));
    try {
      start();
      if (with_ != FillWith::Netgen) folder_.emplace();
      process_->messages().send(static_cast<std::uint32_t>(with_),
                                pack(FillTask{domain, folder_ ? folder_->path() : "", limits_.most_memory}), until_);
      const Message reply = receive();
      switch (static_cast<FillReply>(reply.kind)) {
        case FillReply::Done:
          return unpack_filled(reply.payload);
        case FillReply::Failed:
          throw FillFailed(
              fmt::format("fill: expected a domain that {} can fill, got {}", name_of(with_), reply.payload));
        case FillReply::Missing:
          throw ReadError("fill: expected the program that fills to be installed, got " + reply.payload);
        case FillReply::OutOfMemory:
          throw OutOfBudget("fill: needs more memory than --max-memory allows");
        default:
          throw BadMessage("a reply of no kind");
      }
    } catch (const Hangup&) {
      fail_by_end();
    } catch (const TooLate&) {
      process_.reset();
      throw FillFailed(
          fmt::format("fill: expected a domain that {} fills within {} s, got one that takes longer "
                      "(--fill-seconds)",
                      name_of(with_), limits_.seconds));
    } catch (const BadMessage& bad) {
      throw FillFailed(std::string("fill: expected an answer of ") + kFillProgram + ", got " + bad.what());
    }
  }

 private:
  void start() {
    Message first;
    try {
      process_.emplace(worker_program(kFillProgram), nullptr);
      first = process_->messages().receive(until_, kMostOfFilling);
    } catch (const std::system_error& error) {
      fail_without_program(error.what());
    } catch (const Hangup&) {
      fail_without_program("one that does not start");
    }
    if (first.kind != static_cast<std::uint32_t>(FillReply::Version) || first.payload != VDB_OFFSET_VERSION)
      fail_without_program("version " + first.payload + " for a program of version " VDB_OFFSET_VERSION);
  }

  /// The reply; progress that comes before it is passed on. \throw Cancelled; the program is ended then
  Message receive() {
    while (true) {
      Message reply = process_->messages().receive(until_, kMostOfFilling);
      if (reply.kind != kProgressMessage) return reply;
      if (!limits_.progress || limits_.progress(Stage::Fill, 0)) continue;
      process_.reset();
      throw Cancelled();
    }
  }

  [[noreturn]] void fail_by_end() {
    const std::optional<int> status = process_->how_it_ended();
    const std::string end = !status                ? "its end"
                            : WIFSIGNALED(*status) ? fmt::format("its end by signal {}", WTERMSIG(*status))
                                                   : fmt::format("its end with code {}", WEXITSTATUS(*status));
    throw FillFailed(fmt::format("fill: expected a domain that {} can fill, got {}", name_of(with_), end));
  }

  const FillWith with_;
  const FillerLimits& limits_;
  Deadline until_;
  std::optional<FolderForFiles> folder_;  // outlives the process, which writes to it
  std::optional<WorkerProcess> process_;
};

}  // namespace

Filler make_filler(FillWith with, FillerLimits limits) {
  name_of(with);  // there is such a filler
  return [with, limits = std::move(limits)](const FillDomain& domain) { return FillerRun(with, limits).fill(domain); };
}

}  // namespace vdb_offset::io
