// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RunStages.hpp"

#include "Harmos_Drift.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_BoundaryParts.hpp"
#include "Harmos_ContactFields.hpp"
#include "Harmos_EnergyAccount.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_MovingBounds.hpp"
#include "Harmos_ResultFile.hpp"
#include "Harmos_RunMonitor.hpp"
#include "Harmos_StressRecovery.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <set>
#include <sstream>
#include <unordered_map>

namespace Harmos::run {
namespace {

constexpr double mebi = 1048576.0;

void logResult(const Log& log, const RunReport& report) {
  const qp::Counters& c = report.result.counters;
  std::ostringstream text;
  text << (report.converged ? "Converged: " : "NOT converged: ") << c.outerIterations << " outer iterations, "
       << c.hessianApplications << " applications of F (" << c.cgSteps << " cg, " << c.expansionSteps
       << " expansion, " << c.proportioningSteps << " proportioning steps, " << c.faces << " faces), "
       << c.setupApplications << " more for set-up";
  log.info(text.str());
}

} // namespace

const std::vector<std::string>& RunStages::names() {
  static const std::vector<std::string> result = {"mesh",   "assembly", "factorization", "dual_operator",
                                                  "coarse", "solve",    "recovery",      "output"};
  return result;
}

RunStages::RunStages(const RunContext& context)
    : context_(context),
      directory_(*context.comm, context.options),
      costs_(context.scene),
      time_(context.scene.timeline.ends().front()) {}

void RunStages::setUp(Motion* motion) {
  motion_ = motion;
  context_.report.restartedFrom = directory_.restartedFrom();
  directory_.checkDeck();
  context_.scene.timeline.check(context_.scene.effects);
  announce();
  directory_.prepare(context_.log);
  decompose();
  makePipeline();
}

RunStages::~RunStages() = default;

Solution RunStages::goOnce() {
  setUp();
  solve(nullptr, monitor(directory_.checkpoint(), context_.log, {}), context_.log, 0.0,
        context_.options.tolerance);
  if (context_.report.isInterrupted()) {
    leaveInterrupted();
    return {std::move(owned_), {}, solve_->solution().lambda};
  }
  recover();
  tellResult();
  context_.report.steps = {onlyStep()};
  write();
  // The checkpoint has served, unless a limit stopped the solver.
  const qp::Reason reason = context_.report.result.reason;
  if (reason == qp::Reason::Converged || reason == qp::Reason::Infeasible || reason == qp::Reason::Unbounded)
    directory_.removeCheckpoint(context_.report.checkpoints > 0);
  return hand();
}

// Of the state there is; loads and displacements went up together.
StepRow RunStages::onlyStep() {
  const MovingBounds bounds(context_.scene, contact_);
  const auto answer = [&](const scene::TimedLoads& loads) {
    scene::TimedLoads::Products products = loads.products(*context_.comm, torn_.displacement, reactions_);
    bounds.addProducts(*context_.comm, multipliers(), loads.cases(), products);
    return EnergyAccount::Answer{loads.factors(time_), products, context_.report.audit.energy,
                                 scene::freeStrainEnergy(*context_.comm, context_.scene, owned_, time_),
                                 context_.report.audit.frictionWork};
  };
  std::optional<EnergyAccount> energy;
  if (context_.scene.hasTemperatures(time_)) {
    const scene::TimedLoads loads(context_.scene, owned_, costs_);
    energy.emplace(loads.cases());
    energy->reach(answer(loads));
  } else { // all loads are at hand: fᵀu = ½uᵀKu − (½uᵀKu − fᵀu)
    const double load = 0.5 * context_.report.audit.energyNorm * context_.report.audit.energyNorm -
                        context_.report.audit.primalEnergy;
    double motion = bounds.product(multipliers());
    for (std::size_t i = 0; i < owned_.size(); ++i) {
      const std::vector<feti::FixedDof>& fixed = pipeline_->system().subdomain(static_cast<int>(i)).fixed;
      std::set<int> counted;
      for (std::size_t k = 0; k < fixed.size(); ++k)
        if (counted.insert(fixed[k].dof).second)
          motion += fixed[k].value * reactions_[i][k];
    }
    energy.emplace(std::vector<scene::TimedLoads::Case>(1));
    energy->reach({{1.0},
                   {{load}, {globalSum(*context_.comm, motion)}},
                   context_.report.audit.energy,
                   0.0,
                   context_.report.audit.frictionWork});
  }
  StepRow row = stepRow(context_.report, *energy);
  row.time = time_;
  tellFurther(context_.scene, nullptr, row);
  return row;
}

// The linear problem of the adjoint shares operators with what was solved.
std::optional<QuantityValue> RunStages::quantity() {
  if (context_.options.quantity == nullptr || !solve_ || !context_.report.converged)
    return std::nullopt;
  AdjointProblem problem = adjointProblem(*context_.comm, *context_.options.quantity,
                                          {context_.scene, owned_, pipeline_->system(), contact_,
                                           torn_.displacement, multipliers(), context_.report.forces});
  const auto scope = context_.timers.scope("solve");
  feti::IncrementSolver::Increment adjoint =
      increment({std::move(problem.loads), std::move(problem.rows), context_.options.tolerance, true});
  if (!adjoint.report.converged)
    throw NumericalError("the adjoint of the quantity did not converge: " + adjoint.report.reason);
  for (std::size_t i = 0; i < problem.known.size(); ++i)
    for (std::size_t k = 0; k < problem.known[i].size(); ++k)
      adjoint.displacement[i][k] += problem.known[i][k];
  return QuantityValue{problem.value, std::move(adjoint.displacement)};
}

Solution RunStages::hand() {
  std::optional<QuantityValue> value = quantity();
  context_.report.contactPoints = std::move(contact_.points);
  // A first step whose loads nothing can hold was not solved.
  return {std::move(owned_), std::move(torn_.displacement),
          solve_ ? solve_->solution().lambda : Teuchos::null, std::move(value)};
}

void RunStages::announce() {
  context_.report.ranks = context_.comm->getSize();
  context_.report.scene = context_.scene.name;
  context_.report.isFinite = context_.scene.isFinite();
  for (const scene::Body& body : context_.scene.bodies)
    context_.report.bodies.push_back(body.name);
  context_.report.effects = context_.scene.effectKinds();
  context_.report.tolerance = context_.options.tolerance;
  context_.report.toleranceRule = feti::toString(context_.options.toleranceRule);
  context_.report.stoppingRule = feti::toString(context_.options.stoppingRule);
  context_.report.subdomains = context_.scene.subdomains();
  std::string effects;
  for (const std::string& effect : context_.report.effects)
    effects += (effects.empty() ? "" : ", ") + effect;
  context_.log.info("Scene \"" + context_.scene.name + "\": " + std::to_string(context_.scene.bodies.size()) +
                    " bodies, " + std::to_string(context_.report.subdomains) + " subdomains on " +
                    std::to_string(context_.report.ranks) +
                    (context_.report.ranks == 1 ? " rank" : " ranks") + "; effects: " + effects);
  for (const std::string& note : context_.scene.notes)
    context_.log.info(note);
}

void RunStages::decompose() {
  const auto scope = context_.timers.scope("mesh");
  owned_ = scene::decompose(*context_.comm, context_.scene,
                            feti::mayJoin(context_.options.dual.clusters, context_.comm->getSize())
                                ? scene::Numbering::Compact
                                : scene::Numbering::AsMade);
  scene::checkBoundaryParts(*context_.comm, context_.scene, owned_);
}

namespace {

// Where contacts of deformed bodies may act, and all components of nodes with prescribed values, which frames
// mix: by the nodes of the subdomain. Those of one mesh share the list.
void reserve(const scene::Scene& scene, const std::vector<scene::OwnedSubdomain>& owned,
             std::vector<feti::Subdomain>& subdomains) {
  const int components = scene.components();
  std::map<std::vector<int>, std::shared_ptr<const std::vector<int>>> known;
  for (std::size_t i = 0; i < owned.size(); ++i) {
    std::set<int> nodes;
    for (const auto& effect : scene.effects)
      if (effect->givesInequalities())
        for (const scene::Effect::BoundaryPart& part : effect->boundaryParts())
          if (const auto set = owned[i].mesh.sets.find(part.set);
              part.body == owned[i].body && set != owned[i].mesh.sets.end())
            nodes.insert(set->second.begin(), set->second.end());
    for (const feti::FixedDof& fixed : subdomains[i].fixed)
      nodes.insert(fixed.dof / components);
    std::vector<int> dofs;
    for (int node : nodes)
      for (int c = 0; c < components; ++c)
        dofs.push_back(node * components + c);
    if (dofs.empty())
      continue;
    std::shared_ptr<const std::vector<int>>& shared = known[dofs];
    if (!shared)
      shared = std::make_shared<const std::vector<int>>(dofs);
    subdomains[i].reserved = shared;
  }
}

} // namespace

feti::SubdomainSystem RunStages::assemble() {
  const auto scope = context_.timers.scope("assembly");
  std::vector<feti::Subdomain> subdomains;
  agree(*context_.comm, [&] {
    if (context_.scene.goesInSteps()) {
      loads_.emplace(context_.scene, owned_, costs_);
      loads_->requireConsistent();
    }
    subdomains = scene::assemble(context_.scene, owned_, costs_);
    if (context_.scene.isFinite())
      reserve(context_.scene, owned_, subdomains);
    if (motion_ != nullptr)
      motion_->addMasses(owned_, subdomains, context_.scene.timeline.ends().front());
  });
  return {context_.comm, std::move(subdomains), dirichletForm(context_.scene, context_.options)};
}

void RunStages::makePipeline() {
  feti::SubdomainSystem system = assemble();
  context_.share.subdomains = system.size();
  for (int i = 0; i < system.size(); ++i)
    context_.share.primalDimension += static_cast<long long>(system.rhs(i).size());
  context_.report.primalDimension = system.primalDimension();
  context_.report.kernelDimension = system.kernelDimension();
  {
    const auto scope = context_.timers.scope("dual_operator");
    contact_ = context_.scene.isFinite()
                   ? scene::setUpMovedContact(*context_.comm, context_.scene, {owned_}, owned_, costs_)
                   : scene::setUpContact(*context_.comm, context_.scene, owned_, costs_);
  }
  feti::PipelineObserver* const observer = this; // which others need not know
  pipeline_ = std::make_unique<feti::DualPipeline>(std::move(system), contact_.rows, dualOptions(), traits(),
                                                   context_.log, observer);
  pipeline_->problem();
}

// What the run that wrote a checkpoint has chosen; and that rounded products, or single precision, were not
// good enough for it.
feti::DualOptions RunStages::dualOptions() const {
  feti::DualOptions options = context_.options.dual;
  if (const CheckpointReader* checkpoint = directory_.checkpoint()) {
    options.before = feti::dualFormsFrom(checkpoint->text("dual forms"));
    if (checkpoint->text("products") == "double") {
      options.mayRound = false;
      options.inverses.precision = feti::Precision::Double;
    }
  }
  // A restart makes the same factors as the run that goes on.
  if (context_.scene.iterates())
    options.inverses.context =
        std::make_shared<feti::FactorizationContext>(feti::FactorizationContext::Likeness::First);
  // FU and what products say of it cancel to many digits.
  if (options.adaptive.vectors == feti::AdaptiveVectors::All)
    options.mayRound = false;
  return options;
}

feti::ProblemTraits RunStages::traits() const {
  return {context_.scene.materialContrast(), context_.scene.hasSeveralMaterials(),
          !context_.scene.hasSeveralMaterials(),
          feti::DualOptions::usualProducts(isElastic(), context_.options.tolerance),
          context_.options.fixedTolerance()};
}

std::shared_ptr<void> RunStages::during(feti::PipelineStage stage) {
  const char* const name = stage == feti::PipelineStage::Inverses ? "factorization"
                           : stage == feti::PipelineStage::Coarse ? "coarse"
                           : stage == feti::PipelineStage::Solve  ? "solve"
                                                                  : "dual_operator";
  return std::shared_ptr<void>(new StageTimers::Scope(context_.timers.scope(name)),
                               [](void* scope) { delete static_cast<StageTimers::Scope*>(scope); });
}

void RunStages::made(feti::PipelineStage stage, const feti::DualPipeline& pipeline) {
  if (stage == feti::PipelineStage::Constraints)
    tellConstraints(pipeline);
  else if (stage == feti::PipelineStage::Inverses)
    tellInverses(pipeline);
  else if (stage == feti::PipelineStage::Coarse)
    tellCoarse(pipeline);
}

void RunStages::tellConstraints(const feti::DualPipeline& pipeline) {
  if (pipeline.counts().constraints > 1) { // of finite displacements: they come and go
    context_.report.dualDimension = pipeline.constraints()->dualDimension();
    context_.report.inequalities = pipeline.constraints()->inequalities();
    context_.report.limited = pipeline.constraints()->limited();
    return;
  }
  for (const std::string& note : contact_.notes)
    context_.log.info(note);
  const feti::Constraints& constraints = *pipeline.constraints();
  if (pipeline.system().dirichletForm() == feti::DirichletForm::Dual)
    costs_.countPrescribedAsRows();
  context_.report.effectCosts = costs_.total(*context_.comm);
  context_.report.dualDimension = constraints.dualDimension();
  context_.report.inequalities = constraints.inequalities();
  context_.report.limited = constraints.limited() - static_cast<long long>(contact_.locks.size());
  context_.report.bonds = contact_.bondCount;
  context_.log.info("Primal dimension " + std::to_string(context_.report.primalDimension) +
                    ", dual dimension " + std::to_string(context_.report.dualDimension) + " (" +
                    std::to_string(context_.report.inequalities) + " inequalities" +
                    (context_.report.limited > 0
                         ? ", " + std::to_string(context_.report.limited) +
                               (contact_.bondCount == 0 ? " of friction" : " of friction and adhesion")
                         : "") +
                    "), kernel dimension " + std::to_string(context_.report.kernelDimension));
  if (!context_.report.effectCosts.empty())
    context_.log.info(scene::costText(context_.report.effectCosts));
}

void RunStages::tellInverses(const feti::DualPipeline& pipeline) {
  const feti::DualOptions::Decided& decided = pipeline.decided();
  const bool isFirst = pipeline.counts().inverses == 1;
  context_.report.isSingle = decided.isSingle();
  context_.report.localCondition = pipeline.accuracy().condition;
  tellFactors(pipeline);
  if (!isFirst)
    return;
  context_.report.dualOperator = decided.describe();
  context_.report.dualForms = toString(decided.forms());
  context_.report.clusters = decided.clusters();
  context_.report.localSolver = decided.inverses.solver.effectiveName();
  std::ostringstream text;
  text << context_.report.distinctFactorizations << " local factorisations (" << context_.report.localSolver
       << ") of " << context_.report.subdomains << " subdomains, " << std::fixed << std::setprecision(0)
       << context_.report.dualOperatorMiB << " MiB; condition number of subdomains about "
       << scientific(context_.report.localCondition, 0);
  if (context_.report.roundedFactorizations > 0)
    text << "; applications of " << context_.report.roundedFactorizations << " in single precision";
  if (const auto replaced =
          globalSum(*context_.comm, static_cast<long long>(pipeline.inverses()->replacedFactorizations()));
      replaced > 0)
    text << "; " << replaced << " of them implicit (too ill-conditioned to condense)";
  context_.log.info(text.str());
}

// To the report.
void RunStages::tellFactors(const feti::DualPipeline& pipeline) {
  context_.share.dualOperatorMiB = pipeline.inverses()->bytes() / mebi;
  context_.report.dualOperatorMiB = globalSum(*context_.comm, context_.share.dualOperatorMiB);
  context_.report.distinctFactorizations =
      globalSum(*context_.comm, static_cast<long long>(pipeline.inverses()->distinctFactorizations()));
  context_.report.roundedFactorizations = pipeline.accuracy().roundedFactorizations;
  context_.report.factorisations =
      globalSum(*context_.comm, static_cast<long long>(pipeline.factorizations().factorizations));
}

void RunStages::countFactorisations() {
  context_.report.factorisations =
      globalSum(*context_.comm, static_cast<long long>(pipeline_->factorizations().factorizations));
}

namespace {

// Of G̃G̃ᵀ, whose pivots go with the squares of the singular values of G̃.
bool isHeldWeakly(const feti::DualPipeline& pipeline) {
  constexpr double weak = 1e-6;
  const feti::CoarseSpace& coarse = *pipeline.coarse();
  return coarse.dimension() > 0 && coarse.smallestPivotRatio() < weak &&
         !pipeline.constraints()->hasWeights();
}

} // namespace

void RunStages::tellCoarse(const feti::DualPipeline& pipeline) {
  if (pipeline.counts().coarse > 1)
    return;
  const feti::CoarseSpace& coarse = *pipeline.coarse();
  context_.report.coarseDimension = coarse.dimension();
  context_.report.isCoarseDistributed = coarse.isDistributed();
  if (context_.report.clusters > 0)
    context_.log.info(feti::describeClusters(pipeline.system(), *pipeline.inverses()));
  if (context_.report.isCoarseDistributed)
    context_.log.info("Coarse problem of dimension " + std::to_string(coarse.dimension()) + ": " +
                      coarse.description());
  if (coarse.dimension() < coarse.kernelDimension())
    context_.log.info(
        std::to_string(coarse.kernelDimension() - coarse.dimension()) +
        " rigid-body modes without any constraint (a round body without friction rotates freely); "
        "their displacement is set to zero");
  if (isHeldWeakly(pipeline))
    context_.log.info(
        "Weakly constrained rigid-body mode: smallest singular value of G about " +
        scientific(std::pow(10.0, std::round(0.5 * std::log10(coarse.smallestPivotRatio()))), 0) +
        " of the largest (a round body with faceted normals rotates almost freely)");
}

void RunStages::prepare(const Data& data) {
  time_ = data.time;
  {
    const auto scope = context_.timers.scope("dual_operator");
    pipeline_->setLoads(data.loads);
    if (data.prescribed != nullptr)
      pipeline_->setPrescribed(*data.prescribed);
    if (data.rows != nullptr)
      pipeline_->setBounds(*data.rows);
    if (data.rows != nullptr && context_.report.limited > 0)
      slipsBefore_ = slipsBefore(*data.rows);
  }
  pipeline_->problem();
}

void RunStages::checkBounds(const std::vector<std::vector<double>>& prescribed) {
  pipeline_->setPrescribed(prescribed);
  pipeline_->setBounds(contact_.rows);
}

Teuchos::RCP<RunMonitor> RunStages::monitor(const CheckpointReader* checkpoint, const Log& log,
                                            SolvePlace place) {
  return Teuchos::rcp(new RunMonitor(*context_.comm, context_.options, checkpoint, contact_, log,
                                     context_.report, std::move(place)));
}

feti::IncrementSolver::Increment RunStages::increment(const feti::IncrementSolver::Task& task) {
  if (!increments_)
    increments_.emplace(*pipeline_, solverOptions(context_.scene, context_.options), context_.log);
  return increments_->solve(task, context_.report.audit.largestDisplacement);
}

namespace {

// What answers are judged by: an entry for each effect with rows, but for those whose force loads make most
// of: what rows add may be nothing.
void addGroups(const Teuchos::Comm<int>& comm, const scene::Scene& scene, const scene::ContactSetup& contact,
               feti::AnswerCriteria& criteria) {
  std::unordered_map<const scene::Effect*, std::size_t> places;
  for (std::size_t k = 0; k < scene.effects.size(); ++k)
    places[scene.effects[k].get()] = k;
  std::vector<double> rows(scene.effects.size(), 0.0);
  for (const scene::ContactSetup::Origin& origin : contact.origins)
    rows[places.at(origin.effect)] += 1.0;
  globalSum(comm, rows);
  const std::vector<std::string> paths = scene.effectPaths();
  std::vector<int> groupOf(rows.size(), -1);
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k] > 0.0 && !scene.effects[k]->loadsWithItsForce()) {
      groupOf[k] = static_cast<int>(criteria.groups.size());
      criteria.groups.push_back(paths[k]);
    }
  for (const scene::ContactSetup::Origin& origin : contact.origins) {
    criteria.groupOf.push_back(groupOf[places.at(origin.effect)]);
    criteria.areaOf.push_back(origin.area);
  }
}

} // namespace

