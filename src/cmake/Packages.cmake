# SPDX-License-Identifier: Apache-2.0
# Debian packages, one for each component of what is installed; scripts/packages makes them.
#
#   command      vdb-offset            the command, its manual page, the guides
#   development  libvdb-offset-dev     archives, headers, the CMake package, the pkg-config file
#   python       python3-vdb-offset    only where the build has it
#
# What Debian asks for and a prefix has no use for (compressed pages, copyright, changelog) is added by
# src/cmake/debian/stage.cmake.

# The guides, which try things out with the scenes.
install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT command)
install(DIRECTORY docs scenes DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT command)

# A shared library would belong into a package of its own, which nobody has asked for.
if(BUILD_SHARED_LIBS OR NOT VDB_OFFSET_FILES OR NOT CMAKE_SYSTEM_NAME STREQUAL "Linux")
  return()
endif()

set(VDB_OFFSET_MAINTAINER "vdb_offset maintainers <maintainers@vdb-offset.example>" CACHE STRING
    "Whom the Debian packages name as their maintainer: Name <address>")

get_cmake_property(installed COMPONENTS)
set(CPACK_COMPONENTS_ALL command development)
if("python" IN_LIST installed)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_SOURCE_GENERATOR "")
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
                                                WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_SOURCE_DIR}/src/cmake/debian/stage.cmake)
set(CPACK_VDB_OFFSET_SOURCE ${CMAKE_CURRENT_SOURCE_DIR})
# CPack's own word for "none": each package has a first line of its own.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_NAME} built using CMake")

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# Packed from outside, so that the project's version and that of the packing are two.
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SOURCE vdb-offset)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${VDB_OFFSET_MAINTAINER})
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(about "vdb_offset moves the vertices of a triangle or polygon mesh, or of plane
curves, by a distance, and keeps the vertices, the faces and all else that the
file has. No face of the result is inverted or collapsed, and none that did
not cross another does so.")

set(CPACK_DEBIAN_COMMAND_PACKAGE_NAME vdb-offset)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SUGGESTS parallel)
set(CPACK_DEBIAN_COMMAND_DESCRIPTION "offset meshes and plane curves and keep their topology
${about}
.
This package has the command vdb_offset, vdb_offset-batch for folders of
models, and the guides.")

# Depends: what find_package needs for the component engine alone. Those of files are small and recommended; OpenMesh is for
# one component, which few programs ask for.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libopenvdb-dev, libtbb-dev, libboost-iostreams-dev, libblosc-dev, libimath-dev, \
zlib1g-dev, libfmt-dev, libgmp-dev, libmpfr-dev, libmuparser-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "libopenmesh-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libvdb-offset-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS "libexpat1-dev, libzip-dev, libzstd-dev, pkg-config")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "offset meshes and keep their topology (C++ library)
${about}
.
This package has the library as archives, its headers, and its files for CMake
and pkg-config. The component engine needs nothing but what this package
depends on; the components files and openmesh need packages that are
recommended and suggested.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-vdb-offset)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "offset meshes and keep their topology (Python module)
${about}
.
This package has the module vdb_offset for Python 3.")
# An extension module is made for one version of Python.
if("python" IN_LIST CPACK_COMPONENTS_ALL)
  find_package(Python3 COMPONENTS Interpreter)
  math(EXPR next "${Python3_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next}), python3-numpy")
endif()

include(CPack)

# Builds what the packages hold, and packs it.
set(targets vdb_offset_command vdb_offset_man)
foreach(component IN LISTS components)
  list(APPEND targets vdb_offset_${component})
endforeach()
if(TARGET vdb_offset_python)
  list(APPEND targets vdb_offset_python)
endif()
set(VDB_OFFSET_PACKAGE_DIR ${CMAKE_CURRENT_BINARY_DIR}/packages CACHE PATH "Where vdb_offset_packages puts the Debian packages")
add_custom_target(vdb_offset_packages
  COMMAND ${CMAKE_CPACK_COMMAND} --config ${CMAKE_CURRENT_BINARY_DIR}/CPackConfig.cmake -B ${VDB_OFFSET_PACKAGE_DIR}
  DEPENDS ${targets} VERBATIM USES_TERMINAL)
