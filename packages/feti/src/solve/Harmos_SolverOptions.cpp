// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SolverOptions.hpp"

#include "Harmos_Qp.hpp"

namespace Harmos::feti {

void SolverOptions::addTo(ParameterSpec& solver) {
  const SolverOptions defaults;
  solver.choice(
      "Method", defaults.method,
      {{"Auto", "PCPG without inequalities; else PDAS if there is a preconditioner; else SMALBE if there are "
                "floating subdomains, and MPRGP if there are none"},
       {"SMALBE", "augmented Lagrangian method for bounds and equalities"},
       {"Dual Penalty", "equalities enforced by a fixed penalty"},
       {"MPRGP", "bounds alone: no floating subdomain"},
       {"PCPG", "equalities alone: no contact"},
       {"PDAS", "primal-dual active sets; falls back to SMALBE or MPRGP"}},
      "Method for the dual problem.");
  solver.real("Tolerance", defaults.tolerance, Range::strictlyWithin(0.0, 1.0),
              "Relative tolerance ε of the stopping rule. Not used by the tolerance rule \"balanced\".");
  solver.choice("Stopping rule", "scaled",
                {{"scaled", "‖g^P‖ ≤ ε‖Pd‖ and ‖Gλ‖ ≤ ε max(‖λ̃‖, ‖λ + λ̃‖)"},
                 {"paper", "‖g^P‖ ≤ ε‖d‖ and ‖Gλ‖ ≤ ε‖(G̃G̃ᵀ)⁻¹ẽ‖"},
                 {"permon", "‖g^P‖ ≤ ε‖Pd‖ and ‖Gλ‖ ≤ ε‖Pd‖"}},
                "Reference values of the residuals.");
  solver.integer("Maximum iterations", defaults.maximumIterations, 0, 1000000000,
                 "Largest number of inner iterations.");
  solver.real("Maximum seconds", defaults.maximumSeconds, Range::atLeast(0.0),
              "Time limit of a solve in seconds; 0: no limit.");
  solver.integer("Progress frequency", defaults.progressFrequency, 0, 1000000000,
                 "Inner iterations between two lines of progress; 0: no lines.");
  solver.choice("Tolerance rule", "fixed",
                {{"fixed", "ε is \"Tolerance\""},
                 {"balanced", "ε is reduced until the solver error is below a share of the discretisation "
                              "error; both are estimated during the run, in the energy norm"}},
                "Choice of the tolerance.");
  ParameterSpec& expert = solver.expert();
  expert.choice("Initial guess", "zero", {{"zero", "λ⁰ = 0"}, {"half load", "λ⁰ = ½Bf"}},
                "First iterate of the shifted dual problem, before the projection onto the bounds.");
  expert.real("Solver error share", defaults.solverErrorShare, Range::above(0.0),
              "Rule \"balanced\": the largest solver error, as a share of the discretisation error.");
  expert.list(qp::MethodSpecs::mprgp());
  expert.list(qp::MethodSpecs::smalbe());
  expert.list(qp::MethodSpecs::dualPenalty());
  expert.list(qp::MethodSpecs::pcpg());
  expert.list(qp::MethodSpecs::pdas());
}

SolverOptions SolverOptions::fromList(const Teuchos::ParameterList& solver) {
  SolverOptions options;
  const Teuchos::ParameterList& expert = solver.sublist("Expert");
  options.method = solver.get<std::string>("Method");
  options.tolerance = solver.get<double>("Tolerance");
  const std::string rule = solver.get<std::string>("Stopping rule");
  options.stoppingRule = rule == "paper"    ? StoppingRule::Paper
                         : rule == "permon" ? StoppingRule::Permon
                                            : StoppingRule::Scaled;
  options.initialGuess =
      expert.get<std::string>("Initial guess") == "half load" ? InitialGuess::HalfLoad : InitialGuess::Zero;
  options.toleranceRule = solver.get<std::string>("Tolerance rule") == "balanced" ? ToleranceRule::Balanced
                                                                                  : ToleranceRule::Fixed;
  options.solverErrorShare = expert.get<double>("Solver error share");
  options.maximumIterations = solver.get<int>("Maximum iterations");
  options.maximumSeconds = solver.get<double>("Maximum seconds");
  options.progressFrequency = solver.get<int>("Progress frequency");
  for (const char* method : {"MPRGP", "SMALBE", "Dual Penalty", "PCPG", "PDAS"})
    options.methodLists.sublist(method) = expert.sublist(method);
  return options;
}

std::string toString(ToleranceRule rule) {
  return rule == ToleranceRule::Balanced ? "balanced" : "fixed";
}

std::string toString(StoppingRule rule) {
  switch (rule) {
  case StoppingRule::Scaled:
    return "scaled";
  case StoppingRule::Paper:
    return "paper";
  case StoppingRule::Permon:
    return "permon";
  }
  return "";
}

} // namespace Harmos::feti
