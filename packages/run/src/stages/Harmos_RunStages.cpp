// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RunStages.hpp"

#include "Harmos_Drift.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_BoundaryParts.hpp"
#include "Harmos_ContactFields.hpp"
#include "Harmos_EnergyAccount.hpp"
#include "Harmos_Exchange.hpp"
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

RunStages::RunStages(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const scene::Scene& scene,
                     const RunOptions& options, const Log& log, const StageTimers& timers, RunReport& report,
                     RankShare& share)
    : comm_(comm),
      scene_(scene),
      options_(options),
      log_(log),
      timers_(timers),
      report_(report),
      share_(share),
      directory_(*comm, options),
      costs_(scene),
      time_(scene.timeline.ends().front()) {}

void RunStages::setUp() {
  report_.restartedFrom = directory_.restartedFrom();
  directory_.checkDeck();
  scene_.timeline.check(scene_.effects);
  announce();
  directory_.prepare(log_);
  decompose();
  makePipeline();
}

RunStages::~RunStages() = default;

Solution RunStages::goOnce() {
  setUp();
  solve(nullptr, monitor(directory_.checkpoint(), log_, {}), log_, 0.0, options_.tolerance);
  if (report_.isInterrupted()) {
    leaveInterrupted();
    return {std::move(owned_), {}, solve_->solution().lambda};
  }
  recover();
  tellResult();
  report_.steps = {onlyStep()};
  write();
  // The checkpoint has served, unless a limit stopped the solver.
  const qp::Reason reason = report_.result.reason;
  if (reason == qp::Reason::Converged || reason == qp::Reason::Infeasible || reason == qp::Reason::Unbounded)
    directory_.removeCheckpoint(report_.checkpoints > 0);
  return hand();
}

// Of the state there is; loads and displacements went up together.
StepRow RunStages::onlyStep() {
  const auto answer = [&](const scene::TimedLoads& loads) {
    return EnergyAccount::Answer{loads.factors(time_), loads.products(*comm_, torn_.displacement, reactions_),
                                 report_.audit.energy, scene::freeStrainEnergy(*comm_, scene_, owned_, time_),
                                 report_.audit.frictionWork};
  };
  const std::vector<double> rises = scene_.temperatureRises(time_);
  std::optional<EnergyAccount> energy;
  if (std::any_of(rises.begin(), rises.end(), [](double rise) { return rise != 0.0; })) {
    const scene::TimedLoads loads(scene_, owned_, costs_);
    energy.emplace(loads.cases());
    energy->reach(answer(loads));
  } else { // all loads are at hand: fᵀu = ½uᵀKu − (½uᵀKu − fᵀu)
    const double load =
        0.5 * report_.audit.energyNorm * report_.audit.energyNorm - report_.audit.primalEnergy;
    double motion = 0.0;
    for (std::size_t i = 0; i < owned_.size(); ++i) {
      const std::vector<feti::FixedDof>& fixed = pipeline_->system().subdomain(static_cast<int>(i)).fixed;
      std::set<int> counted;
      for (std::size_t k = 0; k < fixed.size(); ++k)
        if (counted.insert(fixed[k].dof).second)
          motion += fixed[k].value * reactions_[i][k];
    }
    energy.emplace(std::vector<scene::TimedLoads::Case>(1));
    energy->reach({{1.0},
                   {{load}, {globalSum(*comm_, motion)}},
                   report_.audit.energy,
                   0.0,
                   report_.audit.frictionWork});
  }
  StepRow row = stepRow(report_, *energy);
  row.time = time_;
  tellFurther(scene_, row);
  return row;
}

Solution RunStages::hand() {
  report_.contactPoints = std::move(contact_.points);
  // A first step whose loads nothing can hold was not solved.
  return {std::move(owned_), std::move(torn_.displacement),
          solve_ ? solve_->solution().lambda : Teuchos::null};
}

