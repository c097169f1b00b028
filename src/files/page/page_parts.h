// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace vdb_offset::io {

/// The files that a page is put together of, as they were when the library was built. Those of the viewer are three.js.
struct PageParts {
  std::string_view page, style, figures, view, colours, places, script;  ///< Of this folder.
  std::string_view viewer, controls, viewer_licence;
};
PageParts page_parts();

}  // namespace vdb_offset::io
