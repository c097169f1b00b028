# SPDX-License-Identifier: Apache-2.0
# Modules that are opened when a file of theirs is asked for, so that not every run loads VTK, CGNS and Assimp, nor every
# program has to be linked to them.

file(RELATIVE_PATH from_command ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR}/vdb_offset)
set_source_files_properties(bytes/open_module.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON COMPILE_DEFINITIONS
  "VDB_OFFSET_MODULES_FROM_COMMAND=\"${from_command}\";VDB_OFFSET_MODULES=\"${CMAKE_INSTALL_FULL_LIBDIR}/vdb_offset\"")
# What uses a module, and the tests, need all of them.
add_custom_target(vdb_offset_modules)

# vdb_offset_module(NAME NEEDS FOLDER SOURCES...): of the sources of a folder, and of copies of what they need of the library.
# No archive: its one object would come whole.
function(vdb_offset_module name needs folder)
  file(GLOB sources CONFIGURE_DEPENDS ${folder}/*.cpp)
  list(TRANSFORM ARGN APPEND .cpp)
  add_library(vdb_offset_${name}_module MODULE ${sources} ${ARGN})
  target_compile_features(vdb_offset_${name}_module PRIVATE cxx_std_20)
  target_include_directories(vdb_offset_${name}_module PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src/files
                                                               ${PROJECT_SOURCE_DIR}/src/engine)
  target_link_libraries(vdb_offset_${name}_module PRIVATE OpenVDB::openvdb TBB::tbb fmt::fmt ${needs} vdb_offset_build)
  target_link_options(vdb_offset_${name}_module PRIVATE -Wl,--as-needed -Wl,-Bsymbolic-functions)
  set_target_properties(vdb_offset_${name}_module PROPERTIES OUTPUT_NAME vdb_offset_${name} PREFIX "" SUFFIX .so
    UNITY_BUILD_MODE BATCH UNITY_BUILD_BATCH_SIZE 0 LINKER_LANGUAGE CXX CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_precompile_headers(vdb_offset_${name}_module REUSE_FROM vdb_offset_engine_objects)
  add_dependencies(vdb_offset_modules vdb_offset_${name}_module)
  install(TARGETS vdb_offset_${name}_module LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/vdb_offset)
endfunction()

set(rounding ../engine/ground/numbers/rounding)
vdb_offset_module(vtk_meshes "VTK::IOXML;VTK::IOLegacy" vtk/module document/trial document/document bytes/nearest_names ${rounding})
vdb_offset_module(assimp assimp::assimp assimp/module document/trial document/document ${rounding})
vdb_offset_module(cgns vdb_offset_cgns volume/cgns volume/patch_words ../engine/products/volume/volume_faces
  ../engine/products/volume/volume_mesh)
