// SPDX-License-Identifier: Apache-2.0
// Has OpenCASCADE read a CAD file in a program of its own, and asks that program about the file. The file's bytes are
// handed over as a file without a name; the worker is started, and has to be of this version. Each request is a message
// and gets one reply, and all of them together have so many seconds. A worker that ends, is late or answers with
// something else is given up, and answers nothing more; that, and a request for more memory than it may have, becomes
// an error that begins with the file's name. Replies are unpacked with their lengths checked. So a broken file cannot
// harm this process. What the worker does with a request is in src/cad.
#include "cad/cad_worker.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <system_error>
#include <utility>

#include "bytes/open_module.h"
#include "ground/process/worker_process.h"
#include "vdb_offset/api.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

constexpr const char* kWorkerName = "vdb_offset_cad";
constexpr std::uint64_t kMostOfReply = std::uint64_t{1} << 40;

// What OpenCASCADE takes to read any file, beside the file's bytes. Measured: 3 to 5 MiB for a box, by format.
constexpr std::uint64_t kLeastOfReader = std::uint64_t{3} << 20;

double in_mib(std::uint64_t bytes) { return static_cast<double>(bytes) / 1048576.0; }

/// \throw OutOfBudget if no file of that size can be read with so much memory, 0: any
void require_least_memory(const std::string& path, std::size_t bytes, std::uint64_t most_memory) {
  const std::uint64_t least = kLeastOfReader + bytes;
  if (most_memory == 0 || most_memory >= least) return;
  throw OutOfBudget(fmt::format("{}: needs at least {:.3g} MiB, more than --max-memory allows ({:.3g} MiB)", path,
                                in_mib(least), in_mib(most_memory)));
}

/// The worker's own name of a format.
std::string format_of(const std::string& path, std::string_view ending) {
  if (ending.starts_with('.')) ending.remove_prefix(1);
  std::string format(ending);
  for (char& letter : format) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  if (format == "step" || format == "stp") return "step";
  if (format == "iges" || format == "igs") return "iges";
  if (format == "brep") return "brep";
  throw InvalidInput(fmt::format("{}: expected a file .step, .stp, .iges, .igs or .brep, got .{}", path, format));
}

/// A file without a name that has these bytes.
OpenFile file_of(const std::string& path, std::string_view bytes) {
  OpenFile file(::memfd_create(kWorkerName, MFD_CLOEXEC));
  bool is_written = file.number() >= 0;
  while (is_written && !bytes.empty()) {
    const ssize_t done = ::write(file.number(), bytes.data(), bytes.size());
    if (done >= 0) bytes.remove_prefix(static_cast<std::size_t>(done));
    else if (errno != EINTR) is_written = false;
  }
  if (!is_written) throw ReadError(path + ": cannot be handed to " + kWorkerName + ": " + std::strerror(errno));
  return file;
}

[[noreturn]] void fail_to_start(const std::string& path, const std::string& found) {
  throw ReadError(
      fmt::format("{}: expected the program {}, which reads it, got: {} (install the whole package, or "
                  "convert it first)",
                  path, kWorkerName, found));
}

}  // namespace

struct CadWorker::State {
  State(std::string its_path, double most_seconds, std::uint64_t most_bytes)
      : path(std::move(its_path)), seconds(most_seconds), most_memory(most_bytes) {}

  std::string path;
  double seconds;
  std::uint64_t most_memory;
  std::optional<WorkerProcess> process;
  std::chrono::steady_clock::duration spent{};  // of those seconds, with all that was asked so far

  static constexpr double kForever = 1e8;  // seconds, three years; more would not be counted

  double seconds_left() const { return std::min(seconds, kForever) - std::chrono::duration<double>(spent).count(); }

