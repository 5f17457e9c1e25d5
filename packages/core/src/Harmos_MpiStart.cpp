// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MpiStart.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <mpi.h>

namespace Harmos {
namespace {

#ifdef OPEN_MPI

bool isSet(const char* name) {
  return std::getenv(name) != nullptr;
}

// By any launcher that Open MPI knows, or within a job of a batch system that may be one.
bool isLaunched() {
  constexpr std::array<const char*, 9> names = {
      "OMPI_COMM_WORLD_SIZE", "PMIX_RANK",   "PMIX_NAMESPACE", "PMI_RANK",      "PMI_FD",
      "SLURM_PROCID",         "ALPS_APP_PE", "PBS_JOBID",      "FLUX_TASK_RANK"};
  return std::any_of(names.begin(), names.end(), isSet);
}

bool isOnOneMachine() {
  const char* all = std::getenv("OMPI_COMM_WORLD_SIZE");
  const char* here = std::getenv("OMPI_COMM_WORLD_LOCAL_SIZE");
  return all != nullptr && here != nullptr && std::strcmp(all, here) == 0;
}

void propose(const char* name, const char* value) {
  constexpr int overwrite = 0;
  setenv(name, value, overwrite); // NOLINT(concurrency-mt-unsafe): before MPI and threads
}

#endif

} // namespace

void prepareMpiStart() {
#ifdef OPEN_MPI
  const bool alone = !isLaunched();
  if (!alone && !isOnOneMachine())
    return;
  if (alone) {
    propose("OMPI_MCA_ess_singleton_isolated", "1");
    // Else all programs without a daemon share one directory, and the first that ends removes it for those
    // that begin.
    propose("OMPI_MCA_orte_create_session_dirs", "0");
    // It would keep the file pointers that ranks share in that directory; there are none.
    propose("OMPI_MCA_sharedfp", "^sm");
  }
  if (isSet("OMPI_MCA_pml") || isSet("OMPI_MCA_mtl") || isSet("OMPI_MCA_btl"))
    return;
  propose("OMPI_MCA_pml", "ob1");
  propose("OMPI_MCA_btl", OMPI_MAJOR_VERSION < 5 ? "self,vader" : "self,sm");
#endif
}

} // namespace Harmos
