// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace vdb_offset::io {

/// Names as a message can show them: a handful, those that look most like `wanted`, and how many more there are.
std::string nearest_names(std::string_view wanted, const std::vector<std::string>& known);

/// The first few of a list, and how many more there are.
std::string first_names(const std::vector<std::string>& names);

}  // namespace vdb_offset::io
