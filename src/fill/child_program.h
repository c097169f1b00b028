// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "vdb_offset/fill.h"

namespace vdb_offset {

/// There is no such program.
struct FillerMissing : FillFailed {
  using FillFailed::FillFailed;
};

/// Runs a program to its end, which comes with this one's if that comes before; what it says is not heard.
/// \param words its name, which is looked for as shells do, and its arguments
/// \param surroundings variables of its environment beside those of this one, by name and value
/// \param most_memory how many bytes of addresses it may ask for; 0: any
/// \throw FillFailed with how it ended, but for code 0; FillerMissing if there is no such program
void run_program(const std::vector<std::string>& words,
                 const std::vector<std::pair<std::string, std::string>>& surroundings, std::uint64_t most_memory);

}  // namespace vdb_offset
