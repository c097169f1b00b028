# SPDX-License-Identifier: Apache-2.0
# The packages that the components need, for the library's own build and for those who link it.
#
# vdb_offset_find_dependencies(COMPONENT): a shared library has its own with it. The engine comes first.

# A library without a package of its own as a target, so that no path of this machine goes into what is installed.
function(vdb_offset_find_library target header library)
  if(TARGET ${target})
    return()
  endif()
  string(TOUPPER ${target} name)
  find_path(${name}_HEADERS ${header} REQUIRED)
  find_library(${name}_LIBRARY ${library} REQUIRED)
  mark_as_advanced(${name}_HEADERS ${name}_LIBRARY)
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} INTERFACE ${${name}_HEADERS})
  target_link_libraries(${target} INTERFACE ${${name}_LIBRARY})
endfunction()

macro(vdb_offset_find_dependencies component)
  if(${component} STREQUAL engine)
    find_package(TBB 2021 REQUIRED)
    # Debian keeps OpenVDB's find module beside its other files, not on CMake's module path.
    find_path(OPENVDB_MODULE_DIR FindOpenVDB.cmake PATH_SUFFIXES cmake/OpenVDB lib/cmake/OpenVDB
              PATHS /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE} /usr/local)
    mark_as_advanced(OPENVDB_MODULE_DIR)
    if(OPENVDB_MODULE_DIR)
      list(APPEND CMAKE_MODULE_PATH ${OPENVDB_MODULE_DIR})
    endif()
    find_package(OpenVDB 10 REQUIRED COMPONENTS openvdb)
    # Of an archive, OpenVDB's find module leaves out what its own files are compressed with.
    if(OPENVDB_USE_STATIC_LIBS)
      find_package(ZLIB REQUIRED)
      target_link_libraries(OpenVDB::openvdb INTERFACE $<TARGET_NAME_IF_EXISTS:Blosc::blosc> ZLIB::ZLIB)
    endif()
    if(NOT vdb_offset_shared)
      find_package(fmt REQUIRED)
      # CGAL is headers alone; its exact numbers need these two.
      vdb_offset_find_library(vdb_offset_gmp gmp.h gmp)
      vdb_offset_find_library(vdb_offset_mpfr mpfr.h mpfr)
      find_package(muparser 2.3 REQUIRED)
    endif()
  elseif(${component} STREQUAL files AND NOT vdb_offset_shared)
    # For compressed files and drawings.
    find_package(ZLIB REQUIRED)
    find_package(EXPAT REQUIRED)
    vdb_offset_find_library(vdb_offset_zstd zstd.h zstd)
    # Debian's package of libzip for CMake asks for programs that are in other packages.
    vdb_offset_find_library(vdb_offset_libzip zip.h zip)
  elseif(${component} STREQUAL openmesh)
    find_package(OpenMesh REQUIRED)
  endif()
endmacro()
