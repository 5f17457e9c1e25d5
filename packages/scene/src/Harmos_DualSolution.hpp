// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_DualProblem.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_RunOptions.hpp"
#include "Harmos_RunReport.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace Harmos::scene {

/// The answer to the dual problem.
struct DualSolution {
  Teuchos::RCP<MultiVector> lambda;
  std::vector<double> mu;
  /// Where no forces can hold the bodies: amplitudes of the rigid motion that escapes, by columns of R.
  std::vector<double> escape;
};

/// Is asked about λ and μ that just meet a tolerance: the tolerance to go on to, or nothing. Collective.
using Acceptance = std::function<std::optional<double>(const MultiVector& lambda,
                                                       const std::vector<double>& mu, double tolerance)>;

/// Hands the dual problem to the quadratic programming layer, with the solver, stopping rule and
/// preconditioner of the options, and puts what became of it into the report.
/// @param preconditioner or null. @param acceptance null: what meets the tolerance is accepted; of
/// the penalty method always.
/// @throws NumericalError, InternalError on all ranks. @note Collective.
DualSolution solveDualProblem(const feti::SubdomainSystem& system, const feti::Constraints& constraints,
                              const feti::CoarseSpace& coarse, const feti::DualProblem& dual,
                              const Teuchos::RCP<const Operator>& preconditioner, const RunOptions& options,
                              const Acceptance& acceptance, const Log& log, RunReport& report);

} // namespace Harmos::scene
