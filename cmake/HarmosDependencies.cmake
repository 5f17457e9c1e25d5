# SPDX-License-Identifier: BSD-3-Clause
# Imports what Harmos stands on as targets of the namespace harmos_dep:: . Read by Harmos' own build and, installed,
# by HarmosConfig.cmake, so that both find the same things in the same way.
#
# Trilinos 13 exports variables and targets without include directories, Trilinos 14 and later
# exports complete targets `<Package>::all_libs`: both are wrapped here and nowhere else. Headers of Trilinos 16
# (Amesos2, Thyra, MueLu) still include those of Epetra, each of which has a #warning that Epetra is deprecated: with
# -Werror nothing would compile, and SYSTEM does not silence it.

# C++ alone: applications that find Harmos need not enable C, though MUMPS and HDF5 are C libraries.
find_package(MPI REQUIRED COMPONENTS CXX)

function(harmos_import_trilinos name)
  foreach(package IN LISTS ARGN)
    find_package(${package} CONFIG REQUIRED)
    set(${package}_VERSION ${${package}_VERSION} PARENT_SCOPE)
  endforeach()
  add_library(harmos_dep::${name} INTERFACE IMPORTED GLOBAL)
  foreach(package IN LISTS ARGN)
    if(TARGET ${package}::all_libs)
      target_link_libraries(harmos_dep::${name} INTERFACE ${package}::all_libs)
      target_compile_options(harmos_dep::${name} INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-cpp>)
    else()
      # Include directories of imported targets are SYSTEM: our warning flags are not for other people's headers.
      target_link_libraries(harmos_dep::${name} INTERFACE ${${package}_LIBRARIES} ${${package}_TPL_LIBRARIES})
      target_include_directories(harmos_dep::${name} INTERFACE ${${package}_INCLUDE_DIRS}
                                                               ${${package}_TPL_INCLUDE_DIRS})
    endif()
  endforeach()
  target_link_libraries(harmos_dep::${name} INTERFACE MPI::MPI_CXX)
endfunction()

# harmos_import(<name> INCLUDE <directories> LIBRARIES <libraries>)
function(harmos_import name)
  cmake_parse_arguments(ARG "" "" "INCLUDE;LIBRARIES" ${ARGN})
  add_library(harmos_dep::${name} INTERFACE IMPORTED GLOBAL)
  target_link_libraries(harmos_dep::${name} INTERFACE ${ARG_LIBRARIES})
  target_include_directories(harmos_dep::${name} INTERFACE ${ARG_INCLUDE})
endfunction()

# harmos_find_dependencies(<name>...): each as harmos_dep::<name>, once.
macro(harmos_find_dependencies)
  foreach(harmos_dependency ${ARGN})
    if(TARGET harmos_dep::${harmos_dependency})
      continue()
    endif()
    if(harmos_dependency STREQUAL "teuchos")
      harmos_import_trilinos(teuchos Teuchos)
    elseif(harmos_dependency STREQUAL "tpetra")
      harmos_import_trilinos(tpetra Tpetra Belos)
    elseif(harmos_dependency STREQUAL "amesos2")
      harmos_import_trilinos(amesos2 Amesos2)
    elseif(harmos_dependency STREQUAL "thyra")
      harmos_import_trilinos(thyra Thyra Stratimikos)
    elseif(harmos_dependency STREQUAL "intrepid2")
      harmos_import_trilinos(intrepid2 Intrepid2 Shards)
    elseif(harmos_dependency STREQUAL "muelu")
      harmos_import_trilinos(muelu MueLu Ifpack2)
    elseif(harmos_dependency STREQUAL "rol")
      harmos_import_trilinos(rol ROL)
    elseif(harmos_dependency STREQUAL "mumps")
      # Double and single precision, parallel build.
      find_path(MUMPS_INCLUDE_DIR dmumps_c.h REQUIRED)
      find_library(MUMPS_DMUMPS_LIBRARY dmumps REQUIRED)
      find_library(MUMPS_SMUMPS_LIBRARY smumps REQUIRED)
      find_library(MUMPS_COMMON_LIBRARY mumps_common REQUIRED)
      harmos_import(
        mumps
        INCLUDE ${MUMPS_INCLUDE_DIR}
        LIBRARIES ${MUMPS_DMUMPS_LIBRARY} ${MUMPS_SMUMPS_LIBRARY} ${MUMPS_COMMON_LIBRARY} MPI::MPI_CXX)
    elseif(harmos_dependency STREQUAL "metis")
      find_path(METIS_INCLUDE_DIR metis.h REQUIRED)
      find_library(METIS_LIBRARY metis REQUIRED)
      harmos_import(metis INCLUDE ${METIS_INCLUDE_DIR} LIBRARIES ${METIS_LIBRARY})
    elseif(harmos_dependency STREQUAL "zlib")
      find_path(ZLIB_INCLUDE_DIR zlib.h REQUIRED)
      find_library(ZLIB_LIBRARY z REQUIRED)
      harmos_import(zlib INCLUDE ${ZLIB_INCLUDE_DIR} LIBRARIES ${ZLIB_LIBRARY})
    elseif(harmos_dependency STREQUAL "exodus")
      find_path(EXODUS_INCLUDE_DIR exodusII.h REQUIRED)
      find_library(EXODUS_LIBRARY NAMES exoIIv2c exodus REQUIRED)
      harmos_import(exodus INCLUDE ${EXODUS_INCLUDE_DIR} LIBRARIES ${EXODUS_LIBRARY})
    elseif(harmos_dependency STREQUAL "hdf5")
      # CMake's module compiles a program in C. A project without C takes the HDF5 that Harmos was built with.
      get_property(harmos_languages GLOBAL PROPERTY ENABLED_LANGUAGES)
      if("C" IN_LIST harmos_languages)
        set(HDF5_PREFER_PARALLEL ON)
        find_package(HDF5 REQUIRED COMPONENTS C)
      elseif(EXISTS "${Harmos_HDF5_INCLUDE_DIR}/hdf5.h")
        set(HDF5_C_INCLUDE_DIRS "${Harmos_HDF5_INCLUDE_DIR}")
        set(HDF5_C_LIBRARIES "${Harmos_HDF5_LIBRARIES}")
        set(HDF5_IS_PARALLEL TRUE)
      else()
        message(
          FATAL_ERROR
            "The HDF5 that Harmos was built with is not in \"${Harmos_HDF5_INCLUDE_DIR}\"; enable the language C, so "
            "that CMake can look for another one: project(... LANGUAGES C CXX).")
      endif()
      if(NOT HDF5_IS_PARALLEL)
        message(
          FATAL_ERROR
            "Harmos writes its results with parallel HDF5, but the HDF5 that was found (${HDF5_INCLUDE_DIRS}) is "
            "serial. Install libhdf5-openmpi-dev or set HDF5_ROOT.")
      endif()
      harmos_import(hdf5 INCLUDE ${HDF5_C_INCLUDE_DIRS} LIBRARIES ${HDF5_C_LIBRARIES} MPI::MPI_CXX)
    elseif(harmos_dependency STREQUAL "json")
      find_package(nlohmann_json CONFIG REQUIRED)
      harmos_import(json LIBRARIES nlohmann_json::nlohmann_json)
    else()
      message(FATAL_ERROR "Harmos does not know the dependency ${harmos_dependency}")
    endif()
  endforeach()
endmacro()
