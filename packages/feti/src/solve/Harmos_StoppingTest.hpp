// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualStages.hpp"
#include "Harmos_SolverOptions.hpp"
#include "Harmos_StatusTest.hpp"

#include <functional>

namespace Harmos::feti::Details {

/// ‖g^P‖ ≤ ε · scale, or ‖g^P‖ at most the rounding errors of the terms of g, if these are larger.
///
/// With compliant rows g = Fλ − d + s(λ), where s are the openings of their springs. For a stiff body on soft
/// springs s exceeds ‖Pd‖ ~ 1/E by orders of magnitude: Fλ − d cancels s up to rounding errors. The scale
/// nevertheless remains ‖Pd‖, because the strains of the stiff body have this size and ε times the openings
/// may exceed all of them.
///
/// Guarded by tests/unit/feti/solve/test_stopping_test.cpp.
class GradientTest : public qp::StatusTestProjectedGradient<MultiVector> {
 public:
  /// Rounding errors of g at an iterate. Collective; asked only where the rest does not pass.
  using Rounding = std::function<double(const MultiVector& lambda)>;

  GradientTest(double tolerance, double scale, Rounding rounding)
      : qp::StatusTestProjectedGradient<MultiVector>(tolerance, scale), rounding_(std::move(rounding)) {}
  qp::Status checkStatus(const qp::IterationState<MultiVector>& state) override;
  /// The rounding errors that the gradient was last compared with; 0 if it was not.
  double rounding() const { return lastRounding_; }

 private:
  Rounding rounding_; // null: none
  double lastRounding_ = 0.0;
};

/// The convergence test of a stopping rule.
struct StoppingTest {
  Teuchos::RCP<qp::StatusTest<MultiVector>> test;
  Teuchos::RCP<GradientTest> gradient;
  Teuchos::RCP<qp::StatusTestEqualityResidual<MultiVector>> equality; // null without a coarse problem
};

/// @param judgeEquality whether ‖Gλ‖ has a say. @param report gets the scales.
/// @note Collective.
StoppingTest stoppingTest(const DualStages& stages, const SolverOptions& options, double tolerance,
                          bool judgeEquality, SolveReport& report);

} // namespace Harmos::feti::Details
