// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/numbers.h"

#include <catch2/catch.hpp>

using namespace vdb_offset;

TEST_CASE("decimal: what files have as a number is one, whole, and nothing else is", "[decimal]") {
  CHECK(decimal<double>("0.5") == 0.5);
  CHECK(decimal<double>("+.5e+1") == 5);
  CHECK(decimal<double>("-5.") == -5);
  CHECK(decimal<double>("0.100000000000000000001") == 0.1);  // the nearest double
  CHECK(decimal<double>("0e-400") == 0);
  for (const char* text : {"", "+", "-", ".", "+-1", "--1", " 1", "1 ", "1,5", "0x10", "0x1p3", "1e", "1f", "inf",
                           "nan", "1e400", "1e-400", "[1]", "1_0"})
    CHECK_FALSE(decimal<double>(text));
  CHECK(decimal<int>("010") == 10);
  CHECK(decimal<int>("+7") == 7);
  for (const char* text : {"", "+-1", "0x2", "2.0", "2e0", "111111111111111111111"}) CHECK_FALSE(decimal<int>(text));
}
