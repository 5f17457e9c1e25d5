// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Teuchos_Comm.hpp>

#include <string>
#include <vector>

namespace Harmos::run {

/// What one rank had to do with a run.
struct RankShare {
  long long subdomains = 0;
  long long primalDimension = 0;
  double dualOperatorMiB = 0.0;
  double peakMemoryMiB = 0.0;
  std::vector<double> seconds; ///< of each stage
};

/// ranks.csv: a line a rank, with the host that it ran on; written by rank 0, whole or not at all.
/// @param stages of RankShare::seconds. @throws InputError on all ranks. @note Collective.
/// Guarded by tests/regression/test_checkpoint.py.
void writeRankTable(const Teuchos::Comm<int>& comm, const std::string& path,
                    const std::vector<std::string>& stages, const RankShare& share);

} // namespace Harmos::run
