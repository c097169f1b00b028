// SPDX-License-Identifier: Apache-2.0
// TetGen is a program of its own, which this one starts: it gets the domain as a text and leaves its points and cells
// as texts, all in one folder. Where it is not told of a point in each hole it fills these as well.
#include "tetgen.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <numbers>

#include "cells_inside.h"
#include "child_program.h"
#include "text_file.h"

namespace vdb_offset {
namespace {

void write_domain(const FillDomain& domain, const std::string& path) {
  TextFile file(path);
  file.print("{} 3 0 0\n", domain.points.size());
  file.print_points(domain.points, 0);
  file.print("{} 0\n", domain.triangles.size());
  for (const auto& [a, b, c] : domain.triangles) file.print("1\n3 {} {} {}\n", a, b, c);
  file.print("{}\n", domain.outside.size());
  file.print_points(domain.outside, 0);
  file.print("0\n");
  file.finish();
}

/// The numbers of the lines of a file, `width` a line behind the first of each; the first line starts with their count.
template <class Number, std::size_t kWidth>
std::vector<std::array<Number, kWidth>> read_lines(const std::string& path) {
  std::ifstream file(path);
  std::size_t count = 0;
  std::string rest;
  if (!(file >> count) || !std::getline(file, rest)) throw FillFailed("no file " + path.substr(path.rfind('/') + 1));
  std::vector<std::array<Number, kWidth>> lines;
  for (std::size_t i = 0, number; i < count; ++i) {
    file >> number;
    for (Number& value : lines.emplace_back()) file >> value;
    if (!file || !std::getline(file, rest)) throw FillFailed("a file that is cut off");
  }
  return lines;
}

}  // namespace

FilledDomain fill_by_tetgen(const FillDomain& domain, const std::string& folder, std::uint64_t most_memory) {
  // Y keeps the border. Radii of at most 1.4 edges and angles of at least 10 degrees: 1.2 and 14 take twice as many
  // cells. T: the default, 1e-8 of the whole domain, joins points of fine walls that have a farfield.
  const double largest = domain.longest * domain.longest * domain.longest / (6 * std::numbers::sqrt2);
  const std::string options = fmt::format("-pYq1.4/10a{}T1e-14QC", largest), path = folder + "/domain";
  write_domain(domain, path + ".poly");
  run_program({"tetgen", options, path + ".poly"}, {}, most_memory);
  FilledDomain filled;
  const auto points = read_lines<double, 3>(path + ".1.node");
  if (points.size() < domain.points.size()) throw FillFailed("a mesh that does not keep the points of its border");
  for (std::size_t p = domain.points.size(); p < points.size(); ++p)
    filled.added.emplace_back(points[p][0], points[p][1], points[p][2]);
  for (const auto& cell : read_lines<std::uint32_t, 4>(path + ".1.ele")) {
    if (*std::max_element(cell.begin(), cell.end()) >= points.size()) throw FillFailed("cells of points that are none");
    filled.cells.push_back(cell);
  }
  keep_cells_inside(domain, filled);
  return filled;
}

}  // namespace vdb_offset
