// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RunOptions.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_Qp.hpp"
#include "Harmos_SparseSolve.hpp"

namespace Harmos::scene {

void RunOptions::addTo(ParameterSpec& deck) {
  ParameterSpec decomposition("Decomposition", "How the bodies are torn.");
  decomposition.choice("Dirichlet", "primal",
                       {{"primal", "FETI: prescribed displacements stay in the subdomain matrices"},
                        {"dual", "Total FETI: they become Lagrange multipliers; every subdomain floats"}},
                       "How prescribed displacements are enforced.");
  deck.list(std::move(decomposition));

  DualOptions::addTo(deck);

  ParameterSpec solver("Solver", "Solution of the dual quadratic program.");
  solver.choice(
      "Method", "Auto",
      {{"Auto", "PCPG without inequalities; else PDAS with a preconditioner; else MPRGP without floating "
                "subdomains and SMALBE with them"},
       {"SMALBE", "augmented Lagrangians for bounds and equalities"},
       {"Dual Penalty", "equalities by a fixed penalty alone"},
       {"MPRGP", "bounds alone: no floating subdomain"},
       {"PCPG", "equalities alone: no contact"},
       {"PDAS", "primal-dual active sets; falls back to SMALBE or MPRGP"}},
      "The solver.");
  solver.real("Tolerance", 1e-4, Range::strictlyWithin(0.0, 1.0),
              "Relative tolerance ε of the stopping rule; not used by the tolerance rule \"balanced\".");
  solver.choice("Tolerance rule", "fixed",
                {{"fixed", "ε is \"Tolerance\""},
                 {"balanced", "ε is lowered until the solver's error is below a share of the discretisation "
                              "error; both are estimated during the run, in the energy norm"}},
                "What the tolerance is.");
  solver.real("Solver error share", 0.3, Range::above(0.0),
              "Rule \"balanced\": the largest solver error, as a share of the discretisation error.");
  solver.choice("Stopping rule", "scaled",
                {{"scaled", "‖g^P‖ ≤ ε‖Pd‖ and ‖Gλ‖ ≤ ε max(‖λ̃‖, ‖λ + λ̃‖)"},
                 {"paper", "‖g^P‖ ≤ ε‖d‖ and ‖Gλ‖ ≤ ε‖(G̃G̃ᵀ)⁻¹ẽ‖"},
                 {"permon", "‖g^P‖ ≤ ε‖Pd‖ and ‖Gλ‖ ≤ ε‖Pd‖"}},
                "What the residuals are measured against.");
  solver.choice("Initial guess", "zero", {{"zero", "λ⁰ = 0"}, {"half load", "λ⁰ = ½Bf"}},
                "First iterate of the shifted dual problem, before it is projected onto the bounds.");
  solver.integer("Maximum iterations", 10000, 0, 1000000000,
                 "Inner iterations after which the solver gives up.");
  solver.real("Maximum seconds", 0.0, Range::atLeast(0.0),
              "Time after which the solver gives up; 0 for no limit.");
  solver.integer("Progress frequency", 10, 0, 1000000000,
                 "A line of progress every so many inner iterations; 0 prints none.");
  solver.list(qp::MethodSpecs::mprgp());
  solver.list(qp::MethodSpecs::smalbe());
  solver.list(qp::MethodSpecs::dualPenalty());
  solver.list(qp::MethodSpecs::pcpg());
  solver.list(qp::MethodSpecs::pdas());
  deck.list(std::move(solver));

  ParameterSpec output("Output", "What a run leaves behind.");
  output.text("Directory", "run",
              "Where the files go; made if it is not there. The option --output overrides it.");
  output.boolean("Fields", true, "Write result.vtkhdf for ParaView; false for timing.");
  output.boolean("Stresses", true, "Recover stresses at the nodes of elastic bodies and write them too.");
  deck.list(std::move(output));
}

RunOptions RunOptions::fromDeck(const Teuchos::ParameterList& deck) {
  RunOptions options;
  options.dirichlet = deck.sublist("Decomposition").get<std::string>("Dirichlet") == "dual"
                          ? feti::DirichletForm::Dual
                          : feti::DirichletForm::Primal;
  options.dual = DualOptions::fromList(deck.sublist("Dual operator"));
  const Teuchos::ParameterList& solver = deck.sublist("Solver");
  options.method = solver.get<std::string>("Method");
  options.tolerance = solver.get<double>("Tolerance");
  options.toleranceRule = solver.get<std::string>("Tolerance rule") == "balanced" ? ToleranceRule::Balanced
                                                                                  : ToleranceRule::Fixed;
  options.solverErrorShare = solver.get<double>("Solver error share");
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
  options.outputDirectory = deck.sublist("Output").get<std::string>("Directory");
  options.writeFields = deck.sublist("Output").get<bool>("Fields");
  options.writeStresses = deck.sublist("Output").get<bool>("Stresses");
  return options;
}

void checkConsistency(const Scene& scene, const RunOptions& options) {
  if (options.method == "PCPG" && scene.hasInequalities())
    throw InputError(
        "contradictory options: \"Solver/Method\" = \"PCPG\" solves problems without inequalities, but "
        "the scene has contact; use \"Auto\" or \"SMALBE\", or tie the interface",
        {{"path", "Solver/Method"}});
  const bool floats = scene.hasFloatingBody() || options.dirichlet == feti::DirichletForm::Dual;
  if (options.method == "MPRGP" && floats)
    throw InputError(
        "contradictory options: \"Solver/Method\" = \"MPRGP\" solves problems without floating "
        "subdomains, but " +
            std::string(options.dirichlet == feti::DirichletForm::Dual
                            ? "with \"Decomposition/Dirichlet\" = \"dual\" every subdomain floats"
                            : "the scene has a body without a prescribed displacement") +
            "; use \"Auto\" or \"SMALBE\"",
        {{"path", "Solver/Method"}});
  if (options.toleranceRule == ToleranceRule::Balanced && options.method == "Dual Penalty")
    throw InputError(
        "contradictory options: the penalty method leaves jumps by design, whatever the tolerance, but "
        "\"Solver/Tolerance rule\" = \"balanced\"; use \"fixed\" or another method",
        {{"path", "Solver/Tolerance rule"}});
  // Residuals are those of a problem whose dense blocks are rounded to 6e-8: smaller ones would say nothing.
  constexpr double singleReaches = 1e-6;
  if (options.dual.inverses.precision == feti::Precision::Single && options.tolerance < singleReaches &&
      options.toleranceRule == ToleranceRule::Fixed && options.dual.form != feti::DualForm::Implicit)
    throw InputError(
        "\"Solver/Tolerance\" = " + scientific(options.tolerance, 0) +
            " is out of reach of dense blocks in single precision; set \"Dual operator/Precision\" = "
            "\"double\", or \"Dual operator/Form\" = \"implicit\", whose solves are refined, or a tolerance "
            "of 1e-6 at least",
        {{"path", "Solver/Tolerance"}});
  const feti::LocalInverseOptions& inverses = options.dual.inverses;
  if (options.dual.form != feti::DualForm::Condensed && inverses.implicitSolver != "MUMPS") {
    if (!feti::SparseSolve::isAvailable(inverses.implicitSolver))
      throw InputError("\"Dual operator/Implicit solver\" = \"" + inverses.implicitSolver +
                           "\" is no direct solver of this Trilinos; use \"MUMPS\" or \"KLU2\"",
                       {{"path", "Dual operator/Implicit solver"}});
    if (inverses.precision == feti::Precision::Single || inverses.blockLowRank > 0.0)
      throw InputError(
          "contradictory options: single precision and block low rank factors are MUMPS' alone, but "
          "\"Dual operator/Implicit solver\" = \"" +
              inverses.implicitSolver + "\"",
          {{"path", "Dual operator/Implicit solver"}});
  }
  if (options.outputDirectory.empty())
    throw InputError("\"Output/Directory\" is empty; name a directory, \".\" for the present one",
                     {{"path", "Output/Directory"}});
}

} // namespace Harmos::scene
