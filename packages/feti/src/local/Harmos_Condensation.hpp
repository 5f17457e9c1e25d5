// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SparseFactor.hpp"

#include <memory>
#include <vector>

namespace Harmos::feti {

/// The Schur complement of boundary rows b, and A_ii's factorisation, i the others: static condensation.
class Condensation {
 public:
  virtual ~Condensation() = default;

  /// Factors A_ii of a matrix. @return S = A_bb − A_bi A_ii⁻¹ A_ib, whole, column after column.
  /// @throws InputError if it is not the first matrix, and its graph differs; NumericalError, InternalError.
  virtual std::vector<double> condense(const LocalMatrix& matrix) = 0;

  /// reduced ← f_b − A_bi A_ii⁻¹ f_i, for count vectors.
  virtual void reduce(double* f, double* reduced, int count) const = 0;
  /// f ← (A_ii⁻¹(f_i − A_ib x_b), x_b) after reduce() of the same f.
  virtual void expand(double* f, double* boundary, int count) const = 0;

  virtual double bytes() const = 0;
  virtual FactorizationCounts counts() const = 0;
};

/// @param boundary rising; not all rows. Local.
std::unique_ptr<Condensation> makeCondensation(const SparseSolverChoice& solver,
                                               const std::vector<int>& boundary,
                                               std::shared_ptr<FactorizationContext> context);

} // namespace Harmos::feti
