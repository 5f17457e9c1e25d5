// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_SubdomainSystem.hpp"

#include <vector>

namespace Harmos::feti {

/// In which inner product the rows of B are made orthonormal.
enum class RowWeights {
  None,     ///< BBᵀ = I at gluing rows
  Stiffness ///< BD⁻¹Bᵀ = I there, D the diagonal of K: soft copies give way to stiff ones
};

/// By how much stiffness jumps: the largest over the smallest mean of the diagonal of K at the interfaces of
/// subdomains; or, if that is more, a tenth of the largest over the smallest entry at one interface, since
/// corners and sizes of cells do some of that. @note Collective.
double stiffnessContrast(const SubdomainSystem& system);

/// By how much rows that give way change the diagonal of F: 1 + c k, c the largest compliance of this rank's
/// share of the rows or any other's, k the mean of the diagonal of K at the interfaces. One where none does.
/// @note Collective.
double complianceContrast(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows);

namespace Details {
/// By which copies and rows are weighted.
struct Weights {
  std::vector<std::vector<double>> ofDofs; ///< of the interface dofs of each subdomain; none without weights
  double unit = 0.0;                       ///< the stiffness that a weight of one stands for
};

/// One over the mean of the diagonal of K at interface dofs. @note Collective.
double meanSoftness(const SubdomainSystem& system);

/// The diagonal of K at interface dofs, relative to the smallest. @note Collective.
Weights stiffnessWeights(const SubdomainSystem& system);
} // namespace Details

} // namespace Harmos::feti
