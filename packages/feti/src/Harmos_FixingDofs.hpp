// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Kernel.hpp"
#include "Harmos_LocalMatrix.hpp"

#include <vector>

namespace Harmos::feti {

/// Dofs spread over a subdomain, at which its kernel is held: the farthest-first traversal of the matrix
/// graph.
///
/// Each next dof is the one farthest, in edges of the graph, from those chosen, beginning with one that is
/// far from dof 0; deterministic. @param count how many; all dofs if there are fewer.
std::vector<int> fixingDofs(const LocalMatrix& matrix, int count);

/// The regularised matrix K_ρ = K + ρ N(NᵀN)⁻¹Nᵀ, N the rows of the kernel at the fixing dofs, zero
/// elsewhere.
///
/// K_ρ is positive definite and K_ρ⁻¹ a generalised inverse of K: K K_ρ⁻¹ K = K, for any ρ > 0 (Brzobohatý,
/// Dostál, Kozubek, Kovář, Markopoulos: Cholesky decomposition with fixing nodes to stable computation of a
/// generalized inverse, Int. J. Numer. Meth. Engng. 88, 2011). ρ is the largest diagonal entry of K, so that
/// K_ρ is not worse conditioned than need be.
/// @throws NumericalError if the kernel is not determined by its rows at the fixing dofs.
LocalMatrix regularized(const LocalMatrix& matrix, const Kernel& kernel, const std::vector<int>& fixing);

} // namespace Harmos::feti
