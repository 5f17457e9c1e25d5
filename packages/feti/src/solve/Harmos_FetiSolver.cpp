// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FetiSolver.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_DualOperator.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>

namespace Harmos::feti {
namespace {

// What all bounds are known to.
double roundingOf(const Teuchos::Comm<int>& comm, const std::vector<ConstraintRow>& rows) {
  double rounding = 0.0;
  for (const ConstraintRow& row : rows)
    rounding = std::max(rounding, row.rounding);
  return globalMax(comm, rounding);
}

} // namespace

ParameterSpec FetiSolver::parameters() {
  ParameterSpec spec("Harmos FETI", "A torn problem of an application's own.");
  DualOptions::addDecompositionTo(spec);
  DualOptions::addTo(spec);
  ParameterSpec solver("Solver", "Solution of the dual quadratic program.");
  SolverOptions::addTo(solver);
  spec.list(std::move(solver));
  return spec;
}

FetiSolver::FetiSolver(Teuchos::RCP<const Teuchos::Comm<int>> comm, std::vector<Subdomain> subdomains,
                       const std::vector<ConstraintRow>& rows, const Teuchos::ParameterList& given,
                       const Log& log)
    : log_(log) {
  std::vector<std::string> notes;
  list_ = parameters().validated(given, "the parameters given", &notes);
  for (const std::string& note : notes)
    log_.info("Note: " + note);
  dual_ = DualOptions::fromList(list_.sublist("Dual operator"));
  dual_.coarse = dual_.coarseFrom(list_.sublist("Decomposition"));
  dual_.clusters = DualOptions::clustersFrom(list_.sublist("Decomposition"));
  options_ = SolverOptions::fromList(list_.sublist("Solver"));
  const DirichletForm form =
      DualOptions::decompositionFrom(list_.sublist("Decomposition")).value_or(DirichletForm::Primal);
  rounding_ = roundingOf(*comm, rows);
  system_ = std::make_unique<SubdomainSystem>(std::move(comm), std::move(subdomains), form);
  contrast_ = std::max(stiffnessContrast(*system_), complianceContrast(*system_, rows));
  constraints_ = std::make_unique<Constraints>(*system_, rows, dual_.weightsFor(contrast_));
  setUpInverses();
  setUpOperators();
}

FetiSolver::~FetiSolver() = default;

void FetiSolver::setUpInverses() {
  // What the subdomains are made of is not known here: materials may jump within them.
  const int products = DualOptions::usualProducts(true, options_.tolerance);
  decided_ = dual_.decided(*system_, *constraints_, products, false, log_);
  clusters_ = dual_.clustersFor(*system_, *constraints_, decided_, products, log_);
  decided_.inverses.clusters = makeClusters(*system_, *constraints_, clusters_);
  auto made = std::make_unique<LocalInverses>(makeLocalInverses(*system_, *constraints_, decided_.inverses));
  if (inverses_)
    spent_ += inverses_->counts();
  inverses_ = std::move(made);
  defect_ = globalMax(*system_->comm(), inverses_->defect());
}

// All that is made of the inverses and kernels. The operator last: it tells that the rest is there.
void FetiSolver::setUpOperators() {
  problem_.reset();
  history_.clear();
  increments_.clear();
  adaptive_.reset();
  coarse_ = makeCoarseSpace(motionsOf(*system_, *inverses_), *constraints_, dual_.coarse);
  preconditioner_ =
      decided_.preconditioner == PreconditionerKind::None
          ? Teuchos::null
          : Teuchos::rcp(new DualPreconditioner(*system_, *constraints_, *inverses_, decided_.preconditioner,
                                                dual_.scalingFor(false, contrast_)));
  operator_ = std::make_unique<DualOperator>(*constraints_, *inverses_);
  adaptive_ = std::make_unique<AdaptiveSpace>(
      AdaptiveSpace::Stages{*system_, *constraints_, *inverses_, *coarse_, *operator_, preconditioner_},
      AdaptiveSpace::Forms{decided_.inverses, decided_.preconditioner, dual_.scalingFor(false, contrast_)},
      dual_.adaptive);
}

void FetiSolver::setLoads(std::vector<std::shared_ptr<const std::vector<double>>> loads) {
  system_->setLoads(std::move(loads));
  problem_.reset();
}

void FetiSolver::setPrescribed(const std::vector<std::vector<double>>& values) {
  system_->setPrescribed(values);
  problem_.reset();
}

void FetiSolver::setBounds(const std::vector<ConstraintRow>& rows) {
  constraints_->setBounds(rows);
  problem_.reset();
}

void FetiSolver::setMatrices(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness,
                             const std::vector<std::shared_ptr<const Kernel>>& motions) {
  const Factored before = operator_ ? factored() : Factored(); // after an error in the midst nothing is known
  system_->setMatrices(stiffness, motions);
  forgetOperators();
  renewInverses(before);
  setUpOperators();
}

void FetiSolver::setShape(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness,
                          const std::vector<std::shared_ptr<const Kernel>>& motions,
                          std::vector<std::shared_ptr<const std::vector<double>>> loads,
                          const std::vector<ConstraintRow>& rows) {
  const Factored before = operator_ ? factored() : Factored(); // after an error in the midst nothing is known
  system_->setMatrices(stiffness, motions);
  forgetOperators();
  system_->setLoads(std::move(loads));
  constraints_ = std::make_unique<Constraints>(*system_, rows, dual_.weightsFor(contrast_));
  solution_.reset(); // its multipliers are those of the rows of before
  renewInverses(before);
  setUpOperators();
}

// The matrices and kernels that inverses are of, or are to be of.
FetiSolver::Factored FetiSolver::factored() const {
  Factored result;
  for (int i = 0; i < system_->size(); ++i)
    result.emplace_back(&system_->matrix(i), &system_->kernel(i));
  return result;
}

// From here on nothing that was made of the old matrices may be used, also if a factorisation fails.
void FetiSolver::forgetOperators() {
  problem_.reset();
  history_.clear();
  increments_.clear();
  adaptive_.reset();
  operator_.reset();
  preconditioner_ = Teuchos::null;
}

void FetiSolver::renewInverses(const Factored& before) {
  const Factored now = factored();
  std::vector<CongruenceClass> classes;
  std::vector<char> isSame;
  agree(*system_->comm(), [&] {
    classes =
        congruenceClasses(*system_, *constraints_, decided_.inverses.share, decided_.inverses.fixingPlaces);
    for (std::size_t i = 0; i < now.size(); ++i)
      isSame.push_back(!before.empty() && now[i] == before[i] ? 1 : 0);
  });
  const auto same = [](const CongruenceClass& a, const CongruenceClass& b) {
    return a.members == b.members && a.boundary == b.boundary;
  };
  const bool areSame = std::equal(classes.begin(), classes.end(), inverses_->classes().begin(),
                                  inverses_->classes().end(), same);
  if (globalMin(*system_->comm(), areSame ? 1LL : 0LL) > 0) {
    decided_.inverses.clusters = makeClusters(*system_, *constraints_, clusters_);
    inverses_->refactor(*system_, decided_.inverses, isSame);
  } else {
    setUpInverses();
  }
}

const SolveReport& FetiSolver::solve() {
  return solve(options_.tolerance);
}

void FetiSolver::requireOperators() const {
  if (!operator_)
    throw InputError(
        "the last setMatrices() or setShape() failed; give matrices that can be factored, and rows that fit "
        "them, or make a new solver");
}

const SolveReport& FetiSolver::solve(double tolerance) {
  requireOperators();
  if (!problem_) {
    try {
      problem_ = std::make_unique<DualProblem>(*system_, *constraints_, *inverses_, *operator_, *coarse_);
    } catch (const NumericalError& error) { // on all ranks: loads on a motion that nothing can hold
      report_ = {};
      report_.reason = error.what();
      solution_.reset();
      return report_;
    }
  }
  Answer answer = solved({*system_, *constraints_, *problem_, history_, rounding_, 0.0}, tolerance);
  report_ = std::move(answer.report);
  audit_ = answer.audit;
  solution_ = std::make_unique<TornSolution>(std::move(answer.torn));
  return report_;
}

FetiSolver::Increment
FetiSolver::solveIncrement(std::vector<std::shared_ptr<const std::vector<double>>> loads,
                           const std::vector<ConstraintRow>& rows, double tolerance, bool withDisplacement) {
  requireOperators();
  SubdomainSystem system = *system_;
  system.setLoads(std::move(loads));
  std::vector<std::vector<double>> held;
  for (int i = 0; i < system.size(); ++i)
    held.emplace_back(system.subdomain(i).fixed.size(), 0.0);
  system.setPrescribed(held);
  const Constraints constraints = constraints_->withBounds(system, rows);
  const DualProblem problem(system, constraints, *inverses_, *operator_, *coarse_);
  // Gaps of the last solution are known to rounding errors, and changes of them to the same share.
  const double size = solution_ ? audit_.largestDisplacement : 0.0,
               share = size > 0.0 ? rounding_ / size : 0.0;
  double largest = 0.0;
  for (const ConstraintRow& row : rows)
    largest = std::max(largest, std::abs(row.bound));
  const double rounding = roundingOf(*system.comm(), rows) + share * globalMax(*system.comm(), largest);
  Answer answer =
      solved({system, constraints, problem, increments_, rounding, share}, tolerance, withDisplacement);
  return {std::move(answer.report), std::move(answer.torn.displacement),
          constraints.givenMultipliers(*answer.torn.multiplier)};
}

FetiSolver::Answer FetiSolver::solved(const Task& task, double tolerance, bool recovers) {
  const DualStages stages{task.system,  task.constraints, *inverses_,     *coarse_,
                          task.problem, preconditioner_,  adaptive_.get()};
  const std::optional<WarmStart> start = task.history.start(task.problem, tolerance);
  Answer answer;
  bool looked = !recovers, agrees = !recovers;
  const auto look = [&](const MultiVector& lambda, const std::vector<double>& mu) {
    answer.torn = recover(task.system, task.constraints, *inverses_, *coarse_, task.problem, lambda, mu);
    answer.audit = feti::audit(task.system, task.constraints, answer.torn);
    const double rounding = task.rounding + task.roundingShare * answer.audit.largestDisplacement;
    return auditAgrees(answer.audit, {auditShare(tolerance), rounding, defect_});
  };
  const auto accept = [&](const MultiVector& lambda, const std::vector<double>& mu,
                          double reached) -> Verdict {
    const double least = decided_.inverses.precision == Precision::Single ? 1e-7 : 1e-15;
    looked = true;
    agrees = look(lambda, mu);
    if (agrees || reached / 10.0 < least)
      return {};
    log_.info("Audit contradicts the residuals: continue with a smaller tolerance");
    return {reached / 10.0, false};
  };
  SolveReport& report = answer.report;
  SolverOptions options = options_;
  options.tolerance = tolerance;
  const DualSolution dual = solveDualProblem(stages, options, start ? &*start : nullptr,
                                             recovers ? Acceptance(accept) : Acceptance(), log_, report);
  operator_->rethrowFailure();
  if (!preconditioner_.is_null())
    preconditioner_->rethrowFailure();
  if (dual.isEscaping)
    report.reason += "; unconstrained rigid-body mode under load: " + escapingSubdomains(dual);
  if (!recovers) {
    const Teuchos::RCP<MultiVector> total = Teuchos::rcp(new MultiVector(*dual.lambda, Teuchos::Copy));
    total->update(1.0, *task.problem.shift(), 1.0);
    answer.torn.multiplier = total;
  }
  // An answer that was accepted has been looked at last.
  if (recovers && (!looked || !report.converged))
    agrees = look(*dual.lambda, dual.mu);
  if (!agrees && report.converged && report.solver != "Dual Penalty") {
    report.converged = false;
    report.reason = "the residuals of the dual problem reached their rounding level, but the audit of "
                    "displacements and forces contradicts them";
  }
  if (report.converged)
    task.history.add(task.problem, answer.torn.multiplier, dual.mu);
  return answer;
}

void FetiSolver::exchangeStarts(qp::StateArchive<MultiVector>& archive) {
  if (!problem_)
    throw InputError("there is no dual problem yet, so no start for it can be set; call solve() first");
  history_.exchange(archive, *problem_);
  increments_.exchange(archive, *problem_, "increments: ");
}

// "subdomains 4, 5, 6": whoever made them knows what bodies they are of.
std::string FetiSolver::escapingSubdomains(const DualSolution& dual) const {
  constexpr std::size_t mostNamed = 20;
  std::vector<long long> numbers;
  for (int i = 0; i < system_->size(); ++i)
    numbers.push_back(system_->subdomain(i).number);
  const std::vector<long long> parts =
      escapingParts(coarse_->motions(), dual.escape, numbers, system_->globalSubdomains());
  std::string text = parts.size() == 1 ? "subdomain" : "subdomains";
  for (std::size_t k = 0; k < std::min(parts.size(), mostNamed); ++k)
    text += (k == 0 ? " " : ", ") + std::to_string(parts[k]);
  if (parts.size() > mostNamed)
    text += " and " + std::to_string(parts.size() - mostNamed) + " more";
  return text;
}

const TornSolution& FetiSolver::solution() const {
  if (!solution_)
    throw InputError("there is no solution yet; call solve() first");
  return *solution_;
}

FactorizationCounts FetiSolver::factorizations() const {
  FactorizationCounts sum = spent_;
  sum += inverses_->counts();
  return sum;
}

} // namespace Harmos::feti
