# SPDX-License-Identifier: Apache-2.0
# Pages of a run: what they show it with, as it is kept by Debian's package libjs-three, becomes a part of the library.

find_file(THREE_SCRIPT three.min.js PATHS /usr/share/javascript/three /usr/share/nodejs/three/build NO_DEFAULT_PATH)
find_file(THREE_CONTROLS OrbitControls.js PATHS /usr/share/javascript/three/examples/js/controls NO_DEFAULT_PATH)
find_file(THREE_LICENCE copyright PATHS /usr/share/doc/libjs-three NO_DEFAULT_PATH)
if(NOT THREE_SCRIPT OR NOT THREE_CONTROLS OR NOT THREE_LICENCE)
  message(FATAL_ERROR "Pages (--html) need three.js: Debian's package libjs-three, or THREE_SCRIPT, THREE_CONTROLS and "
                      "THREE_LICENCE with the paths of three.min.js, OrbitControls.js (r111) and their licence.")
endif()
# view.js is written for this revision: names have changed since.
file(READ ${THREE_SCRIPT} three)
if(NOT three MATCHES "REVISION=\"111\"")
  message(FATAL_ERROR "${THREE_SCRIPT}: expected revision 111 of three.js")
endif()
mark_as_advanced(THREE_SCRIPT THREE_CONTROLS THREE_LICENCE)

set(page_folder ${CMAKE_CURRENT_SOURCE_DIR}/page)
# A compiler does not see which files the assembler takes; nor does ccache, which leaves such a source alone.
set_source_files_properties(page/page_parts.cpp PROPERTIES
  SKIP_PRECOMPILE_HEADERS ON SKIP_UNITY_BUILD_INCLUSION ON
  OBJECT_DEPENDS "${page_folder}/page.html;${page_folder}/page.css;${page_folder}/figures.js;${page_folder}/view.js;${page_folder}/colours.js;${page_folder}/places.js;${page_folder}/page.js;${THREE_SCRIPT};${THREE_CONTROLS};${THREE_LICENCE}"
  COMPILE_DEFINITIONS "VDB_OFFSET_PAGE_FOLDER=\"${page_folder}\";VDB_OFFSET_THREE=\"${THREE_SCRIPT}\";VDB_OFFSET_THREE_CONTROLS=\"${THREE_CONTROLS}\";VDB_OFFSET_THREE_LICENCE=\"${THREE_LICENCE}\"")
