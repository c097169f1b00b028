// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "bytes/line_records.h"
#include "bytes/obj_lines.h"

using namespace vdb_offset;

namespace {

using Words = std::vector<std::string>;

/// Keyword and words of every line, the keyword first; only that of blank lines.
std::vector<Words> lines_of(const std::string& text) {
  const std::string path = "in.obj";
  std::vector<Words> lines;
  io::for_each_obj_line(path, text, [&](const io::ObjLine& line) {
    Words& words = lines.emplace_back();
    words.emplace_back(line.keyword);
    if (line.keyword.empty()) return;
    io::Scanner scanner = line.words();
    while (!scanner.at_line_end()) words.emplace_back(scanner.token());
  });
  return lines;
}

/// Records of a number each, or of two words.
std::vector<double> numbers_of(const std::string& text, std::size_t begin, std::size_t count) {
  const io::LineRecords records(text, begin, count);
  std::vector<double> numbers(count, -1);
  if (!records.complete()) return {};
  if (!records.for_each([&](std::size_t i, io::FastCursor& cursor) { return cursor.number(numbers[i]); })) return {};
  return numbers;
}

}  // namespace

TEST_CASE("OBJ lines: a keyword and words, blanks and comments around them", "[text_lines]") {
  CHECK(lines_of("v 1 2 3\n  vn\t0 0 1 \n\n# v 9 9 9\nf 1 2 3 # the end\ng a b") ==
        std::vector<Words>{
            {"v", "1", "2", "3"}, {"vn", "0", "0", "1"}, {""}, {""}, {"f", "1", "2", "3"}, {"g", "a", "b"}});
  CHECK(lines_of("").empty());
  CHECK(lines_of("\xef\xbb\xbfv 1 2 3") == std::vector<Words>{{"v", "1", "2", "3"}});
  CHECK(lines_of("v#1 2 3\nv\r\n") == std::vector<Words>{{"v"}, {"v"}});
}

TEST_CASE("OBJ lines: a backslash joins a line to the next one", "[text_lines]") {
  CHECK(lines_of("f 1 2 \\\n3\nv 0 0 0\n") == std::vector<Words>{{"f", "1", "2", "3"}, {"v", "0", "0", "0"}});
  CHECK(lines_of("f 1\\\r\n2 3\r\nv 0 0 0") == std::vector<Words>{{"f", "1", "2", "3"}, {"v", "0", "0", "0"}});
  // In front of the keyword, behind it, and within what would be one.
  CHECK(lines_of("\\\nv 1 2 3\n") == std::vector<Words>{{"v", "1", "2", "3"}});
  CHECK(lines_of("v\\\n 1 2 3\n") == std::vector<Words>{{"v", "1", "2", "3"}});
  CHECK(lines_of("v\\\nn 1 2 3\n") == std::vector<Words>{{"v", "n", "1", "2", "3"}});
  // Not where it stands in a comment, or where no line ends.
  CHECK(lines_of("v 1 2 3 # \\\nf 1 2 3") == std::vector<Words>{{"v", "1", "2", "3"}, {"f", "1", "2", "3"}});
  CHECK(lines_of("g a\\b c\ng\\b c") == std::vector<Words>{{"g", "a\\b", "c"}, {"g\\b", "c"}});
  CHECK(lines_of("v 1 2 \\\n") == std::vector<Words>{{"v", "1", "2"}});
}

TEST_CASE("OBJ lines: together they are the text", "[text_lines]") {
  const std::string path = "in.obj", text = "v 1 2 \\\n3\n\n#x\\\nf 1\r\nlast";
  std::string whole;
  io::for_each_obj_line(path, text, [&](const io::ObjLine& line) {
    CHECK(line.begin() == whole.size());
    whole += line.whole;
  });
  CHECK(whole == text);
}

TEST_CASE("lines: runs begin and end with whole lines, and are the text", "[text_lines]") {
  std::string text = "head\n";
  while (text.size() < (3 << 19)) text += "f 1 2 3 \\\n 4 5 6\nv 0.25 0.5 0.75\n";
  const std::vector<std::size_t> cuts = io::cut_at_lines(text, 5);
  REQUIRE(cuts.size() > 2);
  CHECK(cuts.front() == 5);
  CHECK(cuts.back() == text.size());
  for (const std::size_t cut : cuts) {
    CHECK(text[cut - 1] == '\n');
    CHECK(text[cut - 2] != '\\');
  }
  CHECK(io::cut_at_lines("", 0) == std::vector<std::size_t>{0});
  CHECK(io::cut_at_lines("no line end", 0) == std::vector<std::size_t>{0, 11});
}

TEST_CASE("lines: records fill a line each", "[text_lines]") {
  CHECK(numbers_of("x\n1\n 2.5 \n-3e1\nrest", 2, 3) == std::vector<double>{1, 2.5, -30});
  CHECK(numbers_of("1\n2", 0, 2) == std::vector<double>{1, 2});
  CHECK(io::LineRecords("1\n2\nrest\n", 0, 2).end() == 4);
  // Too few of them, one without a number, one with two.
  CHECK(numbers_of("1\n2\n", 0, 3).empty());
  CHECK(numbers_of("1\n\n3\n", 0, 3).empty());
  CHECK(numbers_of("1\n2 2\n3\n", 0, 3).empty());
  CHECK(numbers_of("1\nnan\n3\n", 0, 3).empty());
}

TEST_CASE("lines: many records, in runs, each once", "[text_lines]") {
  std::string text;
  constexpr std::size_t kCount = 200000;
  for (std::size_t i = 0; i < kCount; ++i) text += std::to_string(i) + "\n";
  std::vector<double> expected(kCount);
  std::iota(expected.begin(), expected.end(), 0);
  CHECK(numbers_of(text + "1 2 3\n", 0, kCount) == expected);
}
