// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "vdb_offset/api.h"

namespace vdb_offset {

/// Distances of vertices: one for all, or one for each. World units; negative is inward, 0 leaves a vertex where it is.
class VDB_OFFSET_API Distances {
 public:
  Distances(double uniform = 0);  // NOLINT(google-explicit-constructor): one number is the usual case
  /// One number a vertex. \throw InvalidInput for one that is not finite, by its index.
  explicit Distances(std::vector<double> each);

  double operator[](std::size_t vertex) const { return each_.empty() ? uniform_ : each_[vertex]; }
  bool uniform() const { return each_.empty(); }
  /// How many vertices have a distance of their own; 0 if all have the same.
  std::size_t count() const { return each_.size(); }

  /// The largest distance outward, and inward; both at least 0.
  double outward() const { return outward_; }
  double inward() const { return inward_; }
  /// The largest distance without its sign: what is small is small compared to this.
  double scale() const { return outward_ > inward_ ? outward_ : inward_; }
  /// The largest distance with its sign.
  double farthest() const { return outward_ >= inward_ ? outward_ : -inward_; }

 private:
  void extend(double distance);

  double uniform_ = 0, outward_ = 0, inward_ = 0;
  std::vector<double> each_;
};

}  // namespace vdb_offset
