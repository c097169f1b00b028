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
set(cad_sources read/document read/name_instances read/read_model surface/face_surface surface/offset_points tessellate/append_body
  tessellate/divide_to_deflection tessellate/flip_slivers tessellate/orient tessellate/place_on_surfaces
  tessellate/sew_open_edges tessellate/take_mesh tessellate/tessellate
  offset/arrange offset/build offset/contact offset/contract offset/edge_curve offset/mend_pcurve offset/model offset/offset_solid
  offset/offset_surface offset/place offset/resolve offset/surface_fit
  hold/held_field hold/hold_back hold/room hold/smooth_edges
  judge/clearance judge/edge_points judge/judge judge/parameters judge/soup judge/soup_crossings
  trim/cut_faces trim/join_pieces trim/point_in_face trim/trim_offset
  write/assemblies write/blended_faces write/body_shape write/face_distances write/faceted write/offset_bodies write/own_process
  write/thick_solids write/write_model write/write_offset
  worker/guard worker/memory_limit worker/requests)
list(TRANSFORM cad_sources PREPEND src/vdb_offset/cad/)
list(TRANSFORM cad_sources APPEND .cpp)
target_sources(vdb_offset_cad_objects PRIVATE ${cad_sources})
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
  set_target_properties(${target} PROPERTIES UNITY_BUILD OFF CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endforeach()
add_dependencies(vdb_offset_modules vdb_offset_cad)
install(TARGETS vdb_offset_cad RUNTIME DESTINATION ${CMAKE_INSTALL_LIBDIR}/vdb_offset)
