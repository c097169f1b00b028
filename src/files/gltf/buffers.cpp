// SPDX-License-Identifier: Apache-2.0
#include "gltf/buffers.h"

#include <fmt/format.h>

#include <filesystem>
#include <limits>
#include <optional>
#include <utility>

#include "gltf/uri.h"

namespace vdb_offset::io::gltf {
namespace {

namespace fs = std::filesystem;

/// Opens a file that a URI names. Anything but a regular file, such as a device, might never end.
void open_beside(const MeshFile& file, const JsonValue& uri, Buffer& buffer) {
  const std::optional<std::string> path = relative_path(uri.text());
  if (!path) uri.fail("a path relative to the file, or base64 in a data: URI");
  if (file.path == "-") uri.fail("a file with its data in itself, as it comes from standard input");
  buffer.in = Buffer::In::File;
  buffer.uri = uri.text();
  buffer.path = (fs::path(file.path).parent_path() / *path).string();
  std::error_code error;
  if (!fs::is_regular_file(buffer.path, error))
    uri.fail(fmt::format("a file at {}", buffer.path),
             error || !fs::exists(buffer.path, error) ? "none" : "another thing");
  buffer.file = FileBytes::open(buffer.path);
  buffer.bytes = buffer.file.view();
}

void decode(const JsonValue& uri, Buffer& buffer) {
  std::optional<DataUri> data = parse_data_uri(uri.text());
  if (!data) uri.fail("data in base64");
  buffer.in = Buffer::In::Text;
  buffer.text = std::make_shared<const std::string>(std::move(data->bytes));
  buffer.bytes = *buffer.text;
}

Buffer read_buffer(const MeshFile& file, const Container& container, const JsonValue& value, bool is_first) {
  Buffer buffer;
  const std::optional<JsonValue> uri = value.find("uri");
  if (uri && is_data_uri(uri->text())) {
    decode(*uri, buffer);
  } else if (uri) {
    open_beside(file, *uri, buffer);
  } else if (is_first && container.bin) {
    buffer.in = Buffer::In::Chunk;
    buffer.bytes = file.text().substr(container.bin->begin, container.bin->size);
  }
  const JsonValue length = value.at("byteLength");
  const std::uint64_t size = length.whole(std::numeric_limits<std::int64_t>::max());
  // What an extension fills in may be nowhere; if it is asked for, a view finds no bytes.
  if (buffer.in == Buffer::In::Nowhere) return buffer;
  if (size > buffer.bytes.size())
    length.fail(fmt::format("at most {}, as many bytes as there are", buffer.bytes.size()));
  buffer.bytes = buffer.bytes.substr(0, size);
  return buffer;
}

}  // namespace

std::vector<Buffer> read_buffers(const MeshFile& file, const Container& container, const JsonValue& root) {
  std::vector<Buffer> buffers;
  const JsonList list(root, "buffers");
  for (std::size_t i = 0; i < list.size(); ++i) buffers.push_back(read_buffer(file, container, list[i], i == 0));
  return buffers;
}

}  // namespace vdb_offset::io::gltf
