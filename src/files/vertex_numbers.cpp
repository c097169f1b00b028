// SPDX-License-Identifier: Apache-2.0
// Reads one number for each vertex of a mesh: from a text, from an array that NumPy saved, or from a property of the
// mesh file itself. The first bytes decide between text and array. A text is read word by word. The header of an array
// is read here: its version, its length, and a dictionary that has each of its three keys once, in any order; the
// numbers behind it, floating or whole and in either byte order, are read in parallel. There have to be as many numbers
// as vertices, all of them finite, or the file is refused by the line or the byte of what is wrong. Memory stays within
// a small multiple of the count, whatever a header promises. What the numbers mean is up to the caller.
#include "vdb_offset/io/mesh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <charconv>
#include <cmath>

#include "bytes/compression.h"
#include "bytes/line_records.h"
#include "bytes/nearest_names.h"
#include "bytes/scanner.h"
#include "document/binary_number.h"
#include "document/document.h"
#include "ground/system/parallel.h"
#include "vdb_offset/run.h"

namespace vdb_offset::io {
namespace {

constexpr std::string_view kNpyMagic("\x93NUMPY", 6);

void require_count(const std::string& path, std::size_t count, std::uint64_t found) {
  if (found != count)
    throw InvalidInput(fmt::format("{}: expected {} numbers, one for each vertex, found {}", path, count, found));
}

std::string number_of_vertex(std::string_view what, std::size_t v) {
  return fmt::format("{} for vertex {} (counted from 0)", what, v);
}

std::vector<double> parse_text(const std::string& path, std::string_view text, std::size_t count) {
  std::vector<double> numbers;
  numbers.reserve(std::min(count, text.size() / 2 + 1));  // a number takes two bytes at least: a digit and a blank
  Scanner scanner(path, text, byte_order_mark(text), false, '#');
  std::size_t found = 0;
  for (; !scanner.at_text_end(); ++found) {
    const std::string_view word = scanner.token();
    double number = 0;
    if (word.size() > kLongestNumber)
      scanner.fail(number_of_vertex(fmt::format("a number of at most {} characters", kLongestNumber), found),
                   scanner.last_token());
    if (!parse_double(word, number)) scanner.fail(number_of_vertex("a number", found), scanner.last_token());
    if (!std::isfinite(number)) scanner.fail(number_of_vertex("a finite number", found), scanner.last_token());
    if (found < count) numbers.push_back(number);
  }
  require_count(path, count, found);
  return numbers;
}

/// The header of a NumPy array (numpy.lib.format).
struct NpyHeader {
  NumberType type{'f', 8};
  Encoding encoding = Encoding::LittleEndian;
  std::uint64_t count = 0;
  std::size_t end = 0;  // first byte of the numbers
};

/// Reads the header: magic bytes, a version, a length, and a dictionary as Python writes it.
class NpyHeaderReader {
 public:
  NpyHeaderReader(const std::string& path, std::string_view bytes) : path_(path), text_(bytes) {}

  NpyHeader read() {
    read_length();
    take('{');
    bool has_type = false, has_order = false, has_shape = false;
    while (!skip('}')) {
      const std::size_t at = at_;
      const std::string_view key = quoted("a key");
      take(':');
      bool& has = key == "descr" ? has_type : key == "fortran_order" ? has_order : has_shape;
      if (has || (key != "descr" && key != "fortran_order" && key != "shape"))
        fail("each of the keys 'descr', 'fortran_order' and 'shape' once", at);
      has = true;
      if (key == "descr") read_type();
      else if (key == "shape") read_shape();
      else read_order();
      if (!skip(',') && !next_is('}')) fail("',' or '}'", at_);
    }
    if (!has_type || !has_order || !has_shape)
      fail("the keys 'descr', 'fortran_order' and 'shape' before this", at_ - 1);
    return header_;
  }

 private:
  void read_length() {
    constexpr std::size_t kVersionAt = 6, kLengthAt = 8;
    if (text_.size() < kLengthAt) fail("the version of a NumPy array", text_.size());
    const auto version = static_cast<unsigned char>(text_[kVersionAt]);
    if (version < 1 || version > 3)
      fail_with("version 1, 2 or 3 of NumPy's format", fmt::format("version {}", version), kVersionAt);
    const std::size_t bytes = version == 1 ? 2 : 4;
    at_ = kLengthAt + bytes;
    if (text_.size() < at_) fail("the length of the header", text_.size());
    const double length =
        binary_number(text_.data() + kLengthAt, {'u', static_cast<std::uint8_t>(bytes)}, Encoding::LittleEndian);
    header_.end = at_ + static_cast<std::size_t>(length);
    if (header_.end > text_.size()) fail_with(fmt::format("a header of {} bytes", length), "the end of the file", at_);
    text_ = text_.substr(0, header_.end);
  }

  void read_type() {
    const std::size_t at = at_;
    constexpr const char* kExpected = "numbers of the types f4, f8, i1 to i8 or u1 to u8";
    if (next_is('[')) fail(kExpected, at);  // the array is one of rows with several columns
    const std::string_view type = quoted(kExpected);
    if (type.size() != 3) fail_with(kExpected, shown(at, at_), at);
    const char order = type[0], kind = type[1], bytes = type[2];
    const bool is_known = kind == 'f'                  ? bytes == '4' || bytes == '8'
                          : kind == 'i' || kind == 'u' ? bytes == '1' || bytes == '2' || bytes == '4' || bytes == '8'
                                                       : false;
    if (!is_known || (order != '<' && order != '>' && !(order == '|' && bytes == '1')))
      fail_with(kExpected, shown(at, at_), at);
    header_.type = {kind, static_cast<std::uint8_t>(bytes - '0')};
    header_.encoding = order == '>' ? Encoding::BigEndian : Encoding::LittleEndian;
  }

