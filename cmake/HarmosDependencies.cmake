# SPDX-License-Identifier: BSD-3-Clause
# Imports what Harmos stands on as targets of the namespace harmos_dep:: .
#
# Trilinos 13 exports variables and targets without include directories, Trilinos 14 and later
# exports complete targets `<Package>::all_libs`: both are wrapped here and nowhere else.

find_package(MPI REQUIRED COMPONENTS C CXX)

function(harmos_import_trilinos name)
  if(TARGET harmos_dep::${name})
    return()
  endif()
  add_library(harmos_dep_${name} INTERFACE)
  add_library(harmos_dep::${name} ALIAS harmos_dep_${name})
  foreach(package IN LISTS ARGN)
    find_package(${package} CONFIG REQUIRED)
    if(TARGET ${package}::all_libs)
      target_link_libraries(harmos_dep_${name} INTERFACE ${package}::all_libs)
    else()
      target_link_libraries(harmos_dep_${name} INTERFACE ${${package}_LIBRARIES}
                                                         ${${package}_TPL_LIBRARIES})
      # SYSTEM: our warning flags are not for other people's headers.
      target_include_directories(
        harmos_dep_${name} SYSTEM INTERFACE ${${package}_INCLUDE_DIRS}
                                            ${${package}_TPL_INCLUDE_DIRS})
    endif()
  endforeach()
  target_link_libraries(harmos_dep_${name} INTERFACE MPI::MPI_CXX)
endfunction()

harmos_import_trilinos(teuchos Teuchos)
harmos_import_trilinos(tpetra Tpetra Belos)
harmos_import_trilinos(amesos2 Amesos2)
harmos_import_trilinos(intrepid2 Intrepid2 Shards)
if(HARMOS_ENABLE_TESTS)
  harmos_import_trilinos(muelu MueLu Ifpack2)
endif()

# MUMPS (double and single precision, parallel build).
find_path(MUMPS_INCLUDE_DIR dmumps_c.h REQUIRED)
find_library(MUMPS_DMUMPS_LIBRARY dmumps REQUIRED)
find_library(MUMPS_SMUMPS_LIBRARY smumps REQUIRED)
find_library(MUMPS_COMMON_LIBRARY mumps_common REQUIRED)
add_library(harmos_dep_mumps INTERFACE)
add_library(harmos_dep::mumps ALIAS harmos_dep_mumps)
target_link_libraries(harmos_dep_mumps INTERFACE ${MUMPS_DMUMPS_LIBRARY} ${MUMPS_SMUMPS_LIBRARY} ${MUMPS_COMMON_LIBRARY}
                                                 MPI::MPI_C)
target_include_directories(harmos_dep_mumps SYSTEM INTERFACE ${MUMPS_INCLUDE_DIR})

# METIS.
find_path(METIS_INCLUDE_DIR metis.h REQUIRED)
find_library(METIS_LIBRARY metis REQUIRED)
add_library(harmos_dep_metis INTERFACE)
add_library(harmos_dep::metis ALIAS harmos_dep_metis)
target_link_libraries(harmos_dep_metis INTERFACE ${METIS_LIBRARY})
target_include_directories(harmos_dep_metis SYSTEM INTERFACE ${METIS_INCLUDE_DIR})

# Gmsh.
if(HARMOS_ENABLE_GMSH)
  find_path(GMSH_INCLUDE_DIR gmsh.h REQUIRED)
  find_library(GMSH_LIBRARY gmsh REQUIRED)
  add_library(harmos_dep_gmsh INTERFACE)
  add_library(harmos_dep::gmsh ALIAS harmos_dep_gmsh)
  target_link_libraries(harmos_dep_gmsh INTERFACE ${GMSH_LIBRARY})
  target_include_directories(harmos_dep_gmsh SYSTEM INTERFACE ${GMSH_INCLUDE_DIR})
endif()

# HDF5 with MPI.
set(HDF5_PREFER_PARALLEL ON)
find_package(HDF5 REQUIRED COMPONENTS C)
if(NOT HDF5_IS_PARALLEL)
  message(FATAL_ERROR "Harmos writes its results with parallel HDF5, but the HDF5 that was found "
                      "(${HDF5_INCLUDE_DIRS}) is serial. Install libhdf5-openmpi-dev or set HDF5_ROOT.")
endif()
add_library(harmos_dep_hdf5 INTERFACE)
add_library(harmos_dep::hdf5 ALIAS harmos_dep_hdf5)
target_link_libraries(harmos_dep_hdf5 INTERFACE ${HDF5_C_LIBRARIES} MPI::MPI_C)
target_include_directories(harmos_dep_hdf5 SYSTEM INTERFACE ${HDF5_C_INCLUDE_DIRS})

find_package(nlohmann_json CONFIG REQUIRED)
if(HARMOS_ENABLE_APPS)
  find_package(CLI11 CONFIG REQUIRED)
endif()
