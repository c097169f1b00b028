# SPDX-License-Identifier: Apache-2.0
# From objects to libraries, and what is installed of them.

# vdb_offset_inside: all objects and their headers, for the tests and benchmarks.
add_library(vdb_offset_inside INTERFACE)
foreach(component IN LISTS components)
  target_link_libraries(vdb_offset_inside INTERFACE vdb_offset_${component}_objects)
  vdb_offset_objects(${component} objects)
  target_sources(vdb_offset_inside INTERFACE ${objects})
endforeach()

# An archive's inline functions, and those of the headers that it was compiled with, are weak: a program that has compiled
# one of them with flags of its own, as -mfma, would put its own in their place, and results would have other bits. So the
# objects become one, in which they are local. Sanitizers need them as they are.
# LLVM's linker cannot join groups, and CMake takes it for clang.
find_program(VDB_OFFSET_LINKER NAMES ld.bfd ${CMAKE_LINKER})
find_program(VDB_OFFSET_OBJCOPY NAMES ${CMAKE_OBJCOPY} objcopy)
set(is_sealed OFF)
if(NOT BUILD_SHARED_LIBS AND NOT VDB_OFFSET_SANITIZE AND NOT VDB_OFFSET_SANITIZE_THREADS AND NOT VDB_OFFSET_FUZZ
   AND VDB_OFFSET_LINKER AND VDB_OFFSET_OBJCOPY AND CMAKE_NM AND CMAKE_SYSTEM_NAME STREQUAL "Linux")
  set(is_sealed ON)
endif()

