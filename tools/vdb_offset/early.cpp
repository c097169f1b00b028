// SPDX-License-Identifier: Apache-2.0
// What has to be done before main(), and before libraries are initialised. One of them starts threads then: where the
// system has none left, the process would end by a signal and without a message of ours.
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

// The functions that run before main() must not be instrumented: the sanitizers are not initialised yet.

/// Opens a file for each standard stream that the caller has closed: otherwise the next file that is opened would get
/// its number, and messages would be written into it. Reading and writing it fail, as they would for the closed stream.
[[gnu::no_sanitize_address]] void fill_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0 && errno == EBADF)
      static_cast<void>(::open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY));
}

/// Ends the process with a message, after an exception that nothing can catch: one thrown before main(), by a thread of
/// a library, or while another one was handled.
[[noreturn]] void end_with_message() {
  const std::exception_ptr thrown = std::current_exception();
  if (!thrown) std::abort();  // without an exception it is a defect, which is to dump core
  try {
    std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    report_problem("out of memory (see --max-memory, --threads, and ulimit)");
  } catch (const std::system_error& error) {
    report_problem(std::string("expected more threads or memory than there are: ") + error.what() +
                   " (see --threads and ulimit)");
  } catch (const std::exception& error) {
    report_problem(error.what());
  } catch (...) {
    report_problem("ended unexpectedly");
  }
  remove_temporaries();
  ::_exit(3);
}

[[gnu::no_sanitize_address]] void prepare(int, char**, char**) {
  fill_closed_streams();
  std::set_terminate(end_with_message);
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is then an error of writing like any other
}

[[gnu::section(".preinit_array"), gnu::used]] void (*before_libraries)(int, char**, char**) = prepare;

}  // namespace
}  // namespace vdb_offset::tool
