# SPDX-License-Identifier: BSD-3-Clause
find_package(GTest REQUIRED)
# Debian's own interpreter first: it is the one that sees Debian's python3-* packages.
find_program(
  HARMOS_PYTHON
  NAMES python3
  PATHS /usr/bin
  NO_DEFAULT_PATH)
if(NOT HARMOS_PYTHON)
  find_program(HARMOS_PYTHON NAMES python3 REQUIRED)
endif()

# What every test needs: the variables that cmake/environment.sh sets in an empty environment.
execute_process(
  COMMAND env -i "PATH=$ENV{PATH}" sh -c ". ./environment.sh && env | grep -E '^(OMP|OPENBLAS|OMPI|PRTE)_'"
  WORKING_DIRECTORY "${CMAKE_CURRENT_LIST_DIR}"
  OUTPUT_VARIABLE HARMOS_TEST_ENVIRONMENT
  OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE "\n" ";" HARMOS_TEST_ENVIRONMENT "${HARMOS_TEST_ENVIRONMENT}")
# Ranks that wait give their core to another test's.
list(APPEND HARMOS_TEST_ENVIRONMENT "OMPI_MCA_mpi_yield_when_idle=1" "PMIX_MCA_gds=hash")

# harmos_add_test(NAME <name> SOURCES <files> LIBRARIES <targets> [RANKS <n>...] [LONG_RANKS <n>...] [LABELS <l>...])
#
# One executable, registered once for each number of ranks as <name>_np<n>; with LONG_RANKS the test is long.
function(harmos_add_test)
  cmake_parse_arguments(ARG "" "NAME" "SOURCES;LIBRARIES;RANKS;LONG_RANKS;LABELS" ${ARGN})
  if(NOT ARG_RANKS)
    set(ARG_RANKS 1)
  endif()
  add_executable(${ARG_NAME} ${ARG_SOURCES})
  set_target_properties(${ARG_NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/tests/bin")
  target_link_libraries(${ARG_NAME} PRIVATE ${ARG_LIBRARIES} harmos_test_support harmos_setup_flags)
  target_precompile_headers(${ARG_NAME} REUSE_FROM harmos_test_support)
  # Each file of a unit test has a namespace of its own, so that several may be compiled at once.
  set_target_properties(${ARG_NAME} PROPERTIES UNITY_BUILD ${HARMOS_UNITY_BUILD} UNITY_BUILD_BATCH_SIZE 12)
  foreach(ranks IN LISTS ARG_RANKS ARG_LONG_RANKS)
    set(labels ${ARG_LABELS})
    if(ranks IN_LIST ARG_LONG_RANKS)
      list(APPEND labels long)
    endif()
    # One rank needs no launcher, which takes longer than many a test.
    set(launcher ${MPIEXEC_EXECUTABLE} ${MPIEXEC_NUMPROC_FLAG} ${ranks})
    if(ranks EQUAL 1)
      set(launcher)
    endif()
    add_test(NAME ${ARG_NAME}_np${ranks} COMMAND ${launcher} $<TARGET_FILE:${ARG_NAME}>)
    set_tests_properties(
      ${ARG_NAME}_np${ranks} PROPERTIES ENVIRONMENT "${HARMOS_TEST_ENVIRONMENT}" LABELS "${labels}"
                                        PROCESSORS ${ranks} TIMEOUT 300)
  endforeach()
endfunction()

# harmos_add_script_test(NAME <name> SCRIPT <file.py> [ARGUMENTS <a>...] [LABELS <l>...] [TIMEOUT <s>]
#                        [PROCESSORS <n>])
#
# A Python test of whole programs. Exit status 77 is shown as SKIPPED: a dependency is missing. Runs that name no number of
# ranks take two, or one where HARMOS_SCRIPT_RANKS is 1 and the script is not long. A script takes one processor by
# default, though: while it reads, compiles or draws, another's ranks work. Scripts that kill runs or compare times take
# two.
function(harmos_add_script_test)
  cmake_parse_arguments(ARG "" "NAME;SCRIPT;TIMEOUT;PROCESSORS" "ARGUMENTS;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(NOT ARG_PROCESSORS)
    set(ARG_PROCESSORS 1)
  endif()
  set(ranks 2)
  if(DEFINED HARMOS_SCRIPT_RANKS AND NOT "long" IN_LIST ARG_LABELS)
    set(ranks ${HARMOS_SCRIPT_RANKS})
  endif()
  add_test(NAME ${ARG_NAME} COMMAND ${HARMOS_PYTHON} ${CMAKE_CURRENT_SOURCE_DIR}/${ARG_SCRIPT}
                                    ${ARG_ARGUMENTS})
  set_tests_properties(
    ${ARG_NAME}
    PROPERTIES ENVIRONMENT
               "${HARMOS_TEST_ENVIRONMENT};HARMOS_SOURCE_DIR=${PROJECT_SOURCE_DIR};HARMOS_BINARY_DIR=${PROJECT_BINARY_DIR};HARMOS_MPIEXEC=${MPIEXEC_EXECUTABLE};HARMOS_DEFAULT_RANKS=${ranks};PYTHONDONTWRITEBYTECODE=1"
               LABELS "${ARG_LABELS}"
               SKIP_RETURN_CODE 77
               PROCESSORS ${ARG_PROCESSORS}
               TIMEOUT ${ARG_TIMEOUT})
endfunction()
