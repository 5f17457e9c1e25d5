// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SolverOptions.hpp"

#include "Harmos_Qp.hpp"

namespace Harmos::feti {

void SolverOptions::addTo(ParameterSpec& solver) {
  const SolverOptions defaults;
  solver.choice(
      "Method", defaults.method,
      {{"Auto", "PCPG without inequalities; else PDAS with a preconditioner; else MPRGP without floating "
                "subdomains and SMALBE with them"},
       {"SMALBE", "augmented Lagrangians for bounds and equalities"},
       {"Dual Penalty", "equalities by a fixed penalty alone"},
       {"MPRGP", "bounds alone: no floating subdomain"},
       {"PCPG", "equalities alone: no contact"},
       {"PDAS", "primal-dual active sets; falls back to SMALBE or MPRGP"}},
      "The solver.");
  solver.real("Tolerance", defaults.tolerance, Range::strictlyWithin(0.0, 1.0),
              "Relative tolerance ε of the stopping rule; not used by the tolerance rule \"balanced\".");
  solver.choice("Stopping rule", "scaled",
                {{"scaled", "‖g^P‖ ≤ ε‖Pd‖ and ‖Gλ‖ ≤ ε max(‖λ̃‖, ‖λ + λ̃‖)"},
                 {"paper", "‖g^P‖ ≤ ε‖d‖ and ‖Gλ‖ ≤ ε‖(G̃G̃ᵀ)⁻¹ẽ‖"},
                 {"permon", "‖g^P‖ ≤ ε‖Pd‖ and ‖Gλ‖ ≤ ε‖Pd‖"}},
                "What the residuals are measured against.");
  solver.choice("Initial guess", "zero", {{"zero", "λ⁰ = 0"}, {"half load", "λ⁰ = ½Bf"}},
                "First iterate of the shifted dual problem, before it is projected onto the bounds.");
  solver.integer("Maximum iterations", defaults.maximumIterations, 0, 1000000000,
                 "Inner iterations after which the solver gives up.");
  solver.real("Maximum seconds", defaults.maximumSeconds, Range::atLeast(0.0),
              "Time after which the solver gives up; 0 for no limit.");
  solver.integer("Progress frequency", defaults.progressFrequency, 0, 1000000000,
                 "A line of progress every so many inner iterations; 0 prints none.");
  solver.list(qp::MethodSpecs::mprgp());
  solver.list(qp::MethodSpecs::smalbe());
  solver.list(qp::MethodSpecs::dualPenalty());
  solver.list(qp::MethodSpecs::pcpg());
  solver.list(qp::MethodSpecs::pdas());
}

SolverOptions SolverOptions::fromList(const Teuchos::ParameterList& solver) {
  SolverOptions options;
  options.method = solver.get<std::string>("Method");
  options.tolerance = solver.get<double>("Tolerance");
  const std::string rule = solver.get<std::string>("Stopping rule");
  options.stoppingRule = rule == "paper"    ? StoppingRule::Paper
                         : rule == "permon" ? StoppingRule::Permon
                                            : StoppingRule::Scaled;
  options.initialGuess =
      solver.get<std::string>("Initial guess") == "half load" ? InitialGuess::HalfLoad : InitialGuess::Zero;
  options.maximumIterations = solver.get<int>("Maximum iterations");
  options.maximumSeconds = solver.get<double>("Maximum seconds");
  options.progressFrequency = solver.get<int>("Progress frequency");
  for (const char* method : {"MPRGP", "SMALBE", "Dual Penalty", "PCPG", "PDAS"})
    options.methodLists.sublist(method) = solver.sublist(method);
  return options;
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
