// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <gp_Pnt.hxx>
#include <string>
#include <vector>

namespace vdb_offset::cad {

struct JudgeOptions {
  int samples = 10000;
  double tolerance = 0.01;  ///< Of |distance|: how near or far points may be.
  /// It has triangles of a mesh, which may lie on each other, back to back; and parts of a shell are shells.
  bool is_of_mesh = false;
};

/// How far the faces of a source were to go.
struct AskedDistance {
  double outward = 0, inward = 0;  ///< The largest distance to either side, 0 or more.
  double scale = 0;                ///< What is small is small compared to this, > 0.
  bool is_even = false;            ///< All faces go by the scale, to one side.

  static AskedDistance even(double distance) {
    return {std::max(distance, 0.0), std::max(-distance, 0.0), std::abs(distance), true};
  }
  /// Takes a distance towards the outside in.
  void add(double distance) {
    outward = std::max(outward, distance);
    inward = std::max(inward, -distance);
  }
  bool has_one_side() const { return outward == 0 || inward == 0; }
};

struct Verdict {
  bool is_good = true;
  std::vector<std::string> faults;  ///< In words; empty if it is good.
  std::vector<gp_Pnt> places;       ///< Where some of these are.
  double least = 0, most = 0;       ///< Sampled distances of the result to the source, as shares of |distance|.
  double volume = 0;
  std::size_t samples = 0;  ///< How many points these are of.
};

/// Whether an inward offset of a solid is empty: every sampled point of the source, moved by the distance, is nearer to
/// another part of it.
bool leaves_nothing(const TopoDS_Shape& source, double distance);

/// The volume of a closed shape, below 0 if it is turned inside out.
double volume_of(const TopoDS_Shape& shape);

/// Judges an offset by what it is, not by how it was made: valid topology; as many solids and shells as the source, if
/// it is not an even one of solids, and as closed; its tessellation is closed if the source is, no triangles of it
/// cross, and it goes round its material once, so that none of its walls have passed each other. Where all faces go to
/// one side, sampled points of it are on that side of the source.
///
/// Of an even offset, too: every such point is at least the distance from the source, and no farther but over edges and
/// vertices; every point of the source whose offset is no nearer to another part of the source has it in the result.
/// \param made the result before it was written: who reads a file may turn what is inside out
Verdict judge_offset(const TopoDS_Shape& source, const TopoDS_Shape& made, const TopoDS_Shape& result,
                     const AskedDistance& asked, const JudgeOptions& options);

}  // namespace vdb_offset::cad
