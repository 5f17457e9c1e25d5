// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Kernel.hpp"
#include "Harmos_LocalMatrix.hpp"

#include <vector>

namespace Harmos::feti {

/// Dofs at which a kernel is held: places spread over the subdomain by farthest-first traversal of the matrix
/// graph, at each the dofs that hold motions of their own (one for a scalar kernel, the components of a
/// displacement for an elastic one).
///
/// Each next place is the one farthest, in edges of the graph, from those chosen, beginning with one that is
/// far from dof 0; deterministic. Places are added beyond the wanted number until the smallest singular value
/// of the kernel's rows there is a tenth of what evenly spread dofs would give: three places at least that
/// are not on a line for a solid.
/// @param kernel with orthonormal columns. @return rising.
std::vector<int> fixingDofs(const LocalMatrix& matrix, const Kernel& kernel, int places);

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
