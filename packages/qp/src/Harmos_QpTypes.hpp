// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace Harmos::qp {

/// Why a solver stopped; never to be guessed from an iteration count.
enum class Reason {
  Converged,      ///< the convergence test passed
  IterationLimit, ///< more iterations than allowed
  Stagnation,     ///< the residuals are at the level of rounding errors, above the tolerance
  Unbounded,      ///< a feasible direction along which the cost falls without end
  Breakdown       ///< a number that is not finite, or a Hessian that is not positive semidefinite
};

/// "converged", "iteration limit", ...
std::string toString(Reason reason);

/// What an iteration did.
enum class StepKind { Start, ConjugateGradient, Expansion, Proportioning, Projected };

/// "start", "cg", "expansion", "proportioning", "pcpg".
std::string toString(StepKind kind);

/// Everything is counted: fallbacks, restarts and confirmations included.
struct Counters {
  int outerIterations = 0;
  int hessianApplications = 0; ///< from the first iterate to the stop
  int setupApplications = 0;   ///< for norm estimates, before the first iterate
  int cgSteps = 0;
  int expansionSteps = 0;
  int proportioningSteps = 0;
  int faces = 0;         ///< faces examined: active sets in a row that differ, the first one included
  int fallbacks = 0;     ///< projected conjugate gradient expansions undone because the cost rose
  int stepCuts = 0;      ///< fixed steps that proved too long
  int confirmations = 0; ///< gradients recomputed because rounding might have spoilt the recurrence
};

/// One inner iteration, as it stands in iterations.csv.
struct IterationRecord {
  int outer;
  int inner;
  StepKind step;
  double projectedGradient; ///< ‖g^P(x, μ + ρr, 0)‖, what the stopping rule looks at
  double equalityResidual;  ///< ‖Cx − c‖, 0 without equalities
  double penalty;           ///< ρ, 0 without equalities
  double precision;         ///< M of SMALBE, 0 elsewhere
  long long active;         ///< entries at a bound
  int hessianApplications;
  double seconds;
};

/// What solve() returns.
struct Result {
  Reason reason = Reason::Breakdown;
  std::string explanation; ///< a sentence: what happened and, if it failed, likely causes and remedies
  Counters counters;
  double projectedGradientNorm = 0.0; ///< ‖g^P(x, μ, 0)‖ at the end, μ the multiplier returned
  double equalityNorm = 0.0;          ///< ‖Cx − c‖ at the end
  double hessianNorm = 0.0;           ///< estimate of ‖A‖ that was used, 0 if none was needed
  double penalty = 0.0;               ///< ρ at the end
  std::vector<IterationRecord> history;

  bool converged() const { return reason == Reason::Converged; }
};

/// Writes the history with one header line; numbers in full precision.
void writeHistory(std::ostream& out, const std::vector<IterationRecord>& history);

} // namespace Harmos::qp
