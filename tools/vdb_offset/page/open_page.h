// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace vdb_offset::tool {

/// Opens a page in a browser, which goes on without this process: that of $BROWSER, or what xdg-open starts.
/// Returns why none was opened; empty if one was, as far as is known within a second.
std::string open_page(const std::string& path);

}  // namespace vdb_offset::tool
