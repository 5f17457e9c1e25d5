// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Types.hpp"

#include <Amesos2_Solver_decl.hpp>
#include <Teuchos_ParameterList.hpp>
#include <Tpetra_CrsMatrix_fwd.hpp>

namespace Harmos::feti {

using CrsMatrix = Tpetra::CrsMatrix<Scalar, LocalOrdinal, GlobalOrdinal, Node>;
using DirectSolver = Amesos2::Solver<CrsMatrix, MultiVector>;

/// Harmos' own concrete Amesos2 solver over MUMPS, as an Amesos2::Solver.
///
/// Debian's Amesos2 is built without MUMPS, and the stock adapter treats every matrix as unsymmetric. This
/// one factorises symmetric matrices as such.
///
/// Parameters, in the sublist "Harmos MUMPS" of the list "Amesos2" given to setParameters():
///  - "Symmetry": "general", "positive definite" (default; Cholesky, no pivot threshold), "symmetric".
///
/// The matrix is given whole, of symmetric ones the lower triangle is used. Its communicator is MUMPS'.
/// @throws std::runtime_error (Harmos::Error) with the sentences of Harmos::feti::Mumps.
/// Guarded by tests/unit/feti/test_mumps.cpp.
/// @note Collective over the communicator of the matrix.
Teuchos::RCP<DirectSolver> makeMumpsSolver(const Teuchos::RCP<const CrsMatrix>& matrix,
                                           const Teuchos::RCP<MultiVector>& x,
                                           const Teuchos::RCP<const MultiVector>& b);

} // namespace Harmos::feti
