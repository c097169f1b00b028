# SPDX-License-Identifier: Apache-2.0
# Run by CPack when the files of each package are in place and before they are packed: adds what Debian's policy asks
# for. Each component lies in a folder of its name.
set(here ${CPACK_VDB_OFFSET_SOURCE}/src/cmake/debian)
set(version ${CPACK_PACKAGE_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})

# The changelog says when this version was made.
string(REPLACE "." "[.]" pattern ${CPACK_PACKAGE_VERSION})
file(STRINGS ${CPACK_VDB_OFFSET_SOURCE}/CHANGELOG.md heading LIMIT_COUNT 1 REGEX "^## ${pattern} ")
if(NOT heading MATCHES "[(]([0-9-]+)[)]")
  message(FATAL_ERROR "CHANGELOG.md: expected a heading \"## ${CPACK_PACKAGE_VERSION} (YEAR-MONTH-DAY)\", got \"${heading}\"")
endif()
set(day ${CMAKE_MATCH_1})
string(SUBSTRING ${day} 0 4 year)
# In the language of changelogs, whatever that of the user is.
execute_process(COMMAND ${CMAKE_COMMAND} -E env LC_ALL=C TZ=UTC date -R -d ${day} OUTPUT_VARIABLE date
                OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)

# Without a name and a time in it, so that equal files give equal packages.
function(compress file)
  execute_process(COMMAND gzip -9nf ${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  set(root ${CPACK_TEMPORARY_DIRECTORY}/${component}/usr)
  string(TOUPPER ${component} upper)
  set(package ${CPACK_DEBIAN_${upper}_PACKAGE_NAME})
  set(documents ${root}/share/doc/${package})
  configure_file(${here}/copyright.in ${documents}/copyright @ONLY)
  configure_file(${here}/changelog.in ${documents}/changelog.Debian @ONLY)
  compress(${documents}/changelog.Debian)
  # Debian has the text of the licence already; copyright says where.
  file(REMOVE ${documents}/LICENSE)
  if(EXISTS ${documents}/CHANGELOG.md)
    file(RENAME ${documents}/CHANGELOG.md ${documents}/changelog)
    compress(${documents}/changelog)
  endif()
  if(component STREQUAL command)
    configure_file(${here}/vdb_offset-batch.1.in ${root}/share/man/man1/vdb_offset-batch.1 @ONLY)
  endif()
  file(GLOB pages ${root}/share/man/man*/*.[0-9])
  foreach(page IN LISTS pages)
    compress(${page})
  endforeach()
  # Where Debian's zsh looks for what packages bring; site-functions is for what is installed by hand.
  if(IS_DIRECTORY ${root}/share/zsh/site-functions)
    file(RENAME ${root}/share/zsh/site-functions ${root}/share/zsh/vendor-completions)
  endif()
  # Debian's Python packages lie in a folder that all versions of Python 3 share; a prefix such as /usr/local has one for
  # each version.
  file(GLOB modules ${root}/lib/python3.*/*-packages ${root}/lib/*/python3.*/*-packages)
  foreach(folder IN LISTS modules)
    file(MAKE_DIRECTORY ${root}/lib/python3)
    file(RENAME ${folder} ${root}/lib/python3/dist-packages)
    cmake_path(GET folder PARENT_PATH folder)
    file(REMOVE_RECURSE ${folder})
  endforeach()
  if(EXISTS ${here}/${package}.lintian-overrides)
    file(MAKE_DIRECTORY ${root}/share/lintian/overrides)
    configure_file(${here}/${package}.lintian-overrides ${root}/share/lintian/overrides/${package} COPYONLY)
  endif()
endforeach()
