// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <TopoDS_Shape.hxx>
#include <cstddef>
#include <string>
#include <vector>

namespace vdb_offset::cad {

struct JudgeOptions {
  int samples = 10000;
  double tolerance = 0.01;  ///< Of |distance|: how near or far points may be.
};

struct Verdict {
  bool is_good = true;
  std::vector<std::string> faults;  ///< In words; empty if it is good.
  double least = 0, most = 0;       ///< Sampled distances of the result to the source, as shares of |distance|.
  double volume = 0;
  std::size_t samples = 0;  ///< How many points these are of.
};

/// Judges an offset by what it is, not by how it was made: valid topology; as many solids and shells as the source, and
/// as closed; every sampled point of the result at least |distance| from the source, on its right side, and no farther
/// but over edges and vertices; every point of the source whose offset is no nearer to another part of the source has
/// it in the result; its tessellation is closed if the source is, no triangles of it cross, and it goes round its
/// material once.
Verdict judge_offset(const TopoDS_Shape& source, const TopoDS_Shape& result, double distance,
                     const JudgeOptions& options);

}  // namespace vdb_offset::cad
