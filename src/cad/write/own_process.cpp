// SPDX-License-Identifier: Apache-2.0
#include "write/own_process.h"

#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>
#include <Standard_Failure.hxx>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <system_error>

#include "ground/process/packing.h"
#include "read/cad_model.h"

namespace vdb_offset::cad {
namespace {

// Of faces that fold over, OpenCASCADE makes triangles without end. Models of 400 faces take a tenth of this.
constexpr rlim_t kMostMemory = rlim_t{2} << 30;
constexpr int kFailed = 3;   // an exit code
#ifdef __SANITIZE_ADDRESS__  // which has terabytes of addresses
constexpr bool kMayLimit = false;
#else
constexpr bool kMayLimit = true;
#endif

rlim_t addresses() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// Has this process ended by SIGALRM after some seconds.
void ring_after(double seconds) {
  constexpr double kLeast = 1e-3, kMost = 1e8;
  const double after = std::clamp(seconds, kLeast, kMost), whole = std::floor(after);
  const itimerval timer{{0, 0}, {static_cast<time_t>(whole), static_cast<suseconds_t>(1e6 * (after - whole))}};
  ::setitimer(ITIMER_REAL, &timer, nullptr);
}

}  // namespace

MemoryFile::MemoryFile() : descriptor_(::memfd_create("offset", MFD_CLOEXEC)) {
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "memfd_create");
}

MemoryFile::~MemoryFile() { ::close(descriptor_); }

void MemoryFile::write(std::string_view all) const {
  if (::ftruncate(descriptor_, 0) != 0 || ::lseek(descriptor_, 0, SEEK_SET) != 0)
    throw std::system_error(errno, std::generic_category(), "ftruncate");
  while (!all.empty()) {
    const ssize_t put = ::write(descriptor_, all.data(), all.size());
    if (put <= 0) throw std::system_error(errno, std::generic_category(), "write");
    all.remove_prefix(static_cast<std::size_t>(put));
  }
}

std::string MemoryFile::bytes() const {
  struct stat facts {};
  if (::fstat(descriptor_, &facts) != 0) throw std::system_error(errno, std::generic_category(), "fstat");
  std::string all(static_cast<std::size_t>(facts.st_size), '\0');
  for (std::size_t at = 0; at < all.size();) {
    const ssize_t got = ::pread(descriptor_, all.data() + at, all.size() - at, static_cast<off_t>(at));
    if (got <= 0) throw std::system_error(errno, std::generic_category(), "pread");
    at += static_cast<std::size_t>(got);
  }
  return all;
}

void write_apart(const WrittenModel& model, const std::string& format, const std::string& path) {
  const pid_t child = ::fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    try {
      write_model(model, format, path);
    } catch (...) {
      ::_exit(kFailed);
    }
    ::_exit(0);
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
  if (status != 0) throw InvalidCad("expected a model that OpenCASCADE can write, got one that it cannot");
}

std::optional<std::string> in_own_process(const std::function<std::string(const Keep&)>& work, const MostTime& most,
                                          std::string& gap) {
  const MemoryFile reply;
  // With its size, as the process may be ended while it writes.
  const auto keep = [&](std::string_view bytes) { reply.write(Packer().text(bytes).take()); };
  const pid_t child = ::fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    rlimit limit{};
    ::getrlimit(RLIMIT_AS, &limit);
    limit.rlim_cur = std::min<rlim_t>(limit.rlim_cur, addresses() + kMostMemory);
    if (kMayLimit) ::setrlimit(RLIMIT_AS, &limit);
    if (most.of_processor > 0) limit_seconds(most.of_processor);
    ring_after(most.in_all);
    try {
      keep(work(keep));
    } catch (const Standard_Failure&) {
      ::_exit(kFailed);
    } catch (const std::exception&) {
      ::_exit(kFailed);
    }
    ::_exit(0);
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
  const std::string kept = reply.bytes();
  const bool is_whole = kept.size() >= sizeof(std::uint64_t) &&
                        Unpacker(kept).value<std::uint64_t>() == kept.size() - sizeof(std::uint64_t);
  if (is_whole) return kept.substr(sizeof(std::uint64_t));
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  gap = signal == SIGXCPU || signal == SIGALRM ? std::string("OpenCASCADE takes too long with the result")
        : signal != 0 ? "OpenCASCADE is ended by signal " + std::to_string(signal) + " by the result"
                      : std::string("OpenCASCADE fails with the result");
  return std::nullopt;
}

void limit_seconds(unsigned seconds) {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  const rlim_t end = static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) + seconds;
  rlimit time{};
  ::getrlimit(RLIMIT_CPU, &time);
  time.rlim_cur = std::min(end, time.rlim_max);
  ::setrlimit(RLIMIT_CPU, &time);
}

}  // namespace vdb_offset::cad
