// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RunOptions.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"

namespace Harmos::run {

void RunOptions::addTo(ParameterSpec& deck, bool mayBeTransient) {
  feti::DualOptions::addDecompositionTo(deck);
  feti::DualOptions::addTo(deck);
  scene::Timeline::addTo(deck, mayBeTransient);

  ParameterSpec solver("Solver", "Solver of the dual quadratic program.");
  feti::SolverOptions::addTo(solver);
  deck.list(std::move(solver));

  ParameterSpec output("Output", "Files of a run.");
  output.text("Directory", "run",
              "Directory of the results; made if it does not exist. The option --output overrides it.");
  output.boolean("Fields", true, "Write result.vtkhdf for ParaView; false for timing.");
  output.boolean("Stresses", true, "Write the stresses at the nodes of elastic bodies, too.");
  output.integer(
      "Every", 1, 1, 1000000000,
      "Interval of steps with fields. Fields are written for every step whose number is a multiple of it, "
      "and for the last.");
  ParameterSpec checkpoint("Checkpoint",
                           "Times at which checkpoint.h5 is written. --restart goes on from there; a signal "
                           "asks for one at any time.");
  checkpoint.integer(
      "Outer iterations", CheckpointOptions().outerIterations, 0, 1000000000,
      "Outer iterations (PDAS: active sets) from one to the next; 0: no such rule. PCPG and MPRGP have "
      "one outer iteration.");
  checkpoint.real("Minutes", CheckpointOptions().minutes, Range::atLeast(0.0),
                  "Minutes from one to the next; 0: no such rule.");
  checkpoint.integer(
      "Steps", CheckpointOptions().steps, 0, 1000000000,
      "Steps from one to the next, in a run with several; 0: no such rule. Transient runs leave out "
      "those that would make checkpoints take more than a tenth of the seconds.");
  output.list(std::move(checkpoint));
  output.expert().boolean("Rank diagnostics", false,
                          "Write ranks.csv: host, subdomains, memory and seconds of each rank.");
  output.expert().choice(
      "Cell fields", "none",
      {{"none", "subdomain, body and region alone"},
       {"stress", "besides, the mean stress of each cell of elastic bodies, as its element has it"}},
      "Fields of cells in the result files of a run.");
  output.expert().real(
      "Live seconds", RunOptions().liveSeconds, Range::atLeast(0.0),
      "Seconds between two versions of contact.csv during a solve, for harmos-plot --follow; "
      "0: none.");
  deck.list(std::move(output));
}

RunOptions RunOptions::fromDeck(const Teuchos::ParameterList& deck) {
  const Teuchos::ParameterList& solver = deck.sublist("Solver");
  RunOptions options;
  static_cast<feti::SolverOptions&>(options) = feti::SolverOptions::fromList(solver);
  options.dirichlet = feti::DualOptions::decompositionFrom(deck.sublist("Decomposition"));
  options.dual = feti::DualOptions::fromList(deck.sublist("Dual operator"));
  options.dual.coarse = options.dual.coarseFrom(deck.sublist("Decomposition"));
  options.dual.clusters = feti::DualOptions::clustersFrom(deck.sublist("Decomposition"));
  options.outputDirectory = deck.sublist("Output").get<std::string>("Directory");
  options.writeFields = deck.sublist("Output").get<bool>("Fields");
  options.writeStresses = deck.sublist("Output").get<bool>("Stresses");
  options.cellFields.stress =
      deck.sublist("Output").sublist("Expert").get<std::string>("Cell fields") == "stress";
  options.every = deck.sublist("Output").get<int>("Every");
  options.writeRanks = deck.sublist("Output").sublist("Expert").get<bool>("Rank diagnostics");
  options.liveSeconds = deck.sublist("Output").sublist("Expert").get<double>("Live seconds");
  const Teuchos::ParameterList& checkpoint = deck.sublist("Output").sublist("Checkpoint");
  options.checkpoint.outerIterations = checkpoint.get<int>("Outer iterations");
  options.checkpoint.minutes = checkpoint.get<double>("Minutes");
  options.checkpoint.steps = checkpoint.get<int>("Steps");
  return options;
}

namespace {

// Whether there is a body whose subdomains are not generated with its mesh.
bool isCut(const scene::Scene& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                     [](const scene::Body& body) { return body.isCut || !body.subdomain; });
}

} // namespace

