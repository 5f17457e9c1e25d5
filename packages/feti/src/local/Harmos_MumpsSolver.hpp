// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DirectSolver.hpp"
#include "Harmos_Mumps.hpp"

#include <Amesos2_Solver_decl.hpp>
#include <Teuchos_ParameterList.hpp>

#include <string>
#include <vector>

namespace Harmos::feti {

/// What MUMPS offers beyond Amesos2's interface. The solver of makeMumpsSolver() is one as well: see
/// Teuchos::rcp_dynamic_cast<MumpsExtras>().
///
/// Arrays live on the root of the matrix' communicator; the functions are collective over it.
class MumpsExtras {
 public:
  virtual ~MumpsExtras() = default;

  /// Before the symbolic factorisation: rows b, zero-based, to which the Schur complement condenses. A solve
  /// then answers with x_b = 0 and x_i = A_ii⁻¹f_i.
  virtual void setSchurRows(std::vector<int> rows) = 0;
  /// Likewise: an order of elimination, as ordering() of a matrix with the same pattern and Schur rows;
  /// empty: by the parameter "Ordering".
  virtual void setOrdering(std::vector<int> position) = 0;
  virtual std::vector<int> ordering() const = 0;
  /// S = A_bb − A_bi A_ii⁻¹ A_ib, whole, column after column; once after each numerical factorisation.
  virtual std::vector<double> schurComplement() = 0;
  /// g = f_b − A_bi A_ii⁻¹f_i of count right-hand sides. @param reduced count columns of b's length.
  virtual void condense(double* rightHandSides, double* reduced, int count) = 0;
  /// x = (A_ii⁻¹(f_i − A_ib x_b), x_b), after condense() of the same right-hand sides.
  virtual void expand(double* rightHandSides, double* reduced, int count) = 0;
  /// Rows with a null pivot, zero-based; with the parameter "Null pivot threshold".
  virtual std::vector<int> nullPivots() const = 0;
  virtual Mumps::Statistics statistics() const = 0;
  virtual std::vector<std::string> warnings() const = 0;
};

/// Harmos' own concrete Amesos2 solver over MUMPS, as an Amesos2::Solver.
///
/// Debian's Amesos2 is built without MUMPS, and the stock adapter treats every matrix as unsymmetric, offers
/// no Schur complement and throws at warnings. This one factorises symmetric matrices as such.
///
/// Parameters, in the sublist "Harmos MUMPS" of the list "Amesos2" given to setParameters(), before the
/// symbolic factorisation:
///  - "Symmetry": "general", "positive definite" (default; Cholesky, no pivot threshold), "symmetric";
///  - "Ordering": "METIS" (default), "AMD", "AMF", "SCOTCH", "PORD", "QAMD", "automatic";
///  - "Precision": "double" (default) or "single" factors;
///  - "Null pivot threshold": pivots below this part of the norm are null; 0 (default) looks for none;
///  - "Block low rank tolerance": relative accuracy of compressed factors; 0 (default) for none;
///  - "Memory limit MiB": of each rank; 0 (default) for none.
///
/// The matrix is given whole, of symmetric ones the lower triangle is used. Its communicator is MUMPS': one
/// rank's own for a subdomain of its own, several ranks' for a subdomain that spans them.
/// @throws std::runtime_error (Harmos::Error) with the sentences of Harmos::feti::Mumps.
/// Guarded by tests/unit/feti/local/test_mumps.cpp.
/// @note Collective over the communicator of the matrix.
Teuchos::RCP<DirectSolver> makeMumpsSolver(const Teuchos::RCP<const CrsMatrix>& matrix,
                                           const Teuchos::RCP<MultiVector>& x,
                                           const Teuchos::RCP<const MultiVector>& b);

} // namespace Harmos::feti
