// SPDX-License-Identifier: Apache-2.0
// The program that fills volumes by Netgen, TetGen or gmsh. Programs of the project start it, hand it one domain and
// get its cells (messages/fill_messages.h); by hand it is of no use.
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <new>
#include <thread>

#include "child_program.h"
#include "gmsh.h"
#include "ground/process/guard.h"
#include "ground/process/memory_limit.h"
#include "ground/process/progress.h"
#include "messages/fill_messages.h"
#include "netgen.h"
#include "sizes.h"
#include "tetgen.h"
#include "vdb_offset/api.h"

namespace vdb_offset {
namespace {

constexpr std::uint64_t kMostOfRequest = std::uint64_t{1} << 40;

/// While this lives, the program that asked hears every tenth of a second that the work goes on, and can end it: Netgen
/// does not say how far it is.
class Heartbeat {
 public:
  Heartbeat() : beating_([this] { beat(); }) {}
  ~Heartbeat() {
    {
      const std::lock_guard lock(mutex_);
      is_over_ = true;
    }
    changed_.notify_one();
    beating_.join();
  }
  Heartbeat(const Heartbeat&) = delete;
  Heartbeat& operator=(const Heartbeat&) = delete;

 private:
  void beat() {
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, std::chrono::milliseconds(100), [this] { return is_over_; })) report_progress(0);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_over_ = false;
  std::thread beating_;
};

struct Reply {
  FillReply kind;
  std::string payload;
};

Reply reply_to(const Message& asked) {
  try {
    const FillTask task = unpack_fill_task(asked.payload);
    const Heartbeat heartbeat;
    switch (static_cast<FillWith>(asked.kind)) {
      case FillWith::Netgen:
        limit_memory(task.most_memory);
        return {FillReply::Done, pack(fill_by_netgen(task.domain))};
      case FillWith::TetGen:
        return {FillReply::Done, pack(fill_by_tetgen(task.domain, task.folder, task.most_memory))};
      case FillWith::Gmsh:
        return {FillReply::Done, pack(fill_by_gmsh(task.domain, task.folder, task.most_memory))};
    }
    throw BadMessage("a request of no kind");
  } catch (const FillerMissing& missing) {
    return {FillReply::Missing, missing.what()};
  } catch (const std::bad_alloc&) {
    return {FillReply::OutOfMemory, {}};
  } catch (const std::exception& error) {
    return {FillReply::Failed, error.what()};
  } catch (...) {
    return {FillReply::Failed, "an error without a text"};
  }
}

void serve() {
  MessageChannel messages{OpenFile(kWorkerMessages)};
  messages.send(static_cast<std::uint32_t>(FillReply::Version), VDB_OFFSET_VERSION, {});
  report_progress_to(kWorkerMessages);
  const Reply reply = reply_to(messages.receive({}, kMostOfRequest));
  messages.send(static_cast<std::uint32_t>(reply.kind), reply.payload, {});
}

}  // namespace
}  // namespace vdb_offset

int main(int count, char** words) {
  using namespace vdb_offset;
  if (count == 3 && std::strcmp(words[1], "sizes") == 0) {  // gmsh asks
    try {
      serve_sizes(words[2]);
    } catch (const std::exception&) {
      return 1;
    }
    return 0;
  }
  if (::fcntl(kWorkerEnd, F_GETFD) < 0 || ::fcntl(kWorkerMessages, F_GETFD) < 0) {
    std::fprintf(stderr, "%s: is started by vdb_offset, for --fill\n", words[0]);
    return 1;
  }
  ::close_range(kWorkerEnd + 1, ~0U, 0);  // what else the program had open
  start_guard();
  try {
    serve();
  } catch (const Hangup&) {
  } catch (const BadMessage&) {
  }
  ::_exit(0);  // without giving back the mesh, piece by piece
}