feti::AnswerCriteria RunStages::criteria() const {
  feti::AnswerCriteria result;
  result.rule = context_.options.toleranceRule;
  result.solverErrorShare = context_.options.solverErrorShare;
  result.estimate = [this](const feti::TornVector& displacement) {
    return estimateDiscretisationError(*context_.comm, context_.scene, owned_, displacement, time_);
  };
  result.boundRounding = pipeline_->accuracy().boundRounding;
  addGroups(*context_.comm, context_.scene, contact_, result);
  return result;
}

void RunStages::solve(const feti::WarmStart* start, const Teuchos::RCP<RunMonitor>& monitor, const Log& log,
                      double secondsSpent, double tolerance) {
  const std::optional<feti::WarmStart> reached = monitor->startOfOtherClusters(pipeline_->problem());
  feti::SolverOptions options = solverOptions(context_.scene, context_.options);
  options.tolerance = tolerance;
  constexpr double leastSeconds = 1e-3; // 0 is no limit
  if (options.maximumSeconds > 0.0)
    options.maximumSeconds = std::max(leastSeconds, options.maximumSeconds - secondsSpent);
  if (log.showsStatus() || !log.writesInfo())
    options.progressFrequency = 0;
  solve_.emplace(
      *pipeline_, [this] { return pipeline_->stages(); }, options, criteria(), log, context_.report,
      context_.report);
  solve_->go(reached ? &*reached : start, monitor);
  directory_.removeQuietly(directory_.place("contact.csv"));
}

