#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace vdb_offset {

/// How far vertices are to go: all as far, or each its own distance. World units; negative is inward, 0 stays put.
class Distances {
 public:
  Distances(double uniform = 0);  // NOLINT(google-explicit-constructor): one number is the usual case
  /// One number a vertex. \throw InvalidInput for one that is not finite, by its index.
  explicit Distances(std::vector<double> each);

  double operator[](std::size_t vertex) const { return each_.empty() ? uniform_ : each_[vertex]; }
  bool uniform() const { return each_.empty(); }
  /// Of vertices with a distance of their own.
  std::size_t count() const { return each_.size(); }

  /// The farthest that any goes outward, and inward; both at least 0.
  double outward() const { return outward_; }
  double inward() const { return inward_; }
  /// The farthest that any goes: what is small is small compared to this.
  double scale() const { return outward_ > inward_ ? outward_ : inward_; }
  /// The distance that goes farthest, with its sign.
  double farthest() const { return outward_ >= inward_ ? outward_ : -inward_; }

 private:
  void extend(double distance);

  double uniform_ = 0, outward_ = 0, inward_ = 0;
  std::vector<double> each_;
};

}  // namespace vdb_offset
