// SPDX-License-Identifier: Apache-2.0
#include "vdb_offset/error.h"
#include "vdb_offset/io/page_file.h"

// Stands in for pages where the library is built without the viewer that they are made with: writing is refused.
namespace vdb_offset::io {

void require_pages(const std::string& path) {
  throw InvalidOption(path + ": expected no page, as this build is without three.js (VDB_OFFSET_HTML)");
}

void write_page(const std::string& path, const Page&) { require_pages(path); }

}  // namespace vdb_offset::io