// There may be little time left.
void RunStages::leaveInterrupted() {
  const auto scope = context_.timers.scope("output");
  context_.report.audited = false;
  context_.report.reason += context_.report.checkpointFault.empty()
                                ? "; continue with --restart \"" + context_.options.outputDirectory + "\""
                                : "; no checkpoint: " + context_.report.checkpointFault;
  logResult(context_.log, context_.report);
  directory_.writeIterations(context_.report.result.history);
}

// K is known to rounding errors, and what they do to its softest motions is κ times as large: no solver can
// do better.
void RunStages::tellWhatIsAttainable() {
  const double attainable = 0.5 * std::numeric_limits<double>::epsilon() * context_.report.localCondition;
  const qp::Reason reason = context_.report.result.reason;
  const bool isGivenUp = reason == qp::Reason::IterationLimit || reason == qp::Reason::Breakdown;
  if (context_.report.converged || !isGivenUp || !(attainable >= context_.report.tolerance))
    return;
  context_.report.reason =
      "attainable accuracy: rounding errors of a subdomain's matrix change its softest modes by at least " +
      scientific(attainable, 0) + " (relative, condition number at least " +
      scientific(context_.report.localCondition, 0) + "), above the tolerance " +
      scientific(context_.report.tolerance, 0) +
      ". Loosen the tolerance, or use less thin cells, smaller material jumps or a Poisson's ratio further "
      "from 0.5; " +
      context_.report.reason;
}