void RunStages::announce() {
  report_.ranks = comm_->getSize();
  report_.scene = scene_.name;
  report_.effects = scene_.effectKinds();
  report_.tolerance = options_.tolerance;
  report_.toleranceRule = feti::toString(options_.toleranceRule);
  report_.stoppingRule = feti::toString(options_.stoppingRule);
  report_.subdomains = scene_.subdomains();
  std::string effects;
  for (const std::string& effect : report_.effects)
    effects += (effects.empty() ? "" : ", ") + effect;
  log_.info("Scene \"" + scene_.name + "\": " + std::to_string(scene_.bodies.size()) + " bodies, " +
            std::to_string(report_.subdomains) + " subdomains on " + std::to_string(report_.ranks) +
            (report_.ranks == 1 ? " rank" : " ranks") + "; effects: " + effects);
  for (const std::string& note : scene_.notes)
    log_.info(note);
}

void RunStages::decompose() {
  const auto scope = timers_.scope("mesh");
  owned_ =
      scene::decompose(*comm_, scene_,
                       feti::mayJoin(options_.dual.clusters, comm_->getSize()) ? scene::Numbering::Compact
                                                                               : scene::Numbering::AsMade);
  scene::checkBoundaryParts(*comm_, scene_, owned_);
}

feti::SubdomainSystem RunStages::assemble() {
  const auto scope = timers_.scope("assembly");
  std::vector<feti::Subdomain> subdomains;
  agree(*comm_, [&] {
    if (scene_.goesInSteps()) {
      loads_.emplace(scene_, owned_, costs_);
      loads_->requireConsistent();
    }
    subdomains = scene::assemble(scene_, owned_, costs_);
  });
  return {comm_, std::move(subdomains), dirichletForm(scene_, options_)};
}

void RunStages::makePipeline() {
  feti::SubdomainSystem system = assemble();
  share_.subdomains = system.size();
  for (int i = 0; i < system.size(); ++i)
    share_.primalDimension += static_cast<long long>(system.rhs(i).size());
  report_.primalDimension = system.primalDimension();
  report_.kernelDimension = system.kernelDimension();
  {
    const auto scope = timers_.scope("dual_operator");
    contact_ = scene::setUpContact(*comm_, scene_, owned_, costs_);
  }
  feti::PipelineObserver* const observer = this; // which others need not know
  pipeline_ = std::make_unique<feti::DualPipeline>(std::move(system), contact_.rows, dualOptions(), traits(),
                                                   log_, observer);
  pipeline_->problem();
}

// What the run that wrote a checkpoint has chosen; and that rounded products, or single precision, were not
// good enough for it.
feti::DualOptions RunStages::dualOptions() const {
  feti::DualOptions options = options_.dual;
  if (const CheckpointReader* checkpoint = directory_.checkpoint()) {
    options.before = feti::dualFormsFrom(checkpoint->text("dual forms"));
    if (checkpoint->text("products") == "double") {
      options.mayRound = false;
      options.inverses.precision = feti::Precision::Double;
    }
  }
  // FU and what products say of it cancel to many digits.
  if (options.adaptive.vectors == feti::AdaptiveVectors::All)
    options.mayRound = false;
  return options;
}

feti::ProblemTraits RunStages::traits() const {
  return {scene_.materialContrast(), scene_.hasSeveralMaterials(), !scene_.hasSeveralMaterials(),
          feti::DualOptions::usualProducts(isElastic(), options_.tolerance), options_.fixedTolerance()};
}

