# SPDX-License-Identifier: BSD-3-Clause
# The target `doxygen`: the reference of the public headers, in doxygen/html of the build tree. Any warning fails it.
find_program(HARMOS_DOXYGEN doxygen)
if(HARMOS_DOXYGEN)
  file(MAKE_DIRECTORY "${PROJECT_BINARY_DIR}/doxygen")
  add_custom_target(
    doxygen
    COMMAND ${CMAKE_COMMAND} -E env HARMOS_DOXYGEN_OUTPUT=${PROJECT_BINARY_DIR}/doxygen ${HARMOS_DOXYGEN} docs/Doxyfile
    WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}"
    COMMENT "Reading the public headers"
    VERBATIM)
endif()
