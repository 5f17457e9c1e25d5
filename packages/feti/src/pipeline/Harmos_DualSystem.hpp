// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualSolution.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_PreconditionerKind.hpp"
#include "Harmos_Recovery.hpp"

#include <Tpetra_Operator.hpp>

#include <vector>

namespace Harmos::feti {

/// The linear dual problem for iterative solvers of others, Belos' for instance:
///
///     PFPλ = Pd  on Gλ = 0
///
/// where there are no inequalities. Keeps all that it was made of.
///
/// Guarded by tests/unit/thyra/test_preconditioners.cpp.
class DualSystem : public Operator {
 public:
  /// @throws InputError on all ranks for stages with inequalities or limits. @note Collective.
  explicit DualSystem(DualStages stages);

  Teuchos::RCP<const Map> getDomainMap() const override;
  Teuchos::RCP<const Map> getRangeMap() const override { return getDomainMap(); }
  bool hasTransposeApply() const override { return true; }
  /// Y = αPFPX + βY. @note Collective.
  void apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode = Teuchos::NO_TRANS,
             Scalar alpha = 1.0, Scalar beta = 0.0) const override;

  /// Pd.
  Teuchos::RCP<const MultiVector> rhs() const { return stages_.problem->rhs(); }

  enum class Preconditioner {
    Dirichlet, ///< PM⁻¹P, with the Dirichlet preconditioner
    Lumped,    ///< the same with the lumped one
    /// Balanced by the adaptive vectors U: P((I − UWᵀ)M⁻¹(I − WUᵀ) + UUᵀ)P, W = FU, UᵀFU = I; M⁻¹ that of
    /// the stages (Mandel, Balancing domain decomposition, Comm. Numer. Methods Engrg. 9, 1993).
    Deflation
  };
  /// Symmetric and positive semidefinite. @param scaling of the first two.
  /// @throws InputError on all ranks for Deflation where the stages have no preconditioner or no such
  /// vectors; NumericalError. @note Collective.
  Teuchos::RCP<const Operator> preconditioner(Preconditioner kind, PreconditionerScaling scaling,
                                              const Log& log = {}) const;

  /// u of a solution λ. @note Collective.
  TornSolution recover(const MultiVector& lambda) const;

 private:
  DualStages stages_;
};

} // namespace Harmos::feti