std::shared_ptr<void> RunStages::during(feti::PipelineStage stage) {
  const char* const name = stage == feti::PipelineStage::Inverses ? "factorization"
                           : stage == feti::PipelineStage::Coarse ? "coarse"
                           : stage == feti::PipelineStage::Solve  ? "solve"
                                                                  : "dual_operator";
  return std::shared_ptr<void>(new StageTimers::Scope(timers_.scope(name)),
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
  for (const std::string& note : contact_.notes)
    log_.info(note);
  const feti::Constraints& constraints = *pipeline.constraints();
  if (pipeline.system().dirichletForm() == feti::DirichletForm::Dual)
    costs_.countPrescribedAsRows();
  report_.effectCosts = costs_.total(*comm_);
  report_.dualDimension = constraints.dualDimension();
  report_.inequalities = constraints.inequalities();
  report_.limited = constraints.limited();
  report_.bonds = contact_.bondCount;
  log_.info(
      "Primal dimension " + std::to_string(report_.primalDimension) + ", dual dimension " +
      std::to_string(report_.dualDimension) + " (" + std::to_string(report_.inequalities) + " inequalities" +
      (report_.limited > 0 ? ", " + std::to_string(report_.limited) +
                                 (contact_.bondCount == 0 ? " of friction" : " of friction and adhesion")
                           : "") +
      "), kernel dimension " + std::to_string(report_.kernelDimension));
  if (!report_.effectCosts.empty())
    log_.info(scene::costText(report_.effectCosts));
}

void RunStages::tellInverses(const feti::DualPipeline& pipeline) {
  const feti::DualOptions::Decided& decided = pipeline.decided();
  const bool isFirst = pipeline.counts().inverses == 1;
  report_.isSingle = decided.isSingle();
  report_.localCondition = pipeline.accuracy().condition;
  tellFactors(pipeline);
  if (!isFirst)
    return;
  report_.dualOperator = decided.describe();
  report_.dualForms = toString(decided.forms());
  report_.clusters = decided.clusters();
  report_.localSolver = decided.inverses.solver.effectiveName();
  std::ostringstream text;
  text << report_.distinctFactorizations << " local factorisations (" << report_.localSolver << ") of "
       << report_.subdomains << " subdomains, " << std::fixed << std::setprecision(0)
       << report_.dualOperatorMiB << " MiB; condition number of subdomains about "
       << scientific(report_.localCondition, 0);
  if (report_.roundedFactorizations > 0)
    text << "; applications of " << report_.roundedFactorizations << " in single precision";
  if (const auto replaced =
          globalSum(*comm_, static_cast<long long>(pipeline.inverses()->replacedFactorizations()));
      replaced > 0)
    text << "; " << replaced << " of them implicit (too ill-conditioned to condense)";
  log_.info(text.str());
}

// To the report.
void RunStages::tellFactors(const feti::DualPipeline& pipeline) {
  share_.dualOperatorMiB = pipeline.inverses()->bytes() / mebi;
  report_.dualOperatorMiB = globalSum(*comm_, share_.dualOperatorMiB);
  report_.distinctFactorizations =
      globalSum(*comm_, static_cast<long long>(pipeline.inverses()->distinctFactorizations()));
  report_.roundedFactorizations = pipeline.accuracy().roundedFactorizations;
  report_.factorisations =
      globalSum(*comm_, static_cast<long long>(pipeline.factorizations().factorizations));
}

void RunStages::countFactorisations() {
  report_.factorisations =
      globalSum(*comm_, static_cast<long long>(pipeline_->factorizations().factorizations));
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
  const feti::CoarseSpace& coarse = *pipeline.coarse();
  report_.coarseDimension = coarse.dimension();
  report_.isCoarseDistributed = coarse.isDistributed();
  if (report_.clusters > 0)
    log_.info(feti::describeClusters(pipeline.system(), *pipeline.inverses()));
  if (report_.isCoarseDistributed)
    log_.info("Coarse problem of dimension " + std::to_string(coarse.dimension()) + ": " +
              coarse.description());
  if (coarse.dimension() < coarse.kernelDimension())
    log_.info(std::to_string(coarse.kernelDimension() - coarse.dimension()) +
              " rigid-body modes without any constraint (a round body without friction rotates freely); "
              "their displacement is set to zero");
  if (isHeldWeakly(pipeline))
    log_.info("Weakly constrained rigid-body mode: smallest singular value of G about " +
              scientific(std::pow(10.0, std::round(0.5 * std::log10(coarse.smallestPivotRatio()))), 0) +
              " of the largest (a round body with faceted normals rotates almost freely)");
}

void RunStages::prepare(const Data& data) {
  time_ = data.time;
  {
    const auto scope = timers_.scope("dual_operator");
    pipeline_->setLoads(data.loads);
    if (data.prescribed != nullptr)
      pipeline_->setPrescribed(*data.prescribed);
    if (data.rows != nullptr)
      pipeline_->setBounds(*data.rows);
    if (data.rows != nullptr && report_.limited > 0)
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
  return Teuchos::rcp(new RunMonitor(*comm_, options_, checkpoint, contact_, log, report_, std::move(place)));
}

feti::IncrementSolver::Increment RunStages::increment(const feti::IncrementSolver::Task& task) {
  if (!increments_)
    increments_.emplace(*pipeline_, solverOptions(scene_, options_), log_);
  return increments_->solve(task, report_.audit.largestDisplacement);
}

namespace {

// What answers are judged by: an entry for each effect with rows.
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
    if (rows[k] > 0.0) {
      groupOf[k] = static_cast<int>(criteria.groups.size());
      criteria.groups.push_back(paths[k]);
    }
  for (const scene::ContactSetup::Origin& origin : contact.origins)
    criteria.groupOf.push_back(groupOf[places.at(origin.effect)]);
}

} // namespace

feti::AnswerCriteria RunStages::criteria() const {
  feti::AnswerCriteria result;
  result.rule = options_.toleranceRule;
  result.solverErrorShare = options_.solverErrorShare;
  result.estimate = [this](const feti::TornVector& displacement) {
    return estimateDiscretisationError(*comm_, scene_, owned_, displacement, time_);
  };
  result.boundRounding = pipeline_->accuracy().boundRounding;
  addGroups(*comm_, scene_, contact_, result);
  return result;
}

void RunStages::solve(const feti::WarmStart* start, const Teuchos::RCP<RunMonitor>& monitor, const Log& log,
                      double secondsSpent, double tolerance) {
  const std::optional<feti::WarmStart> reached = monitor->startOfOtherClusters(pipeline_->problem());
  feti::SolverOptions options = solverOptions(scene_, options_);
  options.tolerance = tolerance;
  constexpr double leastSeconds = 1e-3; // 0 is no limit
  if (options.maximumSeconds > 0.0)
    options.maximumSeconds = std::max(leastSeconds, options.maximumSeconds - secondsSpent);
  if (log.showsStatus() || !log.writesInfo())
    options.progressFrequency = 0;
  solve_.emplace(
      *pipeline_, [this] { return pipeline_->stages(); }, options, criteria(), log, report_, report_);
  solve_->go(reached ? &*reached : start, monitor);
  directory_.removeQuietly(directory_.place("contact.csv"));
}

// There may be little time left.
void RunStages::leaveInterrupted() {
  const auto scope = timers_.scope("output");
  report_.audited = false;
  report_.reason += report_.checkpointFault.empty()
                        ? "; continue with --restart \"" + options_.outputDirectory + "\""
                        : "; no checkpoint: " + report_.checkpointFault;
  logResult(log_, report_);
  directory_.writeIterations(report_.result.history);
}

// K is known to rounding errors, and what they do to its softest motions is κ times as large: no solver can
// do better.
void RunStages::tellWhatIsAttainable() {
  const double attainable = 0.5 * std::numeric_limits<double>::epsilon() * report_.localCondition;
  const qp::Reason reason = report_.result.reason;
  const bool isGivenUp = reason == qp::Reason::IterationLimit || reason == qp::Reason::Breakdown;
  if (report_.converged || !isGivenUp || !(attainable >= report_.tolerance))
    return;
  report_.reason =
      "attainable accuracy: rounding errors of a subdomain's matrix change its softest modes by at least " +
      scientific(attainable, 0) + " (relative, condition number at least " +
      scientific(report_.localCondition, 0) + "), above the tolerance " + scientific(report_.tolerance, 0) +
      ". Loosen the tolerance, or use less thin cells, smaller material jumps or a Poisson's ratio further "
      "from 0.5; " +
      report_.reason;
}

void RunStages::recover() {
  tellWhatIsAttainable();
  if (solve_->solution().isEscaping)
    report_.reason += "; unconstrained rigid-body mode under load: " + escapingBodies();
  {
    const auto scope = timers_.scope("recovery");
    torn_ = solve_->recover();
  }
  judgeDrift();
  solve_->conclude();
  const auto scope = timers_.scope("recovery");
  if (report_.inequalities > 0)
    report_.contact =
        contactStates(*comm_, contact_.points, feti::contactState(*pipeline_->constraints(), torn_));
  if (report_.limited > 0) {
    report_.slips = rowSlips(*comm_, contact_, feti::frictionState(*pipeline_->constraints(), torn_));
    addSlips(*comm_, contact_, report_.slips, slipsBefore_, report_.contact);
  }
  report_.contactCounts = countContact(*comm_, report_.contact);
  reactions_ = feti::reactions(pipeline_->system(), *pipeline_->constraints(), torn_);
  report_.forces = forcesOf(*comm_, scene_, owned_, pipeline_->system(), contact_, torn_.displacement,
                            reactions_, pipeline_->constraints()->givenMultipliers(*torn_.multiplier));
  // Where nothing is strained: rounding errors of stiffness times displacement are in no balance. Loads and
  // springs are no such errors.
  constexpr double rounding = 1e-12;
  const feti::KktAudit& audit = report_.audit;
  if (report_.forces.known < 0.5 * report_.forces.size &&
      report_.forces.size <= rounding * audit.unitEnergy * audit.unitEnergy * audit.largestDisplacement)
    report_.forces.balance = 0.0;
  for (const PairError& pair : report_.pairErrors)
    for (Forces::Of& effect : report_.forces.effects)
      if (effect.path == pair.path)
        effect.error = pair.relative();
}

void RunStages::tellResult() const {
  logResult(log_, report_);
  if (const std::string text = forcesText(report_.forces); !text.empty())
    log_.info(text);
  log_.info(auditText(report_));
  if (const std::string text = attainableText(report_); report_.converged && !text.empty())
    log_.info(text);
  if (const std::string text = doubtfulForces(report_); report_.converged && !text.empty())
    log_.info(text);
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
  if (!report_.converged || coarse.dimension() == 0 || pipeline_->constraints()->hasWeights() ||
      coarse.smallestPivotRatio() >= hardly)
    return;
  const std::string drift = driftText(*comm_, scene_, owned_, torn_.displacement, prescribed);
  if (drift.empty())
    return;
  report_.converged = false;
  report_.reason = drift;
}

// "“second membrane”": the bodies that have a share in a rigid motion.
std::string RunStages::escapingBodies() const {
  std::vector<long long> bodyOf;
  for (const scene::OwnedSubdomain& item : owned_)
    bodyOf.push_back(item.body);
  std::string names;
  for (const long long body : feti::escapingParts(pipeline_->coarse()->motions(), solve_->solution().escape,
                                                  bodyOf, static_cast<long long>(scene_.bodies.size())))
    names += (names.empty() ? "\"" : ", \"") + scene_.bodies[static_cast<std::size_t>(body)].name + "\"";
  return names;
}

void RunStages::write() {
  const auto scope = timers_.scope("output");
  directory_.writeIterations(report_.result.history);
  if (options_.writeFields)
    writeFields("result.vtkhdf");
}

void RunStages::writeFields(const std::string& file) {
  ResultFields fields;
  fields.displacement = &torn_.displacement;
  fields.components = scene_.components();
  std::vector<std::vector<fem::Voigt>> stress;
  if (options_.writeStresses && isElastic()) {
    stress = recoverStress(*comm_, scene_, owned_, torn_.displacement, time_);
    fields.stress = &stress;
  }
  ContactFields atNodes;
  if (report_.inequalities > 0) {
    fields.kinds = {contact_.hasFriction, scene_.breaks()};
    atNodes = contactFields(*comm_, owned_, contact_.points, report_.contact, fields.kinds);
    fields.contact = &atNodes;
  }
  writeResult(*comm_, directory_.place(file), owned_, fields);
}

} // namespace Harmos::run
