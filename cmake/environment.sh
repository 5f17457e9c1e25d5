# SPDX-License-Identifier: BSD-3-Clause
#
#   . cmake/environment.sh
#
# What Harmos' programs want of a shell: one BLAS thread a rank, and an mpirun of Open MPI that runs as root, and with
# more ranks than cores, each on any core. cmake/bootstrap.sh and the tests (cmake/HarmosTest.cmake,
# tests/support/harmos_runs.py) take it from here. For sh; other launchers than Open MPI's ignore its variables.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
# The names of one release are remarked upon, or do nothing, in another.
case $(mpirun --version 2>/dev/null) in
*"(Open MPI) "[1-4].*)
  export OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_hwloc_base_binding_policy=none
  ;;
*"(Open MPI) 5."*)
  export PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe PRTE_MCA_hwloc_default_binding_policy=none
  ;;
*"(Open MPI) "*)
  export PRTE_MCA_mapby=:oversubscribe PRTE_MCA_bindto=none
  ;;
esac
