// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FetiSolver.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Errors.hpp"

#include <algorithm>

namespace Harmos::feti {
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
  DualOptions dual = DualOptions::fromList(list_.sublist("Dual operator"));
  dual.coarse = dual.coarseFrom(list_.sublist("Decomposition"));
  dual.clusters = DualOptions::clustersFrom(list_.sublist("Decomposition"));
  options_ = SolverOptions::fromList(list_.sublist("Solver"));
  const DirichletForm form =
      DualOptions::decompositionFrom(list_.sublist("Decomposition")).value_or(DirichletForm::Primal);
  SubdomainSystem system(std::move(comm), std::move(subdomains), form);
  ProblemTraits traits;
  traits.contrast = std::max(stiffnessContrast(system), complianceContrast(system, rows));
  // What the subdomains are made of is not known here: materials may jump within them.
  traits.usualApplications = DualOptions::usualProducts(true, options_.tolerance);
  pipeline_ = std::make_unique<DualPipeline>(std::move(system), rows, dual, traits, log_);
  increments_ = std::make_unique<IncrementSolver>(*pipeline_, options_, log_);
}

FetiSolver::~FetiSolver() = default;

void FetiSolver::setLoads(std::vector<std::shared_ptr<const std::vector<double>>> loads) {
  pipeline_->setLoads(std::move(loads));
}

void FetiSolver::setPrescribed(const std::vector<std::vector<double>>& values) {
  pipeline_->setPrescribed(values);
}

void FetiSolver::setBounds(const std::vector<ConstraintRow>& rows) {
  pipeline_->setBounds(rows);
}

void FetiSolver::setRows(const std::vector<ConstraintRow>& rows) {
  changing([&] { pipeline_->setRows(rows); });
}

void FetiSolver::setMatrices(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness,
                             const std::vector<std::shared_ptr<const Kernel>>& motions) {
  pipeline_->setMatrices(stiffness, motions);
  history_.clear();
  increments_->clear();
}

void FetiSolver::setShape(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness,
                          const std::vector<std::shared_ptr<const Kernel>>& motions,
                          std::vector<std::shared_ptr<const std::vector<double>>> loads,
                          const std::vector<ConstraintRow>& rows) {
  changing([&] { pipeline_->setShape(stiffness, motions, std::move(loads), rows); });
}

// What belongs to rows is forgotten with them; where a change was refused as a whole, it stays.
void FetiSolver::changing(const std::function<void()>& change) {
  const auto forget = [&] {
    solution_.reset();
    history_.clear();
    increments_->clear();
    criteria_.groupOf.clear();
    criteria_.groups.clear();
    criteria_.areaOf.clear();
  };
  try {
    change();
  } catch (...) {
    if (!pipeline_->isComplete())
      forget();
    throw;
  }
  forget();
}

void FetiSolver::judgeBy(AnswerCriteria criteria) {
  const std::size_t rows = constraints()->givenRows().size();
  agree(*system().comm(), [&] {
    const int groups = static_cast<int>(criteria.groups.size());
    const std::size_t given = criteria.groupOf.size();
    if (given != (groups > 0 ? rows : 0))
      throw InputError("each constraint row that this rank gave needs a group, or -1: " +
                       std::to_string(given) + " groups for " + std::to_string(rows) + " rows");
    if (!criteria.areaOf.empty() && criteria.areaOf.size() != given)
      throw InputError(
          "each constraint row with a group needs an area, or 0: " + std::to_string(criteria.areaOf.size()) +
          " areas for " + std::to_string(given) + " rows");
    for (int group : criteria.groupOf)
      if (group < -1 || group >= groups)
        throw InputError("group " + std::to_string(group) + " of a constraint row is none of 0 to " +
                         std::to_string(groups - 1) + ", nor -1");
  });
  criteria_ = std::move(criteria);
}

void FetiSolver::requireOperators() const {
  if (!pipeline_->isComplete())
    throw InputError("the last setMatrices(), setShape() or setRows() failed; give matrices that can be "
                     "factored, and rows that fit them, or make a new solver");
}

const SolveReport& FetiSolver::solve(std::optional<double> tolerance) {
  requireOperators();
  try {
    pipeline_->problem();
  } catch (const NumericalError& error) { // on all ranks: loads on a motion that nothing can hold
    report_ = {};
    report_.reason = error.what();
    solution_.reset();
    return report_;
  }
  SolverOptions options = options_;
  options.tolerance = tolerance.value_or(options_.tolerance);
  AnswerCriteria criteria = criteria_;
  criteria.estimatesErrors = !criteria.groups.empty() || options.toleranceRule == ToleranceRule::Balanced;
  if (criteria.groups.empty())
    criteria.groupOf.assign(constraints()->givenRows().size(), -1);
  criteria.rule = options.toleranceRule;
  criteria.solverErrorShare = options.solverErrorShare;
  criteria.boundRounding = pipeline_->accuracy().boundRounding;
  AnswerQuality quality;
  SolveReport report;
  JudgedSolve solve(
      *pipeline_, [this] { return pipeline_->stages(); }, options, std::move(criteria), log_, report,
      quality);
  solution_ = std::make_unique<TornSolution>(solve.go(history_, options.tolerance, monitor_));
  report_ = std::move(report);
  quality_ = std::move(quality);
  return report_;
}

FetiSolver::Increment
FetiSolver::solveIncrement(std::vector<std::shared_ptr<const std::vector<double>>> loads,
                           const std::vector<ConstraintRow>& rows, double tolerance, bool withDisplacement) {
  requireOperators();
  return increments_->solve({std::move(loads), rows, tolerance, withDisplacement},
                            solution_ ? quality_.audit.largestDisplacement : 0.0);
}

void FetiSolver::exchangeStarts(qp::StateArchive<MultiVector>& archive) {
  const Teuchos::RCP<const DualProblem> problem = pipeline_->currentProblem();
  if (problem.is_null())
    throw InputError("there is no dual problem yet, so no start for it can be set; call solve() first");
  history_.exchange(archive, *problem);
  increments_->exchange(archive, *problem);
}

} // namespace Harmos::feti