void RunStages::recover() {
  tellWhatIsAttainable();
  if (solve_->solution().isEscaping)
    context_.report.reason += "; unconstrained rigid-body mode under load: " + escapingBodies();
  {
    const auto scope = context_.timers.scope("recovery");
    torn_ = solve_->recover();
  }
  judgeDrift();
  solve_->conclude();
  const auto scope = context_.timers.scope("recovery");
  tellContact(torn_);
  reactions_ = feti::reactions(pipeline_->system(), *pipeline_->constraints(), torn_);
  if (motion_ == nullptr) {
    tellForces(torn_, nullptr);
    return;
  }
  motion_->reach(torn_.displacement);
  context_.report.audit.energy = motion_->lagrangian(context_.report.audit.energy);
  const Motion::Loads loads = motion_->loadsAndInertia();
  tellForces(torn_, &loads);
}

// Of rows, by a solution of the problem as it is.
void RunStages::tellContact(const feti::TornSolution& solution) {
  context_.report.contact.clear();
  if (context_.report.inequalities > 0)
    context_.report.contact = contactStates(*context_.comm, contact_.points,
                                            feti::contactState(*pipeline_->constraints(), solution));
  if (context_.report.limited > 0) {
    context_.report.slips =
        rowSlips(*context_.comm, contact_, feti::frictionState(*pipeline_->constraints(), solution));
    addSlips(*context_.comm, contact_, context_.report.slips, slipsBefore_, context_.report.contact);
  }
  context_.report.contactCounts = countContact(*context_.comm, context_.report.contact);
}

