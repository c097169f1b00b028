#include "vdb_offset/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace vdb_offset {
namespace {

/// A number in a file of the control group; `missing` if there is none (no group, or "max").
std::size_t number_in(const char* path, std::size_t missing) {
  std::ifstream file(path);
  std::size_t value = 0;
  return file >> value ? value : missing;
}

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

}  // namespace vdb_offset
