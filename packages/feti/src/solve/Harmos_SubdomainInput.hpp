// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DirectSolver.hpp"
#include "Harmos_SubdomainSystem.hpp"

#include <memory>
#include <vector>

namespace Harmos::feti {

/// A copy of an application's compressed rows: whole, also of a symmetric matrix; columns in any order.
/// @param offsets rows + 1 of them. @throws InputError for offsets that fall or columns out of range.
template<class Offset>
std::shared_ptr<const LocalMatrix> localMatrix(int rows, const Offset* offsets, const int* columns,
                                               const double* values);

/// A copy of a rank's own Tpetra matrix, by its local rows and columns: on MPI_COMM_SELF, or any whose
/// columns are its rows in the same order. @throws InputError if it has columns that are no rows.
std::shared_ptr<const LocalMatrix> localMatrix(const CrsMatrix& matrix);

/// A subdomain all of whose dofs have global numbers; which of them are shared with others is found out.
///
/// Numbers may have gaps. Where interiors are large and known, naming the interface alone (Subdomain) makes
/// the set-up cheaper.
/// @param number 0, 1, ... over all ranks. @param load a value a row. @param dofs a global number a row.
/// @param motions the kernel of the matrix without boundary conditions: constantKernel(), rigidBodyKernel()
/// of
///        coordinates, or an application's own. @param fixed by local dof.
/// @throws InputError if lengths differ.
Subdomain makeSubdomain(long long number, std::shared_ptr<const LocalMatrix> stiffness,
                        std::vector<double> load, std::vector<long long> dofs, Kernel motions,
                        std::vector<FixedDof> fixed = {});

} // namespace Harmos::feti
