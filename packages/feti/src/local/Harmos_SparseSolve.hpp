// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundaryOperator.hpp"
#include "Harmos_DirectSolver.hpp"
#include "Harmos_LocalMatrix.hpp"

#include <Teuchos_RCP.hpp>

#include <memory>
#include <string>

namespace Harmos::feti {

/// What was spent on factors.
struct FactorizationCounts {
  int analyses = 0;       ///< symbolic factorisations: orders of elimination, structures of factors
  int factorizations = 0; ///< numerical ones

  FactorizationCounts& operator+=(const FactorizationCounts& other) {
    analyses += other.analyses;
    factorizations += other.factorizations;
    return *this;
  }
};

/// That a matrix has the graph that was analysed, which has this patternHash(). @throws InputError otherwise.
void requireGraph(std::size_t hash, const LocalMatrix& matrix);

/// The factorisation of one rank's sparse symmetric positive definite matrix, by any solver that Amesos2
/// offers.
class SparseSolve {
 public:
  /// Whether there is such a solver.
  static bool isAvailable(const std::string& solver);

  /// @param solver "MUMPS" for Harmos' own adapter, or a name that Amesos2 knows: "KLU2", ...
  /// @param precision Single: factors in float, each solve with one step of refinement; MUMPS only.
  /// @throws InputError for a solver that this Amesos2 lacks, NumericalError, InternalError.
  SparseSolve(const LocalMatrix& matrix, const std::string& solver, Precision precision, double blockLowRank);
  ~SparseSolve();

  /// The same for other values at the same places: no new analysis.
  /// @throws InputError if the graph differs, and as the constructor.
  void refactor(const LocalMatrix& matrix);

  /// Overwrites count right-hand sides, column after column, by the solutions.
  void solve(double* x, int count) const;

  /// Of the factors, as far as the solver tells.
  double bytes() const;
  /// Operations of a solve with one right-hand side.
  double flops() const;
  /// Analyses and factorisations that were made.
  FactorizationCounts counts() const;

 private:
  void solveOnce(double* x, int count) const;

  std::size_t patternHash_;
  int factorizations_ = 1;
  LocalMatrix refined_; // the matrix itself, where residuals are to be computed
  Precision precision_;
  int rows_;
  Teuchos::RCP<const Map> map_;
  Teuchos::RCP<DirectSolver> solver_;
  mutable Teuchos::RCP<MultiVector> b_, x_;
};

} // namespace Harmos::feti
