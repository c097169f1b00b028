// SPDX-License-Identifier: Apache-2.0
// The assembler puts whole files into the library: as text of this language, a compiler would take minutes for them.
#include "page/page_parts.h"

// The file that a macro of the build names, with a 0 behind it.
#define VDB_OFFSET_EMBED(name, path)         \
  asm(".section .rodata\n"                   \
      ".local vdb_offset_page_" #name        \
      "\n"                                   \
      "vdb_offset_page_" #name               \
      ":\n"                                  \
      ".incbin \"" path                      \
      "\"\n"                                 \
      ".local vdb_offset_page_end_of_" #name \
      "\n"                                   \
      "vdb_offset_page_end_of_" #name        \
      ":\n"                                  \
      ".byte 0\n"                            \
      ".previous\n");                        \
  extern "C" __attribute__((visibility("hidden"))) const char vdb_offset_page_##name[], vdb_offset_page_end_of_##name[]

VDB_OFFSET_EMBED(page, VDB_OFFSET_PAGE_FOLDER "/page.html");
VDB_OFFSET_EMBED(style, VDB_OFFSET_PAGE_FOLDER "/page.css");
VDB_OFFSET_EMBED(figures, VDB_OFFSET_PAGE_FOLDER "/figures.js");
VDB_OFFSET_EMBED(view, VDB_OFFSET_PAGE_FOLDER "/view.js");
VDB_OFFSET_EMBED(colours, VDB_OFFSET_PAGE_FOLDER "/colours.js");
VDB_OFFSET_EMBED(places, VDB_OFFSET_PAGE_FOLDER "/places.js");
VDB_OFFSET_EMBED(script, VDB_OFFSET_PAGE_FOLDER "/page.js");
VDB_OFFSET_EMBED(viewer, VDB_OFFSET_THREE);
VDB_OFFSET_EMBED(controls, VDB_OFFSET_THREE_CONTROLS);
VDB_OFFSET_EMBED(viewer_licence, VDB_OFFSET_THREE_LICENCE);

namespace vdb_offset::io {

PageParts page_parts() {
  const auto between = [](const char* begin, const char* end) {
    return std::string_view(begin, static_cast<std::size_t>(end - begin));
  };
  return {.page = between(vdb_offset_page_page, vdb_offset_page_end_of_page),
          .style = between(vdb_offset_page_style, vdb_offset_page_end_of_style),
          .figures = between(vdb_offset_page_figures, vdb_offset_page_end_of_figures),
          .view = between(vdb_offset_page_view, vdb_offset_page_end_of_view),
          .colours = between(vdb_offset_page_colours, vdb_offset_page_end_of_colours),
          .places = between(vdb_offset_page_places, vdb_offset_page_end_of_places),
          .script = between(vdb_offset_page_script, vdb_offset_page_end_of_script),
          .viewer = between(vdb_offset_page_viewer, vdb_offset_page_end_of_viewer),
          .controls = between(vdb_offset_page_controls, vdb_offset_page_end_of_controls),
          .viewer_licence = between(vdb_offset_page_viewer_licence, vdb_offset_page_end_of_viewer_licence)};
}

}  // namespace vdb_offset::io