// @param solution with the displacements. @param loads null: those of the system.
void RunStages::tellForces(const feti::TornSolution& solution,
                           const std::vector<std::shared_ptr<const std::vector<double>>>* loads) {
  context_.report.forces =
      forcesOf(*context_.comm, context_.scene, owned_, pipeline_->system(), contact_, solution.displacement,
               reactions_, pipeline_->constraints()->givenMultipliers(*solution.multiplier), time_, loads);
  // Where nothing is strained: rounding errors of stiffness times displacement are in no balance. Loads and
  // springs are no such errors.
  constexpr double rounding = 1e-12;
  const feti::KktAudit& audit = context_.report.audit;
  if (context_.report.forces.known < 0.5 * context_.report.forces.size &&
      context_.report.forces.size <=
          rounding * audit.unitEnergy * audit.unitEnergy * audit.largestDisplacement)
    context_.report.forces.balance = 0.0;
  for (const PairError& pair : context_.report.pairErrors)
    for (Forces::Of& effect : context_.report.forces.effects)
      if (effect.path == pair.path)
        effect.error = pair.relative();
}

void RunStages::prepare(Iterate iterate) {
  time_ = iterate.time;
  slipsBefore_ = std::move(iterate.slipsBefore);
  {
    const auto scope = context_.timers.scope("dual_operator");
    contact_ = std::move(iterate.contact);
    pipeline_->setPrescribed(iterate.prescribed);
  }
  pipeline_->setShape(iterate.tangent.matrices, iterate.tangent.kernels, std::move(iterate.loads),
                      contact_.rows, std::move(iterate.frames));
  pipeline_->problem();
}

