// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RunStages.hpp"

#include "Harmos_Drift.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_BoundaryParts.hpp"
#include "Harmos_ContactFields.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_DualOperator.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_EnergyAccount.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Recovery.hpp"
#include "Harmos_ResultFile.hpp"
#include "Harmos_RunMonitor.hpp"
#include "Harmos_StressRecovery.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <set>
#include <sstream>

namespace Harmos::run {
namespace {

constexpr double mebi = 1048576.0;

const char* const contradiction =
    "the residuals of the dual problem reached their rounding level, but the audit of displacements and "
    "forces contradicts them. Likely causes are single precision, material jumps of many orders of magnitude "
    "or slender bodies; use fewer subdomains or \"Dual operator/Precision\" = \"double\"";

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
  assemble();
  constrain();
  factorise();
  makeDualProblem();
}

RunStages::~RunStages() = default;

Solution RunStages::goOnce() {
  setUp();
  solve(nullptr, monitor(directory_.checkpoint(), log_, {}), log_, 0.0, options_.tolerance);
  if (report_.isInterrupted()) {
    leaveInterrupted();
    return {std::move(owned_), {}, solution_.lambda};
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
      const std::vector<feti::FixedDof>& fixed = system_->subdomain(static_cast<int>(i)).fixed;
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
  return {std::move(owned_), std::move(torn_.displacement), solution_.lambda};
}

void RunStages::announce() {
  report_.ranks = comm_->getSize();
  report_.scene = scene_.name;
  report_.effects = scene_.effectKinds();
  report_.tolerance = options_.tolerance;
  report_.toleranceRule = options_.toleranceRule == ToleranceRule::Balanced ? "balanced" : "fixed";
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

void RunStages::assemble() {
  {
    const auto scope = timers_.scope("assembly");
    std::vector<feti::Subdomain> subdomains;
    agree(*comm_, [&] {
      if (scene_.goesInSteps()) {
        loads_.emplace(scene_, owned_, costs_);
        loads_->requireConsistent();
      }
      subdomains = scene::assemble(scene_, owned_, costs_);
    });
    system_.emplace(comm_, std::move(subdomains), dirichletForm(scene_, options_));
  }
  share_.subdomains = system_->size();
  for (int i = 0; i < system_->size(); ++i)
    share_.primalDimension += static_cast<long long>(system_->rhs(i).size());
  report_.primalDimension = system_->primalDimension();
  report_.kernelDimension = system_->kernelDimension();
}

void RunStages::constrain() {
  {
    const auto scope = timers_.scope("dual_operator");
    contact_ = scene::setUpContact(*comm_, scene_, owned_, costs_);
    constraints_.emplace(*system_, contact_.rows, options_.dual.weightsFor(scene_.materialContrast()));
  }
  for (const std::string& note : contact_.notes)
    log_.info(note);
  for (const ConstraintRow& row : contact_.rows)
    report_.gapRounding = std::max(report_.gapRounding, row.rounding);
  report_.gapRounding = globalMax(*comm_, report_.gapRounding);
  if (system_->dirichletForm() == feti::DirichletForm::Dual)
    costs_.countPrescribedAsRows();
  report_.effectCosts = costs_.total(*comm_);
  report_.dualDimension = constraints_->dualDimension();
  report_.inequalities = constraints_->inequalities();
  report_.limited = constraints_->limited();
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

namespace {

// What the run that wrote it has chosen; and that rounded products, or single precision, were not good enough
// for it.
void takeFrom(const CheckpointReader& checkpoint, feti::DualOptions& options) {
  options.before = feti::dualFormsFrom(checkpoint.text("dual forms"));
  if (checkpoint.text("products") != "double")
    return;
  options.mayRound = false;
  options.inverses.precision = feti::Precision::Double;
}

} // namespace

void RunStages::factorise() {
  {
    const auto scope = timers_.scope("factorization");
    feti::DualOptions dual = options_.dual;
    if (directory_.checkpoint() != nullptr)
      takeFrom(*directory_.checkpoint(), dual);
    // FU and what products say of it cancel to many digits.
    if (dual.adaptive.vectors == feti::AdaptiveVectors::All)
      dual.mayRound = false;
    const int products = feti::DualOptions::usualProducts(isElastic(), options_.tolerance);
    const feti::DualOptions::Decided decided = dual.decided(
        *system_, *constraints_, products, !scene_.hasSeveralMaterials(), log_, options_.fixedTolerance());
    report_.dualOperator = decided.describe();
    report_.dualForms = toString(decided.forms());
    preconditionerKind_ = decided.preconditioner;
    inverseOptions_ = decided.inverses;
    inverseOptions_.clusters = feti::makeClusters(
        *system_, *constraints_, dual.clustersFor(*system_, *constraints_, decided, products, log_));
    report_.clusters = inverseOptions_.clusters ? inverseOptions_.clusters->total() : 0;
    report_.localSolver = inverseOptions_.solver.effectiveName();
    report_.isSingle = inverseOptions_.precision == feti::Precision::Single;
    inverses_.emplace(feti::makeLocalInverses(*system_, *constraints_, inverseOptions_));
    report_.localCondition = globalMax(*comm_, inverses_->condition());
    report_.localDefect = globalMax(*comm_, inverses_->defect());
    tellFactors();
  }
  std::ostringstream text;
  text << report_.distinctFactorizations << " local factorisations (" << report_.localSolver << ") of "
       << report_.subdomains << " subdomains, " << std::fixed << std::setprecision(0)
       << report_.dualOperatorMiB << " MiB; condition number of subdomains about "
       << scientific(report_.localCondition, 0);
  if (report_.roundedFactorizations > 0)
    text << "; applications of " << report_.roundedFactorizations << " in single precision";
  if (const auto replaced = globalSum(*comm_, static_cast<long long>(inverses_->replacedFactorizations()));
      replaced > 0)
    text << "; " << replaced << " of them implicit (too ill-conditioned to condense)";
  log_.info(text.str());
}

// To the report.
void RunStages::tellFactors() {
  share_.dualOperatorMiB = inverses_->bytes() / mebi;
  report_.dualOperatorMiB = globalSum(*comm_, share_.dualOperatorMiB);
  report_.distinctFactorizations =
      globalSum(*comm_, static_cast<long long>(inverses_->distinctFactorizations()));
  report_.roundedFactorizations =
      globalSum(*comm_, static_cast<long long>(inverses_->roundedFactorizations()));
  countFactorisations();
}

void RunStages::countFactorisations() {
  report_.factorisations = globalSum(*comm_, static_cast<long long>(inverses_->counts().factorizations));
}

feti::PreconditionerScaling RunStages::scaling() const {
  return options_.dual.scalingFor(scene_.hasSeveralMaterials(), scene_.materialContrast());
}

void RunStages::makeOperators() {
  dualOperator_ = std::make_unique<feti::DualOperator>(*constraints_, *inverses_);
  if (preconditionerKind_ != feti::PreconditionerKind::None) {
    const auto scope = timers_.scope("dual_operator");
    preconditioner_ = Teuchos::rcp(
        new feti::DualPreconditioner(*system_, *constraints_, *inverses_, preconditionerKind_, scaling()));
  }
}

void RunStages::makeDualProblem() {
  makeOperators();
  {
    const auto scope = timers_.scope("coarse");
    coarse_ =
        feti::makeCoarseSpace(feti::motionsOf(*system_, *inverses_), *constraints_, options_.dual.coarse);
  }
  report_.coarseDimension = coarse_->dimension();
  report_.isCoarseDistributed = coarse_->isDistributed();
  sayCoarse();
  {
    const auto scope = timers_.scope("dual_operator");
    dual_.emplace(*system_, *constraints_, *inverses_, *dualOperator_, *coarse_);
  }
  bindStages();
}

void RunStages::bindStages() {
  adaptive_.emplace(feti::AdaptiveSpace::Stages{*system_, *constraints_, *inverses_, *coarse_, *dualOperator_,
                                                preconditioner_},
                    feti::AdaptiveSpace::Forms{inverseOptions_, preconditionerKind_, scaling()},
                    options_.dual.adaptive);
  dualStages_.emplace(
      feti::DualStages{*system_, *constraints_, *inverses_, *coarse_, *dual_, preconditioner_, &*adaptive_});
}

// Of G̃G̃ᵀ, whose pivots go with the squares of the singular values of G̃.
bool RunStages::isHeldWeakly() const {
  constexpr double weak = 1e-6;
  return coarse_->dimension() > 0 && coarse_->smallestPivotRatio() < weak && !constraints_->hasWeights();
}

void RunStages::sayCoarse() const {
  if (report_.clusters > 0)
    log_.info(feti::describeClusters(*system_, *inverses_));
  if (report_.isCoarseDistributed)
    log_.info("Coarse problem of dimension " + std::to_string(coarse_->dimension()) + ": " +
              coarse_->description());
  if (coarse_->dimension() < coarse_->kernelDimension())
    log_.info(std::to_string(coarse_->kernelDimension() - coarse_->dimension()) +
              " rigid-body modes without any constraint (a round body without friction rotates freely); "
              "their displacement is set to zero");
  if (isHeldWeakly())
    log_.info("Weakly constrained rigid-body mode: smallest singular value of G about " +
              scientific(std::pow(10.0, std::round(0.5 * std::log10(coarse_->smallestPivotRatio()))), 0) +
              " of the largest (a round body with faceted normals rotates almost freely)");
}

void RunStages::prepare(const Data& data) {
  const auto scope = timers_.scope("dual_operator");
  time_ = data.time;
  system_->setLoads(data.loads);
  if (data.prescribed != nullptr)
    system_->setPrescribed(*data.prescribed);
  if (data.rows != nullptr)
    constraints_->setBounds(*data.rows);
  if (data.rows != nullptr && report_.limited > 0)
    slipsBefore_ = slipsBefore(*data.rows);
  dual_.emplace(*system_, *constraints_, *inverses_, *dualOperator_, *coarse_);
}

void RunStages::checkBounds(const std::vector<std::vector<double>>& prescribed) {
  system_->setPrescribed(prescribed);
  constraints_->setBounds(contact_.rows);
}

Teuchos::RCP<RunMonitor> RunStages::monitor(const CheckpointReader* checkpoint, const Log& log,
                                            SolvePlace place) {
  return Teuchos::rcp(new RunMonitor(*comm_, options_, checkpoint, contact_, log, report_, std::move(place)));
}

void RunStages::solve(const feti::WarmStart* start, const Teuchos::RCP<RunMonitor>& monitor, const Log& log,
                      double secondsSpent, double tolerance) {
  if (options_.toleranceRule != ToleranceRule::Balanced)
    report_.tolerance = tolerance;
  monitor->addState([this](qp::StateArchive<MultiVector>& archive) { check_->exchange(archive); });
  const std::optional<feti::WarmStart> reached = monitor->startOfOtherClusters(*dual_);
  solveOnce(reached ? &*reached : start, monitor, log, secondsSpent);
  if (roundingIsSeen_)
    solveUnrounded(monitor, log, secondsSpent);
}

// Slender bodies, whose pieces bend more when cut than the whole does, show rounding errors of products in
// the jumps that are left: from where the solver has come to it goes on with products in double precision.
void RunStages::solveUnrounded(const Teuchos::RCP<RunMonitor>& monitor, const Log& log, double secondsSpent) {
  log.info(std::string(report_.isSingle ? "Single precision is" : "Single-precision application of F is") +
           " too inaccurate for this problem: switch to double precision");
  const qp::Result first = report_.result;
  const auto reached = Teuchos::rcp(new MultiVector(*solution_.lambda, Teuchos::Copy));
  reached->update(1.0, *dual_->shift(), 1.0);
  const feti::WarmStart start = {reached, solution_.mu};
  {
    const auto scope = timers_.scope("factorization");
    if (report_.isSingle) {
      inverseOptions_.precision = feti::Precision::Double;
      report_.isSingle = false;
      inverses_.emplace(feti::makeLocalInverses(*system_, *constraints_, inverseOptions_));
    } else {
      inverses_->restoreProducts(*comm_);
    }
    tellFactors();
  }
  makeOperators();
  dual_.emplace(*system_, *constraints_, *inverses_, *dualOperator_, *coarse_);
  bindStages();
  monitor->goesOnAfter(first.lastRecord());
  solveOnce(&start, monitor, log, secondsSpent + first.lastRecord().seconds);
  report_.result.goesOnAfter(first);
}

void RunStages::solveOnce(const feti::WarmStart* start, const Teuchos::RCP<RunMonitor>& monitor,
                          const Log& log, double secondsSpent) {
  roundingIsSeen_ = false;
  static_cast<feti::SolveReport&>(report_) = {};
  check_.emplace(*comm_, scene_, owned_, *dualStages_, contact_, options_, time_, log, report_);
  const auto accept = [&](const MultiVector& lambda, const std::vector<double>& mu, double tolerance) {
    const feti::Verdict verdict = check_->judge(lambda, mu, tolerance);
    // Asked for less than what products were rounded to: more of the same brings nothing.
    roundingIsSeen_ = (verdict.next && report_.roundedFactorizations > 0 &&
                       *verdict.next < 0.5 * inverseOptions_.productError) ||
                      (!verdict.next && report_.isSingle && !auditAgrees(report_));
    return roundingIsSeen_ ? feti::Verdict() : verdict;
  };
  feti::SolverOptions first = solverOptions(scene_, options_);
  first.tolerance =
      options_.toleranceRule == ToleranceRule::Balanced ? firstBalancedTolerance() : report_.tolerance;
  constexpr double leastSeconds = 1e-3; // 0 is no limit
  if (first.maximumSeconds > 0.0)
    first.maximumSeconds = std::max(leastSeconds, first.maximumSeconds - secondsSpent);
  if (log.showsStatus() || !log.writesInfo())
    first.progressFrequency = 0;
  {
    const auto scope = timers_.scope("solve");
    solution_ = feti::solveDualProblem(*dualStages_, first, start, accept, log, report_, monitor);
  }
  dualOperator_->rethrowFailure();
  if (!preconditioner_.is_null())
    preconditioner_->rethrowFailure();
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
  if (solution_.isEscaping)
    report_.reason += "; unconstrained rigid-body mode under load: " + escapingBodies();
  {
    const auto scope = timers_.scope("recovery");
    torn_ = check_->finish(*solution_.lambda, solution_.mu, report_.converged && !leavesJumps());
  }
  judgeAudit();
  const auto scope = timers_.scope("recovery");
  if (report_.inequalities > 0)
    report_.contact = contactStates(*comm_, contact_.points, feti::contactState(*constraints_, torn_));
  if (report_.limited > 0) {
    report_.slips = rowSlips(*comm_, contact_, feti::frictionState(*constraints_, torn_));
    addSlips(*comm_, contact_, report_.slips, slipsBefore_, report_.contact);
  }
  report_.contactCounts = countContact(*comm_, report_.contact);
  reactions_ = feti::reactions(*system_, *constraints_, torn_);
  report_.forces = forcesOf(*comm_, scene_, owned_, *system_, contact_, torn_.displacement, reactions_,
                            constraints_->givenMultipliers(*torn_.multiplier));
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

void RunStages::judgeAudit() {
  double prescribed = 0.0;
  for (int i = 0; i < system_->size(); ++i)
    for (const feti::FixedDof& fixed : system_->subdomain(i).fixed)
      prescribed = std::max(prescribed, std::abs(fixed.value));
  // Soft springs let bodies move as far, and hold them.
  constexpr double hardly = 1e-3;
  if (report_.converged && coarse_->dimension() > 0 && !constraints_->hasWeights() &&
      coarse_->smallestPivotRatio() < hardly)
    if (const std::string drift = driftText(*comm_, scene_, owned_, torn_.displacement, prescribed);
        !drift.empty()) {
      report_.converged = false;
      report_.reason = drift;
    }
  if (!report_.converged || leavesJumps() || auditAgrees(report_))
    return;
  report_.converged = false;
  const std::string ofRows = rowForceText(report_);
  report_.reason = ofRows.empty() ? contradiction : ofRows;
}

// "“second membrane”": the bodies that have a share in a rigid motion.
std::string RunStages::escapingBodies() const {
  std::vector<long long> bodyOf;
  for (const scene::OwnedSubdomain& item : owned_)
    bodyOf.push_back(item.body);
  std::string names;
  for (const long long body : feti::escapingParts(coarse_->motions(), solution_.escape, bodyOf,
                                                  static_cast<long long>(scene_.bodies.size())))
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
