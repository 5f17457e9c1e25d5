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

/// V with VVᵀ = WN(NᵀWN)⁻¹NᵀW, W the diagonal of the matrix: what makes A + VVᵀ definite and its inverse a
/// generalised inverse of A, for any V with NᵀV regular (Brzobohatý, Dostál, Kozubek, Kovář, Markopoulos:
/// Cholesky decomposition with fixing nodes to stable computation of a generalized inverse, Int. J. Numer.
/// Meth. Engng. 88, 2011, with W = ρI). Weighted, because ρ as large as the stiffest entry would wipe out the
/// digits of soft ones.
/// @param rows N: the kernel at the dofs that hold it. @param diagonal of A there.
/// @throws NumericalError if the kernel is not determined by its rows at these dofs.
Kernel regularization(const Kernel& rows, const std::vector<double>& diagonal);

/// V of a matrix's fixing dofs. @throws NumericalError as above.
Kernel regularizationAt(const LocalMatrix& matrix, const Kernel& kernel, const std::vector<int>& fixing);
/// K_ρ = K + VVᵀ, of that.
LocalMatrix withRegularization(const LocalMatrix& matrix, const Kernel& v, const std::vector<int>& fixing);
/// The regularised matrix K_ρ. @throws NumericalError as above.
LocalMatrix regularized(const LocalMatrix& matrix, const Kernel& kernel, const std::vector<int>& fixing);

} // namespace Harmos::feti
