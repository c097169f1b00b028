// SPDX-License-Identifier: Apache-2.0
#include "messages.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <new>

#include "vdb_offset/run.h"

namespace vdb_offset::tool {
namespace {

// Most bytes of a message, which is to be read and not searched, and of a word in it, by which a name is recognised.
constexpr std::size_t kLongestMessage = 500, kLongestWord = 160;

// The error number of the last failure to print on standard output; 0 if there was none.
int print_error = 0;

bool is_tail(char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; }

/// The number of bytes of the UTF-8 character that a text begins with; 0 if these bytes are none, or a control
/// character.
std::size_t character_at(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  if (first < 0x80) return first >= 0x20 && first != 0x7f ? 1 : 0;
  const std::size_t length = first >= 0xf0 && first < 0xf5 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first >= 0xf5 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if (!is_tail(text[i])) return 0;
  const bool is_control = first == 0xc2 && static_cast<unsigned char>(text[1]) < 0xa0;
  return is_control ? 0 : length;
}

void write_to_error(std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t count = ::write(STDERR_FILENO, text.data(), text.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(count));
  }
}

}  // namespace

std::string as_text(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t length = character_at(text);
    if (length > 0) shown += text.substr(0, length);
    else shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[0]));
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return shown;
}

std::string shortened(std::string_view text, std::size_t most) {
  constexpr std::string_view kGap = "...";
  if (text.size() <= most) return std::string(text);
  std::size_t head = (most - kGap.size() + 1) / 2, tail = text.size() - (most - kGap.size()) / 2;
  while (head > 0 && is_tail(text[head])) --head;
  while (tail < text.size() && is_tail(text[tail])) ++tail;
  return std::string(text.substr(0, head)).append(kGap).append(text.substr(tail));
}

std::string shell_word(std::string_view word) {
  const auto is_plain = [](unsigned char c) {
    return std::isalnum(c) || c > 127 || std::string_view("._-+=/,:@%").find(static_cast<char>(c)) != std::string::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return std::string(word);
  std::string quoted = "'";
  for (const char c : word) {
    if (c == '\'') quoted += "'\\''";
    else quoted += c;
  }
  return quoted + "'";
}

std::string readable(std::string_view message) {
  constexpr std::size_t kMostLookedAt = 1 << 16;  // bytes; a message is cut to this length before it is searched
  const std::string whole = shortened(message, kMostLookedAt);
  std::string line;
  for (std::size_t begin = 0; begin < whole.size();) {
    const std::size_t end = std::min(whole.find(' ', begin), whole.size());
    const std::string word = as_text(std::string_view(whole).substr(begin, end - begin));
    line += shortened(word, kLongestWord);
    if (end < whole.size()) line += ' ';
    begin = end + 1;
  }
  return shortened(line, kLongestMessage);
}

void report_problem(std::string_view message) noexcept {
  try {
    write_to_error("vdb_offset: " + readable(message) + "\n");
  } catch (const std::bad_alloc&) {
    write_to_error("vdb_offset: out of memory\n");
  }
}

Printout::Printout(bool output_is_taken) : on_error_(output_is_taken), lines_(::open_memstream(&text_, &size_)) {
  if (!lines_) throw std::bad_alloc();
}

Printout::~Printout() {
  std::fclose(lines_);
  if (on_error_) write_to_error({text_, size_});
  else if (std::fwrite(text_, 1, size_, stdout) != size_ || std::fflush(stdout) != 0) print_error = errno;
  std::free(text_);
}

void require_printed() {
  if (print_error != 0)
    throw WriteError(std::string("standard output: cannot be written: ") + std::strerror(print_error));
}

}  // namespace vdb_offset::tool
