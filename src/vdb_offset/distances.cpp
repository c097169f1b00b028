#include "vdb_offset/distances.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "vdb_offset/error.h"

namespace vdb_offset {

Distances::Distances(double uniform) : uniform_(uniform) {
  if (!std::isfinite(uniform)) throw InvalidInput("distance: expected a finite number");
  extend(uniform);
}

Distances::Distances(std::vector<double> each) : each_(std::move(each)) {
  for (std::size_t v = 0; v < each_.size(); ++v) {
    if (!std::isfinite(each_[v]))
      throw InvalidInput("distance: expected a finite number for each vertex, got none for vertex " +
                         std::to_string(v) + " (counted from 0)");
    extend(each_[v]);
  }
}

void Distances::extend(double distance) {
  outward_ = std::max(outward_, distance);
  inward_ = std::max(inward_, -distance);
}

}  // namespace vdb_offset
