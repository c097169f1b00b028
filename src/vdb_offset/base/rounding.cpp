// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/base/rounding.h"

#include <charconv>
#include <iterator>

namespace vdb_offset {

double Rounding::rounded_to_digits(double value) const {
  char text[40];
  const auto end = std::to_chars(std::begin(text), std::end(text), value, std::chars_format::general, digits).ptr;
  double rounded = value;
  std::from_chars(text, end, rounded);
  return rounded;
}

}  // namespace vdb_offset
