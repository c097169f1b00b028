# SPDX-License-Identifier: Apache-2.0
# Installs the build into a prefix of its own, moves that, and uses it the way a stranger would: by CMake and by pkg-config,
# each header alone, and with flags that the library must not take over.
set(prefix ${BUILD}/consumer/prefix)
file(REMOVE_RECURSE ${BUILD}/consumer)
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE code OUTPUT_VARIABLE text ERROR_VARIABLE text)
  if(code)
    message(FATAL_ERROR "${ARGV}: ${code}\n${text}")
  endif()
  set(output "${text}" PARENT_SCOPE)
endfunction()
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${BUILD}/consumer/installed)
file(RENAME ${BUILD}/consumer/installed ${prefix})

foreach(file bin/vdb_offset bin/vdb_offset-batch share/man/man1/vdb_offset.1 share/bash-completion/completions/vdb_offset
             share/zsh/site-functions/_vdb_offset share/fish/vendor_completions.d/vdb_offset.fish)
  if(NOT EXISTS ${prefix}/${file})
    message(FATAL_ERROR "expected ${file} to be installed")
  endif()
endforeach()

# What is installed names no place of this machine.
file(GLOB_RECURSE texts ${prefix}/*targets*.cmake ${prefix}/*config*.cmake)
foreach(file IN LISTS texts)
  file(READ ${file} text)
  if(text MATCHES "/usr/lib|${BUILD}")
    message(FATAL_ERROR "${file}: expected no path of the machine that built it, got ${CMAKE_MATCH_0}")
  endif()
endforeach()

# The command writes what needs a library that it loads, and finds it after the move.
foreach(ending vtu cgns)
  set(written ${BUILD}/consumer/layers.${ending})
  run(${prefix}/bin/vdb_offset ${SCENE} ${written} --layers 2 --total-thickness 1% --quiet)
  if(NOT EXISTS ${written})
    message(FATAL_ERROR "${written}: expected the installed command to write it")
  endif()
endforeach()

run(${CMAKE_COMMAND} -S ${CONSUMER} -B ${BUILD}/consumer/build -G Ninja -DCMAKE_PREFIX_PATH=${prefix})
run(${CMAKE_COMMAND} --build ${BUILD}/consumer/build)
run(${BUILD}/consumer/build/consumer)
run(${BUILD}/consumer/build/consumer_openmesh)
run(${BUILD}/consumer/build/consumer_plain)
set(plain "${output}")
run(${BUILD}/consumer/build/consumer_fast)
if(NOT plain STREQUAL output)
  message(FATAL_ERROR "a program's flags change the library's results:\n${plain}and\n${output}")
endif()

# Each header is enough by itself.
file(GLOB_RECURSE headers RELATIVE ${prefix}/include ${prefix}/include/*.h)
file(WRITE ${BUILD}/consumer/headers.txt "")
foreach(header IN LISTS headers)
  string(MAKE_C_IDENTIFIER ${header} name)
  file(WRITE ${BUILD}/consumer/headers/${name}.cpp "#include <${header}>\n")
  file(APPEND ${BUILD}/consumer/headers.txt "${BUILD}/consumer/headers/${name}.cpp\n")
endforeach()
run(sh -c "xargs -P 2 -n 1 ${CXX} -std=c++20 -fsyntax-only -Wall -Wextra -Werror -I${prefix}/include < ${BUILD}/consumer/headers.txt")

# What offset.h costs those who include it.
file(WRITE ${BUILD}/consumer/lines.cpp "#include <vdb_offset/offset.h>\n")
run(sh -c "${CXX} -std=c++20 -E -I${prefix}/include ${BUILD}/consumer/lines.cpp | wc -l")
if(output GREATER 120000)
  message(FATAL_ERROR "vdb_offset/offset.h: expected at most 120000 lines with all that it includes, got ${output}")
endif()

# Without CMake.
find_program(PKG_CONFIG pkg-config)
if(PKG_CONFIG)
  set(ENV{PKG_CONFIG_PATH} ${prefix}/${LIBDIR}/pkgconfig)
  run(sh -c "${CXX} -std=c++20 ${CONSUMER}/main.cpp $(${PKG_CONFIG} --cflags --libs vdb_offset) -o ${BUILD}/consumer/by_pkg_config")
  run(${BUILD}/consumer/by_pkg_config)
endif()