void RunStages::take(Equilibrium equilibrium) {
  const auto scope = context_.timers.scope("recovery");
  context_.report.audit = equilibrium.audit;
  context_.report.audited = true;
  tellContact(equilibrium.change);
  reactions_ = std::move(equilibrium.reactions);
  torn_ = {std::move(equilibrium.displacement), equilibrium.change.multiplier, {}};
  tellForces(torn_, &equilibrium.loads);
  materials_ = *equilibrium.states;
}

void RunStages::tellResult() const {
  logResult(context_.log, context_.report);
  if (const std::string text = forcesText(context_.report.forces); !text.empty())
    context_.log.info(text);
  context_.log.info(auditText(context_.report));
  if (const std::string text = attainableText(context_.report); context_.report.converged && !text.empty())
    context_.log.info(text);
  if (const std::string text = doubtfulForces(context_.report); context_.report.converged && !text.empty())
    context_.log.info(text);
}

// Soft springs let bodies move as far, and hold them.
void RunStages::judgeDrift() {
  const feti::SubdomainSystem& system = pipeline_->system();
  double prescribed = 0.0;
  for (int i = 0; i < system.size(); ++i)
    for (const feti::FixedDof& fixed : system.subdomain(i).fixed)
      prescribed = std::max(prescribed, std::abs(fixed.value));
  constexpr double hardly = 1e-3;
  const feti::CoarseSpace& coarse = *pipeline_->coarse();
  if (!context_.report.converged || coarse.dimension() == 0 || pipeline_->constraints()->hasWeights() ||
      coarse.smallestPivotRatio() >= hardly)
    return;
  const std::string drift = driftText(*context_.comm, context_.scene, owned_, torn_.displacement, prescribed);
  if (drift.empty())
    return;
  context_.report.converged = false;
  context_.report.reason = drift;
}

