// SPDX-License-Identifier: Apache-2.0
#include "ground/process/memory_limit.h"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <string>

namespace vdb_offset {
namespace {

// What has to be left for the limit not to have been met: the largest pieces that OpenCASCADE asks for by habit; and
// the share of the limit that the largest of its own growing lists would have passed it from.
constexpr std::size_t kPiece = std::size_t{1} << 26;
constexpr double kShare = 0.75;

// The share of what is allowed from which a list that grows to twice its size could have passed it.
constexpr double kUsedShare = 0.5;

/// The most bytes of addresses that this process has had; 0 if the system does not say.
std::uint64_t most_addresses() {
  std::ifstream file("/proc/self/status");
  for (std::string word; file >> word;)
    if (std::uint64_t kilobytes = 0; word == "VmPeak:" && file >> kilobytes) return kilobytes * 1024;
  return 0;
}

}  // namespace

void limit_memory(std::uint64_t more) {
#ifndef __SANITIZE_ADDRESS__
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlim_t most = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + more;
  if (const rlimit limit{most, most}; more > 0 && pages > 0) ::setrlimit(RLIMIT_AS, &limit);
#else
  (void)more;
#endif
}

bool is_memory_used_up(std::uint64_t more) {
  rlimit limit{};
  if (more == 0 || ::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return false;
  const std::uint64_t at_start = limit.rlim_cur - more, most = most_addresses();
  return most > at_start && static_cast<double>(most - at_start) > kUsedShare * static_cast<double>(more);
}

bool is_memory_short() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return false;
  if (static_cast<double>(most_addresses()) > kShare * static_cast<double>(limit.rlim_cur)) return true;
  void* const piece = std::malloc(kPiece);
  std::free(piece);
  return piece == nullptr;
}

}  // namespace vdb_offset
