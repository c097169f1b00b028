// SPDX-License-Identifier: Apache-2.0
// The program that reads CAD files by OpenCASCADE. Programs of the project start it, and talk with it by messages
// (messages/cad_messages.h); by hand it is of no use.
#include <fcntl.h>
#include <unistd.h>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <Standard_Failure.hxx>
#include <Standard_OutOfMemory.hxx>

#include <cstdio>
#include <new>

#include "ground/process/guard.h"
#include "ground/process/message_channel.h"
#include "ground/process/progress.h"
#include "vdb_offset/api.h"
#include "worker/requests.h"

namespace vdb_offset::cad {
namespace {

constexpr std::uint64_t kMostOfRequest = std::uint64_t{1} << 40;

struct Reply {
  io::CadReply kind;
  std::string payload;
};

const std::string kTooLarge = "expected a CAD file whose model fits into memory, got one that asks for more";

/// OpenCASCADE's own words, on one line.
std::string in_short(const char* words) {
  std::string line(words ? words : "");
  for (char& letter : line)
    if (static_cast<unsigned char>(letter) < ' ') letter = ' ';
  constexpr std::size_t kMostLetters = 200;
  line.resize(std::min(line.size(), kMostLetters));
  return line.empty() ? "an error without a text" : line;
}

Reply reply_to(Requests& requests, const Message& asked) {
  try {
    return {io::CadReply::Done, requests.answer(static_cast<io::CadRequest>(asked.kind), asked.payload)};
  } catch (const InvalidCad& invalid) {
    return {io::CadReply::InvalidFile, invalid.what()};
  } catch (const BadMessage& bad) {
    return {io::CadReply::Failed, bad.what()};
  } catch (const std::bad_alloc&) {
    return {io::CadReply::OutOfMemory, kTooLarge};
  } catch (const std::length_error&) {
    return {io::CadReply::OutOfMemory, kTooLarge};
  } catch (const Standard_OutOfMemory&) {
    return {io::CadReply::OutOfMemory, kTooLarge};
  } catch (const Standard_Failure& failure) {
    return {io::CadReply::InvalidFile, std::string("expected a CAD file that OpenCASCADE can read, got: ") +
                                           failure.DynamicType()->Name() + ": " + in_short(failure.GetMessageString())};
  } catch (const std::exception& error) {
    return {io::CadReply::InvalidFile, "expected a CAD file that OpenCASCADE can read, got: " + in_short(error.what())};
  }
}

void serve() {
  MessageChannel messages{OpenFile(kWorkerMessages)};
  messages.send(static_cast<std::uint32_t>(io::CadReply::Version), VDB_OFFSET_VERSION, {});
  report_progress_to(kWorkerMessages);
  Requests requests;
  while (true) {
    const Message asked = messages.receive({}, kMostOfRequest);
    const Reply reply = reply_to(requests, asked);
    messages.send(static_cast<std::uint32_t>(reply.kind), reply.payload, {});
  }
}

}  // namespace
}  // namespace vdb_offset::cad

int main(int, char** words) {
  using namespace vdb_offset;
  if (::fcntl(kWorkerEnd, F_GETFD) < 0 || ::fcntl(kWorkerMessages, F_GETFD) < 0) {
    std::fprintf(stderr, "%s: is started by vdb_offset, for CAD files\n", words[0]);
    return 1;
  }
  ::close_range(kWorkerEnd + 1, ~0U, 0);  // what else the program had open
  start_guard();
  ::Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  try {
    cad::serve();
  } catch (const Hangup&) {
  } catch (const BadMessage&) {
  }
  ::_exit(0);  // without giving back what the model is made of, piece by piece
}
