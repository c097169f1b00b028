// SPDX-License-Identifier: Apache-2.0
// VTK writes texts of legacy files with fewer digits than numbers have, so that these are rewritten where they stand.
#include <fmt/format.h>
#include <vtkDataArray.h>
#include <vtkPoints.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "bytes/append_number.h"
#include "vdb_offset/numbers.h"
#include "vtk/module/vtk_document.h"

namespace vdb_offset::io {
namespace {

/// Numbers of a file, before and after.
struct ChangedArray {
  std::string_view keyword;  ///< With which their line begins.
  vtkDataArray *before, *after;

  bool single() const { return before->GetDataType() == VTK_FLOAT; }
  std::size_t count() const { return static_cast<std::size_t>(before->GetNumberOfValues()); }
  double old_number(std::size_t i) const { return number(*before, i); }
  double new_number(std::size_t i) const { return number(*after, i); }

 private:
  static double number(vtkDataArray& array, std::size_t i) {
    return array.GetComponent(static_cast<vtkIdType>(i / 3), static_cast<int>(i % 3));
  }
};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// Appends the numbers' words from `at` on, new ones where a number changes, and moves `at` behind them. False, with
/// nothing of use appended, if these are not the old numbers.
bool append_words(std::string_view text, const ChangedArray& array, std::size_t& at, std::string& result) {
  const Rounding precision{array.single() ? Rounding::Kind::Single : Rounding::Kind::Double};
  for (std::size_t i = 0; i < array.count(); ++i) {
    const std::size_t begin = at;
    while (at < text.size() && is_blank(text[at])) ++at;
    result.append(text, begin, at - begin);
    const std::size_t first = at;
    while (at < text.size() && !is_blank(text[at])) ++at;
    const std::string_view word = text.substr(first, at - first);
    const double wanted = array.old_number(i);
    if (array.single() ? decimal<float>(word) != static_cast<float>(wanted) : decimal<double>(word) != wanted)
      return false;
    if (array.new_number(i) == wanted) result += word;
    else append_number(result, array.new_number(i), precision);
  }
  return true;
}

template <class Number>
std::string big_endian(double value) {
  std::string bytes;
  append_binary(bytes, static_cast<Number>(value));
  std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

/// As append_words(), for numbers of 4 or 8 bytes.
bool append_numbers(std::string_view text, const ChangedArray& array, std::size_t& at, std::string& result) {
  const std::size_t width = array.single() ? sizeof(float) : sizeof(double);
  if (text.size() - at < array.count() * width) return false;
  const auto stored = [&](double value) {
    return array.single() ? big_endian<float>(value) : big_endian<double>(value);
  };
  for (std::size_t i = 0; i < array.count(); ++i, at += width) {
    if (text.substr(at, width) != stored(array.old_number(i))) return false;
    if (array.new_number(i) == array.old_number(i)) result.append(text, at, width);
    else result += stored(array.new_number(i));
  }
  return true;
}

/// Puts the new numbers behind the line of their keyword at which the old ones stand.
std::optional<std::string> with_array(std::string_view text, bool ascii, const ChangedArray& array) {
  const std::string start = fmt::format("\n{} ", array.keyword);
  for (std::size_t line = text.find(start); line != std::string_view::npos; line = text.find(start, line + 1)) {
    std::size_t at = text.find('\n', line + 1);
    if (at == std::string_view::npos) break;
    std::string result(text.substr(0, ++at));
    result.reserve(text.size() + text.size() / 8);
    if (ascii ? append_words(text, array, at, result) : append_numbers(text, array, at, result))
      return result.append(text, at, text.size() - at);
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> rewrite_legacy(const MeshFile& source, bool ascii, vtkPointSet& before, vtkPointSet& after,
                                          vtkDataArray* old_normals, vtkDataArray* new_normals) {
  auto bytes =
      with_array(source.text(), ascii, {"POINTS", before.GetPoints()->GetData(), after.GetPoints()->GetData()});
  if (!bytes || !new_normals) return bytes;
  // Normals stand behind a line of their own, or are a field of some name.
  const char* const name = old_normals->GetName();
  for (const std::string& keyword : {std::string("NORMALS"), (name ? name : "Normals") + std::string(" 3")})
    if (auto with_normals = with_array(*bytes, ascii, {keyword, old_normals, new_normals})) return with_normals;
  return std::nullopt;
}

}  // namespace vdb_offset::io
