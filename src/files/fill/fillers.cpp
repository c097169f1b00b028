// SPDX-License-Identifier: Apache-2.0
// Has Netgen or TetGen fill a domain, by a program of its own: it is started for one domain, has to be of this version,
// gets the domain as a message and answers with one. Whatever it does else becomes an error.
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
    std::string name = (std::filesystem::temp_directory_path() / "vdb_offset-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw WriteError(name + ": cannot be made: " + std::strerror(errno));
    folder_.emplace(name, Temporary::Kind::Folder);
    // What TetGen reads and writes goes too where a signal ends this process, which removes no folder that is not
    // empty.
    for (const char* const file : {"poly", "1.node", "1.ele", "1.face", "1.edge", "1.smesh", "1.poly"})
      files_.emplace_back(name + "/domain." + file, Temporary::Kind::File);
  }
  FolderForFiles(const FolderForFiles&) = delete;
  FolderForFiles& operator=(const FolderForFiles&) = delete;

  const std::string& path() const { return folder_->path(); }

 private:
  std::optional<Temporary> folder_;
  std::vector<Temporary> files_;  // go before it
};

struct FillerName {
  FillWith with;
  const char* name;
};

class FillerRun {
 public:
  FillerRun(const FillerName& filler, const FillerLimits& limits) : filler_(filler), limits_(limits) {
    constexpr double kForever = 1e8;  // seconds, three years; more would not be counted
    if (limits.seconds < kForever)
      until_ = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                      std::chrono::duration<double>(limits.seconds));
  }

  FilledDomain fill(const FillDomain& domain) {
    try {
      start();
      std::optional<FolderForFiles> folder;
      if (filler_.with != FillWith::Netgen) folder.emplace();
      process_->messages().send(static_cast<std::uint32_t>(filler_.with),
                                pack(FillTask{domain, folder ? folder->path() : "", limits_.most_memory}), until_);
      const Message reply = receive();
      switch (static_cast<FillReply>(reply.kind)) {
        case FillReply::Done:
          return unpack_filled(reply.payload);
        case FillReply::Failed:
          throw FillFailed(
              fmt::format("fill: expected a domain that {} can fill, got {}", filler_.name, reply.payload));
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
                      filler_.name, limits_.seconds));
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
    throw FillFailed(fmt::format("fill: expected a domain that {} can fill, got {}", filler_.name, end));
  }

  const FillerName& filler_;
  const FillerLimits& limits_;
  Deadline until_;
  std::optional<WorkerProcess> process_;
};

}  // namespace

Filler netgen_filler(FillerLimits limits) {
  static constexpr FillerName kNetgen{FillWith::Netgen, "Netgen"};
  return [limits = std::move(limits)](const FillDomain& domain) { return FillerRun(kNetgen, limits).fill(domain); };
}

Filler tetgen_filler(FillerLimits limits) {
  static constexpr FillerName kTetGen{FillWith::TetGen, "TetGen"};
  return [limits = std::move(limits)](const FillDomain& domain) { return FillerRun(kTetGen, limits).fill(domain); };
}

}  // namespace vdb_offset::io
