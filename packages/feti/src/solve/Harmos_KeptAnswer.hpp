// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_QpTypes.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_Types.hpp"

#include <Teuchos_RCP.hpp>

#include <optional>

namespace Harmos::feti::Details {

/// A solution that met the tolerance, kept while the solver continues to a smaller tolerance. It is returned
/// if the solver makes no further progress.
///
/// Guarded by tests/unit/feti/solve/test_kept_answer.cpp.
class KeptAnswer {
 public:
  /// With a solver that continues.
  struct Patience {
    int iterations; ///< without half of the least residual so far
    double rise;    ///< of the residual, above that of what is kept
  };

  bool isThere() const { return kept_.has_value(); }
  void forget() { kept_.reset(); }

  /// Copies. @param mu null without equality rows. @param gradient, equality its residuals. @param inner the
  /// iterations after which it was found. @param patience see isSpent().
  void keep(const MultiVector& lambda, const Teuchos::RCP<const MultiVector>& mu, double gradient,
            double equality, int inner, const Patience& patience);

  /// Of the solver that continues. @param gradient its residual after so many iterations.
  void observe(int inner, double gradient);

  /// Whether the patience has come to its end: where Coulomb's friction holds bodies
  /// by little, active sets may wander below a tolerance that they have met. Not a limit of the iterations in
  /// all: what a residual first falls by says little of what follows.
  bool isSpent(int inner) const {
    return isThere() && (inner > least_.inner + patience_.iterations || isAstray_);
  }

  /// Puts the answer in the place of one that has not converged, and its residuals with the result; unless
  /// there is none, or the solver is to go on in another run. @return whether it did.
  bool replace(qp::Result& result, MultiVector& lambda, const Teuchos::RCP<MultiVector>& mu) const;

  /// As part of the state of a solver. @param lambda, mu of the right shape. @note Collective.
  void exchange(qp::StateArchive<MultiVector>& archive, const MultiVector& lambda,
                const Teuchos::RCP<const MultiVector>& mu);

 private:
  struct Kept {
    Teuchos::RCP<MultiVector> lambda, mu;
    double gradient, equality;
  };
  struct Least { // residual that counts as progress
    double gradient;
    int inner;
  };
  std::optional<Kept> kept_;
  Least least_{};
  Patience patience_{};
  bool isAstray_ = false;
};

} // namespace Harmos::feti::Details
