// SPDX-License-Identifier: Apache-2.0
// What has to stand before main(), and before libraries set themselves up: one that this command is linked to starts
// threads then, and where none are to be had the process would end by a signal, without a word of ours.
#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <new>
#include <system_error>

#include "messages.h"
#include "vdb_offset/output_files.h"

namespace vdb_offset::tool {
namespace {

// Neither of the two below may be instrumented: it runs before the sanitizers do.

/// A file that is opened later must not get the number of a standard stream that the caller has closed: messages would
/// go into it. What holds the number instead fails all reading and writing, as the closed one would.
[[gnu::no_sanitize_address]] void fill_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      static_cast<void>(::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY));
}

/// For what no one can catch: thrown before main(), by a thread of a library, or while something else was cleaned up.
[[noreturn]] void end_with_message() {
  const std::exception_ptr thrown = std::current_exception();
  if (!thrown) std::abort();  // a fault of the program, not of its surroundings
  try {
    std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    tell("out of memory (see --max-memory, --threads, and ulimit)");
  } catch (const std::system_error& error) {
    tell(std::string("expected more threads or memory than there are: ") + error.what() +
         " (see --threads and ulimit)");
  } catch (const std::exception& error) {
    tell(error.what());
  } catch (...) {
    tell("ended unexpectedly");
  }
  remove_temporaries();
  ::_exit(3);
}

[[gnu::no_sanitize_address]] void prepare(int, char**, char**) {
  fill_closed_streams();
  std::set_terminate(end_with_message);
  std::signal(SIGPIPE, SIG_IGN);  // a reader that has gone is an error of writing like any other
}

[[gnu::section(".preinit_array"), gnu::used]] void (*before_libraries)(int, char**, char**) = prepare;

}  // namespace
}  // namespace vdb_offset::tool
