// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace cad_proof {

/// Random numbers that are the same on every machine (splitmix64).
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u) {}

  double between(double least, double most) { return least + (most - least) * next(); }
  /// least, least + 1, ... or most.
  int whole(int least, int most) { return least + static_cast<int>(next() * (most - least + 1)); }
  bool is_likely(double share) { return next() < share; }

 private:
  double next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

  std::uint64_t state_;
};

}  // namespace cad_proof
