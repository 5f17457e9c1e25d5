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
  TimeLimit,      ///< more seconds than allowed
  Stagnation,     ///< the residuals are at the level of rounding errors, above the tolerance
  Infeasible,     ///< no x meets the bounds and the equalities; Result::certificate proves it
  Unbounded,      ///< a feasible direction along which the cost falls without end; so does it
  Interrupted,    ///< the monitor asked the solver to stop
  Breakdown       ///< a number that is not finite, or a Hessian that is not positive semidefinite
};

/// "converged", "iteration limit", ...
std::string toString(Reason reason);

/// What an iteration did.
enum class StepKind { Start, ConjugateGradient, Expansion, Proportioning, Projected, ActiveSet };

/// "start", "cg", "expansion", "proportioning", "pcpg", "active set".
std::string toString(StepKind kind);

/// Everything is counted: fallbacks, restarts and confirmations included.
struct Counters {
  int outerIterations = 0;
  int hessianApplications = 0; ///< from the first iterate to the stop
  int setupApplications = 0;   ///< for norm estimates, before the first iterate
  int cgSteps = 0;
  int expansionSteps = 0;
  int proportioningSteps = 0;
  int faces = 0;            ///< faces examined: active sets in a row that differ, the first one included
  int fallbacks = 0;        ///< projected conjugate gradient expansions undone because the cost rose
  int stepCuts = 0;         ///< fixed steps that proved too long
  int confirmations = 0;    ///< gradients recomputed because rounding might have spoilt the recurrence
  int activeSetUpdates = 0; ///< of a primal-dual active set method
  int descents = 0;         ///< of these, changes to sets that descend
  int safeguards = 0;       ///< changes to a globally convergent method
  int preconditionerApplications = 0;
  int preconditionerSetups = 0; ///< made for a face

  Counters& operator+=(const Counters& other);
};

/// The numbers that prove a problem infeasible or unbounded; the vector itself is
/// SolverManager::certificate().
///
/// Infeasible: y with ‖y‖ = 1 and yᵀ(Cx − c) ≥ gap − defect‖x‖ for every x within the bounds, so that a
/// feasible x would have ‖x‖ ≥ gap/defect. For l_i > u_i, gap is the largest l_i − u_i.
/// Unbounded: d with ‖d‖ = 1 in the recession cone of the bounds, gap = bᵀd > 0, defect = max(‖Ad‖/‖A‖,
/// ‖Cd‖/‖C‖).
struct Certificate {
  double gap = 0.0;
  double defect = 0.0;
  long long entry = -1; ///< global index of an inconsistent pair of bounds, −1 for none
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
  double decrease; ///< of the cost (or the augmented Lagrangian) over this step, NaN where it is not known
};

/// A row of one solve, counted on from the last row of those before it.
IterationRecord countedOn(const IterationRecord& row, const IterationRecord& before);

/// What solve() returns.
struct Result {
  Reason reason = Reason::Breakdown;
  std::string explanation; ///< a sentence: what happened and, if it failed, likely causes and remedies
  Counters counters;
  double projectedGradientNorm = 0.0; ///< ‖g^P(x, μ, 0)‖ at the end, μ the multiplier returned
  double equalityNorm = 0.0;          ///< ‖Cx − c‖ at the end
  double hessianNorm = 0.0;           ///< estimate of ‖A‖ that was used, 0 if none was needed
  double penalty = 0.0;               ///< ρ at the end
  std::string method;                 ///< the solver that did the work: what Auto chose
  Certificate certificate;            ///< of Infeasible and Unbounded
  std::vector<IterationRecord> history;

  bool converged() const { return reason == Reason::Converged; }
  /// The last row of the history; zeros without one.
  IterationRecord lastRecord() const { return history.empty() ? IterationRecord{} : history.back(); }
  /// Puts history and counters of a solve before, which this one went on from, in front of its own.
  void goesOnAfter(const Result& before);
};

/// Writes the history with one header line; numbers in full precision.
void writeHistory(std::ostream& out, const std::vector<IterationRecord>& history);
/// Its header line, and one of its rows, each with the end of the line.
void writeHistoryHeader(std::ostream& out);
void writeHistoryRow(std::ostream& out, const IterationRecord& record);

/// Counters and history as numbers, and back: integers are exact up to 2⁵³.
std::vector<double> toNumbers(const Counters& counters);
Counters countersOf(const std::vector<double>& numbers);
std::vector<double> toNumbers(const std::vector<IterationRecord>& history);
std::vector<IterationRecord> historyOf(const std::vector<double>& numbers);

} // namespace Harmos::qp
