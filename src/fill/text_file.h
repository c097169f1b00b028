// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/fill.h"

namespace vdb_offset {

/// A text that a filler is to read. \throw FillFailed where it cannot be written
class TextFile {
 public:
  explicit TextFile(std::string path) : path_(std::move(path)), file_(std::fopen(path_.c_str(), "w")) {
    if (!file_) throw FillFailed("no file " + path_);
  }

  template <class... Values>
  void print(fmt::format_string<Values...> format, Values&&... values) {
    fmt::print(file_.get(), format, std::forward<Values>(values)...);
  }
  /// A line for each point, which begins with its number.
  void print_points(const std::vector<Vec3d>& points, std::size_t first_number) {
    for (const Vec3d& x : points) print("{} {} {} {}\n", first_number++, x[0], x[1], x[2]);
  }
  void finish() {
    if (std::fflush(file_.get()) != 0) throw FillFailed("no room for " + path_);
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace vdb_offset
