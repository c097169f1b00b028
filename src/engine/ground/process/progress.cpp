// SPDX-License-Identifier: Apache-2.0
#include "ground/process/progress.h"

#include <sys/socket.h>

#include "ground/process/message_channel.h"
#include "ground/process/packing.h"

namespace vdb_offset {
namespace {

int progress_socket = -1;
double part_from = 0, part_to = 1;

double in_request(double share) { return part_from + (part_to - part_from) * share; }

}  // namespace

void report_progress_to(int socket) { progress_socket = socket; }

void report_progress(double share) {
  if (progress_socket < 0) return;
  Packer packer;
  packer.value(in_request(share));
  // In one piece: a process that has a time limit may be ended after any call.
  const std::string message = MessageChannel::framed(kProgressMessage, packer.take());
  [[maybe_unused]] const auto sent =
      ::send(progress_socket, message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

ProgressPart::ProgressPart(double from, double to) : from_before_(part_from), to_before_(part_to) {
  const double begins = in_request(from), ends = in_request(to);
  part_from = begins;
  part_to = ends;
}

ProgressPart::~ProgressPart() {
  part_from = from_before_;
  part_to = to_before_;
}

}  // namespace vdb_offset
