# SPDX-License-Identifier: Apache-2.0
# CAD files: OpenCASCADE runs in a program of its own, the worker, which the component io starts, and which lies where the
# modules are. Nothing else is linked to OpenCASCADE.

vdb_offset_folder(io/documents/cad cad_messages)
if(NOT VDB_OFFSET_CAD OR VDB_OFFSET_SANITIZE_THREADS)
  vdb_offset_folder(io/documents/cad without_cad)
  return()
endif()
vdb_offset_folder(io/documents/cad cad_worker message_channel worker_process)

# Not by its CMake package, which asks for all parts of OpenCASCADE, be they installed or not.
find_path(OPENCASCADE_HEADERS Standard_Version.hxx PATH_SUFFIXES opencascade occt REQUIRED)
set(OPENCASCADE_LIBRARIES "")
foreach(name IN ITEMS TKXDESTEP TKXDEIGES TKXCAF TKLCAF TKCDF TKCAF TKSTEP TKSTEPBase TKSTEPAttr TKSTEP209 TKIGES TKXSBase TKMesh
        TKOffset TKBool TKBO TKPrim TKShHealing TKTopAlgo TKGeomAlgo TKBRep TKGeomBase TKG3d TKG2d TKMath TKernel)
  find_library(OPENCASCADE_${name} ${name} REQUIRED)
  mark_as_advanced(OPENCASCADE_${name})
  list(APPEND OPENCASCADE_LIBRARIES ${OPENCASCADE_${name}})
endforeach()
mark_as_advanced(OPENCASCADE_HEADERS)

# What the worker is made of, for the tests of its parts as well.
add_library(vdb_offset_cad_objects OBJECT)
# Those of a folder are compiled together where units are joined, for the linter too: each reads OpenCASCADE's headers anew.
function(vdb_offset_cad_folder folder)
  list(TRANSFORM ARGN PREPEND src/vdb_offset/cad/${folder}/ OUTPUT_VARIABLE sources)
  list(TRANSFORM sources APPEND .cpp)
  target_sources(vdb_offset_cad_objects PRIVATE ${sources})
  set_source_files_properties(${sources} PROPERTIES UNITY_GROUP cad_${folder})
endfunction()
vdb_offset_cad_folder(read document name_instances read_model)
vdb_offset_cad_folder(surface face_grid face_surface make_triangles offset_points)
vdb_offset_cad_folder(tessellate append_body divide_to_deflection flip_slivers orient place_on_surfaces sew_open_edges take_mesh
  tessellate)
vdb_offset_cad_folder(offset arrange build contact contract edge_curve mend_pcurve model offset_solid offset_surface place resolve
  surface_fit)
vdb_offset_cad_folder(hold held_field hold_back room smooth_edges)
vdb_offset_cad_folder(judge clearance edge_points judge parameters soup soup_crossings)
vdb_offset_cad_folder(trim cut_faces join_pieces point_in_face trim_offset)
vdb_offset_cad_folder(write assemblies blended_faces body_shape face_distances faceted offset_bodies own_process thick_solids
  write_model write_offset)
vdb_offset_cad_folder(worker guard memory_limit requests)
target_compile_features(vdb_offset_cad_objects PUBLIC cxx_std_20)
target_include_directories(vdb_offset_cad_objects PUBLIC include src)
target_include_directories(vdb_offset_cad_objects SYSTEM PUBLIC ${OPENCASCADE_HEADERS})
target_link_libraries(vdb_offset_cad_objects PUBLIC OpenVDB::openvdb ${OPENCASCADE_LIBRARIES} PRIVATE vdb_offset_build)

set(cad_expressions without_expressions)
if(VDB_OFFSET_EXPRESSIONS)
  set(cad_expressions distance_expression)
endif()
add_executable(vdb_offset_cad src/vdb_offset/cad/worker/main.cpp src/vdb_offset/mesh/${cad_expressions}.cpp $<TARGET_OBJECTS:vdb_offset_cad_objects>
  src/vdb_offset/io/documents/cad/cad_messages.cpp src/vdb_offset/io/documents/cad/message_channel.cpp)
target_include_directories(vdb_offset_cad PRIVATE include src)
target_include_directories(vdb_offset_cad SYSTEM PRIVATE ${OPENCASCADE_HEADERS})
target_link_libraries(vdb_offset_cad PRIVATE OpenVDB::openvdb ${OPENCASCADE_LIBRARIES} vdb_offset_build)
if(VDB_OFFSET_EXPRESSIONS)
  target_link_libraries(vdb_offset_cad PRIVATE muparser::muparser fmt::fmt TBB::tbb)
endif()
target_link_options(vdb_offset_cad PRIVATE -Wl,--as-needed)
foreach(target IN ITEMS vdb_offset_cad_objects vdb_offset_cad)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endforeach()
add_dependencies(vdb_offset_modules vdb_offset_cad)
install(TARGETS vdb_offset_cad RUNTIME DESTINATION ${CMAKE_INSTALL_LIBDIR}/vdb_offset)
