# SPDX-License-Identifier: Apache-2.0
# A building (engine, files) is a folder of src whose sources become one set of objects; its CMakeLists.txt says which other
# buildings it sees.

# vdb_offset_building(NAME SEES FOLDERS...): the objects of a building, which includes headers from its own folder, from
# those listed, and the public ones.
function(vdb_offset_building name)
  add_library(vdb_offset_${name}_objects OBJECT)
  target_compile_features(vdb_offset_${name}_objects PUBLIC cxx_std_20)
  list(TRANSFORM ARGN PREPEND ${PROJECT_SOURCE_DIR}/src/ OUTPUT_VARIABLE seen)
  target_include_directories(vdb_offset_${name}_objects PUBLIC ${PROJECT_SOURCE_DIR}/include ${seen})
  target_link_libraries(vdb_offset_${name}_objects PUBLIC OpenVDB::openvdb TBB::tbb PRIVATE fmt::fmt vdb_offset_build)
  set_target_properties(vdb_offset_${name}_objects PROPERTIES POSITION_INDEPENDENT_CODE ON
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON UNITY_BUILD_MODE ${VDB_OFFSET_UNITY})
  if(name STREQUAL engine)
    target_precompile_headers(vdb_offset_engine_objects PRIVATE ${PROJECT_SOURCE_DIR}/src/cmake/pch.h)
  else()
    target_precompile_headers(vdb_offset_${name}_objects REUSE_FROM vdb_offset_engine_objects)
  endif()
endfunction()

# vdb_offset_folders(TARGET FOLDERS...): the sources of folders, each of which is compiled together where units are joined.
function(vdb_offset_folders target)
  foreach(folder IN LISTS ARGN)
    cmake_path(SET path NORMALIZE ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
    file(GLOB sources CONFIGURE_DEPENDS ${path})
    target_sources(${target} PRIVATE ${sources})
    string(MAKE_C_IDENTIFIER ${folder} group)
    set_source_files_properties(${sources} PROPERTIES UNITY_GROUP ${group})
  endforeach()
endfunction()

# Of the objects that CMake lists, precompiled headers are none.
function(vdb_offset_objects name result)
  set(${result} $<FILTER:$<TARGET_OBJECTS:vdb_offset_${name}_objects>,INCLUDE,[.]o$> PARENT_SCOPE)
endfunction()
