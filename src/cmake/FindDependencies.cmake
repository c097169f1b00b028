# The packages that vdb_offset needs, for its own build and for those who link the installed library.
# Debian keeps OpenVDB's find module beside its other files, not on CMake's module path.
find_path(OPENVDB_MODULE_DIR FindOpenVDB.cmake PATH_SUFFIXES cmake/OpenVDB lib/cmake/OpenVDB
          PATHS /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE} /usr/local)
mark_as_advanced(OPENVDB_MODULE_DIR)
if(OPENVDB_MODULE_DIR)
  list(APPEND CMAKE_MODULE_PATH ${OPENVDB_MODULE_DIR})
endif()
# For volume meshes. Before OpenVDB, whose module for TBB makes targets that VTK's own would trip over.
set(vtk_components CommonCore CommonDataModel CommonMisc IOXML)
if(VDB_OFFSET_TESTS)
  list(APPEND vtk_components FiltersVerdict)
endif()
find_package(VTK 9.1 REQUIRED COMPONENTS ${vtk_components})
find_package(TBB 2021 REQUIRED)
find_package(OpenVDB 10 REQUIRED COMPONENTS openvdb)
find_package(OpenMesh REQUIRED)
find_package(fmt REQUIRED)
# CGAL is headers alone; its exact numbers need these two.
find_path(CGAL_HEADERS CGAL/Exact_predicates_inexact_constructions_kernel.h REQUIRED)
find_library(GMP_LIBRARY gmp REQUIRED)
find_library(MPFR_LIBRARY mpfr REQUIRED)
# For compressed meshes.
find_package(ZLIB REQUIRED)
find_library(ZSTD_LIBRARY zstd REQUIRED)
# For drawings.
find_package(EXPAT REQUIRED)
find_package(nlohmann_json 3 REQUIRED)
# For volume meshes.
find_path(CGNS_HEADERS cgnslib.h REQUIRED)
find_library(CGNS_LIBRARY cgns REQUIRED)
# For distances that are expressions.
find_package(muparser 2.3 REQUIRED)
if(VDB_OFFSET_TOOLS)
  find_package(CLI11 2 REQUIRED)
endif()
