// SPDX-License-Identifier: Apache-2.0
#include "ground/system/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <string>

#include "vdb_offset/run.h"

namespace vdb_offset {
namespace {

/// The number in a file of the process's control group; `missing` if the file has none: there is no group, or it says
/// "max".
std::size_t number_in(const char* path, std::size_t missing) {
  std::ifstream file(path);
  std::size_t value = 0;
  return file >> value ? value : missing;
}

std::atomic<std::size_t> most = 0;  // bytes, 0: no limit; one for the process, as all of it shares one memory

}  // namespace

std::size_t available_memory() {
  constexpr auto kUnlimited = static_cast<std::size_t>(-1);
  std::size_t available =
      static_cast<std::size_t>(sysconf(_SC_AVPHYS_PAGES)) * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  std::ifstream info("/proc/meminfo");
  for (std::string key; info >> key;) {
    std::size_t kib = 0;
    if (key == "MemAvailable:" && info >> kib) available = kib * 1024;
    info.ignore(256, '\n');
  }
  const std::size_t limit = number_in("/sys/fs/cgroup/memory.max", kUnlimited),
                    used = number_in("/sys/fs/cgroup/memory.current", 0);
  return limit == kUnlimited ? available : std::min(available, limit - std::min(limit, used));
}

std::size_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

std::size_t held_memory() {
  std::ifstream file("/proc/self/statm");
  std::size_t mapped = 0, resident = 0;
  return file >> mapped >> resident ? resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) : 0;
}

void set_memory_limit(std::size_t bytes) { most = bytes; }

std::size_t memory_limit() { return most; }

bool fits_memory(std::size_t bytes) {
  const std::size_t limit = most;
  return limit == 0 || (bytes <= limit && held_memory() <= limit - bytes);
}

void require_memory(std::size_t bytes, const std::string& where) {
  if (fits_memory(bytes)) return;
  const std::size_t limit = most, held = held_memory();
  const auto mib = [](std::size_t size) { return static_cast<double>(size) / 1048576.0; };
  throw OutOfBudget(
      fmt::format("{}: needs {:.0f} MiB in addition to the {:.0f} MiB in use, more than --max-memory allows "
                  "({:.0f} MiB)",
                  where, mib(bytes), mib(held), mib(limit)));
}

void reserve_memory(const ReserveCallback& callback, std::size_t bytes) {
  if (callback && !callback(bytes)) throw Cancelled();
}

}  // namespace vdb_offset
