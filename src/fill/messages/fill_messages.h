// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "ground/process/message_channel.h"
#include "ground/process/packing.h"
#include "vdb_offset/fill.h"

namespace vdb_offset {

// What the program and its worker, vdb_offset_fill, send each other. The worker first says its version; then it gets
// one request, whose kind is an FillWith and whose payload a FillTask, and sends one reply.

/// What the worker says.
enum class FillReply : std::uint32_t {
  Version = 1,      ///< A text.
  Done = 2,         ///< A FilledDomain.
  Failed = 3,       ///< A text: what the filler says.
  OutOfMemory = 4,  ///< Nothing.
  Missing = 5,      ///< A text: a program that is not there.
  Progress = kProgressMessage,
};

struct FillTask {
  FillDomain domain;
  std::string folder;             ///< For a filler's files; empty for Netgen, which has none.
  std::uint64_t most_memory = 0;  ///< How many bytes more than it has at its start the worker may ask for; 0: any.
};

inline std::string pack(const FillTask& task) {
  Packer packer;
  packer.list(task.domain.points).list(task.domain.triangles).list(task.domain.outside);
  packer.value(task.domain.growth).value(task.domain.longest).text(task.folder).value(task.most_memory);
  return packer.take();
}

/// \throw BadMessage
inline FillTask unpack_fill_task(std::string_view bytes) {
  Unpacker unpacker(bytes);
  FillTask task;
  task.domain.points = unpacker.list<Vec3d>();
  task.domain.triangles = unpacker.list<std::array<std::uint32_t, 3>>();
  task.domain.outside = unpacker.list<Vec3d>();
  task.domain.growth = unpacker.value<double>();
  task.domain.longest = unpacker.value<double>();
  task.folder = unpacker.text();
  task.most_memory = unpacker.value<std::uint64_t>();
  unpacker.end();
  return task;
}

inline std::string pack(const FilledDomain& filled) {
  Packer packer;
  packer.list(filled.added).list(filled.cells);
  return packer.take();
}

/// \throw BadMessage
inline FilledDomain unpack_filled(std::string_view bytes) {
  Unpacker unpacker(bytes);
  FilledDomain filled;
  filled.added = unpacker.list<Vec3d>();
  filled.cells = unpacker.list<std::array<std::uint32_t, 4>>();
  unpacker.end();
  return filled;
}

}  // namespace vdb_offset
