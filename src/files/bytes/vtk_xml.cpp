// SPDX-License-Identifier: Apache-2.0
// Writes files of VTK's XML without VTK: a text that describes the data set, and behind it the arrays, appended raw.
// The text is put together by the caller; for each array it has a place where the array's offset is filled in. Without
// compression all offsets are known before, and the file is made of pieces. With it, each array is compressed in blocks
// of a fixed size, several at a time, and offsets and the blocks' sizes are written by going back once they are known.
// Blocks are cut by size alone, so that the bytes do not depend on the number of threads. Numbers are little-endian,
// with counts of 64 bits. Whether the text fits the arrays is up to the caller.
#include "bytes/vtk_xml.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <functional>
#include <memory>
#include <string_view>
#include <utility>

#include "bytes/compression.h"
#include "ground/system/call_progress.h"
#include "ground/system/parallel.h"
#include "vdb_offset/output_files.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are appended as this machine holds them");

// Bytes of a block that is compressed by itself, and how many of these are made at a time. Not measured beside other
// sizes.
constexpr std::size_t kPackedBlock = std::size_t{1} << 20, kBlocksAtATime = 32;
// Digits that an offset may have in the text of a file whose arrays are not known in length yet.
constexpr std::size_t kOffsetDigits = 20;

template <class Number>
VtkArray as_array(std::string name, const char* type, int components, std::span<const Number> numbers) {
  const auto count = static_cast<std::size_t>(components);
  return {std::move(name),
          type,
          components,
          count * sizeof(Number),
          {numbers.size() / count, [numbers, count](std::string& bytes, std::size_t i) {
             bytes.append(reinterpret_cast<const char*>(numbers.data() + count * i), count * sizeof(Number));
           }}};
}

std::string made(const Section& section, std::size_t begin, std::size_t end) {
  std::string bytes;
  for (std::size_t i = begin; i < end; ++i) section.append(bytes, i);
  return bytes;
}

/// A file that goes back to fill in what was not known yet.
class PatchedFile {
 public:
  PatchedFile(const std::string& temporary, const std::string& path)
      : path_(path), file_(std::fopen(temporary.c_str(), "wb"), &std::fclose) {
    if (!file_) fail();
  }

  void append(std::string_view bytes) {
    put(bytes);
    size_ += bytes.size();
  }
  void patch(std::uint64_t at, std::string_view bytes) {
    seek(at);
    put(bytes);
    seek(size_);
  }
  std::uint64_t size() const { return size_; }
  void close() {
    if (std::fclose(file_.release()) != 0) fail();
  }

 private:
  [[noreturn]] void fail() const { throw WriteError(path_ + ": cannot be written: " + std::strerror(errno)); }
  void put(std::string_view bytes) {
    if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) fail();
  }
  void seek(std::uint64_t at) {
    if (::fseeko(file_.get(), static_cast<off_t>(at), SEEK_SET) != 0) fail();
  }

  const std::string& path_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  std::uint64_t size_ = 0;
};

/// Appends an array in blocks: their number, the bytes of a whole one and of what the last one has if it is not, and
/// what each takes compressed; then these. `report` is called with the share that is done.
void append_packed(PatchedFile& file, const VtkArray& array, const std::function<void(double)>& report) {
  const std::size_t items = array.section.items, per_block = std::max(std::size_t{1}, kPackedBlock / array.item_bytes),
                    blocks = (items + per_block - 1) / per_block;
  std::vector<std::uint64_t> header(3 + blocks, 0);
  header[0] = blocks;
  header[1] = per_block * array.item_bytes;
  header[2] = items % per_block * array.item_bytes;
  const auto in_bytes = [&] {
    return std::string_view(reinterpret_cast<const char*>(header.data()), header.size() * sizeof(std::uint64_t));
  };
  const std::uint64_t begin = file.size();
  file.append(in_bytes());
  for (std::size_t first = 0; first < blocks; first += kBlocksAtATime) {
    std::vector<std::string> packed(std::min(kBlocksAtATime, blocks - first));
    for_each_index(
        packed.size(),
        [&](std::size_t b) {
          const std::size_t from = (first + b) * per_block;
          packed[b] = compress_block(made(array.section, from, std::min(items, from + per_block)));
        },
        1);
    for (std::size_t b = 0; b < packed.size(); ++b) {
      header[3 + first + b] = packed[b].size();
      file.append(packed[b]);
    }
    report(static_cast<double>(first + packed.size()) / static_cast<double>(blocks));
  }
  file.patch(begin, in_bytes());
}

}  // namespace

