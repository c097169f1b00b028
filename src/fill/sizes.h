// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vdb_offset/fill.h"

namespace vdb_offset {

/// How long edges are to be at a place of a domain: as long as those of its border, which grow by so much from cell to
/// cell: min(longest, h(p) + (growth - 1) |x - p|) over all points p of the border, with the mean length h(p) of their
/// edges.
class Sizes {
 public:
  explicit Sizes(const FillDomain& domain);
  /// \param file what write() has written \throw FillFailed
  explicit Sizes(const std::string& file);

  void write(const std::string& file) const;
  double at(const Vec3d& x) const;

 private:
  struct Point {
    Vec3d place;
    double size;
  };
  /// The points from `first` up to `end` are in this box. A node's two halves are the next one, and that at `other`; a
  /// leaf has none.
  struct Node {
    Vec3d lowest, highest;
    double least;  // of their sizes
    std::uint32_t first, end, other;
  };

  void build();
  void split(std::uint32_t first, std::uint32_t end);
  double bound(const Node& node, const Vec3d& x) const;
  void search(std::uint32_t node, const Vec3d& x, double& size) const;

  double slope_ = 0, longest_ = 0;
  std::vector<Point> points_;  // in the order of leaves
  std::vector<Node> nodes_;
};

/// Answers who asks on standard input for the size at places, three numbers each, by one on standard output, as gmsh's
/// field ExternalProcess does, until there is no more, or a place that is none.
/// \throw FillFailed where the file cannot be read
void serve_sizes(const std::string& file);

}  // namespace vdb_offset
