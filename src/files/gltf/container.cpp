// SPDX-License-Identifier: Apache-2.0
#include "gltf/container.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "bytes/append_number.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io::gltf {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are read and written as they are in memory");

constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2;  // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;
constexpr std::size_t kGlbHeader = 12, kChunkHead = 8;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::uint32_t word_at(std::string_view bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

[[noreturn]] void fail_at(const std::string& path, std::size_t byte, const std::string& expected,
                          const std::string& found) {
  throw InvalidInput(fmt::format("{}, byte {}: expected {}, got {}", path, byte, expected, found));
}

/// What a chunk holds whose head is at a byte.
Container::Span chunk_at(const MeshFile& file, std::size_t at, std::size_t end) {
  const std::size_t size = word_at(file.text(), at), left = end - at - kChunkHead;
  if (size > left)
    fail_at(file.path, at, fmt::format("a chunk of at most {} bytes, as many as the file has left", left),
            fmt::format("one of {}", size));
  return {at + kChunkHead, size};
}

Container read_glb(const MeshFile& file) {
  const std::string_view bytes = file.text();
  if (bytes.size() < kGlbHeader + kChunkHead)
    fail_at(file.path, bytes.size(), "the header of a .glb and of its first chunk, 20 bytes", "the end of the file");
  if (word_at(bytes, 0) != kMagic) fail_at(file.path, 0, "\"glTF\", as a .glb begins", "other bytes");
  if (word_at(bytes, 4) != kVersion) fail_at(file.path, 4, "version 2", std::to_string(word_at(bytes, 4)));
  const std::size_t length = word_at(bytes, 8);
  if (length > bytes.size() || length < kGlbHeader + kChunkHead)
    fail_at(file.path, 8, fmt::format("a length from 20 to {}, that of the file", bytes.size()),
            std::to_string(length));
  if (word_at(bytes, kGlbHeader + 4) != kJsonChunk) fail_at(file.path, kGlbHeader + 4, "a chunk of JSON", "another");
  Container container;
  container.is_binary = true;
  container.json = container.json_chunk = chunk_at(file, kGlbHeader, length);
  // Blanks fill the chunk up; some programs take zeros.
  while (container.json.size > 0 && (bytes[container.json.begin + container.json.size - 1] == ' ' ||
                                     bytes[container.json.begin + container.json.size - 1] == '\0'))
    --container.json.size;
  const std::size_t second = container.json_chunk.begin + container.json_chunk.size;
  if (length - second >= kChunkHead && word_at(bytes, second + 4) == kBinChunk)
    container.bin = chunk_at(file, second, length);
  return container;
}

void append_head(std::string& bytes, std::uint64_t length, std::size_t json_size) {
  if (length > 0xffffffff)
    throw InvalidInput(fmt::format("glb: expected a file of less than 4 GiB, got {} bytes (write a .gltf)", length));
  for (const std::uint32_t word :
       {kMagic, kVersion, static_cast<std::uint32_t>(length), static_cast<std::uint32_t>(json_size), kJsonChunk})
    append_binary(bytes, word);
}

std::size_t padding(std::size_t size) { return (4 - size % 4) % 4; }

}  // namespace

Container read_container(const MeshFile& file) {
  const std::string_view bytes = file.text();
  if (file.format == Format::Glb) return read_glb(file);
  if (bytes.size() >= 4 && word_at(bytes, 0) == kMagic)
    fail_at(file.path, 0, "JSON text", "a binary file (whose name ends in .glb)");
  Container container;
  const std::size_t mark = bytes.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
  container.json = {mark, bytes.size() - mark};
  return container;
}

std::string glb_head(const std::string& path, const Container& container, std::string_view file,
                     std::string_view json) {
  const Container::Span& chunk = container.json_chunk;
  std::string text(json);
  if (text.size() == container.json.size)
    text += file.substr(container.json.begin + container.json.size, chunk.size - container.json.size);
  else text.append(padding(text.size()), ' ');
  std::string bytes;
  try {
    append_head(bytes, word_at(file, 8) - std::uint64_t{chunk.size} + text.size(), text.size());
  } catch (const InvalidInput& error) {
    throw InvalidInput(path + ": " + error.what());
  }
  return bytes + text;
}

std::string glb_head(std::string json, std::size_t binary_bytes) {
  json.append(padding(json.size()), ' ');
  std::string bytes;
  append_head(bytes, std::uint64_t{kGlbHeader} + 2 * kChunkHead + json.size() + binary_bytes, json.size());
  bytes += json;
  append_binary(bytes, static_cast<std::uint32_t>(binary_bytes));
  append_binary(bytes, kBinChunk);
  return bytes;
}

}  // namespace vdb_offset::io::gltf
