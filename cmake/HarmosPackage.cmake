# SPDX-License-Identifier: BSD-3-Clause

# Compiler flags of Harmos' own code.
add_library(harmos_flags INTERFACE)
target_compile_options(harmos_flags INTERFACE -Wall -Wextra -Wshadow -Wconversion)
if(HARMOS_WARNINGS_AS_ERRORS)
  target_compile_options(harmos_flags INTERFACE -Werror)
endif()
if(HARMOS_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # A batch includes its sources, whose unnamed namespaces GCC then takes for those of a header.
  target_compile_options(harmos_flags INTERFACE -Wno-subobject-linkage)
endif()
if(HARMOS_ENABLE_NATIVE)
  target_compile_options(harmos_flags INTERFACE -O3 -march=native)
endif()

# Options, reports, decks and programs run once and take microseconds: -O1 shortens their compilation by a third.
# Numerical packages keep the flags of the build type.
add_library(harmos_setup_flags INTERFACE)
target_link_libraries(harmos_setup_flags INTERFACE harmos_flags)
target_compile_options(harmos_setup_flags INTERFACE $<$<CONFIG:Release>:-O1>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # At -O1 GCC 12 takes values of std::optional that are never read for uninitialised.
  target_compile_options(harmos_setup_flags INTERFACE $<$<CONFIG:Release>:-Wno-maybe-uninitialized>)
endif()

# harmos_add_package(<name> SOURCES <files> [FOLDERS <f>...] [INTERNAL <headers>...] [PUBLIC <targets>]
#                    [PRIVATE <targets>] [SETUP])
#
# Makes the library harmos_<name>, known to others as Harmos::<name>, and installs it with its headers. Headers lie in
# src and in its FOLDERS; they are included and installed by their names alone, so that a file may move from folder to
# folder. INTERNAL: Harmos_<header>.hpp is not installed. SETUP: there are no kernels among the sources, see
# harmos_setup_flags.
function(harmos_add_package name)
  cmake_parse_arguments(ARG "SETUP" "" "SOURCES;FOLDERS;INTERNAL;PUBLIC;PRIVATE" ${ARGN})
  set(flags harmos_flags)
  if(ARG_SETUP)
    set(flags harmos_setup_flags)
  endif()
  add_library(harmos_${name} ${ARG_SOURCES})
  add_library(Harmos::${name} ALIAS harmos_${name})
  list(TRANSFORM ARG_FOLDERS PREPEND src/ OUTPUT_VARIABLE folders)
  set(internal "")
  foreach(header IN LISTS ARG_INTERNAL)
    list(APPEND internal PATTERN "Harmos_${header}.hpp" EXCLUDE)
  endforeach()
  foreach(directory IN ITEMS src LISTS folders)
    target_include_directories(harmos_${name} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/${directory}>)
    set(below "")
    foreach(folder IN LISTS folders)
      if(directory STREQUAL "src") # folders are installed by themselves
        list(APPEND below REGEX "/packages/${name}/${folder}$" EXCLUDE)
      endif()
    endforeach()
    install(
      DIRECTORY ${directory}/
      DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/harmos
      COMPONENT development
      FILES_MATCHING
      PATTERN "Harmos_*.hpp" ${internal} ${below})
  endforeach()
  target_include_directories(harmos_${name} PUBLIC $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/harmos>)
  target_compile_features(harmos_${name} PUBLIC cxx_std_17)
  target_link_libraries(harmos_${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:${flags}>)
  set_target_properties(harmos_${name} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS harmos_${name} EXPORT HarmosTargets COMPONENT development)
endfunction()
