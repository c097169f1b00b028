// SPDX-License-Identifier: Apache-2.0
// gmsh is a program of its own, which this one starts: it gets the domain's triangles as a mesh and what to do as a
// script, and leaves a mesh, all in one folder. For sizes it asks a process of its own, which is this program again:
// without them it makes tetrahedra between the smallest and the largest triangles, with nothing between.
#include "gmsh.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "cells_inside.h"
#include "child_program.h"
#include "ground/numbers/disjoint_sets.h"
#include "sizes.h"
#include "text_file.h"

namespace vdb_offset {
namespace {

constexpr int kTriangle = 2, kTetrahedron = 4;  // as MSH files number them
constexpr double kWritten = 1e-12;              // how far coordinates of 16 digits may be off, as a share

/// The connected shells of a domain, each of which is a surface of its own for gmsh: it fills holes as well where all
/// are one. Points are in the order of their shells, as gmsh puts them in this order.
struct Shells {
  explicit Shells(const FillDomain& domain) : number(domain.points.size(), 0) {
    DisjointSets sets(domain.points.size());
    for (const auto& [a, b, c] : domain.triangles) sets.join(a, b), sets.join(b, c);
    std::map<std::uint32_t, std::size_t> numbers;
    for (const auto& triangle : domain.triangles) numbers.try_emplace(sets.first(triangle[0]), numbers.size() + 1);
    count = numbers.size();
    for (std::uint32_t p = 0; p < number.size(); ++p) {
      const auto found = numbers.find(sets.first(p));
      if (found != numbers.end()) number[p] = found->second;
      order.push_back(p);
    }
    std::stable_sort(order.begin(), order.end(), [&](auto p, auto q) { return number[p] < number[q]; });
  }

  std::size_t count = 0;
  std::vector<std::size_t> number;   // of each point its shell's, from 1
  std::vector<std::uint32_t> order;  // the points
};

/// The solid angle that a shell is seen in from a place, 4 pi from inside, 0 from outside (Van Oosterom, Strackee, The
/// solid angle of a plane triangle, 1983).
double angle_around(const Vec3d& x, const FillDomain& domain, const Shells& shells, std::size_t shell) {
  double sum = 0;
  for (const auto& triangle : domain.triangles) {
    if (shells.number[triangle[0]] != shell) continue;
    const Vec3d a = domain.points[triangle[0]] - x, b = domain.points[triangle[1]] - x,
                c = domain.points[triangle[2]] - x;
    const double u = a.length(), v = b.length(), w = c.length();
    sum += 2 * std::atan2(a.dot(b.cross(c)), u * v * w + a.dot(b) * w + b.dot(c) * u + c.dot(a) * v);
  }
  return sum;
}

/// The parts of a domain that do not touch: of each its outer shell, and those of the holes in it.
std::vector<std::vector<std::size_t>> parts_of(const FillDomain& domain, const Shells& shells) {
  std::vector<double> volumes(shells.count + 1, 0);
  std::vector<Vec3d> places(shells.count + 1);
  for (const auto& [a, b, c] : domain.triangles) {
    volumes[shells.number[a]] += domain.points[a].dot(domain.points[b].cross(domain.points[c]));
    places[shells.number[a]] = domain.points[a];
  }
  std::map<std::size_t, std::vector<std::size_t>> parts;  // by the outer shell
  for (std::size_t s = 1; s <= shells.count; ++s)
    if (volumes[s] > 0) parts[s].push_back(s);
  for (std::size_t s = 1; s <= shells.count; ++s) {
    if (volumes[s] > 0) continue;
    std::vector<std::size_t>* around = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (auto& [outer, shells_of_part] : parts)
      if (volumes[outer] < least &&
          (parts.size() == 1 || angle_around(places[s], domain, shells, outer) > 2 * std::numbers::pi)) {
        least = volumes[outer];
        around = &shells_of_part;
      }
    if (around == nullptr) throw FillFailed("a hole that is in nothing");
    around->push_back(s);
  }
  std::vector<std::vector<std::size_t>> all;
  all.reserve(parts.size());
  for (auto& [outer, part] : parts) all.push_back(std::move(part));
  return all;
}

void write_triangles(const FillDomain& domain, const Shells& shells, const std::string& path) {
  TextFile file(path);
  file.print("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", domain.points.size());
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> place(domain.points.size());
  for (const std::uint32_t p : shells.order) {
    place[p] = static_cast<std::uint32_t>(points.size());
    points.push_back(domain.points[p]);
  }
  file.print_points(points, 1);
  file.print("$EndNodes\n$Elements\n{}\n", domain.triangles.size());
  for (std::size_t t = 0; t < domain.triangles.size(); ++t) {
    const auto& [a, b, c] = domain.triangles[t];
    file.print("{} {} 2 0 {} {} {} {}\n", t + 1, kTriangle, shells.number[a], place[a] + 1, place[b] + 1, place[c] + 1);
  }
  file.print("$EndElements\n");
  file.finish();
}

/// \param sizes the command that answers with the size at each place
void write_script(const FillDomain& domain, const Shells& shells, const std::string& sizes, const std::string& path) {
  TextFile file(path);
  file.print("Merge \"domain.msh\";\n");
  for (std::size_t s = 1; s <= shells.count; ++s) file.print("Surface Loop({}) = {{{}}};\n", s, s);
  std::size_t volume = 0;
  for (const std::vector<std::size_t>& part : parts_of(domain, shells))
    file.print("Volume({}) = {{{}}};\n", ++volume, fmt::join(part, ","));
  // Points are moved at random by so many diagonals; the defaults, 1e-9 and more, are larger than the finest layers
  // that have a farfield.
  file.print("Mesh.RandomFactor = 1e-14;\nMesh.RandomFactor3D = 1e-14;\nGeometry.Tolerance = 1e-14;\n");
  file.print("Field[1] = ExternalProcess;\nField[1].CommandLine = \"{}\";\nBackground Field = 1;\n", sizes);
  file.print("Mesh.Algorithm3D = 1;\nMesh.MeshSizeExtendFromBoundary = 0;\nMesh.MeshSizeMax = {};\n", domain.longest);
  file.print("Mesh.Optimize = 1;\nMesh.OptimizeThreshold = 0.5;\nMesh.SaveAll = 1;\nMesh.Binary = 0;\n");
  file.finish();
}

/// A word of a shell, in a text of a script. \throw FillFailed for what cannot be such a word
std::string in_quotes(const std::string& word) {
  if (word.find_first_of("'\"\\\n") != std::string::npos) throw FillFailed("a folder with quotes in its name");
  return "'" + word + "'";
}

/// A file of MSH 2.2 that gmsh wrote, section by section.
class MshReader {
 public:
  explicit MshReader(const std::string& path) : file_(path) {}

