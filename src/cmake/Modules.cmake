# SPDX-License-Identifier: Apache-2.0
# Modules that the command opens when a file of theirs is asked for, so that it does not load VTK and CGNS in every run.

file(RELATIVE_PATH VDB_OFFSET_MODULES ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR}/vdb_offset)

# vdb_offset_module(NAME NEEDS SOURCES...): the objects of NAME, and copies of what they need of the library. No archive: its one
# object would come whole.
function(vdb_offset_module name needs)
  list(TRANSFORM ARGN PREPEND src/vdb_offset/)
  list(TRANSFORM ARGN APPEND .cpp)
  vdb_offset_objects(${name} objects)
  add_library(vdb_offset_${name}_module MODULE ${objects} ${ARGN})
  target_compile_features(vdb_offset_${name}_module PRIVATE cxx_std_20)
  target_include_directories(vdb_offset_${name}_module PRIVATE include src)
  target_link_libraries(vdb_offset_${name}_module PRIVATE OpenVDB::openvdb TBB::tbb fmt::fmt ${needs} vdb_offset_build)
  target_link_options(vdb_offset_${name}_module PRIVATE -Wl,--as-needed -Wl,-Bsymbolic-functions)
  set_target_properties(vdb_offset_${name}_module PROPERTIES OUTPUT_NAME vdb_offset_${name} PREFIX "" SUFFIX .so UNITY_BUILD OFF
    LINKER_LANGUAGE CXX CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  add_dependencies(vdb_offset_command vdb_offset_${name}_module)
  install(TARGETS vdb_offset_${name}_module LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/vdb_offset)
endfunction()

vdb_offset_folder(io/volume/modules open_module)
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
target_link_libraries(vdb_offset_volume_by_modules INTERFACE ${CMAKE_DL_LIBS})
target_compile_definitions(vdb_offset_modules_objects PRIVATE VDB_OFFSET_MODULES="${VDB_OFFSET_MODULES}")