VtkArray array_of(std::string name, int components, std::span<const float> numbers) {
  return as_array(std::move(name), "Float32", components, numbers);
}
VtkArray array_of(std::string name, int components, std::span<const double> numbers) {
  return as_array(std::move(name), "Float64", components, numbers);
}
VtkArray array_of(std::string name, int components, std::span<const std::uint8_t> numbers) {
  return as_array(std::move(name), "UInt8", components, numbers);
}
VtkArray array_of(std::string name, int components, std::span<const std::uint32_t> numbers) {
  return as_array(std::move(name), "UInt32", components, numbers);
}

VtkXml::VtkXml(std::string dataset, const std::string& attributes)
    : dataset_(std::move(dataset)), text_(fmt::format("<{}{}>\n", dataset_, attributes)) {}

void VtkXml::add(VtkArray array) {
  text_ += fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"",
                       array.type, array.name, array.components);
  offset_at_.push_back(text_.size());
  text_ += "\"/>\n";
  arrays_.push_back(std::move(array));
}

void VtkXml::add_words(const std::string& name, std::span<const std::string> words) {
  text_ +=
      fmt::format("<Array type=\"String\" Name=\"{}\" NumberOfTuples=\"{}\" format=\"ascii\">\n", name, words.size());
  for (const std::string& word : words) {
    for (const char c : word) text_ += fmt::format("{} ", static_cast<unsigned>(static_cast<unsigned char>(c)));
    text_ += "0\n";
  }
  text_ += "</Array>\n";
}

namespace {

std::string head(const std::string& dataset, const char* attributes) {
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\"{}>\n",
      dataset, attributes);
}

constexpr std::string_view kAppended = "<AppendedData encoding=\"raw\">\n_", kEnd = "\n</AppendedData>\n</VTKFile>\n";

}  // namespace

Pieces VtkXml::raw() && {
  std::string text = head(dataset_, "");
  std::vector<Section> sections;
  std::uint64_t offset = 0;
  std::size_t copied = 0;
  for (std::size_t a = 0; a < arrays_.size(); ++a) {
    text.append(text_, copied, offset_at_[a] - copied);
    text += fmt::format("{}", offset);
    copied = offset_at_[a];
    const std::uint64_t size = arrays_[a].section.items * arrays_[a].item_bytes;
    offset += sizeof size + size;
    sections.push_back({1, [size](std::string& bytes, std::size_t) {
                          bytes.append(reinterpret_cast<const char*>(&size), sizeof size);
                        }});
    sections.push_back(std::move(arrays_[a].section));
  }
  text.append(text_, copied);
  text += fmt::format("</{}>\n{}", dataset_, kAppended);
  sections.push_back({1, [](std::string& bytes, std::size_t) { bytes += kEnd; }});
  return in_sections(text, std::move(sections));
}

void VtkXml::write_packed(const std::string& temporary, const std::string& path) && {
  PatchedFile file(temporary, path);
  file.append(head(dataset_, " compressor=\"vtkZLibDataCompressor\""));
  std::vector<std::uint64_t> offset_at;
  std::size_t copied = 0;
  for (const std::size_t at : offset_at_) {
    file.append(std::string_view(text_).substr(copied, at - copied));
    offset_at.push_back(file.size());
    file.append(std::string(kOffsetDigits, ' '));
    copied = at;
  }
  file.append(std::string_view(text_).substr(copied));
  file.append(fmt::format("</{}>\n{}", dataset_, kAppended));
  const std::uint64_t begin = file.size();
  const ProgressCallback progress = OutputFiles::progress_of_next();
  const auto bytes_of = [](const VtkArray& array) {
    return static_cast<double>(array.section.items * array.item_bytes);
  };
  double all = 1, done = 0;
  for (const VtkArray& array : arrays_) all += bytes_of(array);
  for (std::size_t a = 0; a < arrays_.size(); ++a) {
    file.patch(offset_at[a], fmt::format("{}", file.size() - begin));
    append_packed(file, arrays_[a], [&](double share) {
      report_share(progress, Stage::Write, (done + share * bytes_of(arrays_[a])) / all);
    });
    done += bytes_of(arrays_[a]);
  }
  file.append(kEnd);
  file.close();
}

}  // namespace vdb_offset::io
