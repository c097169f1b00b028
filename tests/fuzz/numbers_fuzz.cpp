// SPDX-License-Identifier: Apache-2.0
// A libFuzzer target for numbers of vertices: whatever the bytes are, they are refused with InvalidInput or are three
// finite numbers. What else is thrown ends the process, as do the sanitizers.

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "fuzz/promise.h"
#include "vdb_offset/io/mesh_file.h"
#include "vdb_offset/run.h"

using namespace vdb_offset;

namespace {

constexpr std::size_t kCount = 3;  // as the seeds have

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  std::vector<double> numbers;
  try {
    numbers = io::parse_vertex_numbers("fuzz.numbers", {reinterpret_cast<const char*>(data), size}, kCount);
  } catch (const InvalidInput&) {
    return 0;
  }
  require(numbers.size() == kCount, "one number a vertex");
  for (const double number : numbers) require(std::isfinite(number), "numbers are finite");
  const std::string text = fmt::format("{}", fmt::join(numbers, " "));
  require(io::parse_vertex_numbers("again.numbers", text, kCount) == numbers, "numbers can be written and read again");
  return 0;
}