// "“second membrane”": the bodies that have a share in a rigid motion.
std::string RunStages::escapingBodies() const {
  std::vector<long long> bodyOf;
  for (const scene::OwnedSubdomain& item : owned_)
    bodyOf.push_back(item.body);
  std::string names;
  for (const long long body :
       feti::escapingParts(pipeline_->coarse()->motions(), solve_->solution().escape, bodyOf,
                           static_cast<long long>(context_.scene.bodies.size())))
    names +=
        (names.empty() ? "\"" : ", \"") + context_.scene.bodies[static_cast<std::size_t>(body)].name + "\"";
  return names;
}

void RunStages::write() {
  const auto scope = context_.timers.scope("output");
  directory_.writeIterations(context_.report.result.history);
  if (context_.options.writeFields)
    writeFields("result.vtkhdf");
}

void RunStages::writeFields(const std::string& file) {
  ResultFields fields;
  fields.displacement = &torn_.displacement;
  fields.components = context_.scene.components();
  if (motion_ != nullptr)
    fields.velocity = &motion_->velocities();
  RecoveredStress recovered;
  std::vector<std::vector<fem::Voigt>> cellStress;
  if (context_.options.writeStresses && isElastic()) {
    recovered = recoverStress(*context_.comm, context_.scene, owned_, torn_.displacement, time_, materials_);
    fields.stress = &recovered.stress;
    fields.plasticStrain = context_.scene.yields() ? &recovered.states : nullptr; // on all ranks alike
  }
  if (context_.options.cellFields.stress && isElastic()) {
    agree(*context_.comm,
          [&] { cellStress = cellStresses(context_.scene, owned_, torn_.displacement, time_, materials_); });
    fields.cellStress = &cellStress;
  }
  std::vector<std::vector<double>> cellErrors;
  if (context_.options.cellFields.error) {
    estimateDiscretisationError(*context_.comm, context_.scene, owned_, torn_.displacement, time_,
                                &cellErrors);
    for (std::vector<double>& squares : cellErrors)
      for (double& square : squares)
        square = std::sqrt(square);
    fields.cellError = &cellErrors;
  }
  ContactFields atNodes;
  // Of finite displacements contacts come and go, the fields stay.
  const bool isFinite = context_.scene.isFinite();
  if (isFinite ? context_.scene.hasInequalities() : context_.report.inequalities > 0) {
    fields.kinds = {isFinite ? context_.scene.hasInterfaceLaws() : contact_.hasFriction,
                    context_.scene.breaks()};
    atNodes = contactFields(*context_.comm, owned_, contact_.points, context_.report.contact, fields.kinds);
    fields.contact = &atNodes;
  }
  writeResult(*context_.comm, directory_.place(file), owned_, fields);
}

} // namespace Harmos::run
