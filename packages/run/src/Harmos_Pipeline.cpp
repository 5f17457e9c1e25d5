// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Pipeline.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_AnswerCheck.hpp"
#include "Harmos_AtomicFile.hpp"
#include "Harmos_CheckpointFile.hpp"
#include "Harmos_ContactFields.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_Deck.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_DualSolution.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_ProcessMemory.hpp"
#include "Harmos_Qp.hpp"
#include "Harmos_RankTable.hpp"
#include "Harmos_Recovery.hpp"
#include "Harmos_RunMonitor.hpp"
#include "Harmos_StageTimers.hpp"
#include "Harmos_StressRecovery.hpp"
#include "Harmos_TrilinosVersion.hpp"
#include "Harmos_Version.hpp"
#include "Harmos_ResultFile.hpp"

#include <Teuchos_XMLParameterListHelpers.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <sstream>

namespace Harmos::run {
namespace {

const std::vector<std::string> stages = {"mesh",   "assembly", "factorization", "dual_operator",
                                         "coarse", "solve",    "recovery",      "output"};

feti::LocalInverses makeInverses(const feti::SubdomainSystem& system, const feti::Constraints& constraints,
                                 const feti::DualOptions& options, bool elastic, const Log& log,
                                 RunReport& report) {
  constexpr int usualProducts[] = {30, 100}; // of membranes, of elastic bodies
  const feti::LocalInverseOptions inverseOptions =
      options.decided(system, constraints, usualProducts[elastic ? 1 : 0], log);
  report.dualOperator = options.describe(inverseOptions.form);
  feti::LocalInverses inverses = feti::makeLocalInverses(system, constraints, inverseOptions);
  report.distinctFactorizations =
      globalSum(*system.comm(), static_cast<long long>(inverses.distinctFactorizations()));
  report.localCondition = globalMax(*system.comm(), inverses.condition());
  report.dualOperatorMiB = globalSum(*system.comm(), inverses.bytes() / 1048576.0);
  std::ostringstream text;
  text << report.distinctFactorizations << " local factorisations of " << report.subdomains << " subdomains, "
       << std::fixed << std::setprecision(0) << report.dualOperatorMiB
       << " MiB; condition of the subdomains about " << scientific(report.localCondition, 0);
  log.info(text.str());
  return inverses;
}

// "“second membrane”": the bodies that have a share in a rigid motion.
std::string escapingBodies(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                           const std::vector<scene::OwnedSubdomain>& owned,
                           const feti::SubdomainSystem& system, const std::vector<double>& escape) {
  std::vector<double> squares(scene.bodies.size(), 0.0);
  for (int i = 0; i < system.size(); ++i)
    for (int k = 0; k < system.kernel(i).columns; ++k)
      squares[static_cast<std::size_t>(owned[static_cast<std::size_t>(i)].body)] +=
          std::pow(escape[static_cast<std::size_t>(system.kernelOffset(i) + k)], 2);
  globalSum(comm, squares);
  const double largest = *std::max_element(squares.begin(), squares.end());
  std::string names;
  for (std::size_t b = 0; b < squares.size(); ++b)
    if (squares[b] > 1e-4 * largest) // a hundredth of the amplitude
      names += (names.empty() ? "\"" : ", \"") + scene.bodies[b].name + "\"";
  return names;
}

// feti knows subdomains only; whoever reads the message knows bodies.
NumericalError withBody(const scene::Scene& scene, const NumericalError& error) {
  for (const auto& [name, value] : error.data()) {
    if (name != "subdomain")
      continue;
    long long number = std::stoll(value);
    for (const scene::Body& body : scene.bodies) {
      if (number < body.subdomains) {
        ErrorData data = error.data();
        data.emplace_back("body", body.name);
        return NumericalError("body \"" + body.name + "\": " + error.what(), std::move(data));
      }
      number -= body.subdomains;
    }
  }
  return error;
}

const char* const contradiction =
    "the residuals of the dual problem are as small as they get, but the audit of displacements and forces "
    "contradicts them. Materials that vary by many orders of magnitude and single precision do this, and so "
    "do slender bodies, whose pieces bend more when cut than the whole does; fewer subdomains, or "
    "\"Dual operator/Precision\" = \"double\", help";

void logResult(const Log& log, const RunReport& report) {
  const qp::Counters& c = report.result.counters;
  std::ostringstream text;
  text << (report.converged ? "Converged: " : "NOT converged: ") << c.outerIterations << " outer iterations, "
       << c.hessianApplications << " products with F (" << c.cgSteps << " cg, " << c.expansionSteps
       << " expansion, " << c.proportioningSteps << " proportioning steps, " << c.faces << " faces), "
       << c.setupApplications << " more for set-up";
  log.info(text.str());
}

// The checkpoint to go on from; null for none.
std::unique_ptr<CheckpointReader> openCheckpoint(const Teuchos::Comm<int>& comm, const RunOptions& options,
                                                 RunReport& report) {
  if (options.checkpoint.restart.empty())
    return nullptr;
  auto checkpoint = std::make_unique<CheckpointReader>(comm, checkpointPath(options.checkpoint.restart));
  report.restartedFrom = checkpoint->path();
  agree(comm, [&] {
    const std::string before = checkpoint->text("deck"), &now = options.checkpoint.deck;
    if (before.empty() || now.empty())
      return; // of an application without decks
    const std::string difference = scene::firstDifference(
        *Teuchos::getParametersFromXmlString(before), *Teuchos::getParametersFromXmlString(now),
        {"Output", "Solver/Tolerance", "Solver/Maximum iterations", "Solver/Maximum seconds",
         "Solver/Progress frequency"});
    if (!difference.empty())
      throw InputError("the checkpoint \"" + checkpoint->path() + "\" is of another deck: " + difference +
                           "; restart with the deck that wrote it (tolerance, limits and output may differ)",
                       {{"file", checkpoint->path()}});
  });
  return checkpoint;
}

// Whether the run goes on from a checkpoint in its own output directory.
bool isOwn(const RunOptions& options, const RunReport& report) {
  std::error_code error;
  return !report.restartedFrom.empty() &&
         std::filesystem::equivalent(report.restartedFrom, checkpointPath(options.outputDirectory), error);
}

// A checkpoint of another run is not to be taken for one of this, and not to be lost.
void putAside(const RunOptions& options, const RunReport& report, const Log& log) {
  const std::string path = checkpointPath(options.outputDirectory);
  if (!std::filesystem::exists(path) || isOwn(options, report))
    return;
  const std::string aside = options.outputDirectory + "/checkpoint.previous.h5";
  std::error_code error;
  std::filesystem::rename(path, aside, error);
  if (error)
    throw InputError("the checkpoint \"" + path + "\" of an earlier run cannot be put aside: " +
                         error.message() + "; remove it, or choose another output directory",
                     {{"file", path}});
  log.info("The checkpoint of an earlier run is \"" + aside + "\" now");
}

// The rest is rank 0's, and no reason to fail.
void removeQuietly(const Teuchos::Comm<int>& comm, const std::string& path) {
  if (comm.getRank() != 0)
    return;
  try {
    io::removeFile(path);
  } catch (const InputError&) {
  }
}

void writeIterations(const Teuchos::Comm<int>& comm, const RunOptions& options, const RunReport& report) {
  agree(comm, [&] {
    if (comm.getRank() != 0)
      return;
    std::ostringstream history;
    qp::writeHistory(history, report.result.history);
    io::writeAtomically(options.outputDirectory + "/iterations.csv", history.str());
  });
}

Solution runStages(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const scene::Scene& scene,
                   const RunOptions& options, const Log& log, const StageTimers& timers, RunReport& report,
                   RankShare& share) {
  const std::unique_ptr<CheckpointReader> checkpoint = openCheckpoint(*comm, options, report);
  report.ranks = comm->getSize();
  report.scene = scene.name;
  report.effects = scene.effectKinds();
  report.tolerance = options.tolerance;
  report.toleranceRule = options.toleranceRule == ToleranceRule::Balanced ? "balanced" : "fixed";
  report.stoppingRule = feti::toString(options.stoppingRule);
  report.subdomains = scene.subdomains();
  std::string effects;
  for (const std::string& effect : report.effects)
    effects += (effects.empty() ? "" : ", ") + effect;
  log.info("Scene \"" + scene.name + "\": " + std::to_string(scene.bodies.size()) + " bodies, " +
           std::to_string(report.subdomains) + " subdomains on " + std::to_string(report.ranks) +
           (report.ranks == 1 ? " rank" : " ranks") + "; effects: " + effects);
  for (const std::string& note : scene.notes)
    log.info(note);

  agree(*comm, [&] {
    if (comm->getRank() != 0)
      return;
    io::makeDirectory(options.outputDirectory);
    // Results of an earlier run must not be taken for this one's if it fails.
    for (const char* name :
         {"/summary.json", "/iterations.csv", "/result.vtkhdf", "/contact.csv", "/ranks.csv"})
      io::removeFile(options.outputDirectory + name);
    putAside(options, report, log);
  });

  scene::EffectCosts costs(scene);
  std::vector<scene::OwnedSubdomain> owned;
  std::vector<feti::Subdomain> subdomains;
  {
    const auto scope = timers.scope("mesh");
    owned = scene::decompose(*comm, scene);
    scene::checkBoundaryParts(*comm, scene, owned);
  }
  {
    const auto scope = timers.scope("assembly");
    agree(*comm, [&] { subdomains = scene::assemble(scene, owned, costs); });
  }
  const feti::SubdomainSystem system = [&] {
    const auto scope = timers.scope("assembly");
    return feti::SubdomainSystem(comm, std::move(subdomains), options.dirichlet);
  }();
  share.subdomains = system.size();
  for (int i = 0; i < system.size(); ++i)
    share.primalDimension += static_cast<long long>(system.rhs(i).size());
  report.primalDimension = system.primalDimension();
  report.kernelDimension = system.kernelDimension();

  scene::ContactSetup contact;
  const feti::Constraints constraints = [&] {
    const auto scope = timers.scope("dual_operator");
    contact = scene::setUpContact(*comm, scene, owned, costs);
    return feti::Constraints(system, contact.rows);
  }();
  for (const std::string& note : contact.notes)
    log.info(note);
  for (const ConstraintRow& row : contact.rows)
    report.gapRounding = std::max(report.gapRounding, row.rounding);
  report.gapRounding = globalMax(*comm, report.gapRounding);
  if (options.dirichlet == feti::DirichletForm::Dual)
    costs.countPrescribedAsRows();
  report.effectCosts = costs.total(*comm);
  report.dualDimension = constraints.dualDimension();
  report.inequalities = constraints.inequalities();
  log.info("Primal dimension " + std::to_string(report.primalDimension) + ", dual dimension " +
           std::to_string(report.dualDimension) + " (" + std::to_string(report.inequalities) +
           " inequalities), kernel dimension " + std::to_string(report.kernelDimension));
  if (!report.effectCosts.empty())
    log.info(scene::costText(report.effectCosts));

  const feti::LocalInverses inverses = [&] {
    const auto scope = timers.scope("factorization");
    return makeInverses(system, constraints, options.dual, scene.physics != scene::Physics::Membrane, log,
                        report);
  }();
  share.dualOperatorMiB = inverses.bytes() / 1048576.0;
  const feti::DualOperator dualOperator(constraints, inverses);
  const Teuchos::RCP<const feti::DualPreconditioner> preconditioner = [&] {
    const auto scope = timers.scope("dual_operator");
    return options.dual.preconditioner == feti::PreconditionerKind::None
               ? Teuchos::null
               : Teuchos::rcp(
                     new feti::DualPreconditioner(system, constraints, inverses, options.dual.preconditioner,
                                                  options.dual.scalingFor(scene.hasSeveralMaterials())));
  }();
  const feti::CoarseSpace coarse = [&] {
    const auto scope = timers.scope("coarse");
    return feti::CoarseSpace(system, constraints);
  }();
  report.coarseDimension = coarse.dimension();
  if (coarse.dimension() < coarse.kernelDimension())
    log.info(std::to_string(coarse.kernelDimension() - coarse.dimension()) +
             " rigid motions are held by no constraint (a round body without friction rotates freely); they "
             "are left at rest");
  // Of G̃G̃ᵀ, whose pivots go with the squares of the singular values of G̃.
  constexpr double weak = 1e-6;
  if (coarse.dimension() > 0 && coarse.smallestPivotRatio() < weak)
    log.info("a rigid motion is held only weakly: the smallest singular value of G is about " +
             scientific(std::sqrt(coarse.smallestPivotRatio()), 0) +
             " of the largest; a round body whose normals come from its facets rotates almost freely");
  const feti::DualProblem dual = [&] {
    const auto scope = timers.scope("dual_operator");
    return feti::DualProblem(system, constraints, inverses, dualOperator, coarse);
  }();

  const feti::DualStages stagesOfDual{system, constraints, inverses, coarse, dual, preconditioner};
  AnswerCheck check(*comm, scene, owned, stagesOfDual, options, log, report);
  const feti::DualSolution solution = [&] {
    const auto scope = timers.scope("solve");
    const auto monitor =
        Teuchos::rcp(new RunMonitor(*comm, options, checkpoint.get(), contact.points, log, report));
    monitor->addState([&](qp::StateArchive<MultiVector>& archive) { check.exchange(archive); });
    const auto accept = [&](const MultiVector& lambda, const std::vector<double>& mu, double tolerance) {
      return check.judge(lambda, mu, tolerance);
    };
    feti::SolverOptions first = options;
    if (options.toleranceRule == ToleranceRule::Balanced)
      first.tolerance = firstBalancedTolerance();
    if (log.showsStatus())
      first.progressFrequency = 0;
    return feti::solveDualProblem(stagesOfDual, first, nullptr, accept, log, report, monitor);
  }();
  dualOperator.rethrowFailure();
  if (!preconditioner.is_null())
    preconditioner->rethrowFailure();
  removeQuietly(*comm, options.outputDirectory + "/contact.csv");
  if (report.isInterrupted()) {
    // There may be little time left.
    const auto scope = timers.scope("output");
    report.audited = false;
    report.reason += report.checkpointFault.empty()
                         ? "; go on with --restart \"" + options.outputDirectory + "\""
                         : "; no checkpoint: " + report.checkpointFault;
    logResult(log, report);
    writeIterations(*comm, options, report);
    return {std::move(owned), {}, solution.lambda};
  }
  if (!solution.escape.empty())
    report.reason += "; pulled away, with nothing to hold it: " +
                     escapingBodies(*comm, scene, owned, system, solution.escape);
  // The penalty method leaves jumps by design, and says so.
  const bool isPenalty = report.solver == "Dual Penalty";
  const feti::TornSolution torn = [&] {
    const auto scope = timers.scope("recovery");
    return check.finish(*solution.lambda, solution.mu, report.converged && !isPenalty);
  }();
  if (report.converged && !isPenalty && !auditAgrees(report)) {
    report.converged = false;
    report.reason = contradiction;
  }
  logResult(log, report);
  if (report.inequalities > 0) {
    const auto scope = timers.scope("recovery");
    report.contact = contactStates(*comm, contact.points, feti::contactState(constraints, torn));
    report.contactPoints = std::move(contact.points);
  }
  log.info(auditText(report));

  {
    const auto scope = timers.scope("output");
    writeIterations(*comm, options, report);
    if (options.writeFields) {
      ResultFields fields;
      fields.displacement = &torn.displacement;
      fields.components = scene.components();
      std::vector<std::vector<fem::Voigt>> stress;
      if (options.writeStresses && scene.physics != scene::Physics::Membrane) {
        stress = recoverStress(*comm, scene, owned, torn.displacement);
        fields.stress = &stress;
      }
      ContactFields atNodes;
      if (report.inequalities > 0) {
        atNodes = contactFields(owned, report.contactPoints, report.contact);
        fields.contact = &atNodes;
      }
      writeResult(*comm, options.outputDirectory + "/result.vtkhdf", owned, fields);
    }
  }
  // It has served: there is nothing left to go on to.
  const qp::Reason reason = report.result.reason;
  if (reason == qp::Reason::Converged || reason == qp::Reason::Infeasible || reason == qp::Reason::Unbounded)
    if (report.checkpoints > 0 || isOwn(options, report))
      removeQuietly(*comm, checkpointPath(options.outputDirectory));
  return {std::move(owned), torn.displacement, solution.lambda};
}

} // namespace

Solution runScene(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const scene::Scene& scene,
                  const RunOptions& options, const Log& log, std::chrono::steady_clock::time_point begin,
                  RunReport& report) {
  const StageTimers timers(stages);
  RankShare share;
  std::exception_ptr failure;
  Solution solution;
  try {
    solution = runStages(comm, scene, options, log, timers, report, share);
  } catch (const NumericalError& error) {
    failure = std::make_exception_ptr(withBody(scene, error));
  } catch (const Error& error) {
    if (error.kind() == Error::Kind::Internal && !error.isAgreed())
      throw; // of this rank alone: nothing collective may follow
    failure = std::current_exception();
  }
  const std::vector<double> seconds = timers.seconds(*comm);
  for (std::size_t k = 0; k < stages.size(); ++k)
    report.seconds[stages[k]] = seconds[k];
  report.seconds["mesh"] += globalMax(*comm, scene.secondsToMake);
  const std::chrono::duration<double> total = std::chrono::steady_clock::now() - begin;
  report.seconds["total"] = globalMax(*comm, total.count());
  share.peakMemoryMiB = peakMemoryMiB();
  report.peakMemoryMiB = globalSum(*comm, share.peakMemoryMiB);
  if (options.writeRanks) {
    share.seconds = timers.ownSeconds();
    try {
      writeRankTable(*comm, options.outputDirectory + "/ranks.csv", stages, share);
    } catch (const InputError&) {
      if (!failure) // the first failure is the one that matters
        throw;
    }
  }
  if (failure)
    std::rethrow_exception(failure);
  log.info(timingText(report, stages));
  return solution;
}

void checkScene(const Teuchos::Comm<int>& comm, const scene::Scene& scene) {
  const std::vector<scene::OwnedSubdomain> owned = scene::decompose(comm, scene);
  scene::checkBoundaryParts(comm, scene, owned);
  agree(comm, [&] { scene::assemble(scene, owned); });
  scene::setUpContact(comm, scene, owned);
}

void writeSummary(const Teuchos::Comm<int>& comm, const RunOptions& options, const RunReport& report) {
  agree(comm, [&] {
    if (comm.getRank() != 0)
      return;
    io::makeDirectory(options.outputDirectory);
    io::writeAtomically(options.outputDirectory + "/summary.json", toJson(report));
  });
}

} // namespace Harmos::run