function(vdb_offset_archive component)
  vdb_offset_objects(${component} objects)
  if(is_sealed)
    set(sealed ${CMAKE_CURRENT_BINARY_DIR}/sealed/vdb_offset_${component}.o)
    file(GENERATE OUTPUT ${sealed}.objects CONTENT "$<JOIN:${objects},\n>")
    add_custom_command(OUTPUT ${sealed}
      COMMAND ${CMAKE_COMMAND} -DLINKER=${VDB_OFFSET_LINKER} -DNM=${CMAKE_NM} -DOBJCOPY=${VDB_OFFSET_OBJCOPY} -DOUTPUT=${sealed}
              -P ${CMAKE_CURRENT_SOURCE_DIR}/src/cmake/seal.cmake
      DEPENDS ${objects} src/cmake/seal.cmake VERBATIM COMMENT "Sealing ${component}")
    set(objects ${sealed})
    set_source_files_properties(${sealed} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
  endif()
  add_library(vdb_offset_${component} STATIC ${objects})
  set_target_properties(vdb_offset_${component} PROPERTIES LINKER_LANGUAGE CXX)
endfunction()

# What is linked along with a component by those who link it: seen in its headers, and not.
set(engine_public OpenVDB::openvdb TBB::tbb)
set(engine_needs fmt::fmt vdb_offset_gmp vdb_offset_mpfr muparser::muparser)
set(files_public vdb_offset_engine)
set(files_needs EXPAT::EXPAT ZLIB::ZLIB vdb_offset_zstd vdb_offset_libzip)
set(openmesh_public vdb_offset_engine OpenMeshCore)

if(BUILD_SHARED_LIBS)
  add_library(vdb_offset SHARED)
  foreach(component IN LISTS components)
    vdb_offset_objects(${component} objects)
    target_sources(vdb_offset PRIVATE ${objects})
    target_link_libraries(vdb_offset PRIVATE ${${component}_needs})
    add_library(vdb_offset_${component} INTERFACE)
    target_link_libraries(vdb_offset_${component} INTERFACE vdb_offset)
  endforeach()
  target_link_libraries(vdb_offset PUBLIC ${engine_public})
  target_link_libraries(vdb_offset_openmesh INTERFACE OpenMeshCore)
  target_link_libraries(vdb_offset PRIVATE OpenMeshCore)
  # What the standard library's headers compile in is not hidden; calls of it stay inside as well.
  target_link_options(vdb_offset PRIVATE -Wl,-Bsymbolic-functions)
  set_target_properties(vdb_offset PROPERTIES LINKER_LANGUAGE CXX VERSION ${PROJECT_VERSION}
                        SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
else()
  add_library(vdb_offset INTERFACE)
  foreach(component IN LISTS components)
    vdb_offset_archive(${component})
    target_link_libraries(vdb_offset_${component} PUBLIC ${${component}_public} PRIVATE ${${component}_needs})
    if(NOT component STREQUAL openmesh)
      target_link_libraries(vdb_offset INTERFACE vdb_offset_${component})
    endif()
  endforeach()
endif()
foreach(target IN LISTS components)
  add_library(vdb_offset::${target} ALIAS vdb_offset_${target})
  set_target_properties(vdb_offset_${target} PROPERTIES EXPORT_NAME ${target})
endforeach()
add_library(vdb_offset::vdb_offset ALIAS vdb_offset)

# The public headers.
install(DIRECTORY include/vdb_offset DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development FILES_MATCHING PATTERN *.h)
if(BUILD_SHARED_LIBS)
  target_compile_features(vdb_offset PUBLIC cxx_std_20)
  target_include_directories(vdb_offset PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                                               $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
else()
  foreach(component IN LISTS components)
    target_compile_features(vdb_offset_${component} PUBLIC cxx_std_20)
    target_include_directories(vdb_offset_${component} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  endforeach()
endif()

# The package: a set of targets for each component, so that a user of one needs no packages of the others.
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/vdb_offset)
if(BUILD_SHARED_LIBS)
  install(TARGETS vdb_offset EXPORT vdb_offset_engine_targets COMPONENT development)
endif()
foreach(component IN LISTS components)
  install(TARGETS vdb_offset_${component} EXPORT vdb_offset_${component}_targets COMPONENT development)
endforeach()
if(NOT BUILD_SHARED_LIBS)
  # In a set of its own, as it refers to all others.
  install(TARGETS vdb_offset EXPORT vdb_offset_all_targets COMPONENT development)
  install(EXPORT vdb_offset_all_targets NAMESPACE vdb_offset:: DESTINATION ${package_dir} COMPONENT development)
endif()
foreach(component IN LISTS components)
  install(EXPORT vdb_offset_${component}_targets NAMESPACE vdb_offset:: DESTINATION ${package_dir} COMPONENT development)
endforeach()
configure_package_config_file(src/cmake/vdb_offset-config.cmake.in vdb_offset-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(vdb_offset-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/vdb_offset-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/vdb_offset-config-version.cmake src/cmake/Dependencies.cmake
        DESTINATION ${package_dir} COMPONENT development)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

# For builds without CMake, if all packages lie where the system keeps them: pkg-config --cflags --libs vdb_offset.
if(BUILD_SHARED_LIBS)
  set(pc_libraries "-lvdb_offset")
  set(pc_requires "Imath")
else()
  # Static, a program needs all that the library does.
  set(pc_libraries "-lvdb_offset_files -lvdb_offset_engine -lmpfr -lgmp")
  set(pc_requires "Imath fmt expat zlib libzstd libzip muparser")
endif()
# From where the file itself lies, so that what is installed may be moved, or packed.
cmake_path(SET pc_dir NORMALIZE /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig)
cmake_path(RELATIVE_PATH pc_dir BASE_DIRECTORY /prefix OUTPUT_VARIABLE pc_depth)
string(REGEX REPLACE "[^/]+" ".." pc_depth ${pc_depth})
set(pc_prefix "\${pcfiledir}/${pc_depth}")
if(IS_ABSOLUTE ${CMAKE_INSTALL_LIBDIR})
  set(pc_prefix ${CMAKE_INSTALL_PREFIX})
endif()
configure_file(src/cmake/vdb_offset.pc.in vdb_offset.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/vdb_offset.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
