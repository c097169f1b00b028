// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "gltf/gltf_document.h"
#include "gltf/json.h"
#include "gltf/rewriting.h"
#include "gltf/uri.h"

namespace vdb_offset::io::gltf {
namespace {

// Bytes that are written at a time. Not measured beside other sizes.
constexpr std::size_t kSlice = std::size_t{1} << 22;

/// Where the URI of each buffer stands in the JSON text, quotes included.
std::pair<std::size_t, std::size_t> uri_at(std::string_view json, std::size_t buffer) {
  const JsonText text(json);
  const std::size_t list = text.member(text.root(), "buffers").value();
  const std::size_t uri = text.member(text.elements(list)[buffer], "uri").value();
  return {uri, text.end_of(uri)};
}

class Rewriter {
 public:
  Rewriter(const Contents& contents, const MovedMesh& moved)
      : contents_(contents),
        moved_(moved),
        bytes_(moved.source.text()),
        json_(contents.container.json_of(bytes_)),
        patched_(contents, moved),
        beside_(contents, moved.source.path, moved.path) {}

  WrittenDocument run() {
    patched_.add_bounds(json_, replacements_);
    for (const auto& [index, bytes] : patched_.by_index()) put_buffer(index, bytes);
    if (!beside_.in_same_folder()) add_copies();
    std::stable_sort(replacements_.begin(), replacements_.end(),
                     [](const Replacement& a, const Replacement& b) { return a.begin < b.begin; });
    written_.file = contents_.container.is_binary ? as_glb() : as_text();
    return std::move(written_);
  }

 private:
  void put_buffer(std::size_t index, const std::shared_ptr<std::string>& bytes) {
    const Buffer& buffer = contents_.buffers[index];
    if (buffer.in == Buffer::In::Chunk) {
      chunk_ = bytes;
      return;
    }
    const auto [begin, end] = uri_at(json_, index);
    if (buffer.in == Buffer::In::Text) {
      // The bytes behind the buffer's own stay. The head has no character that JSON escapes, as it was read from it.
      const DataUri data =
          parse_data_uri(nlohmann::json::parse(json_.substr(begin, end - begin)).get<std::string>()).value();
      const std::string whole = *bytes + data.bytes.substr(bytes->size());
      replacements_.push_back({begin, end, nlohmann::json(data.head + base64(whole, data.padded)).dump()});
      return;
    }
    buffer.file.require_unchanged(buffer.path);
    const std::string uri = beside_.add_changed(buffer, *bytes, written_);
    if (uri != buffer.uri) replacements_.push_back({begin, end, nlohmann::json(uri).dump()});
  }

  /// Files that stay are needed where the file is read from.
  void add_copies() {
    for (std::size_t i = 0; i < contents_.buffers.size(); ++i)
      if (contents_.buffers[i].in == Buffer::In::File && !patched_.by_index().contains(i))
        beside_.add_copy(contents_.buffers[i].uri, written_);
    for (const std::string& uri : contents_.image_uris)
      if (!is_data_uri(uri)) beside_.add_copy(uri, written_);
  }

  Pieces as_text() {
    if (replacements_.empty()) return in_slices(bytes_);
    return in_slices(std::string(bytes_.substr(0, contents_.container.json.begin)) + replaced(json_, replacements_));
  }

  Pieces as_glb() {
    const Container& container = contents_.container;
    std::string head = glb_head(moved_.source.path, container, bytes_, replaced(json_, replacements_));
    std::size_t from = container.json_chunk.begin + container.json_chunk.size;
    std::vector<Pieces> parts{in_slices(std::move(head))};
    if (chunk_) {
      parts.push_back(in_slices(bytes_.substr(from, container.bin->begin - from)));
      parts.push_back(in_slices(*chunk_, chunk_));
      from = container.bin->begin + chunk_->size();
    }
    parts.push_back(in_slices(bytes_.substr(from)));
    return in_a_row(std::move(parts));
  }

  const Contents& contents_;
  const MovedMesh& moved_;
  std::string_view bytes_, json_;
  PatchedBuffers patched_;
  FilesBeside beside_;
  std::vector<Replacement> replacements_;
  std::shared_ptr<const std::string> chunk_;
  WrittenDocument written_;
};

}  // namespace

Pieces in_slices(std::string_view bytes, std::shared_ptr<const std::string> owner) {
  return {(bytes.size() + kSlice - 1) / kSlice,
          [bytes, kept = std::move(owner)](std::size_t i) { return std::string(bytes.substr(i * kSlice, kSlice)); }};
}

Pieces in_slices(std::string text) {
  auto owner = std::make_shared<const std::string>(std::move(text));
  const std::string_view bytes = *owner;
  return in_slices(bytes, std::move(owner));
}

WrittenDocument GltfDocument::rewrite(const MovedMesh& moved) const { return Rewriter(contents_, moved).run(); }

}  // namespace vdb_offset::io::gltf