feti::SolverOptions solverOptions(const scene::Scene& scene, const RunOptions& options) {
  feti::SolverOptions result = options;
  Teuchos::ParameterList& pdas = result.methodLists.sublist("PDAS");
  if (isCut(scene) && pdas.get("First active set", std::string("auto")) == "auto")
    pdas.set("First active set", "tried");
  return result;
}

feti::DirichletForm dirichletForm(const scene::Scene& scene, const RunOptions& options) {
  // Prescribed values in the matrix leave other motions in its kernel when nodes have moved; where it
  // changes, their forces are those of rows.
  if (scene.iterates())
    return feti::DirichletForm::Dual;
  if (options.dirichlet)
    return *options.dirichlet;
  const bool isDual = isCut(scene) && !scene.hasSeveralMaterials() && options.method != "MPRGP";
  return isDual ? feti::DirichletForm::Dual : feti::DirichletForm::Primal;
}

void checkConsistency(const scene::Scene& scene, const RunOptions& options) {
  scene.timeline.check(scene.effects);
  if (scene.iterates() && options.dirichlet == feti::DirichletForm::Primal)
    throw InputError("contradictory options: \"Decomposition/Dirichlet\" = \"primal\" does not go with "
                     "\"Model/Kinematics\" = \"finite\" and plasticity: use \"dual\" or \"auto\"",
                     {{"path", "Decomposition/Dirichlet"}});
  if (scene.iterates() && options.toleranceRule == ToleranceRule::Balanced)
    throw InputError("contradictory options: \"Solver/Tolerance rule\" = \"balanced\" does not go with "
                     "\"Model/Kinematics\" = \"finite\" and plasticity: use \"fixed\"",
                     {{"path", "Solver/Tolerance rule"}});
  if (options.method == "PCPG" && scene.hasInequalities())
    throw InputError(
        "contradictory options: \"Solver/Method\" = \"PCPG\" needs a problem without inequalities, but the "
        "scene has contact; use \"Auto\" or \"SMALBE\" or tie the interface",
        {{"path", "Solver/Method"}});
  const bool isDual = dirichletForm(scene, options) == feti::DirichletForm::Dual;
  const bool floats = scene.hasFloatingBody() || isDual;
  if (options.method == "MPRGP" && floats)
    throw InputError(
        "contradictory options: \"Solver/Method\" = \"MPRGP\" needs a problem without floating subdomains, "
        "but " +
            std::string(isDual ? "with \"Decomposition/Dirichlet\" = \"dual\" every subdomain floats"
                               : "the scene has a body without a prescribed displacement") +
            "; use \"Auto\" or \"SMALBE\"",
        {{"path", "Solver/Method"}});
  if (options.toleranceRule == ToleranceRule::Balanced && options.method == "Dual Penalty")
    throw InputError("contradictory options: the penalty method leaves jumps at any tolerance, but "
                     "\"Solver/Tolerance rule\" = \"balanced\"; use \"fixed\" or another method",
                     {{"path", "Solver/Tolerance rule"}});
  // Residuals are those of a problem whose dense blocks are rounded to 6e-8: smaller ones would say nothing.
  constexpr double singleReaches = 1e-6;
  if (options.dual.inverses.precision == feti::Precision::Single && options.tolerance < singleReaches &&
      options.toleranceRule == ToleranceRule::Fixed && options.dual.form != feti::DualForm::Implicit)
    throw InputError("\"Solver/Tolerance\" = " + scientific(options.tolerance, 0) +
                         " is below the accuracy of dense blocks in single precision; set \"Dual "
                         "operator/Precision\" = \"double\", or \"Dual operator/Form\" = \"implicit\" (with "
                         "refined solves) or a tolerance of at least 1e-6",
                     {{"path", "Solver/Tolerance"}});
  if (options.outputDirectory.empty())
    throw InputError("\"Output/Directory\" is empty; give a directory, \".\" for the working directory",
                     {{"path", "Output/Directory"}});
}

} // namespace Harmos::run
