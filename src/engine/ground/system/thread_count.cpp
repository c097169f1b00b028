// SPDX-License-Identifier: Apache-2.0
#include "ground/system/thread_count.h"

#include <tbb/info.h>

#include <algorithm>
#include <string>

#include "vdb_offset/run.h"

namespace vdb_offset {

int thread_count(int asked) {
  if (asked < 0) throw InvalidInput("offset: expected 0 threads or more, got " + std::to_string(asked));
  // oneTBB gives no more threads than the machine has.
  const int most = tbb::info::default_concurrency();
  return asked > 0 ? std::min(asked, most) : most;
}

}  // namespace vdb_offset
