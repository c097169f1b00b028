// SPDX-License-Identifier: Apache-2.0
// TetGen is a program of its own, which this one starts: it gets the domain as a text and leaves its points and cells
// as texts, all in one folder. Where it is not told of a point in each hole it fills these as well, so that only the
// cells count which lie on the domain's side of its border.
#include "tetgen.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <memory>
#include <numbers>
#include <span>

#include "ground/mesh/exact_predicates.h"

namespace vdb_offset {
namespace {

constexpr int kNotFound = 127;

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

void write_domain(const FillDomain& domain, const std::string& path) {
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "w"));
  if (!file) throw FillFailed("no file " + path);
  fmt::print(file.get(), "{} 3 0 0\n", domain.points.size());
  for (std::size_t p = 0; p < domain.points.size(); ++p) {
    const Vec3d& x = domain.points[p];
    fmt::print(file.get(), "{} {} {} {}\n", p, x[0], x[1], x[2]);
  }
  fmt::print(file.get(), "{} 0\n", domain.triangles.size());
  for (const auto& [a, b, c] : domain.triangles) fmt::print(file.get(), "1\n3 {} {} {}\n", a, b, c);
  fmt::print(file.get(), "{}\n", domain.outside.size());
  for (std::size_t h = 0; h < domain.outside.size(); ++h) {
    const Vec3d& x = domain.outside[h];
    fmt::print(file.get(), "{} {} {} {}\n", h, x[0], x[1], x[2]);
  }
  fmt::print(file.get(), "0\n");
  if (std::fflush(file.get()) != 0) throw FillFailed("no room for " + path);
}

/// Runs a program, whose end is this one's if this one ends before. \return as of waitpid()
int run(const std::vector<std::string>& words, std::uint64_t most_memory) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t parent = ::getpid(), child = ::fork();
  if (child < 0) throw FillFailed("no more processes");
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(1);
    if (const rlimit most{most_memory, most_memory}; most_memory > 0) ::setrlimit(RLIMIT_AS, &most);
    const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(null, standard);
    ::execvp(arguments[0], arguments.data());
    ::_exit(kNotFound);
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw FillFailed("an end that is not known");
  return status;
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

/// Keeps the cells that can be reached from the inner sides of the domain's triangles without going through these.
class CellsInside {
 public:
  CellsInside(const FillDomain& domain, FilledDomain& filled) : domain_(domain), filled_(filled) {}

  void keep() {
    for (std::uint32_t c = 0; c < filled_.cells.size(); ++c)
      for (std::size_t k = 0; k < 4; ++k) sides_.push_back({face(c, k), c, filled_.cells[c][k]});
    std::sort(sides_.begin(), sides_.end(), [](const Side& a, const Side& b) { return a.corners < b.corners; });
    std::vector<std::uint32_t> left;
    std::vector<std::uint8_t> is_inside(filled_.cells.size(), 0);
    const auto reach = [&](std::uint32_t cell) {
      if (is_inside[cell] == 0) is_inside[cell] = 1, left.push_back(cell);
    };
    for (const auto& triangle : domain_.triangles)
      for (Side& side : behind(sorted(triangle))) {
        side.is_border = true;
        if (side_of_plane({point(triangle[0]), point(triangle[1]), point(triangle[2])}, point(side.apex)) < 0)
          reach(side.cell);
      }
    while (!left.empty()) {
      const std::uint32_t cell = left.back();
      left.pop_back();
      for (std::size_t k = 0; k < 4; ++k)
        for (const Side& side : behind(face(cell, k)))
          if (!side.is_border) reach(side.cell);
    }
    std::uint32_t c = 0;
    std::erase_if(filled_.cells, [&](const auto&) { return is_inside[c++] == 0; });
  }

 private:
  using Face = std::array<std::uint32_t, 3>;
  struct Side {
    Face corners;
    std::uint32_t cell, apex;
    bool is_border = false;
  };

  static Face sorted(Face face) {
    std::sort(face.begin(), face.end());
    return face;
  }
  Face face(std::uint32_t cell, std::size_t left_out) const {
    const auto& corners = filled_.cells[cell];
    return sorted({corners[(left_out + 1) % 4], corners[(left_out + 2) % 4], corners[(left_out + 3) % 4]});
  }
  const Vec3d& point(std::uint32_t p) const {
    const std::size_t known = domain_.points.size();
    return p < known ? domain_.points[p] : filled_.added[p - known];
  }
  /// The sides of cells on a face, one or two.
  std::span<Side> behind(const Face& face) {
    const auto is_before = [](const Side& side, const Face& corners) { return side.corners < corners; };
    const auto first = std::lower_bound(sides_.begin(), sides_.end(), face, is_before);
    auto last = first;
    while (last != sides_.end() && last->corners == face) ++last;
    return {first, last};
  }

  const FillDomain& domain_;
  FilledDomain& filled_;
  std::vector<Side> sides_;  // by their corners
};

}  // namespace

FilledDomain fill_by_tetgen(const FillDomain& domain, const std::string& folder, std::uint64_t most_memory) {
  // Y keeps the border. Radii of at most 1.4 edges and angles of at least 10 degrees: 1.2 and 14 take twice as many
  // cells. T: the default, 1e-8 of the whole domain, joins points of fine walls that have a farfield.
  const double largest = domain.longest * domain.longest * domain.longest / (6 * std::numbers::sqrt2);
  const std::string options = fmt::format("-pYq1.4/10a{}T1e-14QC", largest), path = folder + "/domain";
  write_domain(domain, path + ".poly");
  const int status = run({"tetgen", options, path + ".poly"}, most_memory);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotFound) throw FillerMissing("no program tetgen");
  if (WIFSIGNALED(status)) throw FillFailed(fmt::format("its end by signal {}", WTERMSIG(status)));
  if (WEXITSTATUS(status) != 0) throw FillFailed(fmt::format("its end with code {}", WEXITSTATUS(status)));
  FilledDomain filled;
  const auto points = read_lines<double, 3>(path + ".1.node");
  if (points.size() < domain.points.size()) throw FillFailed("a mesh that does not keep the points of its border");
  for (std::size_t p = domain.points.size(); p < points.size(); ++p)
    filled.added.emplace_back(points[p][0], points[p][1], points[p][2]);
  for (const auto& cell : read_lines<std::uint32_t, 4>(path + ".1.ele")) {
    if (*std::max_element(cell.begin(), cell.end()) >= points.size()) throw FillFailed("cells of points that are none");
    filled.cells.push_back(cell);
  }
  CellsInside(domain, filled).keep();
  return filled;
}

}  // namespace vdb_offset
