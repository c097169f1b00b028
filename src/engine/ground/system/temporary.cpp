// SPDX-License-Identifier: Apache-2.0
#include "ground/system/temporary.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <mutex>
#include <string_view>
#include <utility>

#include "vdb_offset/run.h"

namespace vdb_offset {

/// What remove_temporaries() has to know. These are used again, never freed: a signal handler may read any of them at
/// any moment.
struct Temporary::Known {
  enum class State { Free, Changing, There, Removed };  ///< Removed by a handler, which ends the process.

  std::string path;
  Kind kind = Kind::File;
  std::atomic<State> state = State::Free;
  Known* next = nullptr;
};

std::atomic<Temporary::Known*> Temporary::first_known = nullptr;

namespace {

// How names of temporary files begin: hidden, and recognised by a later run if this one is killed.
constexpr std::string_view kPrefix = ".vdb_offset-";
// Longest ending of a target, in bytes, that its temporary file keeps. The longest known ending, of a compressed file,
// has 9.
constexpr std::size_t kLongestEnding = 16;
// Random names to try before giving up. All but by chance the first one is free.
constexpr int kMostNames = 100;

enum class Phase { Writing, PuttingInPlace, Ending };
std::atomic<Phase> phase = Phase::Writing;
std::mutex putting_in_place;

/// A number for the machine, since when it runs, and the container: process numbers mean something only within these.
std::uint64_t machine() {
  char host[256] = {};
  ::gethostname(host, sizeof host - 1);
  std::string started;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> started;
  struct stat processes {};
  ::stat("/proc/self/ns/pid", &processes);
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (const char c : fmt::format("{}/{}/{}", host, started, processes.st_ino))
    hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return hash;
}

std::string prefix() { return fmt::format("{}{:08x}-", kPrefix, machine() & 0xffffffffu); }

std::uint64_t random_number() {
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof number, GRND_NONBLOCK) != static_cast<ssize_t>(sizeof number))
    number = static_cast<std::uint64_t>(::getpid()) << 32 ^ reinterpret_cast<std::uintptr_t>(&number);
  return number;
}

/// Whether a file of this name was made on this machine by a process that has ended.
bool is_stale(std::string_view name, std::string_view ours) {
  if (!name.starts_with(ours)) return false;
  name.remove_prefix(ours.size());
  pid_t process = 0;
  const auto [end, failed] = std::from_chars(name.data(), name.data() + name.size(), process);
  const bool is_number = failed == std::errc() && end != name.data() + name.size() && *end == '-' && process > 0;
  return is_number && ::kill(process, 0) != 0 && errno == ESRCH;
}

}  // namespace

Temporary::Known& Temporary::free_one() {
  for (Known* known = first_known; known; known = known->next) {
    auto free = Known::State::Free;
    if (known->state.compare_exchange_strong(free, Known::State::Changing)) return *known;
  }
  Known* const made = new Known;
  made->state = Known::State::Changing;
  made->next = first_known;
  while (!first_known.compare_exchange_weak(made->next, made)) {
  }
  return *made;
}

Temporary::Temporary(std::string path, Kind kind) : known_(&free_one()) {
  known_->path = std::move(path);
  known_->kind = kind;
  known_->state = Known::State::There;
}

Temporary::Temporary(Temporary&& other) noexcept : known_(std::exchange(other.known_, nullptr)) {}

Temporary::~Temporary() {
  if (!known_) return;
  if (known_->kind == Kind::File) ::unlink(known_->path.c_str());
  else ::rmdir(known_->path.c_str());
  keep();
}

const std::string& Temporary::path() const { return known_->path; }

void Temporary::keep() {
  auto there = Known::State::There;
  // If a signal handler has removed the file, nothing is left to do: the process is about to end.
  if (known_->state.compare_exchange_strong(there, Known::State::Changing)) known_->state = Known::State::Free;
  known_ = nullptr;
}

Temporary new_temporary_file(const std::filesystem::path& target, const std::string& path) {
  const std::string ending = target.extension().string();
  for (int i = 0; i < kMostNames; ++i) {
    const std::string name = fmt::format("{}{}-{:016x}{}", prefix(), ::getpid(), random_number(),
                                         ending.size() <= kLongestEnding ? ending : "");
    Temporary made((target.parent_path() / name).string(), Temporary::Kind::File);
    const int file = ::open(made.path().c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file >= 0) {
      ::close(file);
      return made;
    }
    const int failed = errno;
    made.keep();  // what has that name already was not made here, and must not be removed
    if (failed != EEXIST) throw WriteError(path + ": cannot be written: " + std::strerror(failed));
  }
  throw WriteError(path + ": cannot be written: every temporary name is taken");
}

void remove_stale_temporaries(const std::filesystem::path& folder) noexcept {
  try {
    const std::string ours = prefix();
    std::error_code failed;
    for (std::filesystem::directory_iterator entry(folder, failed), end; !failed && entry != end;
         entry.increment(failed))
      if (is_stale(entry->path().filename().string(), ours)) ::unlink(entry->path().c_str());
  } catch (const std::exception&) {
    // Files that are left over do no harm.
  }
}

bool remove_temporaries() noexcept {
  auto writing = Phase::Writing;
  if (!phase.compare_exchange_strong(writing, Phase::Ending) && writing == Phase::PuttingInPlace) return false;
  using State = Temporary::Known::State;
  Temporary::Known* const first = Temporary::first_known;
  for (auto* known = first; known; known = known->next) {
    auto there = State::There;
    if (known->state.compare_exchange_strong(there, State::Removed) && known->kind == Temporary::Kind::File)
      ::unlink(known->path.c_str());
  }
  // A folder can only be removed after the folders in it: repeat until no more can be.
  for (bool any = true; std::exchange(any, false);)
    for (auto* known = first; known; known = known->next)
      if (known->state == State::Removed && known->kind == Temporary::Kind::Folder)
        any |= ::rmdir(known->path.c_str()) == 0;
  return true;
}

PuttingInPlace::PuttingInPlace() {
  putting_in_place.lock();
  auto writing = Phase::Writing;
  if (phase.compare_exchange_strong(writing, Phase::PuttingInPlace)) return;
  for (;;) ::pause();  // a signal handler is about to end the process
}

PuttingInPlace::~PuttingInPlace() {
  phase = Phase::Writing;
  putting_in_place.unlock();
}

}  // namespace vdb_offset
