// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DualPipeline.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_CoarseForms.hpp"
#include "Harmos_DualOperator.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <tuple>

namespace Harmos::feti {
namespace {

// Keeps what an object refers to, as long as somebody has the object.
template<class T, class... Others>
Teuchos::RCP<T> keeping(T* made, const Teuchos::RCP<Others>&... others) {
  return Teuchos::rcpWithEmbeddedObjPostDestroy(made, std::make_tuple(others...));
}

} // namespace

DualPipeline::DualPipeline(SubdomainSystem system, const std::vector<ConstraintRow>& rows,
                           const DualOptions& options, const ProblemTraits& traits, const Log& log,
                           PipelineObserver* observer)
    : options_(options), traits_(traits), log_(log), observer_(observer) {
  made_.system = Teuchos::rcp(new SubdomainSystem(std::move(system)));
  constrain(rows);
  {
    const auto scope = during(PipelineStage::Inverses);
    decide();
    makeInverses();
  }
  tell(PipelineStage::Inverses);
  makeCoarse();
  makeOperators();
}

DualPipeline::~DualPipeline() = default;

std::shared_ptr<void> DualPipeline::during(PipelineStage stage) const {
  return observer_ != nullptr ? observer_->during(stage) : nullptr;
}

void DualPipeline::tell(PipelineStage stage) const {
  if (observer_ != nullptr)
    observer_->made(stage, *this);
}

PreconditionerScaling DualPipeline::scaling() const {
  return options_.scalingFor(traits_.hasSeveralMaterials, traits_.contrast);
}

void DualPipeline::constrain(const std::vector<ConstraintRow>& rows) {
  {
    const auto scope = during(PipelineStage::Constraints);
    made_.constraints =
        keeping(new Constraints(*made_.system, rows, options_.weightsFor(traits_.contrast)), made_.system);
    double rounding = 0.0;
    for (const ConstraintRow& row : rows)
      rounding = std::max(rounding, row.rounding);
    areBoundsStale_ = false;
    accuracy_.boundRounding = globalMax(*made_.system->comm(), rounding);
    ++counts_.constraints;
  }
  tell(PipelineStage::Constraints);
}

Teuchos::RCP<const Constraints> DualPipeline::constraintsOf(const std::vector<ConstraintRow>& rows) const {
  return keeping<const Constraints>(
      new Constraints(*made_.system, rows, options_.weightsFor(traits_.contrast)), made_.system);
}

void DualPipeline::decide() {
  const SubdomainSystem& system = *made_.system;
  const Constraints& constraints = *made_.constraints;
  const Log log = counts_.decisions == 0 ? log_ : log_.withoutInfo(); // told once
  decided_ = options_.decided(system, constraints, traits_.usualApplications, traits_.mayLump, log,
                              traits_.tolerance);
  clusters_ = options_.clustersFor(system, constraints, decided_, traits_.usualApplications, log);
  decided_.inverses.clusters = makeClusters(system, constraints, clusters_);
  ++counts_.decisions;
}

void DualPipeline::makeInverses() {
  auto made = Teuchos::rcp(
      new LocalInverses(makeLocalInverses(*made_.system, *made_.constraints, decided_.inverses)));
  if (!made_.inverses.is_null())
    spent_ += made_.inverses->counts();
  made_.inverses = made;
  measureInverses();
}

void DualPipeline::measureInverses() {
  const Teuchos::Comm<int>& comm = *made_.system->comm();
  accuracy_.condition = globalMax(comm, made_.inverses->condition());
  accuracy_.defect = globalMax(comm, made_.inverses->defect());
  accuracy_.roundedFactorizations =
      globalSum(comm, static_cast<long long>(made_.inverses->roundedFactorizations()));
  ++counts_.inverses;
}

// Of inverses and kernels. Whoever has the last ones keeps them.
void DualPipeline::makeCoarse() {
  {
    const auto scope = during(PipelineStage::Coarse);
    std::unique_ptr<CoarseSpace> coarse =
        makeCoarseSpace(motionsOf(*made_.system, *made_.inverses), *made_.constraints, options_.coarse);
    made_.coarse = keeping<const CoarseSpace>(coarse.release(), made_.system, made_.constraints);
    ++counts_.coarse;
  }
  tell(PipelineStage::Coarse);
}

// F last: it tells that the rest is there.
void DualPipeline::makeOperators() {
  {
    const auto scope = during(PipelineStage::Operators);
    if (decided_.preconditioner != PreconditionerKind::None)
      made_.preconditioner = keeping<const DualPreconditioner>(
          new DualPreconditioner(*made_.system, *made_.constraints, *made_.inverses, decided_.preconditioner,
                                 scaling()),
          made_.system, made_.constraints, made_.inverses);
    const Teuchos::RCP<const DualOperator> dual = keeping<const DualOperator>(
        new DualOperator(*made_.constraints, *made_.inverses), made_.constraints, made_.inverses);
    made_.adaptive =
        keeping(new AdaptiveSpace({*made_.system, *made_.constraints, *made_.inverses, *made_.coarse, *dual,
                                   made_.preconditioner},
                                  {decided_.inverses, decided_.preconditioner, scaling()}, options_.adaptive),
                made_.coarse, dual);
    made_.dual = dual;
    ++counts_.operators;
  }
  tell(PipelineStage::Operators);
}

// From here on nothing that was made of the old matrices may be used, also if a factorisation fails.
void DualPipeline::forgetOperators() {
  made_.problem = Teuchos::null;
  made_.adaptive = Teuchos::null;
  made_.dual = Teuchos::null;
  made_.preconditioner = Teuchos::null;
}

void DualPipeline::setLoads(std::vector<std::shared_ptr<const std::vector<double>>> loads) {
  made_.system->setLoads(std::move(loads));
  made_.problem = Teuchos::null;
}

void DualPipeline::setPrescribed(const std::vector<std::vector<double>>& values) {
  made_.system->setPrescribed(values);
  areBoundsStale_ = true;
  made_.problem = Teuchos::null;
}

void DualPipeline::setBounds(const std::vector<ConstraintRow>& rows) {
  made_.constraints->setBounds(rows);
  areBoundsStale_ = false;
  made_.problem = Teuchos::null;
}

void DualPipeline::setRows(const std::vector<ConstraintRow>& rows) {
  const Factored before = isComplete() ? factored() : Factored();
  forgetOperators();
  constrain(rows);
  renewInverses(before);
}

void DualPipeline::setMatrices(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness,
                               const std::vector<std::shared_ptr<const Kernel>>& motions) {
  const Factored before = isComplete() ? factored() : Factored();
  made_.system->setMatrices(stiffness, motions);
  forgetOperators();
  renewInverses(before);
}

void DualPipeline::setShape(const std::vector<std::shared_ptr<const LocalMatrix>>& stiffness,
                            const std::vector<std::shared_ptr<const Kernel>>& motions,
                            std::vector<std::shared_ptr<const std::vector<double>>> loads,
                            const std::vector<ConstraintRow>& rows,
                            std::vector<std::optional<Frame>> frames) {
  const Factored before = isComplete() ? factored() : Factored();
  made_.system->setMatrices(stiffness, motions);
  made_.system->setFrames(std::move(frames));
  forgetOperators();
  made_.system->setLoads(std::move(loads));
  constrain(rows);
  renewInverses(before);
}

// The matrices and kernels that inverses are of, or are to be of. After an error in the midst nothing is
// known of them.
DualPipeline::Factored DualPipeline::factored() const {
  Factored result;
  for (int i = 0; i < made_.system->size(); ++i)
    result.emplace_back(&made_.system->matrix(i), &made_.system->kernel(i));
  return result;
}

// Whether subdomains that shared an inverse do not any more, or the other way round.
bool DualPipeline::haveClassesChanged() const {
  std::vector<CongruenceClass> classes;
  agree(*made_.system->comm(), [&] {
    classes = congruenceClasses(*made_.system, *made_.constraints, decided_.inverses.share,
                                decided_.inverses.fixingPlaces);
  });
  const auto areMembersSame = [](const CongruenceClass& a, const CongruenceClass& b) {
    return a.members == b.members;
  };
  const bool isSame = std::equal(classes.begin(), classes.end(), made_.inverses->classes().begin(),
                                 made_.inverses->classes().end(), areMembersSame);
  return globalMin(*made_.system->comm(), isSame ? 1LL : 0LL) == 0;
}

void DualPipeline::renewInverses(const Factored& before) {
  {
    const auto scope = during(PipelineStage::Inverses);
    if (haveClassesChanged()) {
      decide();
      makeInverses();
    } else {
      const Factored now = factored();
      std::vector<char> isSame;
      for (std::size_t i = 0; i < now.size(); ++i)
        isSame.push_back(!before.empty() && now[i] == before[i] ? 1 : 0);
      decided_.inverses.clusters = makeClusters(*made_.system, *made_.constraints, clusters_);
      made_.inverses->renew(*made_.system, *made_.constraints, decided_.inverses, isSame);
      measureInverses();
    }
  }
  tell(PipelineStage::Inverses);
  makeCoarse();
  makeOperators();
}

void DualPipeline::useDoublePrecision() {
  const bool hadProblem = !made_.problem.is_null();
  const DualOptions::Decided before = decided_;
  forgetOperators();
  // For good: also where all is decided anew.
  options_.mayRound = false;
  options_.inverses.precision = Precision::Double;
  {
    const auto scope = during(PipelineStage::Inverses);
    decided_.inverses.productError = 0.0;
    decided_.inverses.precision = Precision::Double;
    try {
      if (before.isSingle()) {
        makeInverses();
      } else {
        made_.inverses->restoreProducts(*made_.system->comm());
        measureInverses();
      }
    } catch (...) {
      decided_ = before;
      throw;
    }
  }
  tell(PipelineStage::Inverses);
  makeOperators();
  if (hadProblem)
    problem();
}

const DualProblem& DualPipeline::problem() {
  if (made_.problem.is_null()) {
    {
      const auto scope = during(PipelineStage::Problem);
      if (areBoundsStale_) {
        const std::vector<ConstraintRow> rows = made_.constraints->givenRows();
        made_.constraints->setBounds(rows);
        areBoundsStale_ = false;
      }
      made_.problem = keeping<const DualProblem>(
          new DualProblem(*made_.system, *made_.constraints, *made_.inverses, *made_.dual, *made_.coarse),
          made_.coarse, made_.dual);
      ++counts_.problem;
    }
    tell(PipelineStage::Problem);
  }
  return *made_.problem;
}

DualStages DualPipeline::stages() {
  problem();
  return {made_.system,  made_.constraints,    made_.inverses, made_.coarse,
          made_.problem, made_.preconditioner, made_.adaptive};
}

DualStages DualPipeline::incrementStages(std::vector<std::shared_ptr<const std::vector<double>>> loads,
                                         const std::vector<ConstraintRow>& rows) {
  const auto system = Teuchos::rcp(new SubdomainSystem(*made_.system));
  system->setLoads(std::move(loads));
  std::vector<std::vector<double>> held;
  for (int i = 0; i < system->size(); ++i)
    held.emplace_back(system->subdomain(i).fixed.size(), 0.0);
  system->setPrescribed(held);
  const auto constraints = keeping(new Constraints(made_.constraints->withBounds(*system, rows)), system);
  const Teuchos::RCP<const DualProblem> problem = keeping<const DualProblem>(
      new DualProblem(*system, *constraints, *made_.inverses, *made_.dual, *made_.coarse), constraints,
      made_.coarse, made_.dual);
  return {system, constraints, made_.inverses, made_.coarse, problem, made_.preconditioner, made_.adaptive};
}

void DualPipeline::rethrowFailures() const {
  made_.dual->rethrowFailure();
  if (!made_.preconditioner.is_null())
    made_.preconditioner->rethrowFailure();
}

FactorizationCounts DualPipeline::factorizations() const {
  FactorizationCounts sum = spent_;
  sum += made_.inverses->counts();
  return sum;
}

} // namespace Harmos::feti