  /// Reads the order of the axes, which does not matter: only one axis may be longer than 1.
  void read_order() {
    skip_space();
    for (const std::string_view word : {"True", "False"})
      if (text_.substr(at_).starts_with(word)) {
        at_ += word.size();
        return;
      }
    fail("True or False", at_);
  }

  void read_shape() {
    skip_space();
    const std::size_t at = at_;
    std::vector<std::uint64_t> shape;
    take('(');
    while (!skip(')')) {
      const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), shape.emplace_back());
      if (error != std::errc()) fail("a number of rows", at_);
      at_ = static_cast<std::size_t>(end - text_.data());
      if (at_ < text_.size() && text_[at_] == 'L') ++at_;  // Python 2 ends integers with an L
      if (!skip(',') && !next_is(')')) fail("',' or ')'", at_);
    }
    if (shape.empty() || shape.size() > 2 || (shape.size() == 2 && shape[1] != 1))
      fail_with("an array of shape (n,) or (n, 1)", shown(at, at_), at);
    header_.count = shape[0];
  }

  void skip_space() {
    while (at_ < text_.size() && (is_blank(text_[at_]) || text_[at_] == '\n')) ++at_;
  }
  bool next_is(char c) {
    skip_space();
    return at_ < text_.size() && text_[at_] == c;
  }
  bool skip(char c) {
    if (!next_is(c)) return false;
    ++at_;
    skip_space();
    return true;
  }
  void take(char c) {
    if (!skip(c)) fail(fmt::format("'{}'", c), at_);
  }
  std::string_view quoted(const char* expected) {
    if (!next_is('\'') && !next_is('"')) fail(fmt::format("{} in quotation marks", expected), at_);
    const std::size_t begin = at_ + 1, end = text_.find(text_[at_], begin);
    if (end == std::string_view::npos) fail("the end of the quotation", text_.size());
    at_ = end + 1;
    return text_.substr(begin, end - begin);
  }

  /// A part of the text as a message can show it: cut off, without control characters.
  std::string shown(std::size_t begin, std::size_t end) const {
    constexpr std::size_t kShown = 24;  // bytes; a longer word is hard to read in a message
    std::string line(text_.substr(begin, std::min(end - begin, kShown)));
    std::replace_if(
        line.begin(), line.end(), [](unsigned char c) { return !std::isprint(c); }, '?');
    while (line.ends_with(' ')) line.pop_back();
    return end - begin > kShown ? line + "..." : line;
  }
  [[noreturn]] void fail(const std::string& expected, std::size_t at) const {
    fail_with(expected, at < text_.size() ? shown(at, text_.size()) : "the end", at);
  }
  [[noreturn]] void fail_with(const std::string& expected, const std::string& found, std::size_t at) const {
    throw InvalidInput(fmt::format("{}, byte {}: expected {}, got {}", path_, at, expected, found));
  }

  const std::string& path_;
  std::string_view text_;
  std::size_t at_ = 0;
  NpyHeader header_;
};

std::vector<double> parse_npy(const std::string& path, std::string_view bytes, std::size_t count) {
  const NpyHeader header = NpyHeaderReader(path, bytes).read();
  require_count(path, count, header.count);
  const std::size_t size = header.type.bytes, rest = bytes.size() - header.end;
  if (rest / size != count || rest % size != 0)
    throw InvalidInput(
        fmt::format("{}, byte {}: expected {} numbers of {} bytes, got {} bytes", path, header.end, count, size, rest));
  std::vector<double> numbers(count);
  std::atomic<std::uint64_t> first_unusable = count;
  const auto offset_of = [&](std::size_t v) { return header.end + v * size; };
  for_each_index(count, [&](std::size_t v) {
    numbers[v] = binary_number(bytes.data() + offset_of(v), header.type, header.encoding);
    if (!std::isfinite(numbers[v])) lower_to(first_unusable, v);
  });
  if (const std::size_t v = first_unusable; v < count)
    throw InvalidInput(fmt::format("{}, byte {}: expected {}, got {}", path, offset_of(v),
                                   number_of_vertex("a finite number", v), numbers[v]));
  return numbers;
}

}  // namespace

std::vector<double> parse_vertex_numbers(const std::string& name, std::string_view bytes, std::size_t count) {
  if (bytes.starts_with(kNpyMagic)) return parse_npy(name, bytes, count);
  if (without_compression(name).ends_with(".npy"))
    throw InvalidInput(name + ", byte 0: expected a NumPy array, which starts with \\x93NUMPY, got something else");
  return parse_text(name, bytes, count);
}

std::vector<double> read_vertex_numbers(const std::string& path, std::size_t count) {
  const FileBytes bytes = FileBytes::open(path);
  std::vector<double> numbers = parse_vertex_numbers(path, bytes.view(), count);
  bytes.require_unchanged(path);
  return numbers;
}

std::vector<double> vertex_property(const MeshFile& source, const std::string& name) {
  return source.document->vertex_numbers(source, name);
}

}  // namespace vdb_offset::io
