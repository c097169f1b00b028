// SPDX-License-Identifier: Apache-2.0
// Has Netgen fill a domain in a program of its own: it is started for one domain, has to be of this version, gets the
// domain as a message and answers with one. Whatever it does else becomes an error.
#include <fmt/format.h>
#include <sys/wait.h>

#include <optional>
#include <system_error>

#include "bytes/open_module.h"
#include "ground/process/worker_process.h"
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

class NetgenRun {
 public:
  explicit NetgenRun(const FillerLimits& limits) : limits_(limits) {
    constexpr double kForever = 1e8;  // seconds, three years; more would not be counted
    if (limits.seconds < kForever)
      until_ = std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                                       std::chrono::duration<double>(limits.seconds));
  }

  FilledDomain fill(const FillDomain& domain) {
    try {
      start();
      process_->messages().send(static_cast<std::uint32_t>(FillWith::Netgen),
                                pack(FillTask{domain, limits_.most_memory}), until_);
      const Message reply = receive();
      switch (static_cast<FillReply>(reply.kind)) {
        case FillReply::Done:
          return unpack_filled(reply.payload);
        case FillReply::Failed:
          throw FillFailed("fill: expected a domain that Netgen can fill, got: " + reply.payload);
        case FillReply::OutOfMemory:
          throw OutOfBudget("fill: needs more memory than --max-memory allows");
        default:
          throw BadMessage("a reply of no kind");
      }
    } catch (const Hangup&) {
      fail_by_end();
    } catch (const TooLate&) {
      throw FillFailed(fmt::format("fill: expected a domain that Netgen fills within {} s (--fill-seconds)",
                                   limits_.seconds));
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
    throw FillFailed("fill: expected a domain that Netgen can fill, got " + end);
  }

  const FillerLimits& limits_;
  Deadline until_;
  std::optional<WorkerProcess> process_;
};

}  // namespace

Filler netgen_filler(FillerLimits limits) {
  return [limits = std::move(limits)](const FillDomain& domain) { return NetgenRun(limits).fill(domain); };
}

}  // namespace vdb_offset::io
