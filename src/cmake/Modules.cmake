# SPDX-License-Identifier: Apache-2.0
# Modules that are opened when a file of theirs is asked for, so that not every run loads VTK, CGNS and Assimp.

file(RELATIVE_PATH from_command ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR}/vdb_offset)
set_source_files_properties(src/vdb_offset/io/base/open_module.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON COMPILE_DEFINITIONS
  "VDB_OFFSET_MODULES_FROM_COMMAND=\"${from_command}\";VDB_OFFSET_MODULES=\"${CMAKE_INSTALL_FULL_LIBDIR}/vdb_offset\"")
target_link_libraries(vdb_offset_io_objects PRIVATE ${CMAKE_DL_LIBS})
# What uses a module, and the tests, need all of them.
add_custom_target(vdb_offset_modules)

# vdb_offset_module(NAME NEEDS SOURCES...): copies of what it needs of the library are among the sources. No archive: its
# one object would come whole.
function(vdb_offset_module name needs)
  list(TRANSFORM ARGN PREPEND src/vdb_offset/)
  list(TRANSFORM ARGN APPEND .cpp)
  set(objects "")
  if(TARGET vdb_offset_${name}_objects)
    vdb_offset_objects(${name} objects)
  endif()
  add_library(vdb_offset_${name}_module MODULE ${objects} ${ARGN})
  target_compile_features(vdb_offset_${name}_module PRIVATE cxx_std_20)
  target_include_directories(vdb_offset_${name}_module PRIVATE include src)
  target_link_libraries(vdb_offset_${name}_module PRIVATE OpenVDB::openvdb TBB::tbb fmt::fmt ${needs} vdb_offset_build)
  target_link_options(vdb_offset_${name}_module PRIVATE -Wl,--as-needed -Wl,-Bsymbolic-functions)
  set_target_properties(vdb_offset_${name}_module PROPERTIES OUTPUT_NAME vdb_offset_${name} PREFIX "" SUFFIX .so
    UNITY_BUILD_MODE BATCH UNITY_BUILD_BATCH_SIZE 0 LINKER_LANGUAGE CXX CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  target_precompile_headers(vdb_offset_${name}_module REUSE_FROM vdb_offset_core_objects)
  add_dependencies(vdb_offset_modules vdb_offset_${name}_module)
  install(TARGETS vdb_offset_${name}_module LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/vdb_offset)
endfunction()

# Readers: the component io opens them, in whatever program it is.
vdb_offset_folder(io/base open_module)
if(VDB_OFFSET_VTK)
  vdb_offset_folder(io/documents/vtk parse_vtk)
  vdb_offset_module(vtk_meshes "VTK::IOXML;VTK::IOLegacy" io/documents/vtk_module/module io/documents/vtk_module/read_vtk
    io/documents/vtk_module/rewrite_legacy io/documents/vtk_module/vtk_cells io/documents/vtk_module/vtk_complaint io/documents/vtk_module/vtk_document
    io/documents/vtk_module/vtk_header io/documents/trial io/mesh/document io/base/nearest_names base/rounding)
else()
  vdb_offset_folder(io/documents/vtk without_vtk)
endif()
if(VDB_OFFSET_ASSIMP)
  vdb_offset_folder(io/documents/assimp parse_by_assimp)
  vdb_offset_module(assimp "assimp::assimp" io/documents/assimp_module/module io/documents/assimp_module/read_scene
    io/documents/trial io/mesh/document base/rounding)
else()
  vdb_offset_folder(io/documents/assimp without_assimp)
endif()

# Writers: the command opens them, and other programs are linked to what they need.
if(NOT loaders)
  return()
endif()
if(VDB_OFFSET_VTK)
  vdb_offset_folder(io/volume/modules load_vtk)
  vdb_offset_module(vtk "${vtk_needs}" io/volume/modules/vtk_module io/volume/patch_words)
endif()
if(VDB_OFFSET_CGNS)
  vdb_offset_folder(io/volume/modules load_cgns)
  vdb_offset_module(cgns "${cgns_needs}" io/volume/modules/cgns_module io/volume/patch_words volume/volume_faces volume/volume_mesh)
endif()

# What the command is linked to instead of the component volume.
add_library(vdb_offset_volume_by_modules INTERFACE)
vdb_offset_objects(volume objects)
vdb_offset_objects(modules loader_objects)
target_sources(vdb_offset_volume_by_modules INTERFACE ${objects} ${loader_objects})
