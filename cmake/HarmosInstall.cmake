# SPDX-License-Identifier: BSD-3-Clause
# What `cmake --install` and `cpack` make of Harmos beside the libraries and headers (HarmosPackage.cmake) and the
# applications: the configuration for find_package(Harmos CONFIG), and a Debian package.
include(CMakePackageConfigHelpers)

# Where hdf5.h lies among the directories that the module found.
find_path(HDF5_C_INCLUDE_DIR hdf5.h PATHS ${HDF5_C_INCLUDE_DIRS} NO_DEFAULT_PATH REQUIRED)
mark_as_advanced(HDF5_C_INCLUDE_DIR)
set(config_directory "${CMAKE_INSTALL_LIBDIR}/cmake/Harmos")
configure_package_config_file(
  cmake/HarmosConfig.cmake.in "${PROJECT_BINARY_DIR}/HarmosConfig.cmake"
  INSTALL_DESTINATION "${config_directory}"
  NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
# Before 1.0 a minor version may change any interface.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/HarmosConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(
  EXPORT HarmosTargets
  NAMESPACE Harmos::
  DESTINATION "${config_directory}"
  COMPONENT development)
install(
  FILES "${PROJECT_BINARY_DIR}/HarmosConfig.cmake" "${PROJECT_BINARY_DIR}/HarmosConfigVersion.cmake"
        cmake/HarmosDependencies.cmake
  DESTINATION "${config_directory}"
  COMPONENT development)
install(FILES LICENSE README.md DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT development)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME harmos)
set(CPACK_PACKAGE_CONTACT "the Harmos project <harmos@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_PACKAGING_INSTALL_PREFIX "/usr")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# Shared libraries that the applications need, by dpkg-shlibdeps; what a build against the libraries needs is
# cmake/packages-debian.txt.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# All tools want python3. What pictures need besides is of no use on a node that only computes; harmos-plot names what is
# missing.
set(CPACK_DEBIAN_PACKAGE_DEPENDS "openmpi-bin, python3")
# Gmsh is loaded when a file wants it; dpkg-shlibdeps does not see it.
find_program(HARMOS_DPKG_QUERY dpkg-query)
if(HARMOS_ENABLE_GMSH AND HARMOS_DPKG_QUERY)
  get_filename_component(gmsh "${GMSH_LIBRARY}" REALPATH)
  execute_process(COMMAND ${HARMOS_DPKG_QUERY} --search "${gmsh}" OUTPUT_VARIABLE owner ERROR_QUIET)
  if(owner MATCHES "^([^:]+):")
    string(APPEND CPACK_DEBIAN_PACKAGE_DEPENDS ", ${CMAKE_MATCH_1}")
  endif()
endif()
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-h5py, python3-matplotlib, python3-numpy, python3-vtk9")
file(STRINGS cmake/packages-debian.txt packages REGEX "^lib.*-dev")
list(TRANSFORM packages REPLACE " [?]$" "")
list(REMOVE_ITEM packages libgtest-dev libcli11-dev)
list(JOIN packages ", " CPACK_DEBIAN_PACKAGE_SUGGESTS)
include(CPack)
