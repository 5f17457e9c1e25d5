// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_LocalInverses.hpp"
#include "Harmos_Types.hpp"

#include <vector>

namespace Harmos::feti {

class SubdomainSum;

/// What a jump costs that the boundary of one subdomain alone makes: N_s = B_sᵀMB_s for each subdomain s of
/// this rank, M = B_D S B_Dᵀ the preconditioner, of rows of equality alone.
///
/// N_s = Σ_t T_tsᵀ S_t T_ts over the subdomains t that share rows with s, T_ts = B_{D,t}ᵀB_s: the entries of
/// T meet where a row is owned, each t makes its term where its S is.
/// @param dual, preconditioner of these classes. @param mask 1 for rows of equality, 0 for others.
/// @return for each subdomain the whole matrix, column after column; rows as the boundary of its class.
/// @throws NumericalError, InternalError on all ranks. @note Collective.
/// Guarded by tests/unit/feti/test_adaptive_space.cpp.
std::vector<std::vector<double>> jumpEnergies(const std::vector<CongruenceClass>& classes,
                                              const SubdomainSum& dual, const SubdomainSum& preconditioner,
                                              const MultiVector& mask);

} // namespace Harmos::feti