  /// \param order the points of the domain, in the order in which the file has them before others
  FilledDomain read(const FillDomain& domain, std::vector<std::uint32_t> order) {
    FilledDomain filled;
    const std::size_t known = order.size(), points = begin("$Nodes");
    if (points < known) throw FillFailed("a mesh that does not keep the points of its border");
    for (std::size_t p = 0; p < points; ++p) {
      if (number<std::size_t>() != p + 1) throw FillFailed("a mesh whose points come in another order");
      const double x = number<double>(), y = number<double>(), z = number<double>();
      if (p >= known) {
        order.push_back(static_cast<std::uint32_t>(p));
        filled.added.emplace_back(x, y, z);
      } else if (const Vec3d& at = domain.points[order[p]]; (Vec3d(x, y, z) - at).length() > kWritten * at.length()) {
        throw FillFailed("a mesh that moves the points of its border");
      }
    }
    const std::size_t elements = begin("$Elements");
    for (std::size_t e = 0; e < elements; ++e) {
      number<std::size_t>();
      if (number<int>() == kTetrahedron) {
        for (auto tags = number<std::size_t>(); tags > 0; --tags) number<int>();
        for (std::uint32_t& corner : filled.cells.emplace_back()) {
          const auto p = number<std::size_t>();
          if (p == 0 || p > points) throw FillFailed("cells of points that are none");
          corner = order[p - 1];
        }
      }
      file_.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
    }
    return filled;
  }

 private:
  template <class Number>
  Number number() {
    Number value{};
    if (!(file_ >> value)) throw FillFailed("a file that is cut off");
    return value;
  }

  /// Goes on to a section. \return how many lines it has
  std::size_t begin(const std::string& name) {
    std::string line;
    while (std::getline(file_, line))
      if (line == name) return number<std::size_t>();
    throw FillFailed("a file without " + name);
  }

  std::ifstream file_;
};

}  // namespace

FilledDomain fill_by_gmsh(const FillDomain& domain, const std::string& folder, std::uint64_t most_memory) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  const Shells shells(domain);
  write_triangles(domain, shells, folder + "/domain.msh");
  Sizes(domain).write(folder + "/domain.sizes");
  write_script(domain, shells, "exec " + in_quotes(program) + " sizes " + in_quotes(folder + "/domain.sizes"),
               folder + "/domain.geo");
  // A user's own options, which gmsh looks for in its home, are not meant for this.
  run_program({"gmsh", "-3", folder + "/domain.geo", "-nt", "1", "-format", "msh22", "-o", folder + "/filled.msh"},
              {{"GMSH_HOME", folder}}, most_memory);
  FilledDomain filled = MshReader(folder + "/filled.msh").read(domain, shells.order);
  keep_cells_inside(domain, filled);
  return filled;
}

}  // namespace vdb_offset