  Deadline deadline() const {
    if (!(seconds < kForever)) return std::nullopt;
    return std::chrono::steady_clock::now() - spent +
           std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds));
  }

  [[noreturn]] void fail_by_end() {
    const std::optional<int> status = process->how_it_ended();
    const std::string end = !status                ? "ends its reader"
                            : WIFSIGNALED(*status) ? fmt::format("ends its reader by signal {}", WTERMSIG(*status))
                                                   : fmt::format("ends its reader with code {}", WEXITSTATUS(*status));
    process.reset();
    throw InvalidInput(path + ": expected a CAD file that OpenCASCADE can read, got one that " + end);
  }

  [[noreturn]] void fail_by_memory(const std::string& what) {
    if (most_memory == 0) throw OutOfBudget(path + ": " + what);
    throw OutOfBudget(
        fmt::format("{}: needs more memory than --max-memory allows ({:.3g} MiB)", path, in_mib(most_memory)));
  }

  [[noreturn]] void fail_by_time() {
    process.reset();
    throw InvalidInput(
        fmt::format("{}: expected a CAD file, got one that takes OpenCASCADE longer than {} s in all (--cad-seconds)",
                    path, seconds));
  }

  void start(const OpenFile& file, const Deadline& until) {
    Message first;
    try {
      process.emplace(worker_program(kWorkerName), &file);
      first = process->messages().receive(until, kMostOfReply);
    } catch (const std::system_error& error) {
      fail_to_start(path, error.what());
    } catch (const Hangup&) {
      fail_to_start(path, "one that does not start");
    } catch (const BadMessage& bad) {
      fail_to_start(path, bad.what());
    } catch (const TooLate&) {
      fail_by_time();
    }
    if (first.kind != static_cast<std::uint32_t>(CadReply::Version) || first.payload != VDB_OFFSET_VERSION)
      fail_to_start(path, "version " + first.payload + " for a program of version " VDB_OFFSET_VERSION);
  }

  /// The reply to a request; progress that comes before it is passed on. \throw Cancelled; the worker is ended then
  Message reply_to(CadRequest kind, const Deadline& until, const ProgressCallback& progress) {
    const Stage stage = kind == CadRequest::Mesh ? Stage::Read : Stage::Write;
    double most = 0;  // an attempt may begin anew
    while (true) {
      Message reply = process->messages().receive(until, kMostOfReply);
      if (reply.kind != static_cast<std::uint32_t>(CadReply::Progress)) return reply;
      Unpacker unpacker(reply.payload);
      const auto share = unpacker.value<double>();
      unpacker.end();
      most = std::clamp(share, most, 1.0);
      if (!progress || progress(stage, most)) continue;
      process.reset();
      throw Cancelled();
    }
  }

  std::string ask(CadRequest kind, std::string_view payload, const Deadline& until, const ProgressCallback& progress) {
    if (!process) throw InvalidInput(path + ": expected a CAD file that is still being read, got one that failed");
    try {
      process->messages().send(static_cast<std::uint32_t>(kind), payload, until);
      Message reply = reply_to(kind, until, progress);
      switch (static_cast<CadReply>(reply.kind)) {
        case CadReply::Done:
          return std::move(reply.payload);
        case CadReply::InvalidFile:
        case CadReply::Failed:
          throw InvalidInput(path + ": " + reply.payload);
        case CadReply::OutOfMemory:
          fail_by_memory(reply.payload);
        default:
          throw BadMessage("a reply of no kind");
      }
    } catch (const Hangup&) {
      fail_by_end();
    } catch (const TooLate&) {
      fail_by_time();
    } catch (const BadMessage& bad) {
      fail_by_message(bad);
    }
  }

  [[noreturn]] void fail_by_message(const BadMessage& bad) {
    process.reset();
    throw InvalidInput(path + ": expected an answer about the CAD file, got " + bad.what());
  }
};

CadWorker::CadWorker(std::string path, std::string_view bytes, std::string_view format, const CadMeshing& meshing,
                     double seconds, std::uint64_t most_memory, const ProgressCallback& progress)
    : state_(std::make_unique<State>(std::move(path), seconds, most_memory)) {
  const std::string name = format_of(state_->path, format);
  require_least_memory(state_->path, bytes.size(), most_memory);
  const auto begun = std::chrono::steady_clock::now();
  const Deadline until = state_->deadline();
  state_->start(file_of(state_->path, bytes), until);
  const ReadCad read{fmt::format("/proc/self/fd/{}", kWorkerModel), name, meshing, most_memory};
  const std::string reply = state_->ask(CadRequest::Mesh, pack(read), until, progress);
  state_->spent += std::chrono::steady_clock::now() - begun;
  try {
    mesh_ = unpack_mesh(reply);
  } catch (const BadMessage& bad) {
    state_->fail_by_message(bad);
  }
}

CadWorker::~CadWorker() = default;
CadWorker::CadWorker(CadWorker&&) noexcept = default;
CadWorker& CadWorker::operator=(CadWorker&&) noexcept = default;

std::string CadWorker::request(CadRequest kind, std::string_view payload, const ProgressCallback& progress) {
  const auto begun = std::chrono::steady_clock::now();
  std::string reply = state_->ask(kind, payload, state_->deadline(), progress);
  state_->spent += std::chrono::steady_clock::now() - begun;
  return reply;
}

std::vector<double> CadWorker::distance_errors(std::span<const CadPoint> points) {
  Packer packer;
  packer.list(std::vector<CadPoint>(points.begin(), points.end()));
  const std::string reply = request(CadRequest::Distances, packer.take());
  try {
    Unpacker unpacker(reply);
    auto errors = unpacker.list<double>();
    unpacker.end();
    if (errors.size() != points.size()) throw BadMessage("distances of other points");
    return errors;
  } catch (const BadMessage& bad) {
    state_->fail_by_message(bad);
  }
}

std::vector<Vec3d> CadWorker::offset_points(std::span<const CadAim> aims, std::span<const CadPlace> places) {
  Packer packer;
  packer.list(std::vector<CadAim>(aims.begin(), aims.end())).list(std::vector<CadPlace>(places.begin(), places.end()));
  const std::string reply = request(CadRequest::Offset, packer.take());
  try {
    Unpacker unpacker(reply);
    auto points = unpacker.list<Vec3d>();
    unpacker.end();
    if (points.size() != aims.size()) throw BadMessage("points of other vertices");
    return points;
  } catch (const BadMessage& bad) {
    state_->fail_by_message(bad);
  }
}

CadWritten CadWorker::write(WriteCad write, const ProgressCallback& progress) {
  write.seconds = state_->seconds_left();
  const std::string reply = request(CadRequest::Write, pack(write), progress);
  try {
    return unpack_written(reply);
  } catch (const BadMessage& bad) {
    state_->fail_by_message(bad);
  }
}

}  // namespace vdb_offset::io
